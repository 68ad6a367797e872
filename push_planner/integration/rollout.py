"""
Rollout: a push integrated finely along its steps, in closed loop around a reference.

In open loop a push runs away from its path by ``exp(s / L)``, with L the wheelbase. So each change
of the pushing angle is corrected for the deviation of the node at its begin,

    change = change_ref - K (node - node_ref)

and the corrected changes are those of a push in open loop again. Every step is divided into parts,
each a Radau step of three points (see ``collocation``), solved by Newton's method: the rows of a
``push_dynamics.machine_code.RowFunction``.
"""

import functools
import threading
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction
from push_model.dynamics import SMOOTHING
from push_model.geometry import FloatArray, IntArray
from push_planner.collocation.collocation import (
    collocate, contact_impulse, moment_and_force, MotionPoint, Node, radau, robot_yaw_rate, Step,
)
from push_planner.collocation.formulation import Formulation
from push_planner.problem import PushProblem
from push_planner.push_parameters import PushKind, PushParameters, SupportLayout

# Radau points of a part. Chosen: order 5 at its end.
POINTS = 3
# Newton iterations of a part. Chosen: the residual is at rounding then, also at the begin of a
# step, where w may jump and the guess is that it stays.
NEWTON_STEPS = 4
# Ratio of the lengths of successive parts where w settles. Chosen: fine at first, few in all.
GROWTH = 1.6
# First part of a step over the settling distance of w. Chosen: w settles by a quarter in it.
FIRST_PART_RATIO = 0.3
# Longest part of a coarse rollout [m]. Chosen: as fine as a first correction needs.
COARSE_PART = 0.1
# Difference for derivatives [m, rad, 1/m]. Chosen: about the square root of the rounding of
# float64 gives the best forward differences, and Newton's method leaves some more noise.
DIFFERENCE = 1e-6
NODE_SIZE = len(Node._fields)


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

    ``state`` is a node, dw/ds, and the change of the pushing angle over the step. At the begin of
    a step (``is_begin`` is 1) the change is corrected towards ``reference``, and the pushing angle
    may jump; where ``restarts`` is 1 the node is the reference itself. ``scalars`` are the length
    of the part, its fraction of the step, V at its begin, dV/ds and the smoothing. Results are the
    state after it, the node at its begin, and samples and forces at its points, and the
    force at its begin.

    :param kind: how the contact moves with the robot.
    :param supports: ``SupportLayout``.
    :param jumps: whether the pushing angle jumps at the begin of a step.
    """
    parameters, column = PushParameters.symbols(supports)
    state = ca.SX.sym('state', NODE_SIZE + 2)
    reference, gains = ca.SX.sym('reference', NODE_SIZE), ca.SX.sym('gains', NODE_SIZE)
    change, scalars = ca.SX.sym('change'), ca.SX.sym('scalars', 5)
    is_begin, restarts = ca.SX.sym('is_begin'), ca.SX.sym('restarts')
    length, fraction, v_squared, v_squared_slope, smoothing = ca.vertsplit(scalars)
    present = ca.if_else(restarts, reference, state[:NODE_SIZE])
    corrected = ca.if_else(is_begin, change - ca.dot(gains, present - reference),
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
    step = Step(length, along, v_squared, v_squared_slope, False, smoothing)
    # Within a step w goes on smoothly, and so does the guess.
    w_slope = (1.0 - is_begin) * state[NODE_SIZE]
    rates = _solved_rates(kind, parameters, node, step, w_slope)
    result = collocate(kind, parameters, node, step, ca.vertsplit(rates))
    first_force = _force_at_begin(kind, parameters, node, step)
    end_slope = ca.dot(ca.DM(radau(POINTS).inverse[-1]), rates - node.w) / length
    given = {'state': state, 'reference': reference, 'gains': gains, 'change': change,
             'scalars': scalars, 'is_begin': is_begin, 'restarts': restarts, 'column': column}
    found: Any = ca.cse([ca.vertcat(*result.end, end_slope, corrected), begin,
                         ca.vertcat(*[ca.vertcat(*sample) for sample in result.samples]),
                         ca.vertcat(*[ca.vertcat(*force) for force in result.forces]),
                         ca.vertcat(*first_force)])
    return RowFunction(ca.Function('part', list(given.values()), found, list(given),
                                   ['next_state', 'begin', 'samples', 'forces', 'first_force']))


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


def _force_at_begin(kind: PushKind, parameters: PushParameters, node: Node,
                    step: Step) -> tuple[Any, Any]:
    """
    Write the force at the begin of a part, where its angle begins to change at another rate.

    There w goes on, and the moment balance determines dw/ds, in which it is linear.
    """
    point = MotionPoint(node.theta, node.phi, node.w, node.rho,
                        robot_yaw_rate(kind, parameters, node.rho, node.w))
    angle_slope = step.change / step.length
    at_rest, by_unit = (moment_and_force(parameters, point, angle_slope, w_slope, step, 0.0)
                        for w_slope in (0.0, 1.0))
    # Without inertia dw/ds plays no part.
    inertia = by_unit.residual - at_rest.residual
    w_slope = -at_rest.residual / ca.if_else(step.v_squared > 0.0, inertia, ca.inf)
    return moment_and_force(parameters, point, angle_slope, w_slope, step, 0.0).force


class _PartRows:
    """
    Memory of rollouts whose steps are divided into the same numbers of parts, and what is bound.

    Attributes: ``step``, number of the step that each part belongs to; ``begins``, numbers of the
    parts at the begin of each step; ``nodes``, the same and the number of parts; ``fractions`` and
    ``before``, length of each part and of what lies before it over that of its step.

    :param function: of ``part_function``.
    :param counts: number of parts of each step, shape (n,).
    :param variants: number of rollouts one after the other.
    """

    def __init__(self, function: RowFunction, counts: IntArray, variants: int) -> None:
        size = int(counts.sum())
        self.step = np.repeat(np.arange(len(counts)), counts)
        ends = np.cumsum(counts)
        self.begins = ends - counts
        self.nodes = np.append(self.begins, size)
        self.fractions, self.before = np.zeros(size), np.zeros(size)
        count = variants * size
        self.states = np.zeros((count + 1, NODE_SIZE + 2))
        self.references, self.gains = np.zeros((count, NODE_SIZE)), np.zeros((count, NODE_SIZE))
        self.changes, self.scalars = np.zeros((count, 1)), np.zeros((count, 5))
        self.column = np.zeros(function.sizes['column'])
        self.first = np.zeros((count, NODE_SIZE))
        self.samples = np.zeros((count, POINTS * NODE_SIZE))
        self.forces = np.zeros((count, POINTS * 2))
        self.first_forces = np.zeros((count, 2))
        is_begin = np.zeros((variants, size))
        is_begin[:, self.begins] = 1.0
        self.is_begin = is_begin.reshape(count, 1)
        # One rollout goes on from step to step; of several, each step goes on from its reference.
        self.restarts = self.is_begin if variants > 1 else np.zeros((count, 1))
        self.evaluate = function.bind({
            'state': self.states[:-1], 'reference': self.references, 'gains': self.gains,
            'change': self.changes, 'scalars': self.scalars, 'is_begin': self.is_begin,
            'restarts': self.restarts, 'column': self.column, 'next_state': self.states[1:],
            'begin': self.first, 'samples': self.samples, 'forces': self.forces,
            'first_force': self.first_forces})

    def divide(self, fractions: FloatArray) -> None:
        """Take the lengths of all parts over those of their steps."""
        ends = np.cumsum(fractions)
        self.fractions[:] = fractions
        self.before[:] = ends - fractions
        self.before -= self.before[self.begins][self.step]


@functools.lru_cache(maxsize=32)
def _part_rows(function: RowFunction, counts: bytes, variants: int, thread: int) -> _PartRows:
    """
    Allocate memory, or return that of a rollout before: binding it takes longer than a rollout.

    :param function: of ``part_function``.
    :param counts: number of parts of each step, as bytes.
    :param variants: number of rollouts one after the other.
    :param thread: that works on it: each has a memory of its own.
    """
    return _PartRows(function, np.frombuffer(counts, dtype=int), variants)


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
        self._mesh = formulation.mesh
        dimensions = formulation.dimensions
        self._jumps = dimensions.jumps
        self._function = part_function(dimensions.kind, dimensions.supports, dimensions.jumps)
        # V and dV/ds as the program has them: 0 without inertia.
        self._inertia = formulation.steps[:, 2:4]
        self._column = problem.push_parameters.column()
        # The friction of the model becomes viscous below a speed in m/s, here it is per speed.
        speed = np.sqrt(np.maximum(self._mesh.v_squared, self._mesh.end_v_squared))
        self._smoothing = SMOOTHING / speed
        # At most half a part lies between two samples.
        longest = 2.0 * problem.settings.sample_spacing
        first = FIRST_PART_RATIO * settling_distance(problem)
        lengths = self._mesh.step_lengths(free_length)
        # The steps after whose begin w settles are fine: the first, or after all jumps.
        graded = lengths if dimensions.jumps else lengths[:1]
        self._graded = [graded_fractions(length, first, longest) for length in graded.tolist()]
        self._equal_lengths = lengths[len(graded):]
        self._fine = self._parts(longest)

    @functools.cached_property
    def _coarse(self) -> _PartRows:
        return self._parts(COARSE_PART)

    def _parts(self, longest: float, variants: int = 1) -> _PartRows:
        """Divide the graded steps as they are, and those after them into equal parts."""
        equal = np.ceil(self._equal_lengths / longest).astype(int)
        counts = np.append([len(one) for one in self._graded], equal)
        rows = _part_rows(self._function, counts.tobytes(), variants, threading.get_ident())
        rows.divide(np.concatenate([*self._graded, np.repeat(1.0 / equal, equal)]))
        rows.column[:] = self._column
        return rows

    def run(self, track: ReferenceTrack, free_length: float, coarse: bool = False) -> Run:
        """
        Follow a reference.

        :param track: ``ReferenceTrack``.
        :param free_length: S [m].
        :param coarse: whether in fewer parts, with too few samples for a ``Rollout``.
        """
        rows = self._coarse if coarse else self._fine
        begins = rows.begins
        rows.states[0, :NODE_SIZE] = track.nodes[0]
        rows.references[begins] = track.nodes
        rows.gains[begins] = track.gains
        rows.changes[begins, 0] = track.changes
        self._set_scalars(rows, rows.scalars, free_length)
        rows.evaluate()
        return Run(rows.states[rows.nodes, :NODE_SIZE], rows.states[begins + 1, NODE_SIZE + 1])

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
        rows = self._parts(COARSE_PART, variants)
        size, begins = len(rows.step), rows.begins
        for i in range(variants):
            shift = DIFFERENCE * np.eye(1, variants - 1, i - 1)[0]
            at = i * size + begins
            rows.references[at] = nodes + shift[:NODE_SIZE]
            rows.changes[at, 0] = changes + shift[NODE_SIZE + 1] * may_steer
            self._set_scalars(rows, rows.scalars[i * size:(i + 1) * size],
                              free_length + shift[NODE_SIZE])
        rows.evaluate()
        ends = np.append(begins[1:], size)
        found = rows.states[1:].reshape(variants, size, -1)[:, ends - 1, :NODE_SIZE]
        maps = np.zeros((len(nodes), NODE_SIZE + 1, NODE_SIZE + 2))
        maps[:, NODE_SIZE, NODE_SIZE] = 1.0
        maps[:, :NODE_SIZE] = ((found[1:] - found[0]) / DIFFERENCE).transpose(1, 2, 0)
        return maps

    def collect(self, run: Run, free_length: float) -> Rollout:
        """
        Put the samples of the last run together, which was a fine one.

        :param run: ``Run``.
        :param free_length: S of the run [m].
        """
        rows, mesh = self._fine, self._mesh
        step = rows.step
        lengths = mesh.step_lengths(free_length)
        # Path lengths since the begin of the step, of all points.
        s = lengths[step, None] * (rows.before[:, None] + rows.fractions[:, None]
                                   * radau(POINTS).points)
        v_squared = mesh.v_squared[step, None] + mesh.v_squared_slopes[step, None] * s
        begins_at = np.cumsum(lengths) - lengths
        s += begins_at[step, None]
        # The end of a step is the begin of the next, unless there is a jump between them.
        jumps = np.array([0])
        if self._jumps:
            jumps = np.append(0, np.flatnonzero(run.changes[1:]) + 1)
        at = rows.begins[jumps] * POINTS
        samples, forces = rows.samples.reshape(-1, NODE_SIZE), rows.forces.reshape(-1, 2)
        step_forces = rows.first_forces[rows.begins]
        return Rollout(run.nodes, run.changes,
                       _inserted(s.ravel(), at, begins_at[jumps]),
                       _inserted(v_squared.ravel(), at, mesh.v_squared[jumps]),
                       _inserted(samples, at, rows.first[rows.begins[jumps]]),
                       _inserted(forces, at, step_forces[jumps]), step_forces,
                       at + np.arange(len(at)))

    def _set_scalars(self, rows: _PartRows, scalars: FloatArray, free_length: float) -> None:
        """Set what describes each part; see ``part_function``."""
        step = rows.step
        lengths = self._mesh.step_lengths(free_length)[step]
        v_squared, slope = self._inertia[step].T
        scalars[:, 0] = rows.fractions * lengths
        scalars[:, 1] = rows.fractions
        scalars[:, 2] = v_squared + slope * rows.before * lengths
        scalars[:, 3] = slope
        scalars[:, 4] = self._smoothing[step]


def _inserted(values: FloatArray, at: IntArray, new: FloatArray) -> FloatArray:
    """Insert new values before those at increasing places, the first of them at the front."""
    if len(at) > 1:
        return np.insert(values, at, new, axis=0)
    found = np.empty((len(values) + 1, *values.shape[1:]))
    found[0], found[1:] = new[0], values
    return found
