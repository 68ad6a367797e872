"""The soft touch: straight in, slowly, until the object is seen to move."""

import math

from push_control.estimation.contact_detection import CusumTest
from push_control.events import sentence
from push_control.laws.command import holonomic_command, limit_command
from push_control.push.start import contact_start_point, robot_start_pose, start_fault
from push_control.task.approach import approach_direction
from push_control.task.perception import has_moved
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.signals import STOP


class GuardedApproach:
    """Feels for the object, and tells where the robot stands when it has it."""

    def __init__(self, obj, robot, control, drive, supervision, target, rest):
        """
        Prepare.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        :param target: the ``PushTrajectory``.
        :param rest: ``push_control.task.perception.ObjectAtRest`` of the object.
        """
        self._parts, self._settings = (obj, robot, control, drive.limited_to(robot)), supervision
        self._rest, self._speed, self._time = rest.pose, 0.0, -math.inf
        self._target, self._begin, self._way, self._time_left = target, None, 0.0, 0.0
        self._angle = approach_direction(robot, target, robot_start_pose(target, rest.pose))
        self._place = contact_start_point(target)
        self._normal = float(target.contact_poses[0][2] - target.object_poses[0][2])
        self._noise = math.hypot(control.pose_noise,
                                 control.heading_noise * math.hypot(*self._place))
        self._alarm = CusumTest(control.cusum_threshold)
        self.finished, self.failure_reason = False, ''

    def pause(self):
        """Stand; the next step sets out anew."""
        self._speed = 0.0

    def step(self, perception, dt):
        """
        Compute the command; learn where the robot stands once it touches.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``.
        """
        obj, robot, control, drive = self._parts
        localization, measured = perception.localization, perception.observation.object_pose
        if measured.time > self._time:
            self._time = measured.time
            self._look(perception, measured.pose)
        pose, unsure = localization.pose, float(localization.standard_deviations[:2].max())
        gap = find_contact(obj, self._rest, pose[:2], robot.radius)[2]
        if self._begin is None:
            self._set_limits(pose, gap, unsure)
        self._time_left -= dt
        if self._is_beyond(pose) and not self.finished:
            localization.inflate_covariance(self._settings.probe_distance)
            self.failure_reason = self.failure_reason or f'the object is not felt within {self._way:.2f} m'
        if self.failure_reason:
            return STOP
        braking = math.sqrt(control.start_speed ** 2 + 2.0 * drive.acceleration
                            * max(0.0, gap - max(unsure, self._noise)))
        self._speed = min(self._speed + drive.acceleration * dt, braking, drive.speed)
        return limit_command(holonomic_command(self._speed, 0.0, self._angle_ahead(pose), 0.0, 0.0),
                             robot)

    def _set_limits(self, pose, gap, unsure):
        settings, slowest = self._settings, self._parts[2].start_speed
        self._begin, self._way = pose, max(0.0, gap) + settings.probe_distance + 2.0 * unsure
        self._time_left = self._way / slowest + settings.stall_timeout

    def _is_beyond(self, pose):
        return self._time_left < 0.0 or distance(self._begin, pose) > self._way

    def _angle_ahead(self, pose):
        robot = self._parts[1]
        return 0.0 if robot.drive == 'differential' else self._angle - pose.theta

    def _look(self, perception, pose):
        rest = self._rest
        if has_moved(rest, pose, self._settings):
            perception.on_object_moved(*self._parts[:2], rest)
            self.failure_reason = 'the object has been moved'
            return
        before, now = rest.transform(self._place), pose.transform(self._place)
        n_x, n_y = Pose(0.0, 0.0, rest.theta).rotate((math.cos(self._normal),
                                                      math.sin(self._normal)))
        moved = (now[0] - before[0]) * n_x + (now[1] - before[1]) * n_y
        if self._alarm.update(moved / self._noise) > 0:
            perception.update_from_contact(*self._parts[:2], self._noise)
            self.failure_reason = sentence(start_fault(
                *self._parts[1:3], self._target, perception.corrected_observation))
            self.finished = not self.failure_reason
