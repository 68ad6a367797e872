"""Costs of push sequences besides the pushing: paths of the robot, settling, touch, retreat."""

import functools
import math
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.path import NoPathFound, Path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_planner.collocation.speed_profile import push_time
from push_planner.sequence.primitives import PrimitiveTable
from push_planner.settings import PlannerSettings, TaskSettings

ORIGIN = Pose(0.0, 0.0, 0.0)


class SequenceCosts(NamedTuple):
    """
    What sequences of k primitives cost.

    :param first: time until a push with each primitive begins [s], shape (k,).
    :param change: time from one primitive to another [s], shape (k, k); 0 at one location.
    :param speed: of the contact [m/s].
    :param max_path_length: of the contact in one push [m].
    """

    first: FloatArray
    change: FloatArray
    speed: float
    max_path_length: float

    def besides_pushing(self, moves: NDArray[np.int_]) -> FloatArray:
        """
        Time of sequences except for the pushing [s], shape (m,).

        :param moves: numbers of the primitives, shape (m, n).
        """
        return self.first[moves[:, 0]] + self.change[moves[:, :-1], moves[:, 1:]].sum(axis=1)


def standoff_pose(contact_pose: Pose, drive: DriveSettings) -> Pose:
    """
    Step back from the contact, along the heading.

    :param contact_pose: ``Pose`` of the robot at the contact.
    :param drive: ``DriveSettings``.
    :return: ``Pose``.
    """
    return contact_pose @ Pose(-drive.standoff, 0.0, 0.0)


def plan_approach(robot: RoundRobot, obj: PushedObject, object_pose: Pose, start: Pose,
                  contact_pose: Pose, drive: DriveSettings) -> Path:
    """
    Plan the robot's path to where the straight approach to the contact begins.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param contact_pose: ``Pose`` of the robot at the contact.
    :param drive: ``DriveSettings``.
    :return: ``Path``.
    :raises NoPathFound: where there is none.
    """
    return plan_path(robot, obj, object_pose, start, standoff_pose(contact_pose, drive), drive)


def approach_times(robot: RoundRobot, obj: PushedObject, start: Pose,
                   contact_poses: Sequence[Pose], drive: DriveSettings) -> FloatArray:
    """
    Compute the times of the paths to several contacts on open floor; infinite where is none.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``, at the origin.
    :param start: ``Pose`` of the robot in the object frame.
    :param contact_poses: ``Pose`` of the robot at the contacts, in the object frame.
    :param drive: ``DriveSettings``.
    :return: times [s], shape (n,).
    """
    times: list[float] = []
    for contact_pose in contact_poses:
        try:
            path = plan_approach(robot, obj, ORIGIN, start, contact_pose, drive)
        except NoPathFound:
            times.append(math.inf)
        else:
            times.append(travel_time(path, robot, drive))
    return np.array(times)


@functools.lru_cache(maxsize=16)
def transfer_times(robot: RoundRobot, obj: PushedObject, contact_poses: tuple[Pose, ...],
                   drive: DriveSettings) -> FloatArray:
    """
    Compute the times of the paths from contact to contact; arguments as of ``approach_times``.

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


def sequence_costs(table: PrimitiveTable, robot_pose: Pose, settings: PlannerSettings,
                   drive: DriveSettings, task: TaskSettings) -> SequenceCosts:
    """
    Compute what sequences of the primitives of a table cost on open floor.

    :param table: ``PrimitiveTable``.
    :param robot_pose: ``Pose`` of the robot in the frame of the object.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``.
    :return: ``SequenceCosts``.
    """
    problem = table.primitives[0].problem
    first = approach_times(problem.robot, problem.obj, robot_pose, table.robot_poses, drive)
    transfers = transfer_times(problem.robot, problem.obj, table.robot_poses, drive)
    # What a push of 1 m takes longer than at full speed throughout.
    ramps = push_time(settings, 1.0) - 1.0 / settings.pushing_speed
    per_push = task.switch_time + ramps
    locations = table.locations
    change = transfers[np.ix_(locations, locations)] + per_push
    # A contact that has rolled is not where it was: the push cannot go on from there.
    rolls = problem.kind == 'rolling'
    change[locations[:, None] == locations] = math.inf if rolls else 0.0
    return SequenceCosts(first[locations] + per_push, change, settings.pushing_speed,
                         settings.max_path_length)
