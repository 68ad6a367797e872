"""
Places from which the object cannot be pushed back, as the robot has no room beside it.

That is where it has none at any two opposite faces; or, of a disc, on any two opposite sides.

A disc beside a wall rolls off along the line of contact however it is pushed. The robot touches it
behind its middle, no nearer to the wall than its own clearance allows. Where the middle of the
disc is farther from the wall by g than that of the robot has to be, the line of contact points off
the wall by alpha, with R and r the radii of disc and robot:

    sin(alpha) = g / (R + r),    dg/ds = sin(alpha),    so that    s = (R + r) ln(g_1 / g_0)

is the length of pushes along the wall until the room has grown from g_0 to g_1.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.floor import clearance
from push_planner.straight.map_search.scene import object_clearance

# Gap before the contact from which on the robot drives straight [m].
STANDOFF = 0.06
# Cosine between the normals of faces that are opposite.
OPPOSITE = -0.9
# Pairs of opposite sides of a disc that are looked at; chosen: 15 degrees apart.
DISC_SIDES = 12
# Least room g [m], as poses and walls are not known better, and angle off a wall from which on a
# disc counts as clear of it [rad]; chosen.
LEAST_ROOM = 0.005
LEAVING_ANGLE = math.radians(20.0)
# Distance from the middle at which the floor is looked at for the direction of a wall [m].
GRADIENT_STEP = 0.05


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
        return not _has_opposite_sides(scene, pose, needed)
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
def leaving_length(scene: Any, robot_margin: float, position: Any, goal: Any) -> float:
    """
    Find the length of pushes along a wall until a disc is as far from it as it has to be.

    :param scene: ``Scene``.
    :param robot_margin: clearance of the robot from obstacles [m].
    :param position: (x, y) of the object in the frame of the map [m].
    :param goal: (x, y) of its goal; what it lacks there is not needed [m].
    :return: s [m], 0 of other objects.
    """
    if scene.vertices.shape[0] > 0:
        return 0.0
    reach = scene.outer_radius + scene.robot_radius
    needed = scene.robot_radius + robot_margin
    room = max(LEAST_ROOM, clearance(scene.floor, position[0], position[1]) - needed)
    at_goal = min(reach * math.sin(LEAVING_ANGLE),
                  clearance(scene.floor, goal[0], goal[1]) - needed)
    return reach * math.log(at_goal / room) if at_goal > room else 0.0


@compiled
def slide_along(scene: Any, pose: Any, overlap: float) -> None:
    """
    Put a disc that a push presses a little onto a wall beside it: the wall guides it.

    :param scene: ``Scene``.
    :param pose: (x, y, theta) of the object in the frame of the map, is written.
    :param overlap: with obstacles, at most [m]; where it is more, nothing changes.
    """
    if scene.vertices.shape[0] > 0:
        return
    x, y, floor = pose[0], pose[1], scene.floor
    depth = -object_clearance(scene, x, y, pose[2], 0.0)
    if depth <= 0.0 or depth > overlap:
        return
    u = clearance(floor, x + GRADIENT_STEP, y) - clearance(floor, x - GRADIENT_STEP, y)
    v = clearance(floor, x, y + GRADIENT_STEP) - clearance(floor, x, y - GRADIENT_STEP)
    norm = math.sqrt(u * u + v * v)
    # Less than this is between obstacles.
    if norm >= GRADIENT_STEP:
        pose[0] += depth * u / norm
        pose[1] += depth * v / norm


@compiled
def _has_opposite_sides(scene: Any, pose: Any, needed: float) -> bool:
    """Tell whether the robot has room on two opposite sides of a disc."""
    away = scene.outer_radius + scene.robot_radius + STANDOFF
    for side in range(DISC_SIDES):
        angle = math.pi * side / DISC_SIDES
        u, v = away * math.cos(angle), away * math.sin(angle)
        if (clearance(scene.floor, pose[0] + u, pose[1] + v) >= needed
                and clearance(scene.floor, pose[0] - u, pose[1] - v) >= needed):
            return True
    return False


@compiled
def _has_room(floor: Any, pose: Any, middle: Any, normal: Any, needed: float) -> bool:
    """Tell whether the robot has room before the middle of a face."""
    u, v = middle[0] - STANDOFF * normal[0], middle[1] - STANDOFF * normal[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = pose[0] + c * u - s * v, pose[1] + s * u + c * v
    return clearance(floor, x, y) >= needed
