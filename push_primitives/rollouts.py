"""
Rollouts of a push: what it would cost to go on along different arcs, and where best to stop.

From its present state each member of an ensemble drives on along an arc of curvature kappa_1 for
a while and kappa_2 after it. After the distances s_k the cost of stopping there is

    J(kappa, s_k) = mean over members of V(goal seen from the object) + s_k / v

with the cost-to-go V, so that the least J tells curvature and stopping distance at once.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled
from push_dynamics.layout import THETA
from push_dynamics.step import advance
from push_model.geometry import FloatArray, Pose
from push_primitives.cost_to_go import CostGrid, interpolate_cost
from push_primitives.member_motion import drive_robot, member_world, object_origin, Worlds


class RolloutOptions(NamedTuple):
    """
    Options of driven arcs.

    :param direction: of motion in the robot's axes [rad].
    :param speed: of the simulated robot [m/s].
    :param step: of the simulation [s].
    :param switch_distance: from which on the later curvature holds [m].
    """

    direction: float
    speed: float
    step: float
    switch_distance: float


class RolloutGoal(NamedTuple):
    """
    Goal by which stopping is evaluated.

    :param grid: ``CostGrid``.
    :param pose: of the object, in the world.
    :param face: where the robot stands.
    """

    grid: CostGrid
    pose: Pose
    face: int


@compiled
def cost_of_stopping(state: Any, body: Any, goal: RolloutGoal) -> float:
    """
    Evaluate the cost-to-go of a member.

    :param state: values of one member.
    :param body: its body.
    :return: expected time that is still needed [s].
    """
    x, y = object_origin(state, body)
    c, s = math.cos(state[THETA]), math.sin(state[THETA])
    d_x, d_y = goal.pose.x - x, goal.pose.y - y
    return interpolate_cost(goal.grid, Pose(c * d_x + s * d_y, c * d_y - s * d_x,
                                            goal.pose.theta - state[THETA]), goal.face)


@compiled
def copy_values(target: Any, source: Any) -> None:
    """
    Copy a state.

    :param target: is written.
    :param source: of the same length.
    """
    for i in range(len(target)):
        target[i] = source[i]


@compiled
def roll_out(worlds: Worlds, scratch: Any, arcs: FloatArray, stops: FloatArray,
             options: RolloutOptions, goal: RolloutGoal, costs: FloatArray) -> None:
    """
    Evaluate the mean cost-to-go of stopping after every distance of every arc.

    Arcs that start alike are driven once up to where they part.

    :param worlds: ``Worlds`` of the members, the states of which are only read.
    :param scratch: two states, are written: the present one, and that at the switch.
    :param arcs: curvature of each arc at first and later, shape (m, 2) [1/m].
    :param stops: increasing distances, the first is 0, shape (k,) [m].
    :param costs: zeros, shape (m + 1, k), to which mean costs-to-go are added [s]; the last row is
        scratch.
    """
    speed = options.speed
    v_x, v_y = speed * math.cos(options.direction), speed * math.sin(options.direction)
    weight = 1.0 / len(worlds.states)
    state, at_switch = scratch[0], scratch[1]
    member_costs = costs[len(arcs)]
    # The first stop that is reached with the later curvature.
    switch = 1
    while switch < len(stops) and stops[switch - 1] < options.switch_distance:
        switch += 1
    for i in range(len(worlds.states)):
        world = member_world(worlds, i, state)
        for a in range(len(arcs)):
            is_known = a > 0 and arcs[a][0] == arcs[a - 1][0]
            copy_values(state, at_switch if is_known else worlds.states[i])
            for k in range(switch if is_known else 0, len(stops)):
                if k == switch and not is_known:
                    copy_values(at_switch, state)
                if k > 0:
                    curvature = arcs[a][0] if k < switch else arcs[a][1]
                    drive_robot(world, v_x, v_y, curvature * speed)
                    advance(world, (stops[k] - stops[k - 1]) / speed, options.step)
                member_costs[k] = weight * cost_of_stopping(state, world.body, goal)
            for k in range(len(stops)):
                costs[a][k] += member_costs[k]
