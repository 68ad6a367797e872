"""One push of a task, and what it tells of the robot's pose and of the object."""

import math
from typing import Any, Callable

import numpy as np
from push_control.estimation.contact_site import initial_contact_site
from push_control.push.controller import Controller
from push_control.push.start import contact_start_point
from push_control.push.status import ControllerStatus, Phase
from push_control.task.behavior import Behavior, BehaviorContext
from push_control.task.object_model import ObjectModelEstimator
from push_control.task.perception import TaskPerception
from push_control.task.push_innovation import (
    deviation_factor, DISTURBANCE_FACTOR, disturbances, lateral_offset, LateralOffset,
    POSITION_STD, push_innovation,
)
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory

# Standard deviation of the gap at the end of a push, in which the robot is in contact [m]; chosen.
GAP_STD = 0.005
# Rotation of the object relative to the push beyond which somebody else has rotated it [rad], and
# standard deviations of the heading besides; chosen.
MAX_HEADING_ERROR = 0.2
HEADING_SIGMAS = 4.0
# Clearance in a map that neither robot nor object may lack where the plan does not [m]; chosen:
# half of the clearance of plans, and none at all.
GUARDED_CLEARANCES = (0.025, 0.0)
# Standard deviation that a failed push adds to the robot's position [m]; chosen.
FAILED_PUSH_STD = 0.03
# Rejected poses up to which a failed push is evaluated; where more were rejected the object was
# carried off, which tells nothing of the robot. Chosen.
MAX_REJECTED_POSES = 1


class SupervisedPush(Behavior):
    """Pushes along a plan, localizes the robot at the end and identifies the object."""

    def __init__(self, context: BehaviorContext, object_model: ObjectModelEstimator,
                 target: PushTrajectory) -> None:
        """
        Start.

        :param context: the ``BehaviorContext``; its ``control`` with the present uncertainty.
        :param object_model: the ``ObjectModelEstimator``, which this push updates.
        :param target: the ``PushTrajectory``.
        """
        super().__init__()
        self._context = context
        self._object_model = object_model
        self._target = target
        self._controller = Controller(object_model.obj, context.robot, context.control)
        # Standard deviation of the robot's position before the push [m].
        self._start_deviation: float | None = None

    @property
    def push_status(self) -> ControllerStatus:
        """The ``ControllerStatus``."""
        return self._controller.status

    def pause(self) -> None:
        """Do nothing: the controller waits by itself."""

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """
        Compute the command; evaluate the push at its end.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``.
        """
        if self._start_deviation is None:
            self._start_deviation = perception.localization.position_deviation
        command = self._controller.step(self._target, perception.observation, dt)
        status = self._controller.status
        self.finished = status.phase is Phase.DONE
        if status.phase is Phase.FAILED:
            self.failure_reason = status.reason
        else:
            self.failure_reason = (self._path_deviation(perception.object_pose.pose)
                                   or self._near_obstacle(status))
        has_estimate = self._context.control.control_law != 'open_loop'
        if (self.finished or self.failure_reason) and has_estimate and status.in_contact:
            self._evaluate(perception, status, command)
        return STOP if self.failure_reason else command

    def _path_deviation(self, pose: Pose) -> str:
        path = self._target.object_poses[:, :2]
        deviation = float(np.hypot(*(path - (pose.x, pose.y)).T).min())
        # False for a pose that is not finite: the controller waits for a better one.
        if deviation > self._context.supervision.max_path_deviation:
            return f'the object deviates by {deviation:.2f} m from its planned path'
        return ''

    def _near_obstacle(self, status: ControllerStatus) -> str:
        """Name the body that is nearer to an obstacle than allowed, and than planned."""
        occupancy_map, target = self._context.occupancy_map, self._target
        if occupancy_map is None or status.phase is not Phase.PUSHING:
            return ''
        path = target.object_poses[:, :2] - status.object_pose[:2]
        nearest = int(np.hypot(*path.T).argmin())
        if _loses_clearance(occupancy_map.object_is_free, self._object_model.obj,
                            status.object_pose, Pose(*target.object_poses[nearest])):
            return 'the object deviates towards an obstacle of the map'
        if _loses_clearance(occupancy_map.robot_is_free, self._context.robot,
                            status.robot_pose, Pose(*target.robot_poses[nearest])):
            return 'the robot deviates towards an obstacle of the map'
        return ''

    def _evaluate(self, perception: TaskPerception, status: ControllerStatus,
                  command: Twist) -> None:
        """Localize the robot and identify the object; less where the contact did not hold."""
        robot, obj = self._context.robot, self._object_model.obj
        was_steady = disturbances(status) == 0 and status.rejected_poses <= MAX_REJECTED_POSES
        if not self.finished and not was_steady:
            perception.localization.inflate_covariance(FAILED_PUSH_STD)
            perception.correct_overlap(obj, robot, GAP_STD)
            return
        perception.update_from_contact(obj, robot, GAP_STD, is_certain=False)
        self._localize(perception, status, command)
        perception.on_push_succeeded()
        self._identify(status)

    def _localize(self, perception: TaskPerception, status: ControllerStatus,
                  command: Twist) -> None:
        robot, factor = self._context.robot, deviation_factor(status)
        offset = LateralOffset()
        if self._contact_can_be_off or factor > 1:
            offset = lateral_offset(self._object_model, robot, status)
        seen = push_innovation(status, perception.corrected_observation.odometry, command,
                               robot.time_constant, offset)
        heading_std = perception.localization.standard_deviations[2]
        if abs(seen.error[2]) > MAX_HEADING_ERROR + HEADING_SIGMAS * heading_std:
            # Somebody has rotated the object: what it tells of the robot is wrong.
            return
        perception.localization.update_pose(seen.error, seen.covariance,
                                            self.finished and factor == 1)

    def _identify(self, status: ControllerStatus) -> None:
        start_deviation = 0.0
        if self._contact_can_be_off and self._start_deviation is not None:
            start_deviation = self._start_deviation
        deviation = math.hypot(start_deviation,
                               DISTURBANCE_FACTOR * disturbances(status) * POSITION_STD)
        self._object_model.update(contact_start_point(self._target), status.friction_center,
                                  deviation)

    @property
    def _contact_can_be_off(self) -> bool:
        """Whether a robot that is off touches elsewhere, as it does not at a vertex."""
        site = initial_contact_site(self._object_model.obj, self._context.robot, self._target)
        return site.kind != 'vertex'


def _loses_clearance(is_free: Callable[..., bool], body: Any, pose: Pose, planned: Pose) -> bool:
    """Whether a body lacks a clearance at its pose that it has where the plan puts it."""
    return any(not is_free(body, [pose], clearance) and is_free(body, [planned], clearance)
               for clearance in GUARDED_CLEARANCES)
