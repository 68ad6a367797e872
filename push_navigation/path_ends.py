"""How a way begins and ends at the object, and what lies between."""

import math
from typing import NamedTuple

from push_model.geometry import wrap_angle
from push_navigation.path import differential_path, holonomic_path

SLANT = math.radians(75.0)
TOUCHING = 0.005
REACHED = 1e-7


class NoPathFound(ValueError):
    """
    There is no way, and why.

    :param reason: why, one phrase.
    """

    def __init__(self, reason):
        super().__init__(reason)
        self.reason = reason


class Departure(NamedTuple):
    """
    Where the straight piece that leads off the object ends.

    :param place: (x, y) at the clearance, or where the robot is if it is as far away.
    :param is_needed: whether there is such a piece.
    :param is_backwards: whether the robot goes off backwards.
    """

    place: tuple
    is_needed: bool
    is_backwards: bool


def departure_from_start(robot, body, pose, clearance):
    """
    Find the way off the object from where the robot stands.

    :param robot: the ``RoundRobot``.
    :param body: ``InflatedObstacle`` object, grown by the robot's radius and the clearance.
    :param pose: ``Pose`` of the robot in the object frame.
    :param clearance: how far off it leads [m].
    :return: ``Departure``, in the object frame.
    :raises NoWay: where the robot's centre is inside the object.
    """
    return _off(robot, body, pose, clearance, robot.radius, 'start')


def departure_from_goal(robot, body, pose, clearance):
    """
    Find the same for where the robot is to stand; it goes there the other way round.

    :param robot: the ``RoundRobot``.
    :param body: ``InflatedObstacle`` object, grown by the robot's radius and the clearance.
    :param pose: ``Pose`` of the robot in the object frame.
    :param clearance: how far off it leads [m].
    :return: ``Departure``, in the object frame.
    :raises NoWay: where the robot would stand in the object.
    """
    return _off(robot, body, pose, clearance, TOUCHING, 'goal')


def assemble_paths(robot, start, goal, off, on, waypoints, max_reverse_distance):
    """
    Join the pieces to ways: forwards, and backwards too where it is short.

    :param robot: the ``RoundRobot``.
    :param start: ``Pose``.
    :param goal: ``Pose``.
    :param off: ``Departure`` at the start.
    :param on: ``Departure`` at the goal.
    :param waypoints: (x, y, bend) sequence from behind the end of ``off`` to that of ``on``.
    :param max_reverse_distance: longest way that is gone backwards [m].
    :return: list of ``Path``.
    """
    segments = [(*off.place, 0.0)] * off.is_needed + waypoints + [(*goal[:2], 0.0)] * on.is_needed
    if robot.drive == 'holonomic':
        return [holonomic_path(start, goal, segments, (off.is_needed, on.is_needed))]
    ways = []
    for back in (False, True):
        flags = ([off.is_backwards] * off.is_needed + [back] * len(waypoints)
                 + [not on.is_backwards] * on.is_needed)
        ways.append(differential_path(start, goal, segments, flags))
    return ways if ways[1].length <= max_reverse_distance else ways[:1]


def _off(robot, body, pose, clearance, allowed, name):
    gap, outward = body.nearest(pose.x, pose.y)
    if gap > -REACHED:
        return Departure(pose[:2], False, False)
    overlap = -gap - clearance
    if overlap > allowed:
        raise NoPathFound(f'the {name} of the way lies {overlap:.3f} m inside the object')
    backwards = abs(wrap_angle(outward - pose.theta)) > 0.5 * math.pi
    along = pose.theta + math.pi * backwards
    if robot.drive == 'differential' and abs(wrap_angle(outward - along)) <= SLANT:
        outward = along
    way = body.ray_exit(pose.x, pose.y, outward)
    place = pose.x + way * math.cos(outward), pose.y + way * math.sin(outward)
    return Departure(place, True, backwards)
