"""
Functions that integrate a push finely, while a linear law holds it to the planned nodes.

After a switch of the pushing angle w settles within millimetres when slow: parts begin short and
grow.
"""

import functools

import casadi as ca
import numpy as np

from push_planner.buffered import Buffered
from push_planner.constants import Constants, COUNT
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


@functools.lru_cache(maxsize=64)
def one_step(kind, supports, jumps, parts):
    """Build one step; arguments as for ``advance``."""
    node, planned, gains = (ca.MX.sym(name, 6) for name in ('node', 'planned', 'gains'))
    change, data = ca.MX.sym('change'), ca.MX.sym('data', STEP_ROWS)
    shares, flat = ca.MX.sym('shares', parts), ca.MX.sym('flat', COUNT + 3 * supports)
    driven, begin = _begin(kind, supports, jumps)(node, planned, gains, change, flat)
    along = 0.0 if jumps else driven
    # Within a step w goes on smoothly, and so does the guess.
    now, *found = _part(kind, supports, FIRST_STEPS)(ca.vertcat(begin, 0.0, 0.0), shares[0],
                                                     along, data, flat)
    if parts > 1:
        later = _part(kind, supports, NEWTON_STEPS).mapaccum(parts - 1)
        passed, *more = later(now, shares[1:].T, along, data, flat)
        now, found = passed[:, -1], [ca.horzcat(*pair) for pair in zip(found, more)]
    return ca.Function('step', [node, planned, change, gains, data, shares, flat], [
        now[:6], driven, begin, *(ca.vec(values) for values in found)])


@functools.lru_cache(maxsize=16)
def _begin(kind, supports, jumps):
    """Begin a step: the change of the pushing angle, corrected, and the node after its jump."""
    constants, flat = Constants.symbols(supports)
    node, planned, gains = (ca.SX.sym(name, 6) for name in ('node', 'planned', 'gains'))
    change, begin = ca.SX.sym('change'), Node(*ca.vertsplit(node))
    driven = change - ca.dot(gains, node - planned)
    if jumps:
        jump, _, _ = touch(kind, constants, begin, driven)
        begin = begin._replace(w=begin.w + jump, rho=begin.rho + driven)
    return ca.Function('begin', [node, planned, gains, change, flat], [driven,
                                                                       ca.vertcat(*begin)])


@functools.lru_cache(maxsize=16)
def _part(kind, supports, count):
    """
    Build one Radau step, solved by Newton's method.

    From (node, dw/ds, way in the step), share of the step, change of the pushing angle over the
    step, its numbers and the constants to the same after it, samples and forces.
    """
    constants, flat = Constants.symbols(supports)
    before, rates = ca.SX.sym('before', 8), ca.SX.sym('rates', POINTS)
    share, along, data = ca.SX.sym('share'), ca.SX.sym('along'), ca.SX.sym('data', STEP_ROWS)
    length, square, slope, smoothing = ca.vertsplit(data)
    node, (rise, way) = before[:6], ca.vertsplit(before[6:])
    h, (places, _, inverse) = share * length, radau(POINTS)
    step = Step(h, along * share, square + slope * way, slope, False, smoothing)
    begin = Node(*ca.vertsplit(node))
    if kind == 'held':
        begin = begin._replace(phi=begin.theta)
    out = collocate(kind, constants, begin, step, ca.vertsplit(rates))
    residual = ca.vertcat(*out.residuals)
    given = [before, share, along, data, flat]
    newton = ca.Function('newton', [rates, *given],
                         [rates - ca.solve(ca.jacobian(residual, rates), residual)])
    after = ca.vertcat(*out.node, ca.dot(ca.DM(inverse[-1]), rates - node[0]) / h, way + h)
    finish = ca.Function('finish', [rates, *given], [
        after, ca.vertcat(*[ca.vertcat(*sample) for sample in out.samples]),
        ca.vertcat(*[ca.vertcat(*force) for force in out.forces])])
    found = node[0] + rise * h * ca.DM(places)
    for _ in range(count):
        found = newton(found, *given)
    return ca.Function('part', given, ca.cse(list(finish(found, *given))))
