"""
Numbers of a tape at an instant, read off the arrays of the kernel.

Compiled, as a row is made for every odometry: as plain Python this took longer than to simulate
the time between two of them.
"""

import math
from typing import Any

from push_dynamics import layout
from push_dynamics.compiled import compiled
from push_dynamics.contact_law import nearest_points, surface_velocity, Velocity
from push_dynamics.layout import (
    COM_X, COM_Y, DISC_RADIUS, INERTIA, MASS, MODE, NORMAL_FORCE, OMEGA, ROBOT_OMEGA,
    ROBOT_RADIUS, ROBOT_THETA, ROBOT_V_X, ROBOT_V_Y, ROBOT_X, ROBOT_Y, SEPARATE, TANGENTIAL_FORCE,
    THETA, V_X, V_Y, World, X, Y,
)
from push_model.friction import has_heights
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_sim_node.truth import Energy

# Columns of a tape, but for the friction on each support.
COLUMNS = ('time',
           'object_x', 'object_y', 'object_theta', 'object_v_x', 'object_v_y', 'object_omega',
           'robot_x', 'robot_y', 'robot_theta', 'robot_v_x', 'robot_v_y', 'robot_omega',
           'command_v_x', 'command_v_y', 'command_omega',
           'mode', 'force_n', 'force_t', 'gap', 'pushing_angle', 'contact_x', 'contact_y',
           'normal', *(f'energy_{name}' for name in Energy._fields))
# First column of the object, the robot, the command, the contact and the energies.
OBJECT, ROBOT, COMMAND, CONTACT, ENERGY = (
    COLUMNS.index(name) for name in ('object_x', 'robot_x', 'command_v_x', 'mode', 'energy_work'))
SUPPORTS = len(COLUMNS)
# Columns in the order of the state, where there are walls.
WALL_COLUMNS = ('wall_force_x', 'wall_force_y', 'wall_touches', 'wall_depth', 'robot_at_wall')


def columns_of(obj: PushedObject, has_walls: bool = False) -> tuple[str, ...]:
    """
    List the columns of a tape: ``COLUMNS``, then the friction on each support.

    The loads of the supports follow where pushes shift them, then what walls do.

    :param has_walls: whether there are any.
    """
    supports = range(len(obj.supports))
    columns = COLUMNS + tuple(f'support_{i}_{axis}' for i in supports for axis in 'xy')
    if has_heights(obj):
        columns += tuple(f'support_{i}_load' for i in supports)
    return columns + WALL_COLUMNS if has_walls else columns


@compiled
def write_row(row: Any, world: World) -> None:
    """
    Write a row of a tape, but for time, command and loads of the supports.

    :param row: numbers by the columns, is written.
    """
    state, body, forces = world.state, world.body, world.forces
    write_object(row, state, body)
    for i in range(3):
        row[ROBOT + i] = state[ROBOT_X + i]
        row[ROBOT + 3 + i] = state[ROBOT_V_X + i]
    write_contact(row, world)
    write_energies(row, state, body)
    for i in range(len(forces)):
        row[SUPPORTS + i] = forces[i]


@compiled
def write_object(row: Any, state: Any, body: Any) -> None:
    """
    Write pose and twist of the object frame, world axes.

    :param row: is written.
    :param state: of the kernel.
    :param body: object and robot.
    """
    c, s = math.cos(state[THETA]), math.sin(state[THETA])
    x, y = c * body[COM_X] - s * body[COM_Y], s * body[COM_X] + c * body[COM_Y]
    row[OBJECT] = state[X] - x
    row[OBJECT + 1] = state[Y] - y
    row[OBJECT + 2] = state[THETA]
    row[OBJECT + 3] = state[V_X] + state[OMEGA] * y
    row[OBJECT + 4] = state[V_Y] - state[OMEGA] * x
    row[OBJECT + 5] = state[OMEGA]


@compiled
def write_contact(row: Any, world: World) -> None:
    """
    Write mode, forces, gap, pushing angle, place and normal of the contact.

    :param row: is written, the pose of the object is read.
    """
    state, body = world.state, world.body
    robot = Pose(state[ROBOT_X], state[ROBOT_Y], state[ROBOT_THETA])
    nearest = nearest_points(
        world.outline, body[DISC_RADIUS], body[ROBOT_RADIUS],
        Pose(row[OBJECT], row[OBJECT + 1], row[OBJECT + 2]), robot)
    row[CONTACT] = state[MODE]
    row[CONTACT + 1] = state[NORMAL_FORCE]
    row[CONTACT + 2] = state[TANGENTIAL_FORCE]
    row[CONTACT + 3] = nearest.gap
    row[CONTACT + 4] = math.nan
    row[CONTACT + 5] = nearest.x
    row[CONTACT + 6] = nearest.y
    row[CONTACT + 7] = math.atan2(nearest.n_y, nearest.n_x)
    if state[MODE] == SEPARATE:
        return
    c, s = math.cos(robot.theta), math.sin(robot.theta)
    v_x, v_y = state[ROBOT_V_X], state[ROBOT_V_Y]
    normal, tangential = surface_velocity(
        body[ROBOT_RADIUS], nearest, robot,
        Velocity(c * v_x - s * v_y, s * v_x + c * v_y, state[ROBOT_OMEGA]))
    if normal != 0.0 or tangential != 0.0:
        row[CONTACT + 4] = math.atan2(tangential, normal)


@compiled
def write_energies(row: Any, state: Any, body: Any) -> None:
    """
    Write the energies since the start, in the order of ``Energy``.

    :param row: is written.
    :param state: of the kernel.
    :param body: object and robot.
    """
    v_x, v_y, omega = state[V_X], state[V_Y], state[OMEGA]
    row[ENERGY] = state[layout.WORK]
    row[ENERGY + 1] = 0.5 * (body[MASS] * (v_x * v_x + v_y * v_y)
                             + body[INERTIA] * omega * omega)
    row[ENERGY + 2] = state[layout.SUPPORT_LOSS]
    row[ENERGY + 3] = state[layout.CONTACT_LOSS]
    row[ENERGY + 4] = state[layout.IMPACT_LOSS]
    row[ENERGY + 5] = state[layout.INTEGRATION_LOSS]
