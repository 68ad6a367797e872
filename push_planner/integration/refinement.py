"""From the programme's coarse optimum to a motion that is exact."""

import functools
import math

import casadi as ca
import numpy as np
from push_model.geometry import wrap_angle
from push_planner.collocation.collocation import collocate, contact_impulse, Node, Step
from push_planner.collocation.dimensions import POINTS
from push_planner.collocation.nlp_solver import Buffered
from push_planner.collocation.transcription import origin, SMOOTHING
from push_planner.integration.rollout import ClosedLoopRollout, ReferenceTrack
from push_planner.push_parameters import place, PushParameters

WEIGHTS = np.diag([0.0, 0.0, 1.0, 1.0, 1.0, 0.1, 0.0])
END_WEIGHTS = np.diag([0.0, 0.0, 1e4, 1e4, 1e4, 0.0, 0.0])
STRAIGHT_WEIGHTS = np.diag([0.0, 1e4, 1e4, 1e4, 1e4, 1e3, 0.0])
EFFORT, WAY_EFFORT = 0.03, 10.0
PASSES = 6
# A pushing angle or heading that is a little off at the end is still a straight push.
MATTERS = np.array([0.0, 0.02, 1.0, 1.0, 1.0, 0.02, 0.0])
CLOSE = 2e-5


def refine(problem, formulation, solution):
    """
    Integrate an optimum finely, corrected towards its own nodes and the goal.

    :param problem: the ``PushProblem``.
    :param formulation: ``Formulation``.
    :param solution: ``Solution`` of the programme.
    :return: (``Rollout``, or None where the integration breaks down; S [m]).
    """
    grid, shape, way = formulation.grid, formulation.shape, solution.way
    push = ClosedLoopRollout(problem, formulation, way)
    free = grid.free.copy()
    # The first of angles that jump is a jump as well: impulses add up.
    free[0] = 1.0 if shape.jumps else free[0]
    maps = _maps(problem, shape, free, formulation, solution)
    weights = STRAIGHT_WEIGHTS if shape.straight else END_WEIGHTS
    values, gains = _gains(maps, weights)
    nodes, changes, best = _begin(problem, formulation, solution), solution.changes * free, None
    for attempt in range(PASSES):
        first = attempt == 0
        found = push.run(ReferenceTrack(nodes, changes, gains[:, :6]), way, coarse=first)
        miss = _miss(problem, formulation, found[0][-1])
        size = float(np.abs(MATTERS * miss).max())
        if not np.isfinite(size) or (best is not None and size > 0.9 * best[0]):
            break
        if not first:
            best = size, found, way
        if not first and size < CLOSE:
            break
        nodes, changes = found[0][:-1], found[1]
        if not first:
            # The programme's steps are too coarse to tell how fine ones change.
            maps = push.linear(nodes, changes, way, free)
            values, gains = _gains(maps, weights)
        lead, ahead = _feed_forward(maps, values, gains, miss)
        changes, way = changes - lead, way + ahead
        if way <= 0.0:
            break
    if best is None:
        return None, way
    return push.rollout(*best[1], best[2]), best[2]


def _begin(problem, formulation, solution):
    """Nodes at the begins of the steps, the first of them exact."""
    nodes, ends = solution.nodes[:-1].copy(), formulation.ends
    rho = nodes[0, 1]
    w = ends.w
    if not ends.moving:
        begin = Node(0.0, rho, 0.0, ends.q_x, ends.q_y)
        w = float(contact_impulse(problem.kind, problem.push_parameters, begin)[0])
    nodes[0] = w, rho, 0.0, ends.q_x, ends.q_y, 0.0
    return nodes


def _miss(problem, formulation, last):
    """By how much the end misses the goal, as a deviation of the last node and S."""
    push_parameters, node = problem.push_parameters, Node(*last.tolist())
    x, y = (float(value) for value in origin(problem.kind, push_parameters, node))
    goal = problem.relative_goal
    turn = 0.0 if problem.settings.heading_free else wrap_angle(node.theta - goal.theta)
    # The followed point moves along as the object turns back.
    arm_x, arm_y = node.q_x - x, node.q_y - y
    angle = heading = 0.0
    if formulation.shape.straight:
        delta, c_x, c_y = (float(value) for value in place(push_parameters, node.theta, node.phi))
        f_x, f_y = problem.friction_center
        angle = delta + node.rho - math.atan2(f_y - c_y, f_x - c_x)
        if problem.kind == 'differential':
            heading = delta - formulation.ends.delta + turn
    return np.array([0.0, wrap_angle(angle), turn, x - goal.x - arm_y * turn,
                     y - goal.y + arm_x * turn, heading, 0.0])


def _maps(problem, shape, free, formulation, solution):
    """End of each step by its begin, S and change: one matrix (7, 8) per step."""
    count, grid, steps = len(free), formulation.grid, formulation.steps
    column = problem.push_parameters.column()
    given = np.column_stack([grid.lengths, grid.shares, steps[:, 2], steps[:, 3], free])
    found, = _linear(shape)(solution.nodes[:-1], solution.way, solution.changes[:, None], given,
                            solution.rates, column)
    return found.reshape(count, 8, 7).transpose(0, 2, 1)


def _gains(maps, weights):
    value, values, gains = weights, [weights], np.zeros((len(maps), 7))
    for k in reversed(range(len(maps))):
        both = maps[k].T @ value @ maps[k]
        gain = both[7, :7] / (EFFORT + both[7, 7])
        gains[k] = gain
        value = WEIGHTS + both[:7, :7] - np.outer(both[:7, 7], gain)
        values.append(value)
    return values[::-1], gains


def _feed_forward(maps, values, gains, miss):
    """Find what to take off each change, and to add to S, to close a miss."""
    price, lead = values[-1] @ miss, np.zeros(len(maps))
    for k in reversed(range(len(maps))):
        act = maps[k][:, 7]
        lead[k] = act @ price / (EFFORT + act @ values[k + 1] @ act)
        price = maps[k][:, :7].T @ price - gains[k] * (act @ price)
    ahead = -price[6] / (WAY_EFFORT + values[0][6, 6])
    # All gains answer to the longer way from the first step on.
    return lead + gains[:, 6] * ahead, ahead


@functools.lru_cache(maxsize=16)
def _linear(shape):
    push_parameters, flat = PushParameters.symbols(shape.supports)
    node, rates = ca.SX.sym('node', 6), ca.SX.sym('rates', POINTS)
    data, way, change = ca.SX.sym('data', 5), ca.SX.sym('way'), ca.SX.sym('change')
    length, share, square, slope, free = ca.vertsplit(data)
    step = Step(length + share * way, free * change, square, slope, shape.jumps, SMOOTHING)
    begin = Node(*ca.vertsplit(node))
    if shape.kind == 'held':
        begin = begin._replace(phi=begin.theta)
    out = collocate(shape.kind, push_parameters, begin, step, ca.vertsplit(rates))
    end, residual = ca.vertcat(*out.node, way), ca.vertcat(*out.residuals)
    rest = ca.vertcat(node, way, change)
    settle = ca.solve(ca.jacobian(residual, rates), ca.jacobian(residual, rest))
    total = ca.jacobian(end, rest) - ca.mtimes(ca.jacobian(end, rates), settle)
    one = ca.Function('linear', [node, way, change, data, rates, flat], [ca.densify(total)])
    return Buffered(one.map(shape.steps))
