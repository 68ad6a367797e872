"""How the robot gets from site to site: times of its ways round the object."""

import functools
import math

import numpy as np
from push_drive.detour import find_way, NoWay
from push_drive.way import travel_time
from push_model.geometry import Pose


def standoff(robot_pose, drive):
    """
    Step back from the contact, along the heading.

    :param robot_pose: ``Pose`` of the robot where it touches.
    :param drive: ``DriveSettings``.
    :return: ``Pose``.
    """
    return robot_pose @ Pose(-drive.standoff, 0.0, 0.0)


def way_to(robot, obj, object_pose, start, contact_pose, drive, workspace=None):
    """
    Find the way to where the last straight piece to the contact begins.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param contact_pose: ``Pose`` of the robot at the contact.
    :param drive: ``DriveSettings``.
    :param workspace: ``Workspace`` that the way keeps to; None for open floor.
    :return: ``Way``.
    :raises NoWay: where there is none.
    """
    more = () if workspace is None else (workspace,)
    return find_way(robot, obj, object_pose, start, standoff(contact_pose, drive), drive, *more)


def times_to(robot, obj, start, contact_poses, drive):
    """
    Find the times of the ways to several contacts on open floor; infinite where there is none.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``, at the origin.
    :param start: ``Pose`` of the robot in the object frame.
    :param contact_poses: ``Pose`` sequence of the robot at the contacts, in the object frame.
    :param drive: ``DriveSettings``.
    :return: times [s], shape (n,).
    """
    times = []
    for pose in contact_poses:
        try:
            way = way_to(robot, obj, Pose(0.0, 0.0, 0.0), start, pose, drive)
        except NoWay:
            times.append(math.inf)
        else:
            times.append(travel_time(way, robot, drive))
    return np.array(times)


@functools.lru_cache(maxsize=16)
def times_between(robot, obj, contact_poses, drive):
    """
    Find the times of the ways from contact to contact; arguments as of ``times_to``.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param contact_poses: tuple of ``Pose``.
    :param drive: ``DriveSettings``.
    :return: times [s], shape (n, n), read-only.
    """
    times = np.array([times_to(robot, obj, pose, contact_poses, drive)
                      for pose in contact_poses])
    times.flags.writeable = False
    return times
