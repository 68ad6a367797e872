"""
Motion of many copies of the world, the members of an ensemble, each with parameters of its own.

A member is one row of ``states``, ``bodies`` and ``supports``, in the order of
``push_dynamics.layout``. Compiled: arrays are written in place, scratch arrays are arguments.
"""

import math
from typing import Any, NamedTuple

from push_dynamics import layout
from push_dynamics.compiled import compiled
from push_dynamics.contact_law import ContactPoint, nearest_points
from push_dynamics.layout import (
    COM_X, COM_Y, DISC_RADIUS, NORMAL_FORCE, ROBOT_OMEGA, ROBOT_RADIUS, ROBOT_THETA, ROBOT_V_X,
    ROBOT_V_Y, ROBOT_X, ROBOT_Y, THETA, World, X, Y,
)
from push_dynamics.step import advance
from push_model.geometry import Pose

# A drive that has the commanded velocity at once: time constant [s], accelerations [m/s^2] and
# [rad/s^2], chosen far beyond those of any robot.
IDEAL_DRIVE = (1e-3, 50.0, 500.0)
STATE_SIZE = layout.STATE_SIZE


class Worlds(NamedTuple):
    """
    Worlds that differ in state, body and supports; the other arrays are those of ``World``.

    :param states: shape (n, 34), is written.
    :param bodies: shape (n, 13).
    :param supports: shape (n, k, 8).
    """

    states: Any
    bodies: Any
    supports: Any
    outline: Any
    floor: Any
    forces: Any
    drive: Any
    command: Any
    walls: Any
    touches: Any


@compiled
def member_world(worlds: Worlds, i: int, state: Any) -> World:
    """
    Pick the world of one member.

    :param i: index of the member.
    :param state: array that is its state, which is written.
    """
    return World(state, worlds.bodies[i], worlds.supports[i], worlds.outline, worlds.floor,
                 worlds.forces, worlds.drive, worlds.command, worlds.walls, worlds.touches)


@compiled
def object_origin(state: Any, body: Any) -> tuple[float, float]:
    """
    Find the origin of the object frame.

    :param state: values of one member.
    :param body: its body.
    :return: (x, y) in the world [m].
    """
    c, s = math.cos(state[THETA]), math.sin(state[THETA])
    return (state[X] - c * body[COM_X] + s * body[COM_Y],
            state[Y] - s * body[COM_X] - c * body[COM_Y])


@compiled
def contact_of(state: Any, body: Any, outline: Any) -> ContactPoint:
    """
    Find the nearest points of object and robot.

    :param state: values of one member.
    :param body: its body.
    :param outline: vertices in the object frame [m].
    :return: ``ContactPoint``; its normal points from the robot to the object.
    """
    x, y = object_origin(state, body)
    return nearest_points(outline, body[DISC_RADIUS], body[ROBOT_RADIUS],
                          Pose(x, y, state[THETA]),
                          Pose(state[ROBOT_X], state[ROBOT_Y], state[ROBOT_THETA]))


@compiled
def close_gap(state: Any, body: Any, outline: Any, touches: bool) -> float:
    """
    Move the robot along the contact normal off an overlap, or to where it touches.

    :param state: values of one member, is written.
    :param body: its body.
    :param outline: vertices in the object frame [m].
    :param touches: whether the robot must touch; else a positive gap stays.
    :return: the gap before [m].
    """
    contact = contact_of(state, body, outline)
    if contact.gap < 0.0 or touches:
        state[ROBOT_X] += contact.gap * contact.n_x
        state[ROBOT_Y] += contact.gap * contact.n_y
    return contact.gap


@compiled
def drive_robot(world: World, v_x: float, v_y: float, omega: float) -> None:
    """
    Let the robot move with a velocity at once.

    :param world: its state and command are written.
    :param v_x: velocity in the robot's axes, x [m/s].
    :param v_y: the same, y [m/s].
    :param omega: yaw rate [rad/s].
    """
    state, command = world.state, world.command
    command[0] = v_x
    command[1] = v_y
    command[2] = omega
    state[ROBOT_V_X] = v_x
    state[ROBOT_V_Y] = v_y
    state[ROBOT_OMEGA] = omega


@compiled
def move_members(worlds: Worlds, increments: Any, duration: float, longest: float) -> int:
    """
    Move every member for a while, its robot along an arc to a given pose.

    :param worlds: ``Worlds`` with ``IDEAL_DRIVE``.
    :param increments: motion (x, y, theta) of each robot in its own axes, shape (n, 3).
    :param duration: how long [s], above 0.
    :param longest: longest step [s].
    :return: number of members in contact at the end.
    """
    touching = 0
    for i in range(len(worlds.states)):
        world = member_world(worlds, i, worlds.states[i])
        # The twist whose arc ends at the increment: the chord is shorter by sin(h) / h.
        x, y, half = increments[i][0], increments[i][1], 0.5 * increments[i][2]
        c, s = math.cos(half), math.sin(half)
        ratio = duration * (s / half if half != 0.0 else 1.0)
        drive_robot(world, (c * x + s * y) / ratio, (c * y - s * x) / ratio,
                    2.0 * half / duration)
        advance(world, duration, longest)
        if world.state[NORMAL_FORCE] > 0.0:
            touching += 1
    return touching


@compiled
def close_gaps(states: Any, bodies: Any, outline: Any, gaps: Any) -> None:
    """
    Move robots off overlaps; those that were in contact touch again.

    :param states: shape (n, 34), is written.
    :param bodies: shape (n, 13).
    :param outline: vertices in the object frame [m].
    :param gaps: gap of each member before [m], shape (n,), is written.
    """
    for i in range(len(states)):
        touches = states[i][NORMAL_FORCE] > 0.0
        gaps[i] = close_gap(states[i], bodies[i], outline, touches)
