"""
Guarded approach: go straight to the contact, slowly, until the object is seen to move.

The pose of the robot drifts, and so the contact comes earlier or later than expected. A CUSUM
test of the object's motion along the contact normal detects it.
"""

import math
from typing import NamedTuple

from push_control.behaviors.approach import approach_direction
from push_control.behaviors.behavior import Behavior, BehaviorContext
from push_control.behaviors.bumper import bumped
from push_control.behaviors.failures import BehaviorFailure, FailureReport
from push_control.behaviors.object_touch import touches_object
from push_control.perception.object_at_rest import has_moved, ObjectAtRest
from push_control.perception.perception import TaskPerception
from push_control.steered.estimation.cusum import CusumTest
from push_control.steered.laws.command import holonomic_command, limit_command
from push_control.steered.start import contact_start_point, robot_start_pose, start_fault
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.signals import ObjectPose, STOP, Twist
from push_model.trajectory import PushTrajectory

# Standard deviations of the robot's position by which the search for the contact is extended;
# chosen: one contact in forty is then beyond it.
SEARCH_SIGMAS = 2.0


class _Search(NamedTuple):
    """Start of the search for the contact, and its length [m]."""

    start: Pose
    length: float


class GuardedApproach(Behavior[TaskPerception]):
    """Probes for the object."""

    def __init__(self, context: BehaviorContext, target: PushTrajectory,
                 object_at_rest: ObjectAtRest) -> None:
        """Start."""
        super().__init__()
        self._context = context
        self._drive = context.drive.limited_to(context.robot)
        self._target = target
        self._object_pose = object_at_rest.pose
        self._contact_test = CusumTest(context.control.cusum_threshold)
        self._search: _Search | None = None
        self._remaining_time = 0.0
        self._speed = 0.0
        self._pose_time = -math.inf

    def on_bumped(self, perception: TaskPerception) -> FailureReport | None:
        """End the search at the object; fail at anything else."""
        if not touches_object(perception):
            return bumped(perception)
        self._end_at_contact(perception)
        return self.failure

    def pause(self) -> None:
        """Accelerate again from rest at the next step."""
        self._speed = 0.0

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command."""
        localization, measured = perception.localization, perception.object_pose
        if measured.time > self._pose_time:
            self._pose_time = measured.time
            self._test_contact(perception, measured)
        pose, deviation = localization.pose, localization.position_deviation
        gap = find_contact(self._context.obj, self._object_pose, pose[:2],
                           self._context.robot.radius).gap
        if self._search is None:
            self._search = self._start_search(pose, gap, deviation)
        self._remaining_time -= dt
        is_over = (self._remaining_time < 0.0
                   or distance(self._search.start, pose) > self._search.length)
        if is_over and not self.finished:
            localization.inflate_covariance(self._context.supervision.probe_distance)
            self.failure = self.failure or BehaviorFailure.NO_CONTACT.report(
                length=self._search.length)
        if self.failure is not None:
            return STOP
        return self._command(pose, gap - max(deviation, self._noise(measured)), dt)

    def _noise(self, measured: ObjectPose) -> float:
        """Return the std of the measured contact position along its normal [m]."""
        noise = self._context.control.assumed_covariance(measured)
        lever_arm = math.hypot(*contact_start_point(self._target))
        return math.hypot(noise.position_deviation, noise.heading_deviation * lever_arm)

    def _start_search(self, pose: Pose, gap: float, deviation: float) -> _Search:
        settings = self._context.supervision
        length = max(0.0, gap) + settings.probe_distance + SEARCH_SIGMAS * deviation
        self._remaining_time = length / self._context.control.start_speed + settings.stall_timeout
        return _Search(pose, length)

    def _command(self, pose: Pose, safe_gap: float, dt: float) -> Twist:
        """Brake so that the robot reaches the earliest contact at its start speed."""
        acceleration = self._drive.acceleration
        braking = math.sqrt(self._context.control.start_speed ** 2
                            + 2.0 * acceleration * max(0.0, safe_gap))
        self._speed = min(self._speed + acceleration * dt, braking, self._drive.speed)
        command = holonomic_command(self._speed, 0.0, self._motion_angle(pose), 0.0, 0.0)
        return limit_command(command, self._context.robot)

    def _motion_angle(self, pose: Pose) -> float:
        """Return the direction of motion in the robot's axes [rad]."""
        robot = self._context.robot
        if robot.drive == 'differential':
            return 0.0
        return approach_direction(robot, self._target, robot_start_pose(
            self._target, self._object_pose)) - pose.theta

    def _test_contact(self, perception: TaskPerception, measured: ObjectPose) -> None:
        """Test whether the contact point of the object has moved along the contact normal."""
        context, before, pose = self._context, self._object_pose, measured.pose
        noise = context.control.assumed_covariance(measured)
        if has_moved(before, pose, context.supervision, noise):
            perception.on_object_moved(before)
            self.failure = BehaviorFailure.OBJECT_MOVED.report()
            return
        contact = contact_start_point(self._target)
        (x_before, y_before), (x, y) = before.transform(contact), pose.transform(contact)
        normal = float(self._target.contact_poses[0][2] - self._target.object_poses[0][2])
        n_x, n_y = Pose(0.0, 0.0, before.theta).rotate((math.cos(normal), math.sin(normal)))
        motion = (x - x_before) * n_x + (y - y_before) * n_y
        if self._contact_test.update(motion / self._noise(measured)) > 0:
            self._end_at_contact(perception)

    def _end_at_contact(self, perception: TaskPerception) -> None:
        """End where the push may begin from here; else fail."""
        fault = start_fault(self._context.robot, self._context.control, self._target,
                            perception.corrected_observation)
        if fault is not None:
            self.failure = fault
        self.finished = fault is None
