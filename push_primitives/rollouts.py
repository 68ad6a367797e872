"""
Rollouts of a push: what it would cost to go on along different arcs, and where best to stop.

From its present state each member of an ensemble drives on along an arc of curvature kappa_1 for
a while and kappa_2 after it. After the distances s_k the cost of stopping there is

    J(kappa, s_k) = mean over members of V(goal seen from the object) + s_k / v

with the cost-to-go V, so that the least J tells curvature and stopping distance at once.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_dynamics.layout import THETA
from push_dynamics.step import advance
from push_primitives.cost_to_go import interpolate_cost
from push_primitives.member_motion import drive_robot, object_origin


@compiled
def cost_of_stopping(state: Any, body: Any, values: Any, distances: Any, headings: Any,
                     goal: Any, face: int) -> float:
    """
    Evaluate the cost-to-go of a member.

    :param state: numbers of one member.
    :param body: its body.
    :param values: of the cost-to-go, shape (faces, distances, bearings, headings) [s].
    :param distances: of its grid [m].
    :param headings: of its grid [rad].
    :param goal: (x, y, theta) in the world.
    :param face: where the robot stands.
    :return: expected time that is still needed [s].
    """
    x, y = object_origin(state, body)
    c, s = math.cos(state[THETA]), math.sin(state[THETA])
    d_x, d_y = goal[0] - x, goal[1] - y
    return interpolate_cost(values, distances, headings, c * d_x + s * d_y, c * d_y - s * d_x,
                            goal[2] - state[THETA], face)


@compiled
def copy_numbers(target: Any, source: Any) -> None:
    """
    Copy a state.

    :param target: is written.
    :param source: as many numbers.
    """
    for i in range(len(target)):
        target[i] = source[i]


@compiled
def roll_out(states: Any, bodies: Any, supports: Any, outline: Any, floor: Any, forces: Any,
             drive: Any, command: Any, scratch: Any, arcs: Any, switch_distance: float,
             direction: float, speed: float, step: float, stops: Any, values: Any,
             distances: Any, headings: Any, goal: Any, face: int, costs: Any) -> None:
    """
    Evaluate the mean cost-to-go of stopping after every distance of every arc.

    Arcs that begin alike are driven once up to where they part.

    :param states: shape (n, 28).
    :param bodies: shape (n, 11).
    :param supports: shape (n, k, 8).
    :param outline: vertices in the object frame [m].
    :param floor: no rows: a plain floor.
    :param forces: none, see ``push_dynamics.step``.
    :param drive: ``IDEAL_DRIVE``.
    :param command: scratch, 3 numbers.
    :param scratch: two states: the present one, and that at the switch.
    :param arcs: curvature of each arc at first and later, shape (m, 2) [1/m].
    :param switch_distance: from which on the later curvature holds [m].
    :param direction: of motion in the robot's axes [rad].
    :param speed: of the simulated robot [m/s].
    :param step: of the simulation [s].
    :param stops: increasing distances, the first is 0, shape (k,) [m].
    :param values: of the cost-to-go [s].
    :param distances: of its grid [m].
    :param headings: of its grid [rad].
    :param goal: (x, y, theta) in the world.
    :param face: where the robot stands.
    :param costs: zeros, shape (m + 1, k), to which mean costs-to-go are added [s]; the last row is
        scratch.
    """
    v_x, v_y = speed * math.cos(direction), speed * math.sin(direction)
    weight = 1.0 / len(states)
    state, at_switch = scratch[0], scratch[1]
    member_costs = costs[len(arcs)]
    # The first stop that is reached with the later curvature.
    switch = 1
    while switch < len(stops) and stops[switch - 1] < switch_distance:
        switch += 1
    for i in range(len(states)):
        for a in range(len(arcs)):
            is_known = a > 0 and arcs[a][0] == arcs[a - 1][0]
            copy_numbers(state, at_switch if is_known else states[i])
            for k in range(switch if is_known else 0, len(stops)):
                if k == switch and not is_known:
                    copy_numbers(at_switch, state)
                if k > 0:
                    curvature = arcs[a][0] if k < switch else arcs[a][1]
                    drive_robot(state, command, v_x, v_y, curvature * speed)
                    advance(state, bodies[i], supports[i], outline, floor, forces, command, drive,
                            (stops[k] - stops[k - 1]) / speed, step)
                member_costs[k] = weight * cost_of_stopping(state, bodies[i], values, distances,
                                                            headings, goal, face)
            for k in range(len(stops)):
                costs[a][k] += member_costs[k]
