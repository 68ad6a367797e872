"""
Displacements of the object that are not the robot's: too far for what it has driven meanwhile.

An object that is pushed moves about as far as the robot. One that moves much further from one pose
to the next was carried away, or its tracker errs. Where it moves back soon after, by the same
displacement or to the same place, the tracker had erred, and what was inferred meanwhile is wrong.
"""

from collections import deque
import dataclasses
import enum
import math
from typing import Generic, TypeVar

from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose

# What the object may move from one pose to the next, beside what the robot has driven [m], [rad];
# chosen: noise of 2 cm, and what is driven while a pose is under way.
MIN_DISTANCE = 0.15
MIN_ROTATION = 0.4
# The same over the distance that the robot has driven, without unit and [rad/m]; chosen: the
# origin of an object that is pushed aside of its middle, and a lever of 0.1 m.
DISTANCE_RATIO = 2.0
ROTATION_RATIO = 10.0
# Time within which an object that moves back was never away [s]; chosen: trackers that err
# recover within seconds, and nobody carries an object to and fro as exactly.
MAX_EXCURSION = 10.0
# Displacements that an object may have come back from; chosen: trackers that err more often than
# that within seconds are of no use.
MAX_EXCURSIONS = 5

Memory = TypeVar('Memory')


class Displacement(enum.Enum):
    """Displacement of an object from one pose to the next."""

    # Not at all, or as far as the robot may have pushed it.
    NONE = 'none'
    DISPLACED = 'displaced'
    # By the opposite of a displacement, or to where the robot may have pushed it from before one.
    RETURNED = 'returned'


@dataclasses.dataclass(frozen=True)
class _Excursion(Generic[Memory]):
    """
    A displacement, of which the object may come back.

    :param time: when it was seen [s].
    :param before: ``Pose`` of the object before it.
    :param shift: the displacement (x, y, heading).
    :param memory: what was estimated before it.
    :param total: that the robot had driven before it [m].
    """

    time: float
    before: Pose
    shift: Pose
    memory: Memory
    total: float


class DisplacementWatch(Generic[Memory]):
    """
    Compares the steps of object poses with what the robot drives.

    ``memory``: what was estimated before the object was displaced, where it has returned.
    """

    def __init__(self) -> None:
        """Start before the first pose."""
        self._last: ObjectPose | None = None
        # What the robot has driven since the last pose, and in all [m].
        self._driven = self._total = 0.0
        self._was_rejected = False
        self._excursions: deque[_Excursion[Memory]] = deque(maxlen=MAX_EXCURSIONS)
        self.memory: Memory | None = None

    @property
    def shift(self) -> Pose | None:
        """Last displacement, of which the object has not come back: (x, y, heading), or None."""
        return self._excursions[-1].shift if self._excursions else None

    def drive(self, distance: float) -> None:
        """
        Note a motion of the robot.

        :param distance: that it has driven [m].
        """
        self._total += distance
        if not self._was_rejected:
            self._driven += distance

    def reject(self) -> None:
        """Note a rejected pose: the object may have moved before it, not since."""
        self._was_rejected = True

    def update(self, measured: ObjectPose, memory: Memory) -> Displacement:
        """
        Evaluate the step from the last pose to this one.

        :param measured: ``ObjectPose`` that is not an outlier.
        :param memory: what was estimated at the last one.
        """
        last, self._last = self._last, measured
        driven, self._driven, self._was_rejected = self._driven, 0.0, False
        if last is None:
            return Displacement.NONE
        shift = _difference(last.pose, measured.pose)
        if not _exceeds(shift, driven):
            return Displacement.NONE
        excursions = self._excursions
        for index, one in enumerate(excursions):
            if (measured.time - one.time < MAX_EXCURSION
                    and not (_exceeds(_sum(one.shift, shift), driven)
                             and _exceeds(_difference(one.before, measured.pose),
                                          self._total - one.total))):
                self.memory = one.memory
                while len(excursions) > index:
                    excursions.pop()
                return Displacement.RETURNED
        excursions.append(_Excursion(measured.time, last.pose, shift, memory,
                                     self._total - driven))
        return Displacement.DISPLACED


def _difference(before: Pose, pose: Pose) -> Pose:
    return Pose(pose.x - before.x, pose.y - before.y, wrap_angle(pose.theta - before.theta))


def _sum(shift: Pose, other: Pose) -> Pose:
    return Pose(shift.x + other.x, shift.y + other.y, wrap_angle(shift.theta + other.theta))


def _exceeds(shift: Pose, driven: float) -> bool:
    """Tell whether a shift in the world is more than a robot can have caused."""
    return (math.hypot(shift.x, shift.y) > MIN_DISTANCE + DISTANCE_RATIO * driven
            or abs(shift.theta) > MIN_ROTATION + ROTATION_RATIO * driven)
