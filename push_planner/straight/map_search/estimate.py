"""
Estimate of the time that remains until the object is at its goal.

    h = W (1 / v + c_r / 0.8 m) + |theta - theta_goal| (c_r / 0.6 rad + 0.5 s / rad) b(W) + V_1

charges a push at speed v along the path of length W on the ``DistanceGrid``, and contacts of c_r
each for distance and rotation; b falls from 1 to 0.15 on the last metre and a half, as on a long
path the object is turned in passing. On the last metre h is the cost-to-go V of open floor, if
that is more; V_1 is what that has in excess there. Farther off V misleads: it sees no walls.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled, wrap_angles
from push_model.geometry import Pose
from push_navigation.floor import clearance
from push_planner.straight.map_search.object_distance import length_at, UNREACHED
from push_planner.straight.map_search.problem import FREE
from push_primitives.cost_to_go import interpolate_cost

# Distance and rotation after which the estimate charges another contact [m, rad]; fitted to
# plans: without the charge ten times as many nodes are expanded.
CONTACT_DISTANCE, CONTACT_ROTATION = 0.8, 0.6
ROTATION_TIME = 0.5
# Length of the path from which on the cost-to-go of open floor counts [m]; chosen.
CLOSE_DISTANCE = 1.0
PASSING_DISTANCE, MIN_PASSING = 1.5, 0.15
# Steps between the floor is looked at on a line to the goal [m].
OPEN_STEP = 0.1


@compiled
def estimate(guide: Any, query: Any, x: float, y: float, theta: float, face: int) -> float:
    """
    Estimate the time that remains.

    :param guide: ``Guide``.
    :param query: ``Query``.
    :param x: of the object in the frame of the map [m].
    :param y: likewise [m].
    :param theta: likewise [rad].
    :param face: that was pushed last.
    :return: time [s], ``UNREACHED`` where there is no path.
    """
    length = length_at(guide.grid, x, y)
    if length >= UNREACHED:
        return UNREACHED
    rotation = heading_error(query, theta)
    passing = min(1.0, max(MIN_PASSING, PASSING_DISTANCE - length))
    settings = query.settings
    time = (length * (1.0 / settings.pushing_speed + settings.contact_time / CONTACT_DISTANCE)
            + abs(rotation) * passing * (settings.contact_time / CONTACT_ROTATION + ROTATION_TIME))
    if length > CLOSE_DISTANCE:
        return time + query.closing_time
    c, s = math.cos(theta), math.sin(theta)
    d_x, d_y = query.goal.x - x, query.goal.y - y
    return max(time, interpolate_cost(
        guide.open_floor, Pose(c * d_x + s * d_y, c * d_y - s * d_x, rotation), face))


@compiled
def heading_error(query: Any, theta: float) -> float:
    """Heading of the goal as seen by the object [rad]; 0 where any heading does."""
    if query.settings.heading_tolerance >= FREE:
        return 0.0
    return wrap_angles(query.goal.theta - theta)


@compiled
def is_open(floor: Any, query: Any, x: float, y: float) -> bool:
    """
    Tell whether the floor is open from a position of the object to the goal.

    :param floor: ``Floor``.
    :param query: ``Query``.
    :param x: of the object in the frame of the map [m].
    :param y: likewise [m].
    """
    needed, goal = query.settings.open_radius, query.goal
    if clearance(floor, x, y) < needed:
        return False
    d_x, d_y = goal.x - x, goal.y - y
    count = 1 + int(math.sqrt(d_x * d_x + d_y * d_y) / OPEN_STEP)
    for k in range(count, 0, -1):
        part = k / count
        if clearance(floor, x + part * d_x, y + part * d_y) < needed:
            return False
    return True
