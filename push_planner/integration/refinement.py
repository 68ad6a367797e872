"""
Refinement: from the program's coarse optimum to an exact push.

The optimum is integrated finely (see ``rollout``), in closed loop around its own nodes; and what
the end misses of the goal is taken off by a feed-forward. Both come from one linear-quadratic
problem in the deviations x = (w, rho, theta, q_x, q_y, phi, S) of the nodes and S:

    x_{k+1} = A_k x_k + b_k u_k                             A_k, b_k: derivatives of a step
    minimise  sum_k (x_k' Q x_k + r u_k^2) + x_n' Q_f x_n + r_S x_0[S]^2
              + (x_n + m)' Q_n (x_n + m)

with u the deviations of the changes of the pushing angle and m the miss at the end. Without the
miss, backwards:

    P_n = Q_f,     R_k = r + b' P_{k+1} b,     K_k = b' P_{k+1} A / R_k
    P_k = Q + A' P_{k+1} A - (A' P b) K_k

The feedback knows of no goal: it would meet it in the last two steps, at any price. The goal is
met by v_k = u_k + K_k x_k, which is spread over the push. Up to a constant the cost is

    sum_k R_k v_k^2 + R_S x_0[S]^2 + (x_n + m)' Q_n (x_n + m),           R_S = r_S + P_0[S, S]

and in closed loop x_n is linear in all v_k and x_0[S], with costates L of the components of x_n:

    L_n = 1,       L_k = (A_k - b_k K_k)' L_{k+1},         l_k = L_{k+1}' b_k / R_k
    G = sum_k R_k l_k l_k' + L_0[S]' L_0[S] / R_S,         y = (Q_n^-1 + G)^-1 m
    v_k = -l_k' y,                                         x_0[S] = -L_0[S] y / R_S
"""

from collections.abc import Iterator
import functools
import math
import threading
from typing import NamedTuple, Optional

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction
from push_model.geometry import FloatArray, wrap_angle
from push_planner.collocation.collocation import collocate, contact_impulse, Node, Step
from push_planner.collocation.dimensions import POINTS
from push_planner.collocation.formulation import Formulation
from push_planner.collocation.nlp_solver import Solution
from push_planner.collocation.transcription import object_origin, SMOOTHING
from push_planner.integration.rollout import ClosedLoopRollout, ReferenceTrack, Rollout, Run
from push_planner.problem import PushProblem
from push_planner.push_parameters import (
    contact_frame, PushKind, PushParameters, SupportLayout,
)

# Weights Q of the deviations (w, rho, theta, q_x, q_y, phi, S) along the push, and Q_f at its end.
# Chosen: metres and radians alike. Measured: of 1, 10, 100 and 1000 times Q, ten times needs the
# fewest corrections.
WEIGHTS = np.diag([0.0, 0.0, 1.0, 1.0, 1.0, 0.1, 0.0])
FEEDBACK_END_WEIGHTS = 10.0 * WEIGHTS
# Weights of the miss, the diagonal of Q_n, without and with a final straight. Chosen: 1e4 times
# those along the push, as the goal must be met.
END_WEIGHTS = np.array([0.0, 0.0, 1e4, 1e4, 1e4, 0.0, 0.0])
STRAIGHT_END_WEIGHTS = np.array([0.0, 1e4, 1e4, 1e4, 1e4, 1e3, 0.0])
# Costs r of a change of the pushing angle and r_S of one of S. Chosen: deviations decay within a
# wheelbase or two; S is left to the program, as it decides on the time.
CHANGE_COST = 0.03
FREE_LENGTH_COST = 10.0
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


class Correction(NamedTuple):
    """
    Feed-forward against a miss at the end.

    :param changes: added to the changes of the pushing angle, shape (n,) [rad].
    :param free_length: added to S [m].
    """

    changes: FloatArray
    free_length: float


class Steering(NamedTuple):
    """
    Linear-quadratic problem along a push, solved but for the miss; see the formulas of the module.

    :param values: P_k, shape (n + 1, 7, 7).
    :param gains: K_k, shape (n, 7).
    :param leads: l_k, shape (n, 7).
    :param by_length: L_0[S], response of the end to S, shape (7,).
    :param strength: G but for the part of S, shape (7, 7).
    """

    values: FloatArray
    gains: FloatArray
    leads: FloatArray
    by_length: FloatArray
    strength: FloatArray

    @property
    def length_cost(self) -> float:
        """Cost R_S of S."""
        return FREE_LENGTH_COST + float(self.values[0, 6, 6])


class RefinedPush(NamedTuple):
    """
    A push that has been refined.

    :param rollout: ``Rollout``.
    :param free_length: S [m].
    :param solution: ``Solution`` that it refines.
    :param steering: ``Steering`` by which it was refined.
    """

    rollout: Rollout
    free_length: float
    solution: Solution
    steering: Steering


class _Iterate(NamedTuple):
    """A fine rollout: its run, S [m], the size of its miss [m, rad], and ``Steering``."""

    run: Run
    free_length: float
    miss: float
    steering: Steering


def refine(problem: PushProblem, formulation: Formulation, solution: Solution,
           former: Optional[RefinedPush] = None) -> Optional[RefinedPush]:
    """
    Integrate an optimum finely, corrected towards its own nodes and the goal.

    :param problem: the ``PushProblem``.
    :param formulation: ``Formulation``.
    :param solution: ``Solution`` of the program.
    :param former: ``RefinedPush`` of a solution on the same mesh that is much the same: what it
        corrected is corrected again.
    :return: ``RefinedPush``; None where the integration breaks down.
    """
    rollout = ClosedLoopRollout(problem, formulation, solution.free_length)
    best: Optional[RefinedPush] = None
    least = math.inf
    for iterate in _iterates(problem, formulation, solution, rollout, former):
        if not math.isfinite(iterate.miss) or iterate.miss > MIN_IMPROVEMENT * least:
            break
        # Collected at once, as the next run takes the memory.
        best = RefinedPush(rollout.collect(iterate.run, iterate.free_length), iterate.free_length,
                           solution, iterate.steering)
        least = iterate.miss
        if least < SMALL_MISS:
            break
    return best


def solve_steering(maps: FloatArray) -> Steering:
    """
    Solve the linear-quadratic problem but for the miss; see the formulas of this module.

    :param maps: (A_k, b_k) of each step, shape (n, 7, 8).
    """
    memory = _steering_memory(len(maps), threading.get_ident())
    memory.maps[:], memory.values[-1] = maps, FEEDBACK_END_WEIGHTS
    memory.solve_riccati()
    memory.costates[-1] = np.eye(7)
    memory.solve_costates()
    return Steering(memory.values.copy(), memory.gains.copy(), memory.leads.copy(),
                    memory.costates[0, 6].copy(), memory.strengths[0].copy())


def feed_forward(steering: Steering, end_weights: FloatArray, miss: FloatArray) -> Correction:
    """
    Find the changes and the S that close a miss at the end; see the formulas of this module.

    :param steering: ``Steering``.
    :param end_weights: diagonal of Q_n, shape (7,).
    :param miss: m, deviation of the end from the goal, shape (7,).
    """
    (y,), (found,) = _recursions().aim({
        'strength': steering.strength.reshape(1, 49), 'by_length': steering.by_length,
        'length_cost': np.array([steering.length_cost]), 'weights': end_weights, 'miss': miss})
    free_length = float(found[0])
    # All gains respond to the longer path from the first step on.
    return Correction(-(steering.leads @ y + steering.gains[:, 6] * free_length), free_length)


def goal_miss(problem: PushProblem, formulation: Formulation, last: FloatArray) -> FloatArray:
    """
    Find how far the end is off the goal, as a deviation of the last node and S.

    :param problem: the ``PushProblem``.
    :param formulation: ``Formulation``.
    :param last: the last ``Node``, shape (6,).
    :return: shape (7,); nan where the integration broke down.
    """
    if not np.isfinite(last).all():
        return np.full(7, math.nan)
    parameters, node = problem.push_parameters, Node(*last.tolist())
    x, y = object_origin(problem.kind, parameters, node)
    goal = problem.relative_goal
    rotation = 0.0 if problem.settings.heading_free else wrap_angle(node.theta - goal.theta)
    # The followed point moves along as the object rotates back.
    arm_x, arm_y = node.q_x - x, node.q_y - y
    angle = heading = 0.0
    if formulation.dimensions.straight_end:
        if problem.kind == 'differential':
            delta, *_ = contact_frame(parameters, node.theta, node.phi)
            heading = delta - formulation.boundary.delta + rotation
        # The pushing angle of a straight push, once object and robot have rotated back.
        back = {'held': rotation, 'differential': heading, 'rolling': 0.0}[problem.kind]
        delta, c_x, c_y = contact_frame(parameters, node.theta - rotation, node.phi - back)
        f_x, f_y = problem.friction_center
        angle = delta + node.rho - math.atan2(f_y - c_y, f_x - c_x)
    return np.array([0.0, wrap_angle(angle), rotation, x - goal.x - arm_y * rotation,
                     y - goal.y + arm_x * rotation, heading, 0.0])


def _iterates(problem: PushProblem, formulation: Formulation, solution: Solution,
              rollout: ClosedLoopRollout, former: Optional[RefinedPush]) -> Iterator[_Iterate]:
    """Correct a first rollout, and then fine ones, for what each misses."""
    dimensions = formulation.dimensions
    may_steer = formulation.mesh.may_steer.copy()
    if dimensions.jumps:
        # The first of angles that jump is a jump as well: impulses add up.
        may_steer[0] = 1.0
    end_weights = STRAIGHT_END_WEIGHTS if dimensions.straight_end else END_WEIGHTS
    begins = _begin_nodes(problem, formulation, solution)
    changes, free_length = solution.changes * may_steer, solution.free_length
    if former is None:
        maps = _program_maps(formulation, solution, may_steer)
        steering = solve_steering(maps)
    else:
        steering = former.steering
        begins[1:] += (former.rollout.nodes - former.solution.nodes)[1:-1]
        changes += former.rollout.changes - former.solution.changes * may_steer
        free_length += former.free_length - former.solution.free_length
    run = rollout.run(ReferenceTrack(begins, changes, steering.gains[:, :6]), free_length,
                      coarse=former is None)
    miss = goal_miss(problem, formulation, run.nodes[-1])
    if not math.isfinite(_size(miss)):
        return
    if former is not None:
        yield _Iterate(run, free_length, _size(miss), steering)
    before = math.inf
    for _ in range(FINE_ROLLOUTS):
        if _size(miss) > GOOD_CORRECTION * before:
            # The program's steps are too coarse to tell how fine ones change.
            maps = rollout.linearize(run.nodes[:-1], run.changes, free_length, may_steer)
            steering = solve_steering(maps)
        correction = feed_forward(steering, end_weights, miss)
        free_length = free_length + correction.free_length
        if free_length <= 0.0:
            return
        run = rollout.run(ReferenceTrack(run.nodes[:-1], run.changes + correction.changes,
                                         steering.gains[:, :6]), free_length)
        before, miss = _size(miss), goal_miss(problem, formulation, run.nodes[-1])
        yield _Iterate(run, free_length, _size(miss), steering)


def _size(miss: FloatArray) -> float:
    return float(np.abs(MISS_WEIGHTS * miss).max())


def _begin_nodes(problem: PushProblem, formulation: Formulation,
                 solution: Solution) -> FloatArray:
    """Return nodes at the begins of the steps, the first one exact, shape (n, 6)."""
    nodes, boundary = solution.nodes[:-1].copy(), formulation.boundary
    rho = nodes[0, 1]
    w = boundary.w
    if not boundary.moving:
        begin = Node(0.0, rho, 0.0, boundary.q_x, boundary.q_y)
        w = float(contact_impulse(problem.kind, problem.push_parameters, begin).w_jump)
    nodes[0] = w, rho, 0.0, boundary.q_x, boundary.q_y, 0.0
    return nodes


def _program_maps(formulation: Formulation, solution: Solution,
                  may_steer: FloatArray) -> FloatArray:
    """Differentiate the program's own steps: (A_k, b_k), shape (n, 7, 8)."""
    steps = formulation.steps
    data = np.empty((len(steps), 5))
    data[:, :4], data[:, 4] = steps[:, :4], may_steer
    dimensions = formulation.dimensions
    maps, = _linearized_step(dimensions.kind, dimensions.supports, dimensions.jumps)({
        'node': solution.nodes[:-1], 'free_length': np.array([solution.free_length]),
        'change': solution.changes[:, None], 'data': data, 'rates': solution.rates,
        'column': formulation.common[:dimensions.supports.column_size]})
    return maps.reshape(-1, 7, 8)


@functools.lru_cache(maxsize=16)
def _linearized_step(kind: PushKind, supports: SupportLayout, jumps: bool) -> RowFunction:
    """Build the derivatives of a step of the program, by the implicit function theorem."""
    parameters, column = PushParameters.symbols(supports)
    node, rates = ca.SX.sym('node', 6), ca.SX.sym('rates', POINTS)
    data, free_length = ca.SX.sym('data', 5), ca.SX.sym('free_length')
    change = ca.SX.sym('change')
    length, free_fraction, v_squared, v_squared_slope, may_steer = ca.vertsplit(data)
    step = Step(length + free_fraction * free_length, may_steer * change, v_squared,
                v_squared_slope, jumps, SMOOTHING)
    begin = Node(*ca.vertsplit(node))
    if kind == 'held':
        begin = begin._replace(phi=begin.theta)
    result = collocate(kind, parameters, begin, step, ca.vertsplit(rates))
    end = ca.vertcat(*result.end, free_length)
    residual = ca.vertcat(*result.residuals)
    arguments = ca.vertcat(node, free_length, change)
    # Along the solutions of residual = 0: d rates = -(dr/d rates)^-1 dr/d arguments.
    rates_by_arguments = ca.solve(ca.jacobian(residual, rates),
                                  ca.jacobian(residual, arguments))
    total = ca.jacobian(end, arguments) - ca.mtimes(ca.jacobian(end, rates), rates_by_arguments)
    # Arrays go row by row, casadi column by column.
    given = {'node': node, 'free_length': free_length, 'change': change, 'data': data,
             'rates': rates, 'column': column}
    return RowFunction(ca.Function('linearized', list(given.values()), [
        ca.cse(ca.densify(total).T)], list(given), ['map']), is_independent=True)


class _SteeringMemory:
    """
    Memory of the two recursions, bound once; n steps.

    :param count: n.
    """

    def __init__(self, count: int) -> None:
        self.maps, self.values = np.zeros((count, 7, 8)), np.zeros((count + 1, 7, 7))
        self.gains, self.costates = np.zeros((count, 7)), np.zeros((count + 1, 7, 7))
        self.leads, self.strengths = np.zeros((count, 7)), np.zeros((count + 1, 7, 7))
        maps, values, costates, strengths = (
            array.reshape(len(array), -1)
            for array in (self.maps, self.values, self.costates, self.strengths))
        self.solve_riccati = _recursions().riccati.bind({
            'map': maps[::-1], 'next_values': values[:0:-1], 'values': values[-2::-1],
            'gains': self.gains[::-1]})
        self.solve_costates = _recursions().costates.bind({
            'map': maps[::-1], 'next_values': values[:0:-1], 'gains': self.gains[::-1],
            'next_costates': costates[:0:-1], 'costates': costates[-2::-1],
            'leads': self.leads[::-1], 'next_strength': strengths[:0:-1],
            'strength': strengths[-2::-1]})


@functools.lru_cache(maxsize=32)
def _steering_memory(count: int, thread: int) -> _SteeringMemory:
    """
    Allocate the memory of a number of steps, or return that of before.

    :param count: n.
    :param thread: that works on it: each has a memory of its own.
    """
    return _SteeringMemory(count)


class _Recursions(NamedTuple):
    """One step of the recursions of P_k and K_k, and of L_k and G; y and x_0[S] of a miss."""

    riccati: RowFunction
    costates: RowFunction
    aim: RowFunction


@functools.lru_cache(maxsize=1)
def _recursions() -> _Recursions:
    """Build the formulas of this module for one step; arrays go row by row, casadi by columns."""
    rows, following = ca.SX.sym('map', 8, 7), ca.SX.sym('next_values', 7, 7)
    gains, columns = ca.SX.sym('gains', 7), ca.SX.sym('next_costates', 7, 7)
    transition, b = rows[:7, :].T, rows[7, :].T
    cross = transition.T @ (following @ b)
    cost = CHANGE_COST + b.T @ following @ b
    values = ca.DM(WEIGHTS) + transition.T @ following @ transition - cross @ cross.T / cost
    riccati = ca.Function('riccati', [rows, following], ca.cse([
        # What rounding makes unsymmetric would grow from step to step.
        ca.densify(ca.tril2symm(ca.tril(values))), cross / cost]),
        ['map', 'next_values'], ['values', 'gains'])
    pulls, so_far = columns @ b, ca.SX.sym('next_strength', 7, 7)
    costates = ca.Function('costates', [rows, following, gains, columns, so_far], ca.cse([
        ca.densify(columns @ transition - pulls @ gains.T), pulls / cost,
        so_far + pulls @ pulls.T / cost]),
        ['map', 'next_values', 'gains', 'next_costates', 'next_strength'],
        ['costates', 'leads', 'strength'])
    return _Recursions(RowFunction(riccati), RowFunction(costates), _aim())


def _aim() -> RowFunction:
    """Build y and x_0[S] of a miss; y = W (1 + W G W)^-1 W m with W^2 = Q_n, as Q_n has zeros."""
    strength, by_length = ca.SX.sym('strength', 7, 7), ca.SX.sym('by_length', 7)
    length_cost, weights, miss = (ca.SX.sym('length_cost'), ca.SX.sym('weights', 7),
                                  ca.SX.sym('miss', 7))
    roots = ca.diag(ca.sqrt(weights))
    total = strength + by_length @ by_length.T / length_cost
    y = roots @ ca.solve(ca.SX.eye(7) + roots @ total @ roots, roots @ miss)
    given = [strength, by_length, length_cost, weights, miss]
    return RowFunction(ca.Function(
        'aim', given, ca.cse([y, -ca.dot(by_length, y) / length_cost]),
        ['strength', 'by_length', 'length_cost', 'weights', 'miss'], ['y', 'free_length']))
