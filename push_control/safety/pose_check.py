"""
Is a measured object pose believable: no object jumps, and no tracker measures twice the same.

A pose that is too far from the last one for any object is held back until some in a row agree with
each other: then somebody has moved the object. A tracker whose poses have shown noise, and then
repeat to the last digit, measures nothing any more.
"""

from collections import deque
import math

import numpy as np
from push_control.events import EventReport, PushEvent
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import ObjectPose

# What an object may move from one pose to the next: constant part [m], [rad], and by time [m/s],
# [rad/s]; chosen: far more than robots push it, and noise of 2 cm besides.
JUMP_DISTANCE = 0.15
JUMP_ROTATION = 0.5
MAX_SPEED = 1.0
MAX_YAW_RATE = 3.0
# Poses in a row that agree with each other; chosen: no two outliers do, and no three.
AGREEING_COUNT = 3
# Time without any pose after which the next one is believed wherever it is [s]; chosen: somebody
# may have moved the object meanwhile.
LONGEST_GAP = 1.0
# Steps by which it is known whether a tracker shows noise, in how many of them the change of the
# step changes its sign where that is noise, and the least mean change that is [m], [rad];
# chosen: noise changes it in three of four, motion seldom, and rounding is far below.
NOISE_STEPS = 12
SIGN_CHANGES = 5
LEAST_NOISE = 1e-5
# Times that a noisy pose may come again; chosen: a message or two may be sent twice.
MAX_REPETITIONS = 3


class PoseCheck:
    """
    Holds back poses that cannot be true.

    ``doubt``: ``EventReport`` of what is wrong with the newest pose, None while it is believed.
    """

    def __init__(self) -> None:
        """Begin before the first pose, which counts as right."""
        self._believed: ObjectPose | None = None
        self._newest: ObjectPose | None = None
        self._agreeing = 0
        self._noise = _NoiseTest()
        # The pose that repeats itself, as it came first, and how often.
        self._first = ObjectPose(0.0, Pose(0.0, 0.0, 0.0))
        self._repetitions = 0
        self.doubt: EventReport | None = None

    def believed(self, measured: ObjectPose) -> ObjectPose:
        """
        Judge a pose.

        :param measured: ``ObjectPose``; one that is not newer than the last is no news.
        :return: the same, or the last one that is believed where this one is not.
        """
        if not measured.pose.is_finite():
            return measured
        newest, believed = self._newest, self._believed
        if newest is None or believed is None:
            self._newest = self._first = measured
            return self._accept(measured)
        if measured.time <= newest.time:
            return believed
        self._newest = measured
        self._noise.add(newest.pose, measured.pose)
        if measured.pose == newest.pose:
            self._repetitions += 1
        else:
            self._repetitions, self._first = 0, measured
        if self._noise.is_noisy and self._repetitions > MAX_REPETITIONS:
            self.doubt = PushEvent.OBJECT_POSE_FROZEN.report(count=MAX_REPETITIONS)
            # As old as it is: it was measured when it came first.
            self._believed = self._first if believed.pose == self._first.pose else believed
            return self._believed
        gap = measured.time - newest.time
        if gap > LONGEST_GAP or not _jumps(believed.pose, measured.pose, gap):
            return self._accept(measured)
        agrees = self._agreeing > 0 and not _jumps(newest.pose, measured.pose, gap)
        self._agreeing = self._agreeing + 1 if agrees else 1
        if self._agreeing >= AGREEING_COUNT:
            return self._accept(measured)
        if self.doubt is None or self.doubt.reason is not PushEvent.OBJECT_POSE_JUMPS:
            self.doubt = PushEvent.OBJECT_POSE_JUMPS.report(
                distance=distance(believed.pose, measured.pose),
                rotation=math.degrees(wrap_angle(measured.pose.theta - believed.pose.theta)))
        return believed

    def _accept(self, measured: ObjectPose) -> ObjectPose:
        self._believed = measured
        self._agreeing = 0
        self.doubt = None
        return measured


class _NoiseTest:
    """Whether poses differ from each other as by noise, and not as by motion."""

    def __init__(self) -> None:
        self._steps: deque[tuple[float, float, float]] = deque(maxlen=NOISE_STEPS)
        self._has_repeated = False
        self.is_noisy = False

    def add(self, last: Pose, pose: Pose) -> None:
        """Take in a pose and the one before it."""
        if self.is_noisy or self._has_repeated:
            return
        # A tracker that repeats itself now and then, as one that rounds, is never known to freeze.
        self._has_repeated = pose == last
        self._steps.append((pose.x - last.x, pose.y - last.y, wrap_angle(pose.theta - last.theta)))
        if len(self._steps) == NOISE_STEPS and not self._has_repeated:
            changes = np.diff(np.array(self._steps), axis=0)
            sign_changes = (changes[1:] * changes[:-1] < 0.0).sum(axis=0)
            self.is_noisy = bool(sign_changes.min() >= SIGN_CHANGES
                                 and np.abs(changes).mean(axis=0).min() > LEAST_NOISE)


def _jumps(before: Pose, pose: Pose, duration: float) -> bool:
    """Tell whether an object cannot have moved from one pose to the other in a time [s]."""
    return (distance(before, pose) > JUMP_DISTANCE + MAX_SPEED * duration
            or abs(wrap_angle(pose.theta - before.theta))
            > JUMP_ROTATION + MAX_YAW_RATE * duration)
