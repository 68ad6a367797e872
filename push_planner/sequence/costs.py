"""What chains cost besides their pushing: the robot's ways, settling, touching, retreats."""

import functools
import math

import numpy as np
from push_model.geometry import Pose
from push_navigation.path import NoPathFound
from push_navigation.path_planner import plan_path
from push_navigation.speed_profile import travel_time
from push_planner.collocation.speed_profile import push_time
from push_planner.sequence.search import SequenceCosts


def standoff(robot_pose, drive):
    """
    Step back from the contact, along the heading.

    :param robot_pose: ``Pose`` of the robot where it touches.
    :param drive: ``DriveSettings``.
    :return: ``Pose``.
    """
    return robot_pose @ Pose(-drive.standoff, 0.0, 0.0)


def plan_approach(robot, obj, object_pose, start, contact_pose, drive, occupancy_map=None):
    """
    Find the way to where the last straight piece to the contact begins.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param contact_pose: ``Pose`` of the robot at the contact.
    :param drive: ``DriveSettings``.
    :param occupancy_map: ``OccupancyMap`` that the way keeps to; None for open floor.
    :return: ``Way``.
    :raises NoWay: where there is none.
    """
    return plan_path(robot, obj, object_pose, start, standoff(contact_pose, drive), drive,
                     occupancy_map=occupancy_map)


def approach_times(robot, obj, start, contact_poses, drive):
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
            way = plan_approach(robot, obj, Pose(0.0, 0.0, 0.0), start, pose, drive)
        except NoPathFound:
            times.append(math.inf)
        else:
            times.append(travel_time(way, robot, drive))
    return np.array(times)


@functools.lru_cache(maxsize=16)
def transfer_times(robot, obj, contact_poses, drive):
    """
    Find the times of the ways from contact to contact; arguments as of ``approach_times``.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param contact_poses: tuple of ``Pose``.
    :param drive: ``DriveSettings``.
    :return: times [s], shape (n, n), read-only.
    """
    times = np.array([approach_times(robot, obj, pose, contact_poses, drive)
                      for pose in contact_poses])
    times.flags.writeable = False
    return times


def sequence_costs(table, obj, robot, robot_pose, settings, drive, task):
    """
    Find what chains of the elements of a table cost on open floor.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param robot_pose: ``Pose`` of the robot in the frame of the object.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``.
    :return: ``push_planner.sequence.search.SequenceCosts``.
    """
    first = approach_times(robot, obj, robot_pose, table.places, drive)
    between = transfer_times(robot, obj, table.places, drive)
    ramp = push_time(settings, 1.0) - 1.0 / settings.pushing_speed
    each, numbers = task.switch_time + ramp, table.numbers
    change = between[np.ix_(numbers, numbers)] + each
    # A contact that has rolled is not where it was.
    rolls = table.primitives[0].problem.kind == 'rolling'
    change[numbers[:, None] == numbers] = math.inf if rolls else 0.0
    return SequenceCosts(first[numbers] + each, change, settings.pushing_speed, settings.max_path_length)
