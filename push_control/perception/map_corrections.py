"""
Corrections of a map: what the pose of odometry in the world tells, where its errors stay.

Localization in a map errs by centimetres, and by the same from one message to the next until it
corrects itself, by a jump. A thousand such messages tell no more than one. What tells something
new is the jump: with independent errors before and after it of covariance R, its square is 2 R in
the mean. With m the mean over the axes of the square of a step that the twist does not explain,
over 2 R, successive errors are correlated by about 1 - m, and an average of many of them has the
covariance R (2 - m) / m in place of R. So each correction counts with that, by the mean of m so
far, and what comes between two of them not at all.
"""

import math
from typing import NamedTuple

from push_model.geometry import Pose, wrap_angle
from push_model.signals import Odometry, PoseCovariance
from push_safety.odometry_check import integrated_step

# Standard deviations up to which errors are independent from one message to the next [m], [rad];
# chosen: motion capture errs by less, localization in a map by more.
MAX_INDEPENDENT_STDS = 0.005, 0.0085
# What the pose moves beside its twist by a correction [m], [rad], and over what the twist means;
# chosen: more than the rounding of a step.
MIN_CORRECTION, MIN_CORRECTION_ROTATION, CORRECTION_RATIO = 0.005, 0.004, 0.2


class MapStep(NamedTuple):
    """
    One step of odometry in a map.

    :param step: motion of the robot as ``Pose`` in its axes before.
    :param growth: of the covariance of the pose after it, over what it states; infinite where the
        pose tells nothing new.
    """

    step: Pose
    growth: float


class MapCorrections:
    """Separates corrections of a map from motion, and learns how much they tell."""

    def __init__(self) -> None:
        """Start without any correction."""
        # Sum of m over all corrections, and their number.
        self._sum, self._count = 0.0, 0

    def step(self, previous: Odometry, odometry: Odometry,
             covariance: PoseCovariance) -> MapStep:
        """
        Separate the motion of the robot from a correction of its pose.

        :param covariance: ``PoseCovariance`` that odometry states, greater than 0.
        """
        by_pose = previous.pose.inverse() @ odometry.pose
        by_twist = integrated_step(previous, odometry)
        x, y = by_pose.x - by_twist.x, by_pose.y - by_twist.y
        rotation = wrap_angle(by_pose.theta - by_twist.theta)
        if not _is_correction(math.hypot(x, y), abs(rotation), by_twist):
            return MapStep(by_pose, math.inf)
        self._sum += ((x * x + y * y) / covariance.position_deviation ** 2
                      + (rotation / covariance.heading_deviation) ** 2) / 6.0
        self._count += 1
        return MapStep(by_twist, max(1.0, 2.0 * self._count / self._sum - 1.0))


def _is_correction(offset: float, rotation: float, by_twist: Pose) -> bool:
    """Tell whether a step is more than rounding, and than its twist errs by."""
    return (offset > MIN_CORRECTION + CORRECTION_RATIO * math.hypot(*by_twist[:2])
            or rotation > MIN_CORRECTION_ROTATION + CORRECTION_RATIO * abs(by_twist.theta))


def has_lasting_errors(covariance: PoseCovariance | None) -> bool:
    """
    Tell whether a pose in the world errs by the same from one message to the next.

    :param covariance: that it states, or None where it measures no pose in the world.
    """
    return covariance is not None and (
        covariance.position_deviation > MAX_INDEPENDENT_STDS[0]
        or covariance.heading_deviation > MAX_INDEPENDENT_STDS[1])
