"""
Noise of places of another localization, beyond what they state.

Where the robot is after a metre of path, odometry tells to a few per cent. By what two places
differ besides, they err. With d that difference (x, y, heading), R the covariance that they state,
and Q that of odometry on the path,

    E d_i^2 = 2 g_i R_i + Q_i

where their errors are independent, with the variance g_i R_i. Errors that last make d smaller: so
they err by g_i at least. Its mean over the last places, one for the position and one for the
heading, multiplies their covariance.

A place that differs from the one just before it by far more than both may is a jump: the other
localization has corrected itself, and the robot is where the new place has it.
"""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.odometry_history import OdometryHistory
from push_model.signals import Odometry, PlaceStatus, PoseCovariance, RobotPlace

# Length of path after which two places are compared [m]; chosen: errors of localization in a map
# last for about as long, and odometry errs by less.
COMPARED_LENGTH = 1.0
# Standard deviations of odometry over the length of its path, and of its heading [rad/m]; chosen:
# as odometry of wheels.
ODOMETRY_STD, HEADING_STD = 0.02, 0.02
# Comparisons whose mean counts, and weight of the assumption that places err as stated; chosen:
# some metres of path, and two comparisons.
MEAN_COUNT, PRIOR_COUNT = 20.0, 2.0
# Squared distance of two places over its variance beyond which they jump; chosen: five standard
# deviations.
JUMP_GATE = 27.0


class _Past(NamedTuple):
    """
    A place, where odometry had the robot then, and what that had driven.

    :param odometry_pose: ``Pose``.
    :param length: of the path until then [m].
    """

    place: RobotPlace
    odometry_pose: Pose
    length: float


class _Difference(NamedTuple):
    """
    Difference of two places beside odometry, over its variances where both err as stated.

    :param square: of the distance [m^2].
    :param stated: sum of its variances that both places state [m^2].
    :param odometry: the same of odometry [m^2].
    :param heading_ratio: g of the heading.
    """

    square: float
    stated: float
    odometry: float
    heading_ratio: float


class _Growth:
    """Mean of g over the last comparisons."""

    def __init__(self) -> None:
        self._sum = self._count = PRIOR_COUNT

    @property
    def value(self) -> float:
        """Variance of errors over what is stated, 1 at least."""
        return max(1.0, self._sum / self._count)

    def add(self, ratio: float) -> None:
        """Add the g of a comparison."""
        self._sum += ratio
        self._count += 1.0
        if self._count > MEAN_COUNT:
            self._sum *= MEAN_COUNT / self._count
            self._count = MEAN_COUNT


class PlaceNoise:
    """Compares places with odometry, and widens their covariance by what they err more."""

    def __init__(self) -> None:
        """Start with places that err as they state."""
        self._history = OdometryHistory()
        self._last: Pose | None = None
        self._length = 0.0
        self._past: deque[_Past] = deque()
        self._position, self._heading = _Growth(), _Growth()

    def add_odometry(self, odometry: Odometry) -> None:
        """
        Take in odometry.

        :param odometry: finite ``Odometry``.
        """
        if self._last is not None:
            self._length += math.hypot(*(self._last.inverse() @ odometry.pose)[:2])
        self._last = odometry.pose
        self._history.append(odometry)

    def widened(self, place: RobotPlace) -> RobotPlace:
        """
        Return a place that errs by as much as it and those before it have shown.

        :param place: ``RobotPlace``.
        """
        odometry_pose = self._history.pose_at(place.time)
        if odometry_pose is not None:
            present = _Past(place, odometry_pose, self._length)
            if self._has_jumped(present):
                place = place._replace(status=PlaceStatus.REGAINED)
                # One that jumps again and again is noisy.
                self._position.add(0.5 * JUMP_GATE * self._position.value)
                self._past.clear()
            self._compare(present)
        position, heading = math.sqrt(self._position.value), math.sqrt(self._heading.value)
        scale = np.diag([position, position, heading])
        return place._replace(covariance=PoseCovariance.from_matrix(
            scale @ place.covariance.matrix @ scale))

    def _has_jumped(self, present: _Past) -> bool:
        """Tell whether a place is elsewhere than the one just before it."""
        if not self._past:
            return False
        difference = _difference(self._past[-1], present)
        variance = self._position.value * difference.stated + difference.odometry
        return difference.square > 0.5 * JUMP_GATE * variance

    def _compare(self, present: _Past) -> None:
        """Compare a place with the last one that is far enough back."""
        past = self._past
        before: _Past | None = None
        while past and present.length - past[0].length >= COMPARED_LENGTH:
            before = past.popleft()
        past.append(present)
        if before is None:
            return
        difference = _difference(before, present)
        self._position.add((difference.square - difference.odometry) / difference.stated)
        self._heading.add(difference.heading_ratio)


def _difference(before: _Past, present: _Past) -> _Difference:
    expected = before.place.pose @ (before.odometry_pose.inverse() @ present.odometry_pose)
    pose, stated, other = present.place.pose, before.place.covariance, present.place.covariance
    length = present.length - before.length
    rotation = wrap_angle(pose.theta - expected.theta)
    # The heading of the first place turns all of the path after it.
    x, y = expected.x - before.place.pose.x, expected.y - before.place.pose.y
    return _Difference(
        (pose.x - expected.x) ** 2 + (pose.y - expected.y) ** 2,
        stated.x_x + other.x_x + stated.y_y + other.y_y,
        2.0 * (ODOMETRY_STD * length) ** 2 + (x * x + y * y) * stated.theta_theta,
        (rotation ** 2 - (HEADING_STD * length) ** 2) / (stated.theta_theta + other.theta_theta))
