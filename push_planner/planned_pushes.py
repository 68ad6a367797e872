"""Pushes of a plan as pictures show them: poses of the object, and the robot's ways."""

from typing import NamedTuple

from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.approach.approach_path import plan_approach
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, Path
from push_navigation.settings import DriveSettings
from push_planner.task_plan import TaskPlan


class PlannedPush(NamedTuple):
    """
    One push of a plan.

    :param start: ``Pose`` of the object before it, as expected.
    :param end: ``Pose`` of the object after it, as expected.
    :param robot_start: ``Pose`` of the robot where it touches the object.
    :param approach: ``Path`` of the robot to there; None where none is known by now.
    """

    start: Pose
    end: Pose
    robot_start: Pose
    approach: Path | None


def planned_pushes(plan: TaskPlan, obj: PushedObject, robot: RoundRobot, drive: DriveSettings,
                   occupancy_map: OccupancyMap | None) -> tuple[PlannedPush, ...]:
    """
    List the pushes of a plan, the first one and those that remain.

    The robot's ways to later pushes are planned here, for a robot that knows its position: each
    takes a millisecond or two.

    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    """
    trajectory = plan.trajectory
    first = PlannedPush(Pose(*trajectory.object_poses[0].tolist()),
                        Pose(*trajectory.object_poses[-1].tolist()),
                        Pose(*trajectory.robot_poses[0].tolist()), plan.approach_path)
    pushes, robot_pose = [first], Pose(*trajectory.robot_poses[-1].tolist())
    for push in plan.remaining.pushes if plan.remaining is not None else ():
        try:
            approach = plan_approach(robot, obj, push.start, robot_pose, push.robot_start, drive,
                                     occupancy_map=occupancy_map)
        except NoPathFound:
            approach = None
        pushes.append(PlannedPush(push.start, push.end, push.robot_start, approach))
        robot_pose = push.robot_end
    return tuple(pushes)
