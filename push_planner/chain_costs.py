"""What chains cost besides their pushing: the robot's ways, settling, touching, retreats."""

import math

import numpy as np
from push_planner.approaches import times_between, times_to
from push_planner.hunt import Costs
from push_planner.pushes import push_time


def costs_of(table, obj, robot, robot_pose, settings, drive, task):
    """
    Find what chains of the elements of a table cost on open floor.

    :param table: ``push_planner.elements.Table``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param robot_pose: ``Pose`` of the robot in the frame of the object.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``.
    :return: ``push_planner.hunt.Costs``.
    """
    first = times_to(robot, obj, robot_pose, table.places, drive)
    between = times_between(robot, obj, table.places, drive)
    ramp = push_time(settings, 1.0) - 1.0 / settings.pushing_speed
    each, numbers = task.switch_time + ramp, table.numbers
    change = between[np.ix_(numbers, numbers)] + each
    # A contact that has rolled is not where it was.
    rolls = table.elements[0].problem.kind == 'rolling'
    change[numbers[:, None] == numbers] = math.inf if rolls else 0.0
    return Costs(first[numbers] + each, change, settings.pushing_speed, settings.max_path_length)
