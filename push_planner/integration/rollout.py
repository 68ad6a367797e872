"""
Rollout: a push integrated finely along its steps, in closed loop around a reference.

In open loop a push runs away from its path by ``exp(s / L)``, with L the wheelbase. So each change
of the pushing angle is corrected for the deviation of the node at its begin,

    change = change_ref - K (node - node_ref)

and the corrected changes are those of a push in open loop again. Every step is divided into parts,
each a Radau step of three points (see ``collocation``), solved by Newton's method: the rows of a
``push_dynamics.machine_code.RowFunction``. Parts for which it does not converge are divided.
"""

import functools
import math
import threading
from typing import Any, NamedTuple, Optional

import casadi as ca
import numpy as np
from push_dynamics.machine_code import BoundRows, RowFunction, RowSequence
from push_model.dynamics import SMOOTHING
from push_model.geometry import FloatArray, IntArray
from push_planner.collocation.collocation import (
    collocate, contact_impulse, force_at_begin, Node, radau, Step,
)
from push_planner.collocation.dimensions import Dimensions, StepData
from push_planner.collocation.formulation import Formulation
from push_planner.problem import PushProblem
from push_planner.push_parameters import PushKind, PushParameters, SupportLayout

# Radau points of a part. Chosen: order 5 at its end.
POINTS = 3
# Newton iterations of a part. Measured: the durations of 84 pushes are within 2e-9 of those with
# six, also where w jumps and the guess is that it stays; with two iterations within 8e-7.
NEWTON_STEPS = 3
# Residual of the moment balance over the supports' friction up to which Newton's method has
# converged [m]. Chosen: one more iteration would leave rounding.
CONVERGED = 1e-6
# Number of parts that a part is divided into where it has not, within how many steps at a time,
# and how often. Measured: where an object turns about one of its supports its yaw rate changes
# within a thousandth of a step; of 397 pushes all converge, after five times at most. Chosen: what
# follows a part that fails says little.
DIVISION = 8
DIVIDED_STEPS = 3
MAX_DIVISIONS = 6
# Ratio of the lengths of successive parts where w settles. Chosen: fine at first, few in all.
GROWTH = 1.6
# First part of the push, and of a step after a jump of the angle, over the settling distance of w.
# Measured: of 100 differential drives at a vertex one was 0.8 mm off when driven in open loop with
# 0.3 at the start, and is 0.03 mm off. Chosen: w settles by a quarter after jumps, as they are
# small.
FIRST_PART_RATIO = 0.1
JUMP_PART_RATIO = 0.3
# Largest change of the pushing angle in a part [rad]. Measured: of 100 differential drives at a
# vertex 4 whose meshes were refined were 0.7 to 3.4 mm off when driven in open loop with 0.5 in a
# part, and are 0.01 mm off.
LARGEST_CHANGE = 0.1
# Longest part of a coarse rollout [m]. Chosen: as fine as a first correction needs.
COARSE_PART = 0.1
# Difference for derivatives [m, rad, 1/m]. Chosen: about the square root of the rounding of
# float64 gives the best forward differences, and Newton's method leaves some more noise.
DIFFERENCE = 1e-6
NODE_SIZE = len(Node._fields)
# Numbers of a ``RolloutStep``.
STEP_SIZE = 2 * NODE_SIZE + 5
# Parts that memory is kept for, at least. Chosen: as many as most pushes take.
LEAST_CAPACITY = 256
# Steps back of a rollout that are rounding [m].
ROUNDING = 1e-9
# Numbers of the samples after jumps where there is none but the first touch.
FIRST_SAMPLE = np.array([0])


class Rollout(NamedTuple):
    """
    A push integrated finely; m samples over n steps.

    :param nodes: ``Node`` at the begin of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param s: path length of the contact from the start to each sample, shape (m,) [m].
    :param v_squared: V at each sample, shape (m,) [m^2/s^2].
    :param samples: ``Node`` at each sample, shape (m, 6).
    :param forces: (F_n, F_t) at each sample, shape (m, 2) [N].
    :param step_forces: the same at the begin of each step, shape (n, 2) [N].
    :param begins: numbers of the samples at the start, and after jumps between steps.
    """

    nodes: FloatArray
    changes: FloatArray
    s: FloatArray
    v_squared: FloatArray
    samples: FloatArray
    forces: FloatArray
    step_forces: FloatArray
    begins: IntArray


class Checks(NamedTuple):
    """
    What is checked of a rollout.

    :param total: sum of all samples, path lengths and V, which is finite where they are.
    :param force_ratio: largest |F_t| / F_n; infinite where the contact pulls.
    :param least_length: length of the shortest step [m].
    :param least_v_squared: least V [m^2/s^2].
    """

    total: Any
    force_ratio: Any
    least_length: Any
    least_v_squared: Any

    @property
    def is_sound(self) -> bool:
        """Whether all of the rollout is finite, and its path never goes back."""
        return (math.isfinite(self.total) and self.least_length > -ROUNDING
                and self.least_v_squared >= 0.0)


class RolloutStep(NamedTuple):
    """
    A step of a rollout, as symbols; its numbers are a row of as many columns.

    :param reference: ``Node`` that it is to begin at.
    :param gains: K, of the correction of the change.
    :param change: of the pushing angle [rad].
    :param length: path length [m].
    :param v_squared: V at the begin [m^2/s^2].
    :param v_squared_slope: dV/ds [m/s^2].
    :param smoothing: sliding speed below which friction becomes viscous, per pushing speed.
    """

    reference: Any
    gains: Any
    change: Any
    length: Any
    v_squared: Any
    v_squared_slope: Any
    smoothing: Any


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


@functools.lru_cache(maxsize=16)
def part_function(kind: PushKind, supports: SupportLayout, jumps: bool) -> RowFunction:
    """
    Build one part of a step, which goes on from the one before.

    ``state`` is a node, dw/ds, and the change of the pushing angle over the step. ``step`` is the
    ``RolloutStep`` that the part belongs to, ``part`` its fraction of it and that of what lies
    before it. At the begin of a step the change is corrected towards the reference, and the
    pushing angle may jump; where ``restarts`` is 1 the node there is the reference itself. Results
    are the state after the part, the node at its begin, samples and forces at its points, the
    force at its begin, and what remains of the residual over the supports' friction.

    :param kind: how the contact moves with the robot.
    :param supports: ``SupportLayout``.
    :param jumps: whether the pushing angle jumps at the begin of a step.
    """
    parameters, column = PushParameters.symbols(supports)
    state = ca.SX.sym('state', NODE_SIZE + 2)
    of_step, part, restarts = ca.SX.sym('step', STEP_SIZE), ca.SX.sym('part', 2), ca.SX.sym('r')
    values = RolloutStep(of_step[:NODE_SIZE], of_step[NODE_SIZE:2 * NODE_SIZE],
                         *ca.vertsplit(of_step[2 * NODE_SIZE:]))
    fraction, before = ca.vertsplit(part)
    is_begin = before == 0.0
    present = ca.if_else(is_begin * restarts, values.reference, state[:NODE_SIZE])
    corrected = ca.if_else(
        is_begin, values.change - ca.dot(values.gains, present - values.reference),
        state[NODE_SIZE + 1])
    node, along = Node(*ca.vertsplit(present)), corrected * fraction
    if jumps:
        response = contact_impulse(kind, parameters, node, corrected)
        node = node._replace(w=node.w + is_begin * response.w_jump,
                             rho=node.rho + is_begin * corrected)
        along = 0.0
    begin = ca.vertcat(*node)
    if kind == 'held':
        node = node._replace(phi=node.theta)
    length = fraction * values.length
    v_squared = values.v_squared + values.v_squared_slope * before * values.length
    step = Step(length, along, v_squared, values.v_squared_slope, False, values.smoothing)
    # Within a step w goes on smoothly, and so does the guess.
    w_slope = (1.0 - is_begin) * state[NODE_SIZE]
    rates = _solved_rates(kind, parameters, node, step, w_slope)
    result = collocate(kind, parameters, node, step, ca.vertsplit(rates))
    first_force = force_at_begin(kind, parameters, node, step)
    end_slope = ca.dot(ca.DM(radau(POINTS).inverse[-1]), rates - node.w) / length
    friction = sum(support[2] for support in parameters.terms.supports)
    residual = ca.norm_inf(ca.vertcat(*result.residuals)) / friction
    given = {'state': state, 'step': of_step, 'part': part, 'restarts': restarts,
             'column': column}
    found: Any = ca.cse([ca.vertcat(*result.end, end_slope, corrected), begin,
                         ca.vertcat(*[ca.vertcat(*sample) for sample in result.samples]),
                         ca.vertcat(*[ca.vertcat(*force) for force in result.forces]),
                         ca.vertcat(*first_force), residual])
    return RowFunction(ca.Function(
        'part', list(given.values()), found, list(given),
        ['next_state', 'begin', 'samples', 'forces', 'first_force', 'residual']),
        gathered=['step'])


def _solved_rates(kind: PushKind, parameters: PushParameters, node: Node, step: Step,
                  w_slope: Any) -> Any:
    """Solve the moment balance for w at the points by Newton's method, guessed by a slope."""
    unknowns = ca.SX.sym('rates', POINTS)
    residual = ca.vertcat(*collocate(kind, parameters, node, step,
                                     ca.vertsplit(unknowns)).residuals)
    improved = unknowns - ca.solve(ca.jacobian(residual, unknowns), residual)
    rates = node.w + w_slope * step.length * ca.DM(radau(POINTS).points)
    for _ in range(NEWTON_STEPS):
        rates = ca.substitute(improved, unknowns, rates)
    return rates


class _StepFunctions(NamedTuple):
    """
    Functions around the parts of a rollout.

    :param prepare: ``RolloutStep`` of each step, and path length up to its end.
    :param pick_node: node of a state.
    :param pick_change: change of the pushing angle of a state.
    :param sampling: path length and V at the points of each part, and ``Checks``.
    """

    prepare: RowFunction
    pick_node: RowFunction
    pick_change: RowFunction
    sampling: RowFunction


@functools.lru_cache(maxsize=1)
def _step_functions() -> _StepFunctions:
    """Build what surrounds the parts of a rollout."""
    node, gains, change = ca.SX.sym('node', NODE_SIZE), ca.SX.sym('gains', 7), ca.SX.sym('change')
    data, speeds = ca.SX.sym('data', len(StepData._fields)), ca.SX.sym('speeds', 2)
    free_length, begin = ca.SX.sym('free_length'), ca.SX.sym('begin')
    of_step = StepData(*ca.vertsplit(data))
    length = of_step.length + of_step.free_fraction * free_length
    # The friction of the model becomes viscous below a speed in m/s, here it is per speed.
    smoothing = SMOOTHING / ca.sqrt(ca.fmax(speeds[0], of_step.v_squared_end))
    given = {'node': node, 'gains': gains, 'change': change, 'data': data, 'speeds': speeds,
             'free_length': free_length, 'begin': begin}
    step = RolloutStep(node, gains[:NODE_SIZE], change, length, of_step.v_squared,
                       of_step.v_squared_slope, smoothing)
    prepare = ca.Function('prepare', list(given.values()), [ca.vertcat(*step), begin + length],
                          list(given), ['step', 'end'])
    state = ca.SX.sym('state', NODE_SIZE + 2)
    pick_node, pick_change = (
        RowFunction(ca.Function('pick', [state], [picked], ['state'], ['picked']),
                    is_independent=True, gathered=['state'])
        for picked in (state[:NODE_SIZE], state[NODE_SIZE + 1]))
    return _StepFunctions(RowFunction(prepare), pick_node, pick_change, _sampling())


def _sampling() -> RowFunction:
    """Build path length and V at the points of a part, and what is checked of it."""
    step, speeds = ca.SX.sym('step', STEP_SIZE), ca.SX.sym('speeds', 2)
    part, begin = ca.SX.sym('part', 2), ca.SX.sym('begin')
    samples, forces = ca.SX.sym('samples', POINTS * NODE_SIZE), ca.SX.sym('forces', POINTS * 2)
    first, before = ca.SX.sym('first_force', 2), ca.SX.sym('before', len(Checks._fields))
    so_far, length = Checks(*ca.vertsplit(before)), step[2 * NODE_SIZE + 1]
    s = length * (part[1] + part[0] * ca.DM(radau(POINTS).points))
    v_squared = speeds[0] + speeds[1] * s
    pairs = ca.reshape(ca.vertcat(first, forces), 2, POINTS + 1)
    normal, tangential = pairs[0, :], pairs[1, :]
    ratios = ca.if_else(normal > 0.0, ca.fabs(tangential) / normal, ca.inf)
    checks = Checks(so_far.total + ca.sum1(ca.vertcat(samples, begin + s, v_squared)),
                    ca.fmax(so_far.force_ratio, ca.mmax(ratios)),
                    ca.fmin(so_far.least_length, length),
                    ca.fmin(so_far.least_v_squared, ca.mmin(v_squared)))
    # Where the ratio changes much it may be steeper between the points.
    inside = (tangential / normal)[1:]
    ratio_bound = ca.mmax(ca.fabs(inside)) + ca.mmax(inside) - ca.mmin(inside)
    given = {'step': step, 'speeds': speeds, 'begin': begin, 'part': part, 'samples': samples,
             'forces': forces, 'first_force': first, 'before': before}
    return RowFunction(ca.Function(
        'sampling', list(given.values()), [begin + s, v_squared, ca.vertcat(*checks), ratio_bound],
        list(given), ['s', 'v_squared', 'so_far', 'ratio_bound']),
        gathered=['step', 'speeds', 'begin'])


class _Parts(NamedTuple):
    """
    Parts of n steps, m in all.

    :param steps: number of the step of each part, shape (m,).
    :param parts: fraction of each part, and of what lies before it in its step, shape (m, 2).
    :param nodes: number of the first part of each step, and m, shape (n + 1,).
    """

    steps: IntArray
    parts: FloatArray
    nodes: IntArray


@functools.lru_cache(maxsize=256)
def _equal_parts(counts: tuple[int, ...]) -> _Parts:
    """
    Divide steps into equal parts; most pushes of one length are divided alike.

    :param counts: number of parts of each step.
    """
    nodes = np.zeros(len(counts) + 1, dtype=int)
    np.cumsum(counts, out=nodes[1:])
    steps = np.repeat(np.arange(len(counts)), counts)
    fractions = (1.0 / np.array(counts))[steps]
    return _Parts(steps, np.array([
        fractions, fractions * (np.arange(len(steps)) - nodes[steps])]).T, nodes)


class PartCounts(NamedTuple):
    """
    Division of the steps of a push into parts.

    The steps after whose begin w settles are fine at first: the first one, or, where the pushing
    angle jumps, all.

    :param graded: parts of each of those: their fractions, and those of what lies before them,
        shape (m, 2).
    :param fine: number of the parts of each step.
    :param coarse: the same in a coarse rollout.
    """

    graded: list[FloatArray]
    fine: tuple[int, ...]
    coarse: tuple[int, ...]

    @classmethod
    def of(cls, problem: PushProblem, lengths: FloatArray, changes: FloatArray,
           jumps: bool) -> 'PartCounts':
        """
        Divide steps.

        :param problem: the ``PushProblem``.
        :param lengths: of the steps, shape (n,) [m].
        :param changes: of the pushing angle in them, about, shape (n,) [rad].
        :param jumps: whether the pushing angle jumps between them.
        """
        # At most half a part lies between two samples.
        longest = 2.0 * problem.settings.sample_spacing
        first = (JUMP_PART_RATIO if jumps else FIRST_PART_RATIO) * settling_distance(problem)
        graded = lengths if jumps else lengths[:1]
        fractions = [graded_fractions(length, first, longest) for length in graded.tolist()]
        return cls([np.array([parts, np.cumsum(parts) - parts]).T for parts in fractions], *(
            (*map(len, fractions), *np.ceil(equal[len(graded):]).astype(int).tolist())
            for equal in (np.maximum(lengths / longest, np.abs(changes) / LARGEST_CHANGE),
                          lengths / COARSE_PART)))

    @property
    def doublings(self) -> int:
        """Times that the least capacity of a memory is doubled for all parts to fit in."""
        return capacity_doublings(max(sum(self.fine), sum(self.coarse)))


def capacity_doublings(count: int) -> int:
    """
    Count how often ``LEAST_CAPACITY`` is doubled for a number of parts to fit in.

    :param count: number of parts.
    """
    return max(0, math.ceil(math.log2(count / LEAST_CAPACITY)))


class CapacityExceeded(Exception):
    """There are more parts than a memory has room for."""


class _Division:
    """
    Division of n steps into up to a number of parts.

    Attributes: ``count``, the number m of parts; ``steps``, the number of the step of each part;
    ``parts``, its fraction of that, and of what lies before it in it; ``nodes``, the number of the
    first part of each step, and m; ``changes``, that of the state after each of those;
    ``residuals``, what Newton's method leaves in each part.

    :param step_count: n.
    :param capacity: number of parts.
    """

    def __init__(self, step_count: int, capacity: int) -> None:
        """Allocate the memory."""
        self.count = 0
        # What the steps are divided into, where that is known.
        self._equal: Optional[_Parts] = None
        self.steps, self.parts = np.zeros(capacity, dtype=int), np.zeros((capacity, 2))
        self.nodes = np.zeros(step_count + 1, dtype=int)
        self.changes = np.zeros(step_count, dtype=int)
        self.residuals = np.zeros((capacity, 1))

    def divide(self, graded: list[FloatArray], counts: tuple[int, ...]) -> None:
        """
        Divide the steps.

        :param graded: parts of each of the first steps, see ``PartCounts``.
        :param counts: number of parts of each step; those of the others are equal.
        """
        equal = _equal_parts(counts)
        if equal is not self._equal:
            self._set(equal)
            self._equal = equal
        for begin, parts in zip(equal.nodes.tolist(), graded):
            self.parts[begin:begin + len(parts)] = parts

    def _set(self, division: _Parts) -> None:
        count = len(division.steps)
        if count > len(self.steps):
            raise CapacityExceeded
        self.count, self._equal = count, None
        self.steps[:count], self.parts[:count], self.nodes[:] = division
        self.changes[:] = division.nodes[:-1] + 1

    def converged(self) -> bool:
        """Tell whether Newton's method has converged in all parts."""
        return bool(self.residuals[:self.count].max() <= CONVERGED)

    def first_failed(self) -> IntArray:
        """Find the first parts in which Newton's method has not converged."""
        failed = np.flatnonzero(~(self.residuals[:self.count, 0] <= CONVERGED))
        steps = self.steps[failed]
        return failed[steps < steps[0] + DIVIDED_STEPS]

    def refine(self, numbers: IntArray) -> None:
        """
        Divide some parts further.

        :param numbers: of the parts.
        :raises CapacityExceeded: where that makes too many.
        """
        steps, parts = self.steps[:self.count], self.parts[:self.count]
        counts = np.ones(self.count, dtype=int)
        counts[numbers] = DIVISION
        finer = np.repeat(steps, counts)
        fractions = np.repeat(parts[:, 0] / counts, counts)
        within = np.arange(len(finer)) - np.repeat(np.cumsum(counts) - counts, counts)
        before = np.repeat(parts[:, 1], counts) + within * fractions
        self._set(_Parts(finer, np.array([fractions, before]).T,
                         np.searchsorted(finer, np.arange(len(self.nodes)))))


class _PartMemory:
    """
    Memory of up to a number of parts of some steps.

    :param function: of ``part_function``.
    :param capacity: number of parts.
    :param step_count: number of steps.
    :param column: memory of the parameters.
    """

    def __init__(self, function: RowFunction, capacity: int, step_count: int,
                 column: FloatArray) -> None:
        self._function = function
        self.states = np.zeros((capacity + 1, NODE_SIZE + 2))
        self.steps = np.zeros((step_count, STEP_SIZE))
        self.restarts, self.column = np.zeros(1), column
        self.begins = np.zeros((capacity, NODE_SIZE))
        # One sample before those of the parts: the begin of the push.
        self.all_samples = np.zeros((1 + capacity * POINTS, NODE_SIZE))
        self.all_forces = np.zeros((1 + capacity * POINTS, 2))
        self.samples = self.all_samples[1:].reshape(capacity, -1)
        self.forces = self.all_forces[1:].reshape(capacity, -1)
        self.first_forces = np.zeros((capacity, 2))

    def bind(self, division: _Division) -> BoundRows:
        """
        Bind the integration of parts.

        :param division: ``_Division`` of the steps.
        """
        return self._function.bind({
            'state': self.states[:-1], 'step': self.steps, 'part': division.parts,
            'restarts': self.restarts, 'column': self.column, 'next_state': self.states[1:],
            'begin': self.begins, 'samples': self.samples, 'forces': self.forces,
            'first_force': self.first_forces, 'residual': division.residuals}, division.steps)


class RolloutMemory:
    """
    Memory of rollouts of a push of n steps in up to a number of parts, its functions bound to it.

    Given are the reference ``nodes`` at the begin of each step, shape (n + 1, 6), the ``changes``
    of the pushing angle, shape (n, 1), the gains K and K[S], shape (n, 7), and the ``free_length``
    S, shape (1,). A rollout leaves its own nodes and changes in their place.

    Attributes, besides: ``data``, rows of ``StepData``; ``first_state``, node at the begin of the
    push, shape (6,); ``follow_coarsely``, a rollout in fewer parts, with too few samples for a
    ``Rollout``, and ``follow``, one with all samples.

    :param dimensions: ``Dimensions``.
    :param doublings: of ``LEAST_CAPACITY``, the largest number of parts.
    :param column: memory of the parameters.
    :param gains: memory of the gains.
    :param changes: memory of the changes.
    :param free_length: memory of S.
    """

    def __init__(self, dimensions: Dimensions, doublings: int, column: FloatArray,
                 gains: FloatArray, changes: FloatArray, free_length: FloatArray) -> None:
        """Allocate the memory."""
        n, capacity = dimensions.step_count, LEAST_CAPACITY << doublings
        self._jumps = dimensions.jumps
        self._part_function = part_function(dimensions.kind, dimensions.supports,
                                            dimensions.jumps)
        self._parts = parts = _PartMemory(self._part_function, capacity, n, column)
        self.nodes, self.data = np.zeros((n + 1, NODE_SIZE)), np.zeros((n, len(StepData._fields)))
        self.changes, self.free_length = changes, free_length
        self.first_state = parts.states[0, :NODE_SIZE]
        # V at the begins of the steps and dV/ds, also where they play no part.
        self._speeds = np.zeros((n, 2))
        # Path lengths at the begins of the steps, and at the end.
        self._ends = np.zeros((n + 1, 1))
        self._s, self._v_squared = (np.zeros(1 + capacity * POINTS) for _ in range(2))
        self._checks = np.zeros((capacity + 1, len(Checks._fields)))
        self._checks[0] = Checks(0.0, 0.0, math.inf, math.inf)
        self._ratio_bounds = np.zeros((capacity, 1))
        self._fine, self._coarse = _Division(n, capacity), _Division(n, capacity)
        functions = _step_functions()
        prepare = functions.prepare.bind({
            'node': self.nodes[:-1], 'gains': gains, 'change': changes, 'data': self.data,
            'speeds': self._speeds, 'free_length': free_length, 'begin': self._ends[:-1],
            'step': parts.steps, 'end': self._ends[1:]})
        self._sample = functions.sampling.bind({
            'step': parts.steps, 'speeds': self._speeds, 'begin': self._ends[:-1],
            'part': self._fine.parts, 'samples': parts.samples, 'forces': parts.forces,
            'first_force': parts.first_forces, 'before': self._checks[:-1],
            's': self._s[1:].reshape(capacity, -1),
            'v_squared': self._v_squared[1:].reshape(capacity, -1),
            'so_far': self._checks[1:], 'ratio_bound': self._ratio_bounds}, self._fine.steps)
        self._integrate_coarse, self._integrate_fine = (
            parts.bind(division) for division in (self._coarse, self._fine))
        self.follow_coarsely = RowSequence(prepare, self._integrate_coarse,
                                           *self._pick(functions, self._coarse))
        self.follow = RowSequence(prepare, self._integrate_fine,
                                  *self._pick(functions, self._fine), self._sample)

    def _pick(self, functions: _StepFunctions, division: _Division) -> list[BoundRows]:
        """Bind what takes nodes and changes from the states between the parts."""
        states = self._parts.states
        return [functions.pick_node.bind({'state': states, 'picked': self.nodes}, division.nodes),
                functions.pick_change.bind({'state': states, 'picked': self.changes},
                                           division.changes)]

    def load(self, formulation: Formulation, counts: PartCounts) -> None:
        """
        Take the steps of a push, and divide them.

        :param formulation: ``Formulation``.
        :param counts: ``PartCounts``.
        """
        mesh = formulation.mesh
        self.data[:] = formulation.steps
        self._speeds[:, 0], self._speeds[:, 1] = mesh.v_squared, mesh.v_squared_slopes
        self._fine.divide(counts.graded, counts.fine)
        self._coarse.divide(counts.graded, counts.coarse)
        self._count()

    def _count(self) -> None:
        """Let the functions know the number of parts."""
        self._integrate_fine.count[0] = self._sample.count[0] = self._fine.count
        self._integrate_coarse.count[0] = self._coarse.count

    @property
    def fine_converged(self) -> bool:
        """Whether Newton's method has converged in all parts of the last fine rollout."""
        return self._fine.converged()

    @property
    def coarse_converged(self) -> bool:
        """The same of the last coarse rollout."""
        return self._coarse.converged()

    def follow_divided(self, coarse: bool = False) -> None:
        """
        Follow a reference, and divide the parts for which Newton's method fails.

        Nodes are nan where it fails in all divisions.

        :param coarse: whether in fewer parts, with too few samples for a ``Rollout``.
        :raises CapacityExceeded: where that takes too many parts.
        """
        division, follow = ((self._coarse, self.follow_coarsely) if coarse else
                            (self._fine, self.follow))
        nodes, changes = self.nodes.copy(), self.changes.copy()
        follow()
        for _ in range(MAX_DIVISIONS):
            if division.converged():
                return
            division.refine(division.first_failed())
            self._count()
            self.nodes[:], self.changes[:] = nodes, changes
            follow()
        if not division.converged():
            self.nodes[1:] = math.nan

    def checks(self) -> Checks:
        """Return what is checked of the last rollout."""
        return Checks(*self._checks[self._fine.count].tolist())

    def resolve_forces(self, largest_ratio: float) -> bool:
        """
        Divide the parts in which the force may be steeper than a limit between the samples.

        :param largest_ratio: limit on |F_t| / F_n.
        :return: whether there are any.
        :raises CapacityExceeded: where that makes too many.
        """
        steep = np.flatnonzero(self._ratio_bounds[:self._fine.count] > largest_ratio)
        if len(steep):
            self._fine.refine(steep)
            self._count()
        return len(steep) > 0

    def linearize(self, may_steer: FloatArray) -> FloatArray:
        """
        Differentiate all steps by differences, about the last rollout.

        :param may_steer: 1 where the pushing angle may change, shape (n,).
        :return: derivatives of the end of each step and S by its begin, S and change, shape
            (n, 7, 8).
        """
        # All steps as they are, and then with a difference in each of the 8 arguments.
        variants = NODE_SIZE + 3
        size, count = self._coarse.count, len(self.data)
        memory = _variant_memory(self._part_function, capacity_doublings(variants * size),
                                 variants * count, threading.get_ident())
        memory.load(self._coarse, variants, self._parts)
        steps = memory.parts.steps
        for i in range(variants):
            shift = DIFFERENCE * np.eye(1, variants - 1, i - 1)[0]
            of_variant = steps[i * count:(i + 1) * count]
            of_variant[:] = self._parts.steps
            of_variant[:, :NODE_SIZE] = self.nodes[:-1] + shift[:NODE_SIZE]
            of_variant[:, 2 * NODE_SIZE] = (self.changes[:, 0]
                                            + shift[NODE_SIZE + 1] * may_steer)
            of_variant[:, 2 * NODE_SIZE + 1] += shift[NODE_SIZE] * self.data[:, 1]
        memory.integrate()
        found = memory.parts.states[1:variants * size + 1].reshape(variants, size, -1)
        found = found[:, self._coarse.nodes[1:] - 1, :NODE_SIZE]
        maps = np.zeros((count, NODE_SIZE + 1, NODE_SIZE + 2))
        maps[:, NODE_SIZE, NODE_SIZE] = 1.0
        maps[:, :NODE_SIZE] = ((found[1:] - found[0]) / DIFFERENCE).transpose(1, 2, 0)
        return maps

    def collect(self) -> Rollout:
        """Put the samples of the last rollout together, which was one with all samples."""
        end, parts, first = 1 + POINTS * self._fine.count, self._parts, self._fine.nodes[:-1]
        step_forces = parts.first_forces[first]
        parts.all_samples[0], parts.all_forces[0] = parts.begins[0], step_forces[0]
        self._v_squared[0] = self._speeds[0, 0]
        rollout = Rollout(self.nodes.copy(), self.changes[:, 0].copy(), self._s[:end].copy(),
                          self._v_squared[:end].copy(), parts.all_samples[:end].copy(),
                          parts.all_forces[:end].copy(), step_forces, FIRST_SAMPLE)
        return self._with_jumps(rollout) if self._jumps else rollout

    def _with_jumps(self, rollout: Rollout) -> Rollout:
        """Insert samples after the jumps; else the end of a step is the begin of the next."""
        jumps = np.flatnonzero(rollout.changes[1:]) + 1
        first = self._fine.nodes[jumps]
        at = 1 + POINTS * first
        return rollout._replace(
            s=np.insert(rollout.s, at, self._ends[jumps, 0]),
            v_squared=np.insert(rollout.v_squared, at, self._speeds[jumps, 0]),
            samples=np.insert(rollout.samples, at, self._parts.begins[first], axis=0),
            forces=np.insert(rollout.forces, at, rollout.step_forces[jumps], axis=0),
            begins=np.append(FIRST_SAMPLE, at + np.arange(len(at))))


class _VariantMemory:
    """
    Memory of the parts of many steps at once, each from its own reference.

    :param function: of ``part_function``.
    :param capacity: number of parts.
    :param step_count: number of steps.
    """

    def __init__(self, function: RowFunction, capacity: int, step_count: int) -> None:
        self.parts = _PartMemory(function, capacity, step_count,
                                 np.zeros(function.sizes['column']))
        self._division = _Division(step_count, capacity)
        self.parts.restarts[0] = 1.0
        self.integrate = self.parts.bind(self._division)

    def load(self, division: _Division, times: int, parts: _PartMemory) -> None:
        """Divide the same steps some times, one after the other."""
        size, count = division.count, times * division.count
        shift = np.repeat(np.arange(times) * len(parts.steps), size)
        self._division.steps[:count] = np.tile(division.steps[:size], times) + shift
        self._division.parts[:count] = np.tile(division.parts[:size], (times, 1))
        self.parts.column[:] = parts.column
        self.integrate.count[0] = count


@functools.lru_cache(maxsize=32)
def _variant_memory(function: RowFunction, doublings: int, step_count: int,
                    thread: int) -> _VariantMemory:
    """
    Allocate memory, or return that of before: binding it takes longer than a rollout.

    :param function: of ``part_function``.
    :param doublings: of ``LEAST_CAPACITY``.
    :param step_count: number of steps.
    :param thread: that works on it: each has a memory of its own.
    """
    return _VariantMemory(function, LEAST_CAPACITY << doublings, step_count)
