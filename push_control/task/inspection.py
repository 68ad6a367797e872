"""Inspection: drive round the object, to see it from another side."""

import math

from push_control.task.behavior import Behavior, BehaviorContext
from push_control.task.path_execution import PathExecution
from push_control.task.perception import TaskPerception
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_navigation.path_planner import plan_path

# Angle round the object to the next place [rad]; chosen: with the one before, three sides.
VIEW_ANGLE = 2.0 * math.pi / 3.0
# Gap to the object there [m]; chosen: clear of it wherever the bias puts it.
VIEW_GAP = 0.15
# Steps outwards to that gap; chosen: each leaves less than half of the distance.
STEPS = 12


class Inspection(Behavior):
    """Drives to a place from which the object is seen from another side."""

    def __init__(self, context: BehaviorContext) -> None:
        """
        Start.

        :param context: the ``BehaviorContext``.
        """
        super().__init__()
        self._context = context
        self._execution: PathExecution | None = None

    def pause(self) -> None:
        """Forget the path; the next step plans another one."""
        self._execution = None

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """
        Compute the command.

        :param perception: ``TaskPerception`` of the robot, and of where the object was seen last.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is a ``failure_reason``.
        """
        context, robot_pose = self._context, perception.robot_pose
        if self._execution is None:
            object_pose = perception.localization.object_pose
            try:
                path = plan_path(context.robot, context.obj, object_pose, robot_pose,
                                 viewing_pose(context, robot_pose, object_pose), context.drive,
                                 occupancy_map=context.occupancy_map)
            except ValueError as error:
                self.failure_reason = str(error)
                return STOP
            self._execution = PathExecution(context.robot, context.drive, path,
                                            context.supervision.stall_timeout)
        command = self._execution.step(robot_pose, dt)
        self.finished = self._execution.finished
        self.failure_reason = self._execution.failure_reason
        return command


def viewing_pose(context: BehaviorContext, robot_pose: Pose, object_pose: Pose) -> Pose:
    """
    Choose where to see an object from another side; the robot faces along its path round it.

    :param context: the ``BehaviorContext``.
    :param robot_pose: ``Pose`` of the robot.
    :param object_pose: ``Pose`` of the object.
    :return: ``Pose`` of the robot.
    """
    bearing = VIEW_ANGLE + math.atan2(robot_pose.y - object_pose.y, robot_pose.x - object_pose.x)
    offset = context.robot.radius
    facing = Pose(object_pose.x, object_pose.y, bearing)
    for _ in range(STEPS):
        place = facing.transform((offset, 0.0))
        gap = find_contact(context.obj, object_pose, place, context.robot.radius).gap
        offset += max(0.0, VIEW_GAP - gap)
    return facing @ Pose(offset, 0.0, 0.5 * math.pi)
