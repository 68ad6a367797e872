"""
Places from which the object may not be pushed on, as the robot has no room beside it.

That is where it has none at any two opposite faces; or, of a disc, which rolls off along the line
to an obstacle however it is pushed, none to push it off that obstacle.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.floor import clearance

# Angle at which a disc is pushed off an obstacle [rad], of which one point of the table is certain
# to have most, and distance from its middle at which the floor is looked at for the direction of
# the obstacle [m].
LEAVING_ANGLE = math.radians(20.0)
GRADIENT_STEP = 0.05
# Gap before the contact from which on the robot drives straight [m].
STANDOFF = 0.06
# Cosine between the normals of faces that are opposite.
OPPOSITE = -0.9


@compiled
def is_dead_end(scene: Any, pushes: Any, robot_margin: float, pose: Any) -> bool:
    """
    Tell whether the robot has no room where the object may have to be pushed next.

    :param scene: ``Scene``.
    :param pushes: ``Pushes``.
    :param robot_margin: clearance of the robot from obstacles [m].
    :param pose: (x, y, theta) of the object in the frame of the map.
    """
    needed = scene.robot_radius + robot_margin
    if clearance(scene.floor, pose[0], pose[1]) >= scene.outer_radius + STANDOFF + 2.0 * needed:
        return False
    if scene.vertices.shape[0] == 0:
        return not _leaves_obstacle(scene, pose, needed)
    middles, normals = pushes.middles, pushes.normals
    for first in range(middles.shape[0]):
        if not _has_room(scene.floor, pose, middles[first], normals[first], needed):
            continue
        for second in range(first):
            cosine = (normals[first, 0] * normals[second, 0]
                      + normals[first, 1] * normals[second, 1])
            if cosine < OPPOSITE and _has_room(scene.floor, pose, middles[second],
                                               normals[second], needed):
                return False
    return True


@compiled
def _leaves_obstacle(scene: Any, pose: Any, needed: float) -> bool:
    """Tell whether the robot has room to push a disc off the nearest obstacle."""
    x, y = pose[0], pose[1]
    u = clearance(scene.floor, x + GRADIENT_STEP, y) - clearance(scene.floor, x - GRADIENT_STEP, y)
    v = clearance(scene.floor, x, y + GRADIENT_STEP) - clearance(scene.floor, x, y - GRADIENT_STEP)
    norm = math.sqrt(u * u + v * v)
    if norm < GRADIENT_STEP:
        # Between obstacles.
        return True
    away = scene.outer_radius + scene.robot_radius + STANDOFF
    back, lateral = away * math.sin(LEAVING_ANGLE) / norm, away * math.cos(LEAVING_ANGLE) / norm
    return (clearance(scene.floor, x - back * u - lateral * v, y - back * v + lateral * u)
            >= needed
            or clearance(scene.floor, x - back * u + lateral * v, y - back * v - lateral * u)
            >= needed)


@compiled
def _has_room(floor: Any, pose: Any, middle: Any, normal: Any, needed: float) -> bool:
    """Tell whether the robot has room before the middle of a face."""
    u, v = middle[0] - STANDOFF * normal[0], middle[1] - STANDOFF * normal[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = pose[0] + c * u - s * v, pose[1] + s * u + c * v
    return clearance(floor, x, y) >= needed
