"""
Wheels that spin at an object: what they drove, against how far the object went.

At the contact c, in the direction e of motion, an object whose poses are P_k at their own times
has come ahead by

    A_k = A_k-1 + e . (P_k P_k-1^-1 c - c)

while the wheels drove s. An object that was seen to move along e, and then does so by far less
than the wheels turn, is too heavy, or blocked. A tracker of another object shows A = 0, one that
is mirrored A < 0. In the mean of some poses that is so even where a pose that was far off seemed
to show motion.
"""

from collections import deque
import math

import numpy as np
from push_model.geometry import Coordinates, Pose
from push_model.signals import ObjectPose

# Distance of the wheels over which both are compared [m], and ratio below which they spin.
# Chosen: healthy pushes stay above 0.48, those of objects that are too heavy below 0.33.
COMPARED_DISTANCE = 0.15
MAX_SPIN_RATIO = 0.3
# Advance from which on the object was seen to move [m], and that in standard deviations of a pose;
# chosen: one pose in ten thousand is so far off.
MIN_ADVANCE = 0.008
ADVANCE_SIGMAS = 4.0
# Distance of the wheels, and the part of it that the object went, from which on it is not too
# heavy [m]; chosen: contacts give way by a centimetre, wheels that spin show less than half.
FOLLOWED_DISTANCE, MIN_FOLLOWED_RATIO = 0.05, 0.7
# Time for which distances of the wheels are kept [s]; chosen: poses that are older are refused.
MEMORY = 5.0
# Mean advance of an object that only creeps [m], the same in standard deviations of a pose, poses
# that are averaged for it, and ratio. Chosen: four deviations of such a mean.
MIN_CREEP = 0.003
CREEP_SIGMAS = 1.5
CREEP_POSES = 10
MAX_CREEP_RATIO = 0.1
# Mean distance of the wheels from which on an object that advances by less than that ratio of it
# does not move [m]; chosen: beyond what a push is driven until the object is missed.
WITHOUT_EFFECT_DISTANCE = 0.2
# Mean distance of the wheels from which on a push that ends tells of an object that hardly moves
# [m]; chosen: the ratio of it is four deviations of such a mean.
HINDERED_DISTANCE = 0.04


class SpinWatch:
    """Compares object and wheels during one push."""

    def __init__(self, before: Pose) -> None:
        """
        Start at the touch.

        :param before: ``Pose`` of the object at rest before it, averaged.
        """
        # Times and distances of the wheels [s], [m].
        self._driven: deque[tuple[float, float]] = deque()
        self._previous = ObjectPose(-math.inf, before)
        self._advance = 0.0
        # (distance of the wheels, advance of the object) at each object pose [m].
        self._rows: list[tuple[float, float]] = []
        self._deviation = 0.0

    def add_distance(self, time: float, distance: float) -> None:
        """
        Note what the wheels have driven.

        :param time: now [s].
        :param distance: since the touch [m].
        """
        driven = self._driven
        driven.append((time, distance))
        # The last but one that is older still gives the distance at the end of the memory.
        while len(driven) > 2 and driven[1][0] <= time - MEMORY:
            driven.popleft()

    def add_object_pose(self, measured: ObjectPose, contact: Coordinates, direction: float,
                        deviation: float) -> None:
        """
        Note where the object is seen; a pose that was seen before does not count.

        :param contact: present contact point in the world (x, y) [m].
        :param direction: of motion of the robot, world angle [rad].
        :param deviation: standard deviation of the position [m].
        """
        previous = self._previous
        if measured.time <= previous.time or not self._driven:
            return
        self._previous, self._deviation = measured, deviation
        self._advance += _advance(previous.pose, measured.pose, contact, direction)
        self._rows.append((self._driven_at(measured.time), self._advance))

    def _driven_at(self, time: float) -> float:
        """Interpolate what the wheels had driven; it is the nearest one outside of the memory."""
        after = self._driven[-1]
        if time >= after[0]:
            return after[1]
        # Newest first: poses are late by a few commands.
        for before in reversed(self._driven):
            if before[0] <= time:
                slope = (after[1] - before[1]) / (after[0] - before[0])
                return slope * (time - before[0]) + before[1]
            after = before
        return after[1]

    @property
    def is_spinning(self) -> bool:
        """Tell whether the object moved along the push and has stopped while the wheels turn."""
        if not self._rows:
            return False
        driven, advance = self._rows[-1]
        has_moved = advance >= max(MIN_ADVANCE, ADVANCE_SIGMAS * self._deviation)
        before = [row for row in self._rows if driven - row[0] >= COMPARED_DISTANCE]
        if not (has_moved and before):
            return False
        return advance - before[-1][1] < MAX_SPIN_RATIO * (driven - before[-1][0])

    @property
    def has_followed(self) -> bool:
        """Tell whether the object went as far as the wheels drove, as what is not too heavy."""
        return any(driven >= FOLLOWED_DISTANCE and advance >= MIN_FOLLOWED_RATIO * driven
                   for driven, advance in self._rows)

    @property
    def is_creeping(self) -> bool:
        """Tell whether an object that was not seen to move has, along the push, by millimetres."""
        driven, advance = self._mean_row
        return (max(MIN_CREEP, CREEP_SIGMAS * self._deviation) <= advance
                < MAX_CREEP_RATIO * driven)

    @property
    def is_without_effect(self) -> bool:
        """Tell whether the object has hardly moved along the push, however far the wheels have."""
        driven, advance = self._mean_row
        return driven >= WITHOUT_EFFECT_DISTANCE and abs(advance) < MAX_CREEP_RATIO * driven

    def is_hindered(self, has_spun: bool) -> bool:
        """
        Tell whether a push that ends now has hardly moved the object along.

        :param has_spun: whether the wheels have spun at the object before: then a part of what
            they drive is as good as nothing.
        """
        driven, advance = self._mean_row
        ratio = MAX_SPIN_RATIO if has_spun else MAX_CREEP_RATIO
        return driven >= HINDERED_DISTANCE and abs(advance) < ratio * driven

    @property
    def _mean_row(self) -> tuple[float, float]:
        """Mean of (distance of the wheels, advance of the object) over the last poses [m]."""
        rows = self._rows[-CREEP_POSES:]
        if len(rows) < CREEP_POSES:
            return 0.0, 0.0
        driven, advance = np.mean(rows, axis=0).tolist()
        return driven, advance


def _advance(before: Pose, after: Pose, contact: Coordinates, direction: float) -> float:
    """Compute how far the material of the object at the contact went along a direction [m]."""
    x, y = after.transform(before.inverse().transform(contact))
    return float((x - contact[0]) * math.cos(direction) + (y - contact[1]) * math.sin(direction))
