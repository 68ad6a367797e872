"""
Refinement: from the program's coarse optimum to an exact push.

The optimum is integrated finely (see ``rollout``), in closed loop around its own nodes; and what
the end misses of the goal is taken off by a feed-forward (see ``steering``). First the derivatives
are those of the program's own steps, and so is the reference; a coarse rollout tells what they
miss. Then each rollout is the reference of the next one.
"""

import functools
import math
import threading
from typing import Any, NamedTuple, Optional

import casadi as ca
import numpy as np
from push_dynamics.machine_code import BoundRows, RowFunction, RowSequence
from push_model.geometry import FloatArray
from push_planner.problem import PushProblem
from push_planner.steered.collocation.collocation import (
    collocate, contact_impulse, IntegrationStep, Node,
)
from push_planner.steered.collocation.dimensions import Dimensions, POINTS, StepData
from push_planner.steered.collocation.formulation import Formulation
from push_planner.steered.collocation.solution import Solution
from push_planner.steered.collocation.transcription import (
    common_symbols, CommonSymbols, object_origin, SMOOTHING)
from push_planner.steered.integration.rollout import Rollout, RolloutMemory
from push_planner.steered.integration.rollout_functions import Checks, NODE_SIZE
from push_planner.steered.integration.steering import (
    END_WEIGHTS, SteeringMemory, SteeringSolution, STRAIGHT_END_WEIGHTS,
)
from push_planner.steered.integration.step_division import CapacityExceeded, PartCounts
from push_planner.steered.push_parameters import (
    contact_frame, PushKind, PushParameters, SupportLayout)

# Ratio of the misses after and before a correction up to which its derivatives serve for another
# one. Measured: they take as long as three fine rollouts.
GOOD_CORRECTION = 0.1
# Largest number of fine rollouts. Chosen.
FINE_ROLLOUTS = 5
# Size of a miss in (w, rho, theta, q_x, q_y, phi, S). Chosen: a pushing angle or heading that is a
# little off at the end is still a straight push.
MISS_WEIGHTS = np.array([0.0, 0.02, 1.0, 1.0, 1.0, 0.02, 0.0])
# Miss that is small enough [m, rad]. Chosen: 20 um, a fiftieth of the tolerance of a plan.
SMALL_MISS = 2e-5
# Ratio by which the miss must shrink for another rollout to be worth it.
MIN_IMPROVEMENT = 0.9
# Times that the least capacity of a rollout may be doubled. Chosen: pushes of some kilometres.
MAX_DOUBLINGS = 12
# Times that parts are divided where the contact force changes so much within one that it may leave
# the friction cone between its points. Chosen: to a 64th. Measured: of 720 pushes it is due for
# one, of a differential drive at a vertex, whose object turns about one of its supports.
MAX_FORCE_DIVISIONS = 2
# Column of ``StepData``.
MAY_STEER = StepData._fields.index('may_steer')


class EndError(NamedTuple):
    """
    Deviation of the end of a push from the goal.

    :param position_error: distance [m].
    :param heading_error: angle; 0 where the heading is free [rad].
    """

    position_error: float
    heading_error: float


class RefinedPush(NamedTuple):
    """
    A push that has been refined.

    :param rollout: ``Rollout``.
    :param free_length: S [m].
    :param solution: ``Solution`` that it refines.
    :param steering: ``SteeringSolution`` by which it was refined.
    :param end_error: ``EndError``.
    :param checks: ``Checks`` of the rollout.
    """

    rollout: Rollout
    free_length: float
    solution: Solution
    steering: SteeringSolution
    end_error: EndError
    checks: Checks


def refine(problem: PushProblem, formulation: Formulation, solution: Solution,
           previous: Optional[RefinedPush] = None) -> Optional[RefinedPush]:
    """
    Integrate an optimum finely, corrected towards its own nodes and the goal.

    :param solution: ``Solution`` of the program.
    :param previous: ``RefinedPush`` of a solution on the same mesh that is much the same: what it
        corrected is corrected again, and its steering serves once more.
    :return: ``RefinedPush``; None where the integration breaks down.
    """
    counts = PartCounts.of(problem, formulation.mesh.step_lengths(solution.free_length),
                           solution.changes, formulation.dimensions.jumps)
    for doublings in range(counts.doublings, MAX_DOUBLINGS):
        memory = _refinement_memory(formulation.dimensions, doublings, threading.get_ident())
        try:
            memory.load(formulation, counts)
            return _resolved(problem, memory, solution, _refined(memory, solution, previous))
        except CapacityExceeded:
            continue
    return None


def _resolved(problem: PushProblem, memory: '_RefinementMemory', solution: Solution,
              refined: Optional[RefinedPush]) -> Optional[RefinedPush]:
    """Refine once more, in finer parts, while the force may leave the friction cone in between."""
    friction = problem.obj.contact_friction_coefficient
    for _ in range(MAX_FORCE_DIVISIONS):
        if (problem.settings.angle_limit != 'cone' or refined is None
                or refined.checks.force_ratio > friction or not memory.resolve_forces(friction)):
            break
        refined = _refined(memory, solution, refined)
    return refined


def _refined(memory: '_RefinementMemory', solution: Solution,
             previous: Optional[RefinedPush]) -> Optional[RefinedPush]:
    """Refine a solution in memory that has its program."""
    memory.follow_solution(solution, previous)
    best: Optional[RefinedPush] = None
    least, before, miss = math.inf, memory.first_miss(), memory.miss()
    for _ in range(FINE_ROLLOUTS):
        # Also where the miss is no number.
        if not miss <= MIN_IMPROVEMENT * least or memory.free_length() <= 0.0:
            break
        # Collected at once, as the next rollout takes the memory.
        best, least = memory.collect(solution), miss
        if miss < SMALL_MISS:
            break
        # The program's steps are too coarse to tell how fine ones change.
        memory.correct_again(relinearized=miss > GOOD_CORRECTION * before)
        before, miss = miss, memory.miss()
    return best


def goal_miss(formulation: Formulation, last: FloatArray) -> FloatArray:
    """
    Find how far the end is off the goal, as a deviation of the last node and S.

    :param last: the last ``Node``, shape (6,).
    :return: shape (7,).
    """
    miss, *_ = _goal_miss(formulation.dimensions._replace(step_count=1))({
        'node': last[None], 'common': formulation.common})
    return miss[0]


class _RefinementMemory:
    """
    Memory of the refinement of pushes of the same dimensions, its functions bound to it.

    :param dimensions: ``Dimensions``.
    :param doublings: of the least capacity of a rollout.
    """

    def __init__(self, dimensions: Dimensions, doublings: int) -> None:
        """Allocate the memory."""
        n, any_steps = dimensions.step_count, dimensions._replace(step_count=1)
        self._jumps = dimensions.jumps
        self._steering = steering = SteeringMemory(n)
        steering.end_weights[:] = STRAIGHT_END_WEIGHTS if dimensions.straight_end else END_WEIGHTS
        start_node = _start_node(any_steps)
        self._common, self._rates = np.zeros(start_node.sizes['common']), np.zeros((n, POINTS))
        column = self._common[:dimensions.supports.column_size]
        self._rollout = rollout = RolloutMemory(
            dimensions, doublings, column, steering.present.gains, steering.changes,
            steering.free_length)
        linearize = _linearized_step(dimensions.kind, dimensions.supports, dimensions.jumps).bind({
            'node': rollout.nodes[:-1], 'free_length': steering.free_length,
            'change': steering.changes, 'data': rollout.data, 'rates': self._rates,
            'column': column, 'map': steering.maps.reshape(n, -1)})
        start = start_node.bind({'present': rollout.nodes[0], 'common': self._common,
                                 'node': rollout.nodes[0], 'state': rollout.first_state})
        # Size of the miss and ``EndError``, of the first and of fine rollouts.
        self._first_outcome, self._outcome = np.zeros(3), np.zeros(3)
        evaluate_first_miss, evaluate_miss = (self._bind_miss(any_steps, outcome)
                                              for outcome in (self._first_outcome, self._outcome))
        self._start, self._linearize = RowSequence(start), RowSequence(linearize, steering.solve)
        self._evaluate_first_miss = RowSequence(evaluate_first_miss)
        self._evaluate_miss = RowSequence(evaluate_miss)
        self._correct = RowSequence(steering.correct, rollout.follow, evaluate_miss)
        self._follow = RowSequence(start, rollout.follow_coarsely, evaluate_first_miss,
                                   self._correct)
        self._linearize_and_follow = RowSequence(self._linearize, self._follow)

    def _bind_miss(self, dimensions: Dimensions, outcome: FloatArray) -> BoundRows:
        return _goal_miss(dimensions).bind({
            'node': self._rollout.nodes[-1], 'common': self._common, 'miss': self._steering.miss,
            'outcome': outcome})

    def resolve_forces(self, largest_ratio: float) -> bool:
        """See ``RolloutMemory``."""
        return self._rollout.resolve_forces(largest_ratio)

    def load(self, formulation: Formulation, counts: PartCounts) -> None:
        """Take a program."""
        self._rollout.load(formulation, counts)
        if self._jumps:
            # The first of angles that jump is a jump as well: impulses add up.
            self._rollout.data[0, MAY_STEER] = 1.0
        self._common[:] = formulation.common

    def follow_solution(self, solution: Solution, previous: Optional[RefinedPush]) -> None:
        """Follow the solution of the program, correct it, and follow that."""
        rollout = self._rollout
        self._set_reference(solution, previous)
        if previous is None:
            self._rates[:] = solution.rates
            self._linearize_and_follow()
        else:
            self._steering.load(previous.steering)
            self._follow()
        if rollout.coarse_converged and rollout.fine_converged:
            return
        # Once more, one by one.
        self._set_reference(solution, previous)
        if previous is None:
            self._linearize()
        self._start()
        rollout.follow_divided(coarse=True)
        self._evaluate_first_miss()
        self._correct_and_divide()

    def _set_reference(self, solution: Solution, previous: Optional[RefinedPush]) -> None:
        """Take the solution as the reference, refined as a previous one."""
        nodes, steering = self._rollout.nodes, self._steering
        may_steer = self._rollout.data[:, MAY_STEER]
        nodes[:], steering.changes[:, 0] = solution.nodes, solution.changes * may_steer
        steering.free_length[0] = solution.free_length
        if previous is not None:
            nodes += previous.rollout.nodes - previous.solution.nodes
            steering.changes[:, 0] += (previous.rollout.changes
                                       - previous.solution.changes * may_steer)
            steering.free_length += previous.free_length - previous.solution.free_length

    def correct_again(self, relinearized: bool) -> None:
        """Correct the last rollout, and follow that."""
        rollout, steering = self._rollout, self._steering
        if relinearized:
            steering.maps[:] = rollout.linearize(rollout.data[:, MAY_STEER])
            steering.solve()
        arrays = rollout.nodes, steering.changes, steering.free_length, steering.miss
        present = [array.copy() for array in arrays]
        self._correct()
        if rollout.fine_converged:
            return
        for array, value in zip(arrays, present):
            array[:] = value
        self._correct_and_divide()

    def _correct_and_divide(self) -> None:
        """Correct the last rollout, and follow that in finer parts where it has to be."""
        self._steering.correct()
        self._rollout.follow_divided()
        self._evaluate_miss()

    def first_miss(self) -> float:
        """Size of the miss before all corrections [m, rad]."""
        return self._first_outcome.item(0)

    def miss(self) -> float:
        """Size of the miss of the last rollout [m, rad]; nan where it broke down."""
        return self._outcome.item(0)

    def free_length(self) -> float:
        """S of the last rollout [m]."""
        return self._steering.free_length.item()

    def collect(self, solution: Solution) -> RefinedPush:
        """Copy the last rollout."""
        return RefinedPush(self._rollout.collect(), self.free_length(), solution,
                           self._steering.copy(), EndError(*self._outcome[1:].tolist()),
                           self._rollout.checks())


@functools.lru_cache(maxsize=32)
def _refinement_memory(dimensions: Dimensions, doublings: int, thread: int) -> _RefinementMemory:
    """
    Allocate memory, or return that of before: binding it takes longer than a refinement.

    :param doublings: of the least capacity of a rollout.
    :param thread: that works on it: each has a memory of its own.
    """
    return _RefinementMemory(dimensions, doublings)


@functools.lru_cache(maxsize=16)
def _linearized_step(kind: PushKind, supports: SupportLayout, jumps: bool) -> RowFunction:
    """Build the derivatives of a step of the program, by the implicit function theorem."""
    parameters, column = PushParameters.symbols(supports)
    node, rates = ca.SX.sym('node', 6), ca.SX.sym('rates', POINTS)
    data, free_length = ca.SX.sym('data', len(StepData._fields)), ca.SX.sym('free_length')
    change = ca.SX.sym('change')
    of_step = StepData(*ca.vertsplit(data))
    step = IntegrationStep(of_step.length + of_step.free_fraction * free_length,
                           of_step.may_steer * change, of_step.v_squared,
                           of_step.v_squared_slope, jumps, SMOOTHING)
    start = Node(*ca.vertsplit(node))
    if kind == 'held':
        start = start._replace(phi=start.theta)
    result = collocate(kind, parameters, start, step, ca.vertsplit(rates))
    end = ca.vertcat(*result.end, free_length)
    residual = ca.vertcat(*result.residuals)
    arguments = ca.vertcat(node, free_length, change)
    # Along the solutions of residual = 0: d rates = -(dr/d rates)^-1 dr/d arguments.
    rates_by_arguments = ca.solve(ca.jacobian(residual, rates),
                                  ca.jacobian(residual, arguments))
    total = ca.jacobian(end, arguments) - ca.mtimes(ca.jacobian(end, rates), rates_by_arguments)
    # Arrays go row by row, casadi column by column.
    inputs = {'node': node, 'free_length': free_length, 'change': change, 'data': data,
              'rates': rates, 'column': column}
    return RowFunction(ca.Function('linearized', list(inputs.values()), [
        ca.cse(ca.densify(total).T)], list(inputs), ['map']), is_independent=True)


@functools.lru_cache(maxsize=16)
def _start_node(dimensions: Dimensions) -> RowFunction:
    """Build the node at the start of a push from its pushing angle, alone and of a state."""
    inputs, present = common_symbols(dimensions), ca.SX.sym('present', NODE_SIZE)
    boundary, rho = inputs.boundary, present[Node._fields.index('rho')]
    at_rest = Node(0.0, rho, ca.SX(0.0), boundary.q_x, boundary.q_y)
    response = contact_impulse(dimensions.kind, inputs.parameters, at_rest)
    w = ca.if_else(boundary.moving, boundary.w, response.w_jump)
    node = ca.densify(ca.vertcat(*at_rest._replace(w=w)))
    return RowFunction(ca.Function('start', [present, inputs.column], [node, node],
                                   ['present', 'common'], ['node', 'state']))


@functools.lru_cache(maxsize=32)
def _goal_miss(dimensions: Dimensions) -> RowFunction:
    """Build the deviation of a last node, and S, from the goal; its size, and the ``EndError``."""
    inputs, symbols = common_symbols(dimensions), ca.SX.sym('node', NODE_SIZE)
    node, boundary = Node(*ca.vertsplit(symbols)), inputs.boundary
    x, y = object_origin(dimensions.kind, inputs.parameters, node)
    rotation = ca.SX(0.0) if dimensions.heading_free else _wrapped(node.theta - boundary.theta)
    angle, heading = _straightness(dimensions, inputs, node, rotation)
    off_x, off_y = x - boundary.x, y - boundary.y
    # The followed point moves along as the object rotates back.
    miss = ca.densify(ca.vertcat(
        0.0, angle, rotation, off_x - (node.q_y - y) * rotation,
        off_y + (node.q_x - x) * rotation, heading, 0.0))
    size = ca.mmax(ca.fabs(ca.DM(MISS_WEIGHTS) * miss))
    # The largest of some numbers is one also where only some are.
    size = ca.if_else(ca.fabs(ca.sum1(symbols)) < ca.inf, size, math.nan)
    outcome = ca.vertcat(size, ca.sqrt(off_x ** 2 + off_y ** 2), ca.fabs(rotation))
    return RowFunction(ca.Function(
        'goal_miss', [symbols, inputs.column], ca.cse([miss, ca.densify(outcome)]),
        ['node', 'common'], ['miss', 'outcome']))


def _straightness(dimensions: Dimensions, inputs: CommonSymbols, node: Node,
                  rotation: Any) -> tuple[Any, Any]:
    """Deviations of pushing angle and heading from a straight end, once all rotate back [rad]."""
    if not dimensions.straight_end:
        return 0.0, 0.0
    parameters, boundary, heading = inputs.parameters, inputs.boundary, ca.SX(0.0)
    if dimensions.kind == 'differential':
        delta, *_ = contact_frame(parameters, node.theta, node.phi)
        heading = delta - boundary.delta + rotation
    back = {'held': rotation, 'differential': heading, 'rolling': 0.0}[dimensions.kind]
    delta, c_x, c_y = contact_frame(parameters, node.theta - rotation, node.phi - back)
    direction = ca.atan2(boundary.f_y - c_y, boundary.f_x - c_x)
    return _wrapped(delta + node.rho - direction), heading


def _wrapped(angle: Any) -> Any:
    """Angle in [-pi, pi] [rad]."""
    return ca.atan2(ca.sin(angle), ca.cos(angle))
