"""
Rollout: a push integrated finely along its steps, in closed loop around a reference.

In open loop a push runs away from its path by ``exp(s / L)``, with L the wheelbase. So each change
of the pushing angle is corrected for the deviation of the node at its begin,

    change = change_ref - K (node - node_ref)

and the corrected changes are those of a push in open loop again. Every step is divided into parts,
each a Radau step of three points (see ``collocation``), solved by Newton's method.
"""

from collections.abc import Callable, Sequence
import functools
import math
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.dynamics import SMOOTHING
from push_model.geometry import BoolArray, FloatArray
from push_planner.collocation.collocation import collocate, contact_impulse, Node, radau, Step
from push_planner.collocation.formulation import Formulation
from push_planner.collocation.nlp_solver import BufferedFunction
from push_planner.problem import PushProblem
from push_planner.push_parameters import PushKind, PushParameters, SupportLayout

# Radau points of a part. Chosen: order 5 at its end.
POINTS = 3
# Newton iterations of the first part of a step, where w may jump, and of the others, whose guess
# is the slope before. Chosen: the residual is at rounding then.
FIRST_NEWTON_STEPS = 4
NEWTON_STEPS = 2
# Ratio of the lengths of successive parts where w settles. Chosen: fine at first, few in all.
GROWTH = 1.6
# First part of a step over the settling distance of w. Chosen: w settles by a quarter in it.
FIRST_PART_RATIO = 0.3
# Longest part of a coarse rollout [m]. Chosen: as fine as a first correction needs.
COARSE_PART = 0.1
# Difference for derivatives [m, rad, 1/m]. Chosen: about the square root of the rounding of
# float64 gives the best forward differences, and Newton's method leaves some more noise.
DIFFERENCE = 1e-6
# Scalars of a step that the rollout needs: length, V, dV/ds, smoothing.
STEP_SCALARS = 4
NODE_SIZE = len(Node._fields)


class Rollout(NamedTuple):
    """
    A push integrated finely; m samples over n steps.

    :param nodes: ``Node`` at the begin of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param s: path length of the contact from the start to each sample, shape (m,) [m].
    :param v_squared: V at each sample, shape (m,) [m^2/s^2].
    :param samples: ``Node`` at each sample, shape (m, 6).
    :param forces: (F_n, F_t) at each sample, shape (m, 2) [N]; nan at the begins of steps.
    :param is_begin: whether a sample is at the begin of a step, after a jump, shape (m,).
    """

    nodes: FloatArray
    changes: FloatArray
    s: FloatArray
    v_squared: FloatArray
    samples: FloatArray
    forces: FloatArray
    is_begin: BoolArray


class ReferenceTrack(NamedTuple):
    """
    Reference of a rollout; arrays over the n steps.

    :param nodes: ``Node`` at the begin of each step, shape (n, 6).
    :param changes: of the pushing angle, shape (n,) [rad].
    :param gains: K, of the correction of the changes, shape (n, 6).
    """

    nodes: FloatArray
    changes: FloatArray
    gains: FloatArray


class GroupOutput(NamedTuple):
    """
    Samples of a group of steps, a row for each step; flat, to be reshaped.

    :param begins: ``Node`` at the begins, after a jump.
    :param samples: ``Node`` at the Radau points of all parts.
    :param forces: (F_n, F_t) there [N].
    """

    begins: FloatArray
    samples: FloatArray
    forces: FloatArray


class Run(NamedTuple):
    """
    Result of following a reference.

    :param nodes: ``Node`` at the begin of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle, corrected, shape (n,) [rad].
    :param outputs: ``GroupOutput`` of each group of steps.
    """

    nodes: FloatArray
    changes: FloatArray
    outputs: list[GroupOutput]


class _Group(NamedTuple):
    """Successive steps of equally many parts: which, and the fractions of their parts."""

    steps: slice
    fractions: FloatArray


def graded_fractions(length: float, first: float, longest: float) -> FloatArray:
    """
    Divide a step into parts that grow from a first one.

    :param length: of the step [m].
    :param first: about the first part [m].
    :param longest: the longest part [m].
    :return: fractions of the step, summing to 1.
    """
    parts = [min(first, longest, length)]
    while parts[-1] < longest and sum(parts) < length:
        parts.append(min(longest, GROWTH * parts[-1]))
    rest = length - sum(parts)
    if rest > 0.0:
        count = int(np.ceil(rest / longest))
        parts += [rest / count] * count
    return np.array(parts) / sum(parts)


def settling_distance(problem: PushProblem) -> float:
    """
    Distance over which the yaw rate settles after a jump [m].

    ``v^2 (I/m + r^2) / (mu g r L)``: the larger the inertia against friction, the longer.

    :param problem: the ``PushProblem``.
    """
    vehicle, obj = problem.vehicle, problem.obj
    inertia = obj.inertia + obj.mass * vehicle.arm ** 2
    friction = sum(obj.capacities) * vehicle.arm * vehicle.wheelbase
    return problem.settings.pushing_speed ** 2 * inertia / friction


@functools.lru_cache(maxsize=64)
def chained_steps(kind: PushKind, supports: SupportLayout, jumps: bool, parts: int,
                  count: int) -> BufferedFunction:
    """
    Build the rollout over steps of equally many parts, each from the end of the one before.

    The function takes the node at the begin and, a row for each step: reference node, reference
    change, gains, scalars and fractions of the parts; then the ``PushParameters``. It returns, a
    row for each step: node at the end, change, node after a jump, samples, forces.

    :param kind: how the contact moves with the robot.
    :param supports: ``SupportLayout``.
    :param jumps: whether the pushing angle jumps at the begin of a step.
    :param parts: number of parts of a step.
    :param count: number of steps.
    """
    one = one_step(kind, supports, jumps, parts)
    return BufferedFunction(one.mapaccum('chained', count) if count > 1 else one)


@functools.lru_cache(maxsize=64)
def separate_steps(kind: PushKind, supports: SupportLayout, jumps: bool, parts: int,
                   count: int) -> BufferedFunction:
    """Build steps with a begin of their own each; arguments as of ``chained_steps``."""
    return BufferedFunction(one_step(kind, supports, jumps, parts).map(count))


@functools.lru_cache(maxsize=64)
def one_step(kind: PushKind, supports: SupportLayout, jumps: bool, parts: int) -> Any:
    """Build one step; arguments as of ``chained_steps``."""
    node, reference, gains = (ca.MX.sym(name, NODE_SIZE) for name in ('node', 'reference',
                                                                      'gains'))
    change, scalars = ca.MX.sym('change'), ca.MX.sym('scalars', STEP_SCALARS)
    fractions = ca.MX.sym('fractions', parts)
    column = ca.MX.sym('column', supports.column_size)
    corrected, begin = _begin_step(kind, supports, jumps)(node, reference, gains, change, column)
    along = 0.0 if jumps else corrected
    # Within a step w goes on smoothly, and so does the guess.
    state, *found = _part(kind, supports, FIRST_NEWTON_STEPS)(
        ca.vertcat(begin, 0.0, 0.0), fractions[0], along, scalars, column)
    if parts > 1:
        others = _part(kind, supports, NEWTON_STEPS).mapaccum(parts - 1)
        states, *more = others(state, fractions[1:].T, along, scalars, column)
        state = states[:, -1]
        found = [ca.horzcat(*pair) for pair in zip(found, more)]
    return ca.Function('step', [node, reference, change, gains, scalars, fractions, column], [
        state[:NODE_SIZE], corrected, begin, *(ca.vec(values) for values in found)])


@functools.lru_cache(maxsize=16)
def _begin_step(kind: PushKind, supports: SupportLayout, jumps: bool) -> Any:
    """Build the begin of a step: its corrected change, and the node after a jump."""
    parameters, column = PushParameters.symbols(supports)
    node, reference, gains = (ca.SX.sym(name, NODE_SIZE) for name in ('node', 'reference',
                                                                      'gains'))
    change = ca.SX.sym('change')
    begin = Node(*ca.vertsplit(node))
    corrected = change - ca.dot(gains, node - reference)
    if jumps:
        response = contact_impulse(kind, parameters, begin, corrected)
        begin = begin._replace(w=begin.w + response.w_jump, rho=begin.rho + corrected)
    return ca.Function('begin', [node, reference, gains, change, column],
                       [corrected, ca.vertcat(*begin)])


@functools.lru_cache(maxsize=16)
def _part(kind: PushKind, supports: SupportLayout, newton_steps: int) -> Any:
    """
    Build one part of a step, solved by Newton's method.

    A function (state, fraction of the step, change of the pushing angle over the step, scalars of
    the step, parameters) -> (state after it, samples, forces). A state is a node, dw/ds and the
    path length since the begin of the step.
    """
    parameters, column = PushParameters.symbols(supports)
    state, rates = ca.SX.sym('state', NODE_SIZE + 2), ca.SX.sym('rates', POINTS)
    fraction, along = ca.SX.sym('fraction'), ca.SX.sym('along')
    scalars = ca.SX.sym('scalars', STEP_SCALARS)
    length, v_squared, v_squared_slope, smoothing = ca.vertsplit(scalars)
    node = state[:NODE_SIZE]
    w_slope, s = ca.vertsplit(state[NODE_SIZE:])
    scheme = radau(POINTS)
    h = fraction * length
    step = Step(h, along * fraction, v_squared + v_squared_slope * s, v_squared_slope, False,
                smoothing)
    begin = Node(*ca.vertsplit(node))
    if kind == 'held':
        begin = begin._replace(phi=begin.theta)
    result = collocate(kind, parameters, begin, step, ca.vertsplit(rates))
    residual = ca.vertcat(*result.residuals)
    given = [state, fraction, along, scalars, column]
    newton = ca.Function('newton', [rates, *given],
                         [rates - ca.solve(ca.jacobian(residual, rates), residual)])
    end_slope = ca.dot(ca.DM(scheme.inverse[-1]), rates - node[0]) / h
    finish = ca.Function('finish', [rates, *given], [
        ca.vertcat(*result.end, end_slope, s + h),
        ca.vertcat(*[ca.vertcat(*sample) for sample in result.samples]),
        ca.vertcat(*[ca.vertcat(*force) for force in result.forces])])
    found = node[0] + w_slope * h * ca.DM(scheme.points)
    for _ in range(newton_steps):
        found = newton(found, *given)
    return ca.Function('part', given, ca.cse(list(finish(found, *given))))


class ClosedLoopRollout:
    """
    Integrates one push, again and again.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param free_length: S, about [m].
    """

    def __init__(self, problem: PushProblem, formulation: Formulation,
                 free_length: float) -> None:
        """Divide the steps into parts."""
        self._mesh = formulation.mesh
        self._dimensions = formulation.dimensions
        # V and dV/ds as the program has them: 0 without inertia.
        self._inertia = formulation.steps[:, 2:4]
        self._column = problem.push_parameters.column()
        # At most half a part lies between two samples.
        longest = 2.0 * problem.settings.sample_spacing
        first = FIRST_PART_RATIO * settling_distance(problem)
        lengths = self._mesh.step_lengths(free_length)
        self._groups = self._graded_groups(lengths, first, longest)
        self._coarse_groups = self._groups
        if not self._dimensions.jumps:
            count = len(lengths)
            parts = math.ceil(max(lengths) / COARSE_PART)
            # Coarse, except where w settles.
            self._coarse_groups = [self._groups[0], _Group(
                slice(1, count), np.full((count - 1, parts), 1.0 / parts))]

    def run(self, track: ReferenceTrack, free_length: float, coarse: bool = False) -> Run:
        """
        Follow a reference.

        :param track: ``ReferenceTrack``.
        :param free_length: S [m].
        :param coarse: whether in fewer parts, with too few samples for a ``Rollout``.
        """
        node = track.nodes[0]
        nodes: list[FloatArray] = []
        changes: list[FloatArray] = []
        outputs: list[GroupOutput] = []
        scalars = self._step_scalars(free_length)
        for group in self._coarse_groups if coarse else self._groups:
            steps = group.steps
            ends, corrected, begins, samples, forces = self._function(chained_steps, group)(
                node, track.nodes[steps], track.changes[steps, None], track.gains[steps],
                scalars[steps], group.fractions, self._column)
            nodes += [node[None, :], ends[:-1]]
            changes.append(corrected.ravel())
            outputs.append(GroupOutput(begins, samples, forces))
            node = ends[-1]
        return Run(np.vstack([*nodes, node]), np.concatenate(changes), outputs)

    def linearize(self, nodes: FloatArray, changes: FloatArray, free_length: float,
                  may_steer: FloatArray) -> FloatArray:
        """
        Differentiate all steps by differences.

        :param nodes: ``Node`` at the begin of each step, shape (n, 6).
        :param changes: of the pushing angle, shape (n,) [rad].
        :param free_length: S [m].
        :param may_steer: 1 where the pushing angle may change, shape (n,).
        :return: derivatives of the end of each step and S by its begin, S and change, shape
            (n, 7, 8).
        """
        maps = np.zeros((len(nodes), NODE_SIZE + 1, NODE_SIZE + 2))
        maps[:, 6, 6] = 1.0
        for group in self._coarse_groups:
            steps = group.steps
            count = len(group.fractions)
            # All steps as they are, and then with a difference in each of the 8 arguments.
            shift = np.repeat(np.eye(9, 8, -1), count, axis=0) * DIFFERENCE
            scalars = np.tile(self._step_scalars(free_length)[steps], (9, 1))
            scalars[:, 0] += shift[:, 6] * np.tile(self._mesh.free_fractions[steps], 9)
            shifted = np.tile(changes[steps], 9) + shift[:, 7] * np.tile(may_steer[steps], 9)
            ends = self._function(separate_steps, group, 9)(
                np.tile(nodes[steps], (9, 1)) + shift[:, :NODE_SIZE], 0.0, shifted[:, None], 0.0,
                scalars, np.tile(group.fractions, (9, 1)),
                self._column)[0].reshape(9, count, NODE_SIZE)
            maps[steps, :NODE_SIZE] = ((ends[1:] - ends[0]) / DIFFERENCE).transpose(1, 2, 0)
        return maps

    def collect(self, run: Run, free_length: float) -> Rollout:
        """
        Put the samples of a fine run together.

        :param run: ``Run``.
        :param free_length: S of the run [m].
        """
        mesh = self._mesh
        lengths = mesh.step_lengths(free_length)
        points = radau(POINTS).points
        begins = np.cumsum(lengths) - lengths
        columns: list[tuple[Any, ...]] = []
        for group, output in zip(self._groups, run.outputs):
            steps = group.steps
            count = group.fractions.shape[1] * POINTS
            h = group.fractions * lengths[steps, None]
            # Path lengths since the begin of the step: of the begin, and of all points.
            s = (np.cumsum(h, axis=1) - h)[:, :, None] + h[:, :, None] * points
            s = np.hstack([np.zeros((len(h), 1)), s.reshape(len(h), count)])
            v_squared = (mesh.v_squared[steps, None]
                         + mesh.v_squared_slopes[steps, None] * s)
            samples = np.concatenate([output.begins[:, None, :],
                                      output.samples.reshape(-1, count, NODE_SIZE)], axis=1)
            forces = np.concatenate([np.full((len(h), 1, 2), np.nan),
                                     output.forces.reshape(-1, count, 2)], axis=1)
            columns.append(((begins[steps, None] + s).ravel(), v_squared.ravel(),
                            samples.reshape(-1, NODE_SIZE), forces.reshape(-1, 2),
                            (s == 0.0).ravel()))
        return Rollout(run.nodes, run.changes,
                       *(np.concatenate(column) for column in zip(*columns)))

    def _graded_groups(self, lengths: FloatArray, first: float, longest: float) -> list[_Group]:
        """Divide the steps after whose begin w settles finely: the first, or after all jumps."""
        count = len(lengths)
        if self._dimensions.jumps:
            graded = [graded_fractions(length, first, longest) for length in lengths]
            return [_Group(slice(0, count), _equal_counts(graded, lengths, longest))]
        graded = [graded_fractions(lengths[0], first, longest)]
        parts = math.ceil(max(lengths[1:]) / longest)
        return [_Group(slice(0, 1), _equal_counts(graded, lengths, longest)),
                _Group(slice(1, count), np.full((count - 1, parts), 1.0 / parts))]

    def _step_scalars(self, free_length: float) -> FloatArray:
        """Columns (length, V, dV/ds, smoothing) of the steps, shape (n, 4)."""
        # The friction of the model becomes viscous below a speed in m/s, here it is per speed.
        speed = np.sqrt(np.maximum(self._mesh.v_squared, self._mesh.end_v_squared))
        return np.column_stack([self._mesh.step_lengths(free_length), self._inertia,
                                SMOOTHING / speed])

    def _function(self, build: Callable[..., BufferedFunction], group: _Group,
                  times: int = 1) -> BufferedFunction:
        dimensions = self._dimensions
        count, parts = group.fractions.shape
        return build(dimensions.kind, dimensions.supports, dimensions.jumps, parts,
                     times * count)


def _equal_counts(graded: Sequence[FloatArray], lengths: FloatArray,
                  longest: float) -> FloatArray:
    """Split parts until all steps have as many, enough for the longest of all lengths."""
    parts = max([math.ceil(max(lengths) / longest), *(len(fractions) for fractions in graded)])
    return np.array([_split_largest(fractions, parts) for fractions in graded])


def _split_largest(fractions: FloatArray, parts: int) -> list[float]:
    """Halve the largest fractions until there are as many parts as asked for."""
    found = list(fractions)
    while len(found) < parts:
        largest = int(np.argmax(found))
        half = 0.5 * found[largest]
        found[largest:largest + 1] = [half, half]
    return found
