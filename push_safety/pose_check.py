"""
Second check: object poses against those before them. No object jumps, and no tracker freezes.

A pose that is too far from the last one for any object is held back until some in a row agree with
each other: then somebody has moved the object. A tracker whose poses have shown noise, and then
repeat to the last digit, measures nothing any more.

An outline that a rotation by 2 pi / n takes to itself looks the same in n headings, which a
tracker confuses. Where the pose of such an object is rotated by a multiple of that from one
measurement to the next, and is hardly displaced, it was not the object that moved, which nobody
rotates so exactly about its origin: the rotation is taken back.
"""

from collections import deque
import math

import numpy as np
from push_model.events import EventReport, PushEvent
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose
from push_safety.tolerances import (
    AGREEING_MESSAGES, HEADING_JUMP_DISTANCE, HEADING_JUMP_ROTATION, MAX_OBJECT_SPEED,
    MAX_OBJECT_YAW_RATE, MAX_POSE_GAP, MAX_POSE_REPETITIONS, OBJECT_JUMP_DISTANCE,
    OBJECT_JUMP_ROTATION)

# Steps by which it is known whether a tracker shows noise, in how many of them the change of the
# step changes its sign where that is noise, and the least mean change that is [m], [rad];
# chosen: noise changes it in three of four, motion seldom, and rounding is far below.
NOISE_STEPS = 12
SIGN_CHANGES = 5
MIN_NOISE = 1e-5
# Distance between vertices that are the same over the size of the outline; chosen: a tracker does
# not see a difference of a few per cent.
SAME_RATIO = 0.05


class PoseCheck:
    """
    Takes headings back that a tracker mistakes, and holds back poses that cannot be true.

    ``heading_jump``: angle by which the tracker mistakes the heading of the object [rad], else 0.
    ``fault``: ``EventReport`` of what is wrong with the newest pose, None where it counts.
    """

    def __init__(self, obj: PushedObject, heading_count: int = 0) -> None:
        """
        Start before the first pose, which counts as right.

        :param heading_count: number of headings in which the object looks the same; 0: as the
            outline has it.
        """
        self._angle = 2.0 * math.pi / (heading_count or rotational_symmetry(obj))
        # The last pose with the heading that continues those before it.
        self._continued: Pose | None = None
        # The newest pose as measured, and as it counts.
        self._checked: tuple[ObjectPose, ObjectPose] | None = None
        self.heading_jump = 0.0
        self.restart()

    def restart(self) -> None:
        """Accept the next pose wherever it is: the object may have been moved."""
        self._accepted: ObjectPose | None = None
        self._newest: ObjectPose | None = None
        self._agreeing = 0
        self._noise = _NoiseTest()
        # The pose that repeats itself, as it came first, and how often.
        self._first = ObjectPose(0.0, Pose(0.0, 0.0, 0.0))
        self._repetitions = 0
        self.fault: EventReport | None = None

    def check(self, measured: ObjectPose) -> ObjectPose:
        """
        Evaluate a pose.

        :param measured: ``ObjectPose``; one that is not newer than the last is no news.
        :return: the same, with the heading that continues those before it; or the last one that
            was accepted where this one is not.
        """
        if self._checked is None or measured is not self._checked[0]:
            self._checked = measured, self._plausible(self._with_heading(measured))
        return self._checked[1]

    def _with_heading(self, measured: ObjectPose) -> ObjectPose:
        """Take back a jump of the heading to another one in which the object looks the same."""
        pose, last = measured.pose, self._continued
        if not pose.is_finite():
            return measured
        jump = 0.0
        if last is not None and distance(pose, last) < HEADING_JUMP_DISTANCE:
            rotation = wrap_angle(pose.theta - last.theta)
            multiple = self._angle * round(rotation / self._angle)
            if abs(rotation - multiple) < HEADING_JUMP_ROTATION:
                jump = multiple
        self.heading_jump = jump
        self._continued = Pose(pose.x, pose.y, wrap_angle(pose.theta - jump))
        relative = measured.relative
        if relative is not None:
            relative = Pose(relative.x, relative.y, wrap_angle(relative.theta - jump))
        return measured._replace(pose=self._continued, relative=relative)

    def _plausible(self, measured: ObjectPose) -> ObjectPose:
        """Return a pose that can be true, or the last one."""
        if not measured.pose.is_finite():
            return measured
        newest, accepted = self._newest, self._accepted
        if newest is None or accepted is None:
            self._newest = self._first = measured
            return self._accept(measured)
        if measured.time <= newest.time:
            return accepted
        self._newest = measured
        self._noise.add(newest.pose, measured.pose)
        if measured.pose == newest.pose:
            self._repetitions += 1
        else:
            self._repetitions, self._first = 0, measured
        if self._noise.is_noisy and self._repetitions > MAX_POSE_REPETITIONS:
            self.fault = PushEvent.OBJECT_POSE_FROZEN.report(count=MAX_POSE_REPETITIONS)
            # As old as it is: it was measured when it came first.
            self._accepted = self._first if accepted.pose == self._first.pose else accepted
            return self._accepted
        gap = measured.time - newest.time
        if gap > MAX_POSE_GAP or not _jumps(accepted.pose, measured.pose, gap):
            return self._accept(measured)
        agrees = self._agreeing > 0 and not _jumps(newest.pose, measured.pose, gap)
        self._agreeing = self._agreeing + 1 if agrees else 1
        if self._agreeing >= AGREEING_MESSAGES:
            return self._accept(measured)
        if self.fault is None or self.fault.code is not PushEvent.OBJECT_POSE_JUMPS:
            self.fault = PushEvent.OBJECT_POSE_JUMPS.report(
                distance=distance(accepted.pose, measured.pose),
                rotation=math.degrees(wrap_angle(measured.pose.theta - accepted.pose.theta)))
        return accepted

    def _accept(self, measured: ObjectPose) -> ObjectPose:
        self._accepted = measured
        self._agreeing = 0
        self.fault = None
        return measured


class _NoiseTest:
    """Tell whether poses differ from each other as by noise, and not as by motion."""

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
                                 and np.abs(changes).mean(axis=0).min() > MIN_NOISE)


def _jumps(before: Pose, pose: Pose, duration: float) -> bool:
    """Tell whether an object cannot have moved from one pose to the other in a time [s]."""
    return (distance(before, pose) > OBJECT_JUMP_DISTANCE + MAX_OBJECT_SPEED * duration
            or abs(wrap_angle(pose.theta - before.theta))
            > OBJECT_JUMP_ROTATION + MAX_OBJECT_YAW_RATE * duration)


def rotational_symmetry(obj: PushedObject) -> int:
    """Count the headings in which an outline looks the same; 1 for a disc, which is marked."""
    if not obj.outline:
        return 1
    vertices = np.array(obj.outline)
    vertices = vertices - vertices.mean(axis=0)
    tolerance = SAME_RATIO * float(np.hypot(*vertices.T).max())
    # About the origin, as it is the pose of the frame that must be the same.
    if np.hypot(*np.array(obj.outline).mean(axis=0)) > tolerance:
        return 1
    for count in range(len(vertices), 1, -1):
        c, s = math.cos(2.0 * math.pi / count), math.sin(2.0 * math.pi / count)
        rotated = vertices @ np.array([(c, s), (-s, c)])
        gaps = np.hypot(*(rotated[:, None] - vertices[None]).transpose(2, 0, 1)).min(axis=1)
        if gaps.max() < tolerance:
            return count
    return 1
