"""Touches of an object and walls: vertices at walls, edges at corners, round sides at both."""

import math
from typing import Any

from push_dynamics.compiled import closest_on_polygon, compiled
from push_dynamics.contact_law import Velocity
from push_dynamics.layout import (
    COM_X, COM_Y, DISC_RADIUS, TOUCH_ARM_N, TOUCH_ARM_T, TOUCH_GAP, TOUCH_N_X, TOUCH_N_Y,
    TOUCH_NORMAL, TOUCH_REQUIRED, TOUCH_TANGENTIAL, World,
)
from push_dynamics.wall_grid import walls_near
from push_dynamics.walls import (
    bounding_radius, MAX_DEPTH, required_speed, wall_distance, wall_gap, WallGap,
)
from push_model.geometry import Pose

# Touches at one time, at most; chosen: two faces of a box flat in a corner are four.
MAX_TOUCHES = 12
# Gap below which a touch counts [m], and the speed of a touching point that this allows for
# besides [m/s]; chosen: a touch too many costs time, one too few lets a vertex into the wall.
REACH, MAX_SPEED = 1e-3, 1.0


@compiled
def add_touch(touches: Any, count: int, gap: WallGap, arm_x: float, arm_y: float) -> int:
    """
    Note a touch; where there is no room for it, in place of the one with the widest gap.

    :param touches: rows in the order of ``layout``, are written.
    :param count: of touches so far.
    :param arm_x: from the mass centre to the contact, world axes, x [m].
    :param arm_y: the same, y [m].
    :return: count of touches.
    """
    index = count
    if count == len(touches):
        index = 0
        for i in range(count):
            if touches[i][TOUCH_GAP] > touches[index][TOUCH_GAP]:
                index = i
        if touches[index][TOUCH_GAP] <= gap.distance:
            return count
    row = touches[index]
    row[TOUCH_N_X], row[TOUCH_N_Y] = gap.n_x, gap.n_y
    row[TOUCH_ARM_N] = arm_x * gap.n_y - arm_y * gap.n_x
    row[TOUCH_ARM_T] = arm_x * gap.n_x + arm_y * gap.n_y
    row[TOUCH_GAP] = gap.distance
    row[TOUCH_NORMAL] = row[TOUCH_TANGENTIAL] = 0.0
    return max(count, index + 1)


@compiled
def touch_disc(touches: Any, walls: Any, body: Any, pose: Pose, reach: float) -> int:
    """
    Find where a disc touches walls; arguments are as in ``touch_polygon``.

    :param pose: of the object frame.
    """
    count, radius = 0, body[DISC_RADIUS]
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    com_x, com_y = c * body[COM_X] - s * body[COM_Y], s * body[COM_X] + c * body[COM_Y]
    first, last = walls_near(walls, pose.x, pose.y)
    for k in range(first, last):
        n_x, n_y, distance = wall_gap(walls.rows[walls.near[k]], pose.x, pose.y, pose.x, pose.y)
        if -MAX_DEPTH < distance - radius < reach:
            count = add_touch(touches, count, WallGap(n_x, n_y, distance - radius),
                              -radius * n_x - com_x, -radius * n_y - com_y)
    return count


@compiled
def touch_corner(touches: Any, count: int, corner: Any, outline: Any, body: Any, pose: Pose,
                 reach: float) -> int:
    """
    Find where a polygon touches the corner of a wall; arguments are as in ``touch_polygon``.

    :param count: of touches so far.
    :param corner: a row of ``wall_rows``.
    """
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    d_x, d_y = corner[0] - pose.x, corner[1] - pose.y
    c_x, c_y, n_x, n_y, distance, _, _ = closest_on_polygon(outline, c * d_x + s * d_y,
                                                            c * d_y - s * d_x)
    if not -MAX_DEPTH < distance < reach:
        return count
    gap = WallGap(c * n_x - s * n_y, s * n_x + c * n_y, distance)
    c_x, c_y = c_x - body[COM_X], c_y - body[COM_Y]
    return add_touch(touches, count, gap, c * c_x - s * c_y, s * c_x + c * c_y)


@compiled
def touch_polygon(touches: Any, walls: Any, body: Any, outline: Any, pose: Pose,
                  reach: float) -> int:
    """
    Find where a polygon touches walls.

    :param touches: rows in the order of ``layout``, are written.
    :param walls: ``WallGrid``.
    :param outline: vertices in the object frame, shape (k, 2) [m].
    :param pose: of the object frame.
    :param reach: gap below which a touch counts [m].
    :return: count of touches.
    """
    count = 0
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    center_x = pose.x + c * body[COM_X] - s * body[COM_Y]
    center_y = pose.y + s * body[COM_X] + c * body[COM_Y]
    radius = bounding_radius(body, outline) + reach
    first, last = walls_near(walls, center_x, center_y)
    for k in range(first, last):
        wall = walls.rows[walls.near[k]]
        if wall_distance(wall, center_x, center_y) > radius:
            continue
        if wall[4] == 0.0:
            count = touch_corner(touches, count, wall, outline, body, pose, reach)
            continue
        for i in range(len(outline)):
            x = pose.x + c * outline[i][0] - s * outline[i][1]
            y = pose.y + s * outline[i][0] + c * outline[i][1]
            gap = wall_gap(wall, x, y, center_x, center_y)
            if -MAX_DEPTH < gap.distance < reach:
                count = add_touch(touches, count, gap, x - center_x, y - center_y)
    return count


@compiled
def find_touches(world: World, pose: Pose, guess: Velocity, h: float) -> int:
    """
    Find where the object touches walls in the middle of a step, or may by its end.

    :param world: its touches are written.
    :param pose: of the object frame in the middle of the step.
    :param guess: predicted velocity of the object.
    :param h: step [s].
    :return: count of touches.
    """
    touches, walls, body, outline = world.touches, world.walls, world.body, world.outline
    reach = REACH + h * MAX_SPEED
    if body[DISC_RADIUS] > 0.0:
        count = touch_disc(touches, walls, body, pose, reach)
    else:
        count = touch_polygon(touches, walls, body, outline, pose, reach)
    for i in range(count):
        row = touches[i]
        # As with the robot, the gap is carried back to the start of the step.
        approach = (row[TOUCH_N_X] * guess.v_x + row[TOUCH_N_Y] * guess.v_y
                    + row[TOUCH_ARM_N] * guess.omega)
        row[TOUCH_REQUIRED] = required_speed(row[TOUCH_GAP] - 0.5 * h * approach, h)
    return count
