"""What the supervisor of a task sees: the robot's place, and the object at rest."""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_control.estimation.monitors import is_finite_odometry, measurement_fault
from push_control.events import sentence
from push_control.task.localization import RobotLocalization
from push_model.contact import find_contact
from push_model.geometry import distance, Pose, wrap_angle


class ObjectAtRest(NamedTuple):
    """
    An object at rest.

    :param pose: average of the measured poses.
    :param duration: time between the first and the last of them [s].
    :param position_error: standard error of the position along each axis [m].
    :param heading_error: standard error of the heading [rad].
    """

    pose: Pose
    duration: float
    position_error: float
    heading_error: float


class StationarityWindow:
    """Averages measured poses, and begins anew where one tells that the object has moved."""

    def __init__(self, control, supervision):
        """
        Begin with nothing seen.

        :param control: ``ControlSettings``, for the noise of the poses.
        :param supervision: ``SupervisionSettings``.
        """
        self._noise = control.pose_noise, control.heading_noise
        self._gate, self._longest = supervision.motion_gate_sigmas, supervision.max_averaging_time
        self.clear()

    def clear(self):
        """Forget everything seen."""
        self._seen, self._rest = deque(), None

    def add(self, measured):
        """
        Take in a measurement.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        """
        if self._seen and measured.time <= self._seen[-1].time:
            return
        if self._rest is not None and self._has_moved(measured.pose):
            self._seen.clear()
        self._seen.append(measured)
        while measured.time - self._seen[0].time > self._longest:
            self._seen.popleft()
        self._rest = self._averaged()

    @property
    def object_at_rest(self):
        """What is known as ``ObjectAtRest``, or None before the first measurement."""
        return self._rest

    def _has_moved(self, pose):
        position, heading = self._noise
        before = self._rest.pose
        return (distance(pose, before) > self._gate * position
                or abs(wrap_angle(pose.theta - before.theta)) > self._gate * heading)

    def _averaged(self):
        first = self._seen[0].pose.theta
        rows = np.array([(pose.x, pose.y, wrap_angle(pose.theta - first))
                         for _, pose in self._seen])
        x, y, turn = rows.mean(axis=0).tolist()
        share = 1.0 / math.sqrt(len(rows))
        return ObjectAtRest(Pose(x, y, wrap_angle(first + turn)), self._seen[-1].time - self._seen[0].time,
                            share * self._noise[0], share * self._noise[1])


def has_moved(before, now, settings):
    """
    Tell whether an object has been moved too far for its plan.

    :param before: ``Pose`` that it had.
    :param now: ``Pose`` that it has.
    :param settings: ``SupervisionSettings``.
    """
    return (distance(now, before) > settings.moved_distance
            or abs(wrap_angle(now.theta - before.theta)) > settings.moved_angle)


# Where the robot is found by the motion of the object alone: standard deviations [m, m, rad].
BEHIND, LOST = (0.15, 0.15, 1.0), 10.0
ENOUGH, TRACINGS = 2, 12


class TaskPerception:
    """Takes in every measurement once."""

    def __init__(self, control, supervision):
        """
        Begin with nothing seen.

        :param control: ``ControlSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._settings = control
        self.localization = RobotLocalization(supervision)
        self._window = StationarityWindow(control, supervision)
        self._from, self._pose_time, self._observation = 0.0, None, None
        self._moved = 0

    def take(self, observation):
        """
        Take in what is new.

        :param observation: ``Observation``, odometry as it comes.
        """
        odometry, measured = observation.odometry, observation.object_pose
        if is_finite_odometry(odometry):
            self.localization.predict(odometry)
            odometry = odometry._replace(pose=self.localization.pose)
        if measured is not None and measured.pose.is_finite():
            self._pose_time = measured.time
            if measured.time >= self._from:
                self._window.add(measured)
        self._observation = observation._replace(odometry=odometry)

    def gap(self, obj, robot):
        """
        Tell how far the robot seems to be from the object at rest.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :return: the gap [m], negative on overlap.
        """
        return find_contact(obj, self.object_at_rest.pose, self.robot_pose[:2], robot.radius)[2]

    def update_from_contact(self, obj, robot, deviation, sure=True):
        """
        Learn where the robot stands from its touching the object, when that was last measured.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param deviation: standard deviation of the gap [m].
        :param sure: whether it touches for certain.
        """
        measured = self._observation.object_pose
        there = self.localization.at(measured.time)
        _, normal, gap = find_contact(obj, measured.pose, there[:2], robot.radius)
        self.localization.update_along(normal, gap, deviation, sure)

    def correct_overlap(self, obj, robot, deviation):
        """
        Learn from a robot that seems to stand inside the object, as it stands beside it.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param deviation: standard deviation of the gap [m].
        """
        measured = self._observation.object_pose
        there = self.localization.at(measured.time)
        if find_contact(obj, measured.pose, there[:2], robot.radius)[2] < 0.0:
            self.update_from_contact(obj, robot, deviation)

    def on_push_succeeded(self):
        """Note that a push went well: the robot is where it is believed to be."""
        self._moved = 0

    def on_object_moved(self, obj, robot, before):
        """
        Note that the object has moved while it was not pushed.

        Once it may have been somebody else; at the second time it is the robot that pushes it,
        from behind as the object moves, and not where it is believed to be.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param before: ``Pose`` that the object had.
        """
        self._moved += 1
        pose, here = self.object_at_rest.pose, self.localization.pose
        way = distance(pose, before)
        if self._moved < ENOUGH or way == 0.0:
            return
        x, y = (pose.x - before.x) / way, (pose.y - before.y) / way
        away = 0.0
        for _ in range(TRACINGS):
            place = pose.x - away * x, pose.y - away * y
            away += abs(find_contact(obj, pose, place, robot.radius)[2])
        self.localization.inflate_covariance(LOST)
        error = place[0] - here.x, place[1] - here.y, 0.0
        self.localization.update_pose(error, np.diag(np.square(BEHIND)))

    def look_anew(self, time):
        """
        Forget where the object was.

        :param time: from which on it may be at rest [s].
        """
        self._window.clear()
        self._from = time

    def failure_reason(self, blind=False):
        """
        Say why the measurements cannot be used.

        :param blind: whether the object need not be seen.
        :return: the reason, or an empty text.
        """
        seen = self._observation.time if blind else self._pose_time
        return sentence(measurement_fault(self._observation, seen, self._settings))

    @property
    def observation(self):
        """The newest ``Observation``, drift of its odometry taken off."""
        return self._observation

    @property
    def corrected_observation(self):
        """The same, with what was learnt of the robot's place since."""
        odometry = self._observation.odometry._replace(pose=self.localization.pose)
        return self._observation._replace(odometry=odometry)

    @property
    def time(self):
        """Time of the newest measurement [s]; 0 before the first."""
        return 0.0 if self._observation is None else self._observation.time

    @property
    def robot_pose(self):
        """``Pose`` of the robot in the world."""
        return self.localization.pose

    @property
    def object_at_rest(self):
        """``push_control.task.perception.ObjectAtRest`` of the object, or None before it was seen at rest."""
        return self._window.object_at_rest
