"""Inspection: drive round the object, to see it from another side."""

import contextlib
import math

from push_control.behaviors.behavior import BehaviorContext, MeasurementNeed
from push_control.behaviors.path_execution import PathBehavior
from push_control.perception.perception import TaskPerception
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_navigation.path import NoPathFound, Path
from push_navigation.path_planner import plan_path

# Angle round the object to the next place [rad]; chosen: with the one before, three sides. The
# others are tried where obstacles keep the robot from there.
VIEW_ANGLE = 2.0 * math.pi / 3.0
VIEW_ANGLES = (VIEW_ANGLE, -VIEW_ANGLE, 0.5 * math.pi, -0.5 * math.pi, 0.25 * math.pi,
               -0.25 * math.pi)
# Gap to the object there [m]; chosen: clear of it wherever the bias puts it.
VIEW_GAP = 0.15
# Steps outwards to that gap; chosen: each leaves less than half of the distance.
STEPS = 12


class Inspection(PathBehavior[TaskPerception]):
    """Drives to a place from which the object is seen from another side."""

    measurement_need = MeasurementNeed.ODOMETRY

    def plan(self, perception: TaskPerception) -> Path:
        """
        Plan the path round the object.

        :raises ValueError: where there is none.
        """
        for angle in VIEW_ANGLES[:-1]:
            with contextlib.suppress(NoPathFound):
                return self._path(perception, angle)
        return self._path(perception, VIEW_ANGLES[-1])

    def _path(self, perception: TaskPerception, angle: float) -> Path:
        context, robot_pose = self.context, perception.robot_pose
        object_pose = perception.localization.object_pose
        return plan_path(context.robot, context.obj, object_pose, robot_pose,
                         viewing_pose(context, robot_pose, object_pose, angle), context.drive,
                         occupancy_map=context.occupancy_map,
                         uncertainty=perception.position_uncertainty)


def viewing_pose(context: BehaviorContext, robot_pose: Pose, object_pose: Pose,
                 angle: float) -> Pose:
    """
    Choose where to see an object from another side; the robot faces along its path round it.

    :param angle: round the object [rad].
    """
    bearing = angle + math.atan2(robot_pose.y - object_pose.y, robot_pose.x - object_pose.x)
    facing = Pose(object_pose.x, object_pose.y, bearing)
    offset = distance_at_gap(context, object_pose, facing, VIEW_GAP)
    return facing @ Pose(offset, 0.0, 0.5 * math.pi)


def distance_at_gap(context: BehaviorContext, object_pose: Pose, facing: Pose,
                    gap: float) -> float:
    """
    Find how far from an object its gap to the robot is as wide as asked for.

    :param facing: ``Pose`` at the origin of the object, which faces the place [m, rad].
    :param gap: between robot and object [m].
    :return: distance of the robot's centre from that origin [m].
    """
    offset = context.robot.radius
    for _ in range(STEPS):
        position = facing.transform((offset, 0.0))
        offset += max(0.0, gap - find_contact(context.obj, object_pose, position,
                                              context.robot.radius).gap)
    return offset
