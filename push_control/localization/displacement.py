"""
Displacements of the object that are not the robot's: too far for what it has driven meanwhile.

An object that is pushed moves about as far as the robot. One that moves much further from one pose
to the next was carried away, or its tracker errs. Where it moves back by the same displacement
soon after, the tracker had erred, and what was inferred meanwhile is wrong.
"""

import enum
import math
from typing import NamedTuple

from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose

# What the object may move from one pose to the next, beside what the robot has driven [m], [rad];
# chosen: noise of 2 cm, and what is driven while a pose is under way.
LEAST_DISTANCE = 0.15
LEAST_ROTATION = 0.4
# The same over the distance that the robot has driven, without unit and [rad/m]; chosen: the
# origin of an object that is pushed aside of its middle, and a lever of 0.1 m.
DISTANCE_RATIO = 2.0
ROTATION_RATIO = 10.0
# Time within which an object that moves back was never away [s]; chosen: trackers that err
# recover within seconds, and nobody carries an object to and fro as exactly.
LONGEST_EXCURSION = 10.0


class Displacement(enum.Enum):
    """How an object has moved from one pose to the next."""

    # Not at all, or as far as the robot may have pushed it.
    NONE = 'none'
    DISPLACED = 'displaced'
    # By the opposite of its last displacement.
    RETURNED = 'returned'


class _Excursion(NamedTuple):
    """A displacement, and when it was seen [s]."""

    time: float
    shift: Pose


class DisplacementWatch:
    """Compares the steps of object poses with what the robot drives."""

    def __init__(self) -> None:
        """Begin before the first pose."""
        self._last: ObjectPose | None = None
        self._driven = 0.0
        self._excursion: _Excursion | None = None

    @property
    def shift(self) -> Pose | None:
        """Last displacement, of which the object has not come back: (x, y, heading), or None."""
        return None if self._excursion is None else self._excursion.shift

    def drive(self, distance: float) -> None:
        """
        Note a motion of the robot.

        :param distance: that it has driven [m].
        """
        self._driven += distance

    def update(self, measured: ObjectPose) -> Displacement:
        """
        Judge the step from the last pose to this one.

        :param measured: ``ObjectPose`` that is believed.
        :return: ``Displacement``.
        """
        last, self._last = self._last, measured
        driven, self._driven = self._driven, 0.0
        if last is None:
            return Displacement.NONE
        shift = _difference(last.pose, measured.pose)
        if not _exceeds(shift, driven):
            return Displacement.NONE
        before = self._excursion
        if (before is not None and measured.time - before.time < LONGEST_EXCURSION
                and not _exceeds(_sum(before.shift, shift), driven)):
            self._excursion = None
            return Displacement.RETURNED
        self._excursion = _Excursion(measured.time, shift)
        return Displacement.DISPLACED


def _difference(before: Pose, pose: Pose) -> Pose:
    return Pose(pose.x - before.x, pose.y - before.y, wrap_angle(pose.theta - before.theta))


def _sum(shift: Pose, other: Pose) -> Pose:
    return Pose(shift.x + other.x, shift.y + other.y, wrap_angle(shift.theta + other.theta))


def _exceeds(shift: Pose, driven: float) -> bool:
    """Tell whether a shift in the world is more than a robot can have caused."""
    return (math.hypot(shift.x, shift.y) > LEAST_DISTANCE + DISTANCE_RATIO * driven
            or abs(shift.theta) > LEAST_ROTATION + ROTATION_RATIO * driven)
