"""
A push integrated finely along its steps.

The open loop runs away from its path by ``exp(s / L)``; so each change of the pushing angle is
corrected for the deviation so far. What comes out is an open-loop push again.
"""

import functools
import math
from typing import NamedTuple

import casadi as ca
import numpy as np
from push_model.dynamics import SMOOTHING
from push_planner.collocation.collocation import collocate, contact_impulse, Node, radau, Step
from push_planner.collocation.nlp_solver import Buffered
from push_planner.push_parameters import PARAMETER_COUNT, PushParameters

POINTS = 3
FIRST_STEPS, NEWTON_STEPS = 4, 2
GROWTH = 1.6
STEP_ROWS = 4


def graded_fractions(length, first, longest):
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


def settling_distance(problem):
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

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
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
    shares, flat = ca.MX.sym('shares', parts), ca.MX.sym('flat', PARAMETER_COUNT + 3 * supports)
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
    push_parameters, flat = PushParameters.symbols(supports)
    node, planned, gains = (ca.SX.sym(name, 6) for name in ('node', 'planned', 'gains'))
    change, begin = ca.SX.sym('change'), Node(*ca.vertsplit(node))
    driven = change - ca.dot(gains, node - planned)
    if jumps:
        jump, _, _ = contact_impulse(kind, push_parameters, begin, driven)
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
    push_parameters, flat = PushParameters.symbols(supports)
    before, rates = ca.SX.sym('before', 8), ca.SX.sym('rates', POINTS)
    share, along, data = ca.SX.sym('share'), ca.SX.sym('along'), ca.SX.sym('data', STEP_ROWS)
    length, square, slope, smoothing = ca.vertsplit(data)
    node, (rise, way) = before[:6], ca.vertsplit(before[6:])
    h, (places, _, inverse) = share * length, radau(POINTS)
    step = Step(h, along * share, square + slope * way, slope, False, smoothing)
    begin = Node(*ca.vertsplit(node))
    if kind == 'held':
        begin = begin._replace(phi=begin.theta)
    out = collocate(kind, push_parameters, begin, step, ca.vertsplit(rates))
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


FIRST_SHARE = 0.3
NUDGE = 1e-6
COARSE = 0.1


class Rollout(NamedTuple):
    """
    A push integrated finely.

    :param nodes: ``Node`` at the begin of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param ways: way from the begin of the push to each sample, shape (m,) [m].
    :param squares: V at each sample, shape (m,) [m^2/s^2].
    :param samples: ``Node`` at each sample, shape (m, 6).
    :param forces: (F_n, F_t) at each sample, shape (m, 2) [N]; nan at the begins of steps.
    :param begins: whether a sample is at the begin of a step, after a jump, shape (m,).
    """

    nodes: np.ndarray
    changes: np.ndarray
    ways: np.ndarray
    squares: np.ndarray
    samples: np.ndarray
    forces: np.ndarray
    begins: np.ndarray


class ReferenceTrack(NamedTuple):
    """
    What a rollout follows; arrays over the n steps.

    :param nodes: planned ``Node`` at the begin of each step, shape (n, 6).
    :param changes: planned change of the pushing angle, shape (n,) [rad].
    :param gains: of the correction for the deviation, shape (n, 6).
    """

    nodes: np.ndarray
    changes: np.ndarray
    gains: np.ndarray


class _Group(NamedTuple):
    """Steps that have equally many parts: which, and the shares of their parts."""

    pick: slice
    shares: np.ndarray


class ClosedLoopRollout:
    """
    Integrates one push, again and again.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param way: S, about [m].
    """

    def __init__(self, problem, formulation, way):
        """Divide the steps into parts."""
        self._grid, self._shape = formulation.grid, formulation.shape
        self._inertia = formulation.steps[:, 2:4]
        self._column = problem.push_parameters.column()
        # At most half a part lies between two samples.
        spacing = 2.0 * problem.settings.sample_spacing
        start = FIRST_SHARE * settling_distance(problem)
        lengths = self._grid.steps(way)
        count = len(lengths)
        groups = [range(count)] if self._shape.jumps else [range(1), range(1, count)]
        self._groups = []
        for group in groups:
            rough = group.start == 0
            shares = [graded_fractions(lengths[k], start, spacing) for k in group] if rough else []
            parts = max([math.ceil(max(lengths[group.start:]) / spacing),
                         *(len(share) for share in shares)])
            self._groups.append(_Group(
                slice(group.start, group.stop),
                np.array([_spread(share, parts) for share in shares])
                if rough else np.full((len(group), parts), 1.0 / parts)))
        # A first run and derivatives can do with longer parts, except where w settles.
        few = math.ceil(max(lengths) / COARSE)
        self._coarse = self._groups if self._shape.jumps else [
            self._groups[0], _Group(slice(1, count), np.full((count - 1, few), 1.0 / few))]

    def steps(self, way):
        """
        Collect (length, V, dV/ds, smoothing) of the steps, shape (n, 4).

        :param way: S [m].
        """
        # The friction of the model turns viscous below a speed in m/s, here it is per speed.
        pace = np.sqrt(np.maximum(self._grid.squares, self._grid.ends))
        return np.column_stack([self._grid.steps(way), self._inertia, SMOOTHING / pace])

    def run(self, track, way, coarse=False):
        """
        Follow a track.

        :param track: ``ReferenceTrack``.
        :param way: S [m].
        :param coarse: whether in fewer parts, too few samples for a ``rollout``.
        :return: (nodes, shape (n + 1, 6); changes, shape (n,) [rad]; the rest for ``rollout``).
        """
        node, nodes, changes, rest = track.nodes[0], [], [], []
        steps = self.steps(way)
        for group in self._coarse if coarse else self._groups:
            pick = group.pick
            ends, driven, *more = self._function(advance, group)(
                node, track.nodes[pick], track.changes[pick, None], track.gains[pick],
                steps[pick], group.shares, self._column)
            nodes += [node[None, :], ends[:-1]]
            changes.append(driven.ravel())
            rest.append(more)
            node = ends[-1]
        return np.vstack([*nodes, node]), np.concatenate(changes), rest

    def linear(self, nodes, changes, way, free):
        """
        Differentiate all steps by differences.

        :param nodes: ``Node`` at the begin of each step, shape (n, 6).
        :param changes: of the pushing angle, shape (n,) [rad].
        :param way: S [m].
        :param free: 1 where the pushing angle may change, shape (n,).
        :return: end of each step and S by its begin, S and change, shape (n, 7, 8).
        """
        maps = np.zeros((len(nodes), 7, 8))
        maps[:, 6, 6] = 1.0
        for group in self._coarse:
            pick = group.pick
            count = len(group.shares)
            shift = np.repeat(np.eye(9, 8, -1), count, axis=0) * NUDGE
            steps = np.tile(self.steps(way)[pick], (9, 1))
            steps[:, 0] += shift[:, 6] * np.tile(self._grid.shares[pick], 9)
            bent = np.tile(changes[pick], 9) + shift[:, 7] * np.tile(free[pick], 9)
            ends = self._function(beside, group, 9)(
                np.tile(nodes[pick], (9, 1)) + shift[:, :6], 0.0, bent[:, None], 0.0, steps,
                np.tile(group.shares, (9, 1)), self._column)[0].reshape(9, count, 6)
            maps[pick, :6] = ((ends[1:] - ends[0]) / NUDGE).transpose(1, 2, 0)
        return maps

    def rollout(self, nodes, changes, rest, way):
        """
        Put together what ``run`` gave.

        :param way: S [m].
        :return: ``Rollout``.
        """
        lengths, places = self._grid.steps(way), radau(POINTS)[0]
        begins = np.cumsum(lengths) - lengths
        parts = []
        for group, (after, samples, forces) in zip(self._groups, rest):
            pick, count = group.pick, group.shares.shape[1] * POINTS
            h = group.shares * lengths[pick, None]
            ways = (np.cumsum(h, axis=1) - h)[:, :, None] + h[:, :, None] * places
            ways = np.hstack([np.zeros((len(h), 1)), ways.reshape(len(h), count)])
            squares = self._grid.squares[pick, None] + self._grid.slopes[pick, None] * ways
            rows = np.concatenate([after[:, None, :], samples.reshape(-1, count, 6)], axis=1)
            pressed = np.concatenate([np.full((len(h), 1, 2), np.nan),
                                      forces.reshape(-1, count, 2)], axis=1)
            parts.append(((begins[pick, None] + ways).ravel(), squares.ravel(),
                          rows.reshape(-1, 6), pressed.reshape(-1, 2), (ways == 0.0).ravel()))
        return Rollout(nodes, changes, *(np.concatenate(column) for column in zip(*parts)))

    def _function(self, build, group, times=1):
        shape = self._shape
        count, parts = group.shares.shape
        return build(shape.kind, shape.supports, shape.jumps, parts, times * count)


def _spread(shares, parts):
    """Split the largest shares until there are as many parts as wanted."""
    shares = list(shares)
    while len(shares) < parts:
        widest = int(np.argmax(shares))
        half = 0.5 * shares[widest]
        shares[widest:widest + 1] = [half, half]
    return shares
