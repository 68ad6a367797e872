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
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction
from push_model.dynamics import SMOOTHING
from push_model.geometry import FloatArray, IntArray
from push_planner.collocation.collocation import (
    collocate, contact_impulse, force_at_begin, Node, radau, Step,
)
from push_planner.collocation.formulation import Formulation
from push_planner.problem import PushProblem
from push_planner.push_parameters import PushKind, PushParameters, SupportLayout

# Radau points of a part. Chosen: order 5 at its end.
POINTS = 3
# Newton iterations of a part. Chosen: the residual is at rounding then, also at the begin of a
# step, where w may jump and the guess is that it stays.
NEWTON_STEPS = 4
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


class Run(NamedTuple):
    """
    Result of following a reference.

    :param nodes: ``Node`` at the begin of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle, corrected, shape (n,) [rad].
    """

    nodes: FloatArray
    changes: FloatArray


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


class _Division(NamedTuple):
    """
    Division of n steps into m parts.

    :param step: number of the step that each part belongs to, shape (m,).
    :param parts: fraction of each part, and of what lies before it in its step, shape (m, 2).
    :param nodes: number of the first part of each step, and m, shape (n + 1,).
    """

    step: IntArray
    parts: FloatArray
    nodes: IntArray

    @classmethod
    def of(cls, graded: list[FloatArray], equal: IntArray) -> '_Division':
        """
        Divide steps.

        :param graded: fractions of the parts of each of the first steps.
        :param equal: number of parts of each step after them, which are equal.
        """
        counts = np.array([*map(len, graded), *equal.tolist()])
        step, equal_parts, nodes = _equal_division(counts.tobytes())
        parts = equal_parts.copy()
        for begin, fractions in zip(nodes.tolist(), graded):
            part = parts[begin:begin + len(fractions)]
            part[:, 0] = fractions
            np.cumsum(fractions[:-1], out=part[1:, 1])
        return cls(step, parts, nodes)

    def repeated(self, times: int) -> '_Division':
        """
        Divide the same steps some times, one after the other.

        :param times: how often.
        """
        shift = np.repeat(np.arange(times), len(self.step))
        return _Division(np.tile(self.step, times) + shift * (len(self.nodes) - 1),
                         np.tile(self.parts, (times, 1)), self.nodes)

    def finer(self, parts: IntArray) -> '_Division':
        """
        Divide some parts further.

        :param parts: their numbers.
        """
        counts = np.ones(len(self.step), dtype=int)
        counts[parts] = DIVISION
        step = np.repeat(self.step, counts)
        fractions = np.repeat(self.parts[:, 0] / counts, counts)
        within = np.arange(len(step)) - np.repeat(np.cumsum(counts) - counts, counts)
        before = np.repeat(self.parts[:, 1], counts) + within * fractions
        return _Division(step, np.array([fractions, before]).T.copy(),
                         np.searchsorted(step, np.arange(len(self.nodes))))


@functools.lru_cache(maxsize=64)
def _equal_division(counts: bytes) -> _Division:
    """
    Divide steps into equal parts; most pushes of one length are divided alike.

    :param counts: number of parts of each step, as bytes.
    """
    of_steps = np.frombuffer(counts, dtype=int)
    nodes = np.zeros(len(of_steps) + 1, dtype=int)
    np.cumsum(of_steps, out=nodes[1:])
    step = np.repeat(np.arange(len(of_steps)), of_steps)
    fractions = (1.0 / of_steps)[step]
    return _Division(step, np.array([
        fractions, fractions * (np.arange(len(step)) - nodes[step])]).T.copy(), nodes)


class _PartMemory:
    """
    Memory of rollouts of up to a number of parts, and of as many steps, bound once.

    :param function: of ``part_function``.
    :param capacity: number of parts.
    """

    def __init__(self, function: RowFunction, capacity: int) -> None:
        self.states = np.zeros((capacity + 1, NODE_SIZE + 2))
        self.steps, self.parts = np.zeros((capacity, STEP_SIZE)), np.zeros((capacity, 2))
        self.numbers = np.zeros(capacity, dtype=int)
        self.restarts, self.column = np.zeros(1), np.zeros(function.sizes['column'])
        self.first = np.zeros((capacity, NODE_SIZE))
        self.samples = np.zeros((capacity, POINTS * NODE_SIZE))
        self.forces = np.zeros((capacity, POINTS * 2))
        self.first_forces, self.residuals = np.zeros((capacity, 2)), np.zeros((capacity, 1))
        self._evaluate = function.bind({
            'state': self.states[:-1], 'step': self.steps, 'part': self.parts,
            'restarts': self.restarts, 'column': self.column, 'next_state': self.states[1:],
            'begin': self.first, 'samples': self.samples, 'forces': self.forces,
            'first_force': self.first_forces, 'residual': self.residuals}, self.numbers)

    def evaluate(self, division: _Division, steps: FloatArray) -> None:
        """
        Integrate all parts.

        :param division: ``_Division``.
        :param steps: of ``RolloutStep``, a row each.
        """
        count = len(division.step)
        self.numbers[:count], self.parts[:count] = division.step, division.parts
        self.steps[:len(steps)] = steps
        self._evaluate(count)

    def failed_parts(self, division: _Division) -> IntArray:
        """
        Find the first parts in which Newton's method has not converged.

        :param division: ``_Division`` that has been evaluated.
        """
        failed = np.flatnonzero(~(self.residuals[:len(division.step), 0] <= CONVERGED))
        if len(failed):
            failed = failed[division.step[failed] < division.step[failed[0]] + DIVIDED_STEPS]
        return failed


@functools.lru_cache(maxsize=32)
def _part_memory(function: RowFunction, doublings: int, thread: int) -> _PartMemory:
    """
    Allocate memory, or return that of before: binding it takes longer than a rollout.

    :param function: of ``part_function``.
    :param doublings: of ``LEAST_CAPACITY``.
    :param thread: that works on it: each has a memory of its own.
    """
    return _PartMemory(function, LEAST_CAPACITY << doublings)


class ClosedLoopRollout:
    """
    Integrates one push, again and again; one at a time in a thread, as they share memory.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param free_length: S, about [m].
    """

    def __init__(self, problem: PushProblem, formulation: Formulation,
                 free_length: float) -> None:
        """Divide the steps into parts."""
        self._mesh = mesh = formulation.mesh
        dimensions = formulation.dimensions
        self._jumps = dimensions.jumps
        self._function = part_function(dimensions.kind, dimensions.supports, dimensions.jumps)
        self._column = formulation.common[:dimensions.supports.column_size]
        self._steps = np.zeros((len(mesh.lengths), STEP_SIZE))
        # V and dV/ds as the program has them: 0 without inertia.
        self._steps[:, -3:-1] = formulation.steps[:, 2:4]
        # The friction of the model becomes viscous below a speed in m/s, here it is per speed.
        self._steps[:, -1] = SMOOTHING / np.sqrt(np.maximum(mesh.v_squared, mesh.end_v_squared))
        # At most half a part lies between two samples.
        longest = 2.0 * problem.settings.sample_spacing
        ratio = JUMP_PART_RATIO if dimensions.jumps else FIRST_PART_RATIO
        first = ratio * settling_distance(problem)
        lengths = mesh.step_lengths(free_length)
        # The steps after whose begin w settles are fine: the first, or after all jumps.
        graded = lengths if dimensions.jumps else lengths[:1]
        self._graded = [graded_fractions(length, first, longest) for length in graded.tolist()]
        self._equal_lengths = lengths[len(graded):]
        self._longest = longest
        # By whether they are coarse; made when they are used, and finer where that has failed.
        self._divisions: dict[bool, _Division] = {}

    def _division(self, coarse: bool) -> _Division:
        """Divide the steps at first, or return the division of the last run."""
        if coarse not in self._divisions:
            self._divisions[coarse] = self._divided(COARSE_PART if coarse else self._longest)
        return self._divisions[coarse]

    def _divided(self, longest: float) -> _Division:
        """Divide the graded steps as they are, and those after them into equal parts."""
        return _Division.of(self._graded, np.ceil(self._equal_lengths / longest).astype(int))

    def _memory(self, count: int, restarts: float) -> _PartMemory:
        """Prepare memory for a number of parts."""
        doublings = max(0, math.ceil(math.log2(count / LEAST_CAPACITY)))
        memory = _part_memory(self._function, doublings, threading.get_ident())
        memory.column[:], memory.restarts[0] = self._column, restarts
        return memory

    def run(self, track: ReferenceTrack, free_length: float, coarse: bool = False) -> Run:
        """
        Follow a reference.

        :param track: ``ReferenceTrack``.
        :param free_length: S [m].
        :param coarse: whether in fewer parts, with too few samples for a ``Rollout``.
        :return: ``Run``, of nodes that are nan where Newton's method fails in all divisions.
        """
        steps = self._steps
        steps[:, :NODE_SIZE] = track.nodes
        steps[:, NODE_SIZE:2 * NODE_SIZE] = track.gains
        steps[:, 2 * NODE_SIZE] = track.changes
        steps[:, 2 * NODE_SIZE + 1] = self._mesh.step_lengths(free_length)
        division = self._division(coarse)
        memory, failed = self._integrate(division, track.nodes[0])
        for _ in range(MAX_DIVISIONS):
            if not len(failed):
                break
            division = division.finer(failed)
            memory, failed = self._integrate(division, track.nodes[0])
        self._divisions[coarse] = division
        nodes = division.nodes
        run = Run(memory.states[nodes, :NODE_SIZE], memory.states[nodes[:-1] + 1, NODE_SIZE + 1])
        if len(failed):
            run.nodes[1:] = math.nan
        return run

    def _integrate(self, division: _Division, start: FloatArray) -> tuple[_PartMemory, IntArray]:
        """Integrate from a start; return the results, and the first parts that have failed."""
        memory = self._memory(len(division.step), 0.0)
        memory.states[0, :NODE_SIZE] = start
        memory.evaluate(division, self._steps)
        return memory, memory.failed_parts(division)

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
        # All steps as they are, and then with a difference in each of the 8 arguments.
        variants = NODE_SIZE + 3
        coarse = self._division(True)
        division = coarse.repeated(variants)
        memory = self._memory(len(division.step), 1.0)
        size, count = len(coarse.step), len(nodes)
        steps = np.tile(self._steps, (variants, 1))
        for i in range(variants):
            shift = DIFFERENCE * np.eye(1, variants - 1, i - 1)[0]
            of_variant = steps[i * count:(i + 1) * count]
            of_variant[:, :NODE_SIZE] = nodes + shift[:NODE_SIZE]
            of_variant[:, 2 * NODE_SIZE] = changes + shift[NODE_SIZE + 1] * may_steer
            of_variant[:, 2 * NODE_SIZE + 1] = self._mesh.step_lengths(
                free_length + shift[NODE_SIZE])
        memory.evaluate(division, steps)
        found = memory.states[1:variants * size + 1].reshape(variants, size, -1)
        found = found[:, coarse.nodes[1:] - 1, :NODE_SIZE]
        maps = np.zeros((count, NODE_SIZE + 1, NODE_SIZE + 2))
        maps[:, NODE_SIZE, NODE_SIZE] = 1.0
        maps[:, :NODE_SIZE] = ((found[1:] - found[0]) / DIFFERENCE).transpose(1, 2, 0)
        return maps

    def collect(self, run: Run, free_length: float) -> Rollout:
        """
        Put the samples of the last run together, which was a fine one.

        :param run: ``Run``.
        :param free_length: S of the run [m].
        """
        division, mesh = self._division(False), self._mesh
        step, begins, count = division.step, division.nodes[:-1], len(division.step)
        memory = self._memory(count, 0.0)
        lengths = mesh.step_lengths(free_length)
        # Path lengths since the begin of the step, of all points.
        s = lengths[step, None] * (division.parts[:, 1:] + division.parts[:, :1]
                                   * radau(POINTS).points)
        v_squared = mesh.v_squared[step, None] + mesh.v_squared_slopes[step, None] * s
        begins_at = np.cumsum(lengths) - lengths
        s += begins_at[step, None]
        # The end of a step is the begin of the next, unless there is a jump between them.
        jumps = np.array([0])
        if self._jumps:
            jumps = np.append(0, np.flatnonzero(run.changes[1:]) + 1)
        at = begins[jumps] * POINTS
        samples = memory.samples[:count].reshape(-1, NODE_SIZE)
        forces = memory.forces[:count].reshape(-1, 2)
        step_forces = memory.first_forces[begins]
        return Rollout(run.nodes, run.changes,
                       _inserted(s.ravel(), at, begins_at[jumps]),
                       _inserted(v_squared.ravel(), at, mesh.v_squared[jumps]),
                       _inserted(samples, at, memory.first[begins[jumps]]),
                       _inserted(forces, at, step_forces[jumps]), step_forces,
                       at + np.arange(len(at)))


def _inserted(values: FloatArray, at: IntArray, new: FloatArray) -> FloatArray:
    """Insert new values before those at increasing places, the first of them at the front."""
    if len(at) > 1:
        return np.insert(values, at, new, axis=0)
    found = np.empty((len(values) + 1, *values.shape[1:]))
    found[0], found[1:] = new[0], values
    return found
