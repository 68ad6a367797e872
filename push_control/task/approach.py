"""The way to the object: round it, to where the last straight piece begins."""

import math

from push_control.push.start import robot_start_pose
from push_control.task.perception import has_moved
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP
from push_navigation.path_follower import PathFollower
from push_navigation.path_planner import plan_path
from push_navigation.speed_profile import travel_time

SET_OUT_LIMIT = 3
OVERLAP = 0.01
MOTION = 0.005


def approach_direction(robot, target, start):
    """
    Find the way in which a robot goes straight to its contact.

    :param robot: the ``RoundRobot``.
    :param target: the ``PushTrajectory``.
    :param start: ``Pose`` of the robot at the start of the push, as the object stands now.
    :return: world angle [rad]: the heading of a differential drive, else the contact normal.
    """
    lead = float(target.contact_poses[0][2] - target.robot_poses[0][2])
    return start.theta + (0.0 if robot.drive == 'differential' else lead)


def _apart(pose, other, radius):
    """Distance between two poses of a disc; a turn counts at its rim."""
    return max(distance(pose, other), radius * abs(wrap_angle(pose.theta - other.theta)))


class PathExecution:
    """One way, with an end and a time by which it must be reached."""

    def __init__(self, robot, drive, way, patience):
        """
        Set out.

        :param robot: the ``RoundRobot``.
        :param drive: ``DriveSettings``.
        :param way: the ``Way``.
        :param patience: time without motion after which it is given up, or that it may take
            beyond twice what was expected [s].
        """
        self._follower, self._patience = PathFollower(robot, drive, way), patience
        self._left = 2.0 * travel_time(way, robot, drive) + patience
        self._radius, self._seen, self._still = robot.radius, None, 0.0
        self.finished, self.failure_reason = False, ''

    def step(self, pose, dt):
        """
        Compute the command.

        :param pose: ``Pose`` of the robot.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is ``failure_reason``.
        """
        self._left -= dt
        self._still += dt
        if self._seen is None or _apart(self._seen, pose, self._radius) > MOTION:
            self._seen, self._still = pose, 0.0
        command = self._follower.step(pose, dt)
        self.finished = self._follower.finished
        if (self._left < 0.0 or self._still > self._patience) and not self.finished:
            self.failure_reason = f'the robot does not get on: {self._follower.remaining_distance:.2f} m are left'
            return STOP
        return command


class Approach:
    """Goes round the object to where the last straight piece to the contact begins."""

    def __init__(self, obj, robot, drive, supervision, target, occupancy_map=None):
        """
        Prepare.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        :param target: the ``PushTrajectory``.
        :param occupancy_map: the ``OccupancyMap``, or None.
        """
        self._parts, self._workspace = (obj, robot, drive), occupancy_map
        self._settings, self._target, self._travel = supervision, target, None
        self._set_out, self._first = 0, None
        self.finished, self.failure_reason = False, ''

    def pause(self):
        """Stand; the next step sets out anew."""
        self._travel = None

    def step(self, perception, dt):
        """
        Compute the command.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is ``failure_reason``.
        """
        obj, robot, drive = self._parts
        if perception.object_at_rest.duration > 0.0 and self._is_disturbed(perception):
            return STOP
        robot_pose, object_pose = perception.robot_pose, perception.object_at_rest.pose
        if self._travel is None:
            stand = self._stand(object_pose)
            try:
                way = plan_path(robot, obj, object_pose, robot_pose, stand, drive,
                                occupancy_map=self._workspace)
            except ValueError as error:
                self.failure_reason = str(error)
                return STOP
            self._travel = PathExecution(robot, drive, way, self._settings.stall_timeout)
        command = self._travel.step(robot_pose, dt)
        self.failure_reason = self._travel.failure_reason
        if self._travel.finished:
            self._travel = None
            self._arrive(robot_pose, object_pose)
        return command

    def _is_disturbed(self, perception):
        """Look whether somebody has moved the object, or the robot itself has run into it."""
        obj, robot, _ = self._parts
        gap, unsure = perception.gap(obj, robot), float(perception.localization.standard_deviations[:2].max())
        if gap < -OVERLAP:
            perception.update_from_contact(obj, robot, OVERLAP)
        pose = perception.object_at_rest.pose
        self._first = self._first or pose
        far = gap > OVERLAP + 3.0 * unsure
        near = gap < self._settings.probe_distance + 3.0 * unsure
        if near and distance(pose, self._first) > OVERLAP:
            if far:
                # Either it is misplaced by that, or somebody else has moved the object.
                perception.localization.inflate_covariance(gap)
            perception.update_from_contact(obj, robot, 0.5 * gap if far else OVERLAP)
            self.failure_reason = 'the robot has run into the object'
        elif has_moved(planned := Pose(*self._target.object_poses[0].tolist()), pose,
                       self._settings):
            perception.on_object_moved(obj, robot, planned)
            self.failure_reason = 'the object has been moved'
        return bool(self.failure_reason)

    def _arrive(self, robot_pose, object_pose):
        stand, robot = self._stand(object_pose), self._parts[1]
        error = _apart(robot_pose, stand, robot.radius)
        self._set_out += 1
        self.finished = error <= self._settings.pre_push_tolerance
        if not self.finished and self._set_out >= SET_OUT_LIMIT:
            self.failure_reason = f'the robot stands {1e3 * error:.0f} mm beside its place'

    def _stand(self, object_pose):
        start = robot_start_pose(self._target, object_pose)
        angle = approach_direction(self._parts[1], self._target, start)
        back = self._parts[2].standoff
        return Pose(start.x - back * math.cos(angle), start.y - back * math.sin(angle),
                    start.theta)
