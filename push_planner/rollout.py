"""
Functions that integrate a push finely, while a linear law holds it to the planned nodes.

After a switch of the pushing angle w settles within millimetres when slow: parts begin short and
grow.
"""

import functools

import casadi as ca
import numpy as np

from push_planner.buffered import Buffered
from push_planner.constants import Constants
from push_planner.stage import collocate, touch
from push_planner.step import Node, radau, Step

POINTS = 3
FIRST_STEPS, NEWTON_STEPS = 4, 2
GROWTH = 1.6
STEP_ROWS = 4


def fractions(length, first, longest):
    """
    Divide a step into parts that grow from a first one.

    :param length: of the step [m].
    :param first: about the first part [m].
    :param longest: the longest part [m].
    :return: shares of the step, summing to 1.
    """
    parts = [min(first, longest, length)]
    while parts[-1] < longest and sum(parts) < length:
        parts.append(min(longest, GROWTH * parts[-1]))
    rest = length - sum(parts)
    if rest > 0.0:
        pieces = int(np.ceil(rest / longest))
        parts += [rest / pieces] * pieces
    return np.array(parts) / sum(parts)


def settling_way(problem):
    """
    Way over which the turning rate settles after a switch, ``v^2 (I/m + r^2) / (mu g r L)`` [m].

    :param problem: the ``PushProblem``.
    """
    vehicle, obj = problem.vehicle, problem.obj
    inertia = obj.inertia + obj.mass * vehicle.arm ** 2
    friction = sum(obj.capacities) * vehicle.arm * vehicle.wheelbase
    return problem.settings.pushing_speed ** 2 * inertia / friction


@functools.lru_cache(maxsize=64)
def advance(kind, supports, jumps, parts, steps):
    """
    Build the rollout over steps of equally many parts.

    :param kind: one of ``push_planner.constants.KINDS``.
    :param supports: number of supports.
    :param jumps: whether the pushing angle jumps at the begin of a step.
    :param parts: number of parts of a step.
    :param steps: number of steps.
    :return: ``Buffered`` function of the node at the begin and, one row per step: planned node,
        change, gains, step and shares of the parts; then the constants. It gives, one row per
        step: the node at the end, the change, the node after a jump, samples, forces.
    """
    one = one_step(kind, supports, jumps, parts)
    return Buffered(one.mapaccum('advance', steps) if steps > 1 else one)


@functools.lru_cache(maxsize=64)
def beside(kind, supports, jumps, parts, steps):
    """Build steps that begin where they are told to; arguments as for ``advance``."""
    return Buffered(one_step(kind, supports, jumps, parts).map(steps))


@functools.lru_cache(maxsize=32)
def one_step(kind, supports, jumps, parts):
    """Build one step; arguments as for ``advance``."""
    constants, flat = Constants.symbols(supports)
    node, planned, gains = (ca.SX.sym(name, 6) for name in ('node', 'planned', 'gains'))
    change, data, shares = ca.SX.sym('change'), ca.SX.sym('data', STEP_ROWS), ca.SX.sym(
        'shares', parts)
    length, square, slope, smoothing = ca.vertsplit(data)
    driven = change - ca.dot(gains, node - planned)
    begin = Node(*ca.vertsplit(node))
    if jumps:
        jump, _, _ = touch(kind, constants, begin, driven)
        begin = begin._replace(w=begin.w + jump, rho=begin.rho + driven)
    places, _, inverse = radau(POINTS)
    # Within a step w goes on smoothly, and so does the guess.
    now, way, samples, forces, rise = ca.vertcat(*begin), 0.0, [], [], 0.0
    for i in range(parts):
        h = shares[i] * length
        along = 0.0 if jumps else driven * shares[i]
        part = _part(kind, supports, NEWTON_STEPS if i else FIRST_STEPS)
        found, force = part(now[0] + rise * h * ca.DM(places), now, h, along,
                            square + slope * way, slope, smoothing, flat)
        rise = ca.dot(ca.DM(inverse[-1]), found[0, :].T - now[0]) / h
        way, now = way + h, found[:, POINTS - 1]
        samples.append(found)
        forces.append(force)
    return ca.Function('step', [node, planned, change, gains, data, shares, flat], [
        now, driven, ca.vertcat(*begin), ca.vec(ca.horzcat(*samples)),
        ca.vec(ca.horzcat(*forces))])


@functools.lru_cache(maxsize=16)
def _part(kind, supports, count):
    """One Radau step, solved by Newton's method from a guess: samples (6, K), forces (2, K)."""
    constants, flat = Constants.symbols(supports)
    node, rates = ca.SX.sym('node', 6), ca.SX.sym('rates', POINTS)
    length, change, square, slope, smoothing = (ca.SX.sym(name) for name in (
        'length', 'change', 'square', 'slope', 'smoothing'))
    step = Step(length, change, square, slope, False, smoothing)
    begin = Node(*ca.vertsplit(node))
    if kind == 'held':
        begin = begin._replace(phi=begin.theta)
    out = collocate(kind, constants, begin, step, ca.vertsplit(rates))
    residual = ca.vertcat(*out.residuals)
    given = [node, length, change, square, slope, smoothing, flat]
    newton = ca.Function('newton', [rates, *given],
                         [rates - ca.solve(ca.jacobian(residual, rates), residual)])
    samples = ca.horzcat(*[ca.vertcat(*sample) for sample in out.samples])
    forces = ca.horzcat(*[ca.vertcat(*force) for force in out.forces])
    finish = ca.Function('finish', [rates, *given], [samples, forces])
    found = guess = ca.SX.sym('guess', POINTS)
    for _ in range(count):
        found = newton(found, *given)
    results = ca.cse(list(finish(found, *given)))
    return ca.Function('part', [guess, *given], results)
