"""Where an object stands that does not move: better known with every measurement."""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle


class Rest(NamedTuple):
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


class RestWindow:
    """Averages measured poses, and begins anew where one tells that the object has moved."""

    def __init__(self, control, supervision):
        """
        Begin with nothing seen.

        :param control: ``ControlSettings``, for the noise of the poses.
        :param supervision: ``SupervisionSettings``.
        """
        self._noise = control.pose_noise, control.heading_noise
        self._gate, self._longest = supervision.rest_gate, supervision.longest_look
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
    def rest(self):
        """What is known as ``Rest``, or None before the first measurement."""
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
        return Rest(Pose(x, y, wrap_angle(first + turn)), self._seen[-1].time - self._seen[0].time,
                    share * self._noise[0], share * self._noise[1])


def has_moved(before, now, settings):
    """
    Tell whether an object has been moved too far for its plan.

    :param before: ``Pose`` that it had.
    :param now: ``Pose`` that it has.
    :param settings: ``SupervisionSettings``.
    """
    return (distance(now, before) > settings.shove_distance
            or abs(wrap_angle(now.theta - before.theta)) > settings.shove_angle)
