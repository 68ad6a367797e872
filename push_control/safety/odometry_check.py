"""
Does odometry agree with itself: steps of its pose and its twist compared.

The twist v at both ends of a step of duration dt means that the pose moves by about ``v dt``. One
step that is far off is a jump: a base that has restarted, another source, a slip of a map. Small
differences that add up, within a sliding window, are a contradiction: values that are frozen, a
twist that is not filled in, or in other units or axes than the pose.
"""

from collections import deque
import math
from typing import NamedTuple

from push_control.safety.status import SafetyReason, SafetyReport
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry

# What a step may differ from its twist: constant part [m], [rad], and over what twist, or the
# limits of the robot where the step is long, mean; chosen: the rounding of bases, and one step of
# acceleration.
JUMP_DISTANCE = 0.03
JUMP_ROTATION = 0.08
JUMP_RATIO = 1.0
# The same where the pose is absolute, which corrects itself [m], [rad]; chosen: a correction of a
# map's localization.
ABSOLUTE_JUMP_DISTANCE = 0.15
ABSOLUTE_JUMP_ROTATION = 0.2
# Sliding window [s], and what the sum of the steps may differ from the sum of the twists in it:
# constant part [m], [rad], and over the greater of the two; chosen: 0.3 m/s are noticed in 0.2 s.
WINDOW = 0.6
WINDOW_DISTANCE = 0.03
WINDOW_ROTATION = 0.1
WINDOW_RATIO = 0.4
# Time for which the same pose may come again from a robot that moves [s], and what counts as that
# [m/s], [rad/s]; chosen: messages may be more frequent than what they are made of.
REPETITION_TIME = 0.15
MOVING_SPEED = 0.01
MOVING_YAW_RATE = 0.05
# A step longer than this may begin and end at any velocity [s]; chosen: some lost messages.
LONG_STEP = 0.25


class _Sample(NamedTuple):
    """
    Where the robot is at a time.

    :param time: of odometry [s].
    :param pose: of odometry.
    :param integrated: sum of its twists since the last jump.
    """

    time: float
    pose: Pose
    integrated: Pose


class OdometryCheck:
    """Compares the steps of odometry with its twists."""

    def __init__(self, robot: RoundRobot, *, is_absolute: bool = False) -> None:
        """
        Begin before the first odometry.

        :param robot: the ``RoundRobot``.
        :param is_absolute: whether the pose is measured in the world, and corrects itself.
        """
        self._robot = robot
        self._is_absolute = is_absolute
        self._last: Odometry | None = None
        self._samples: deque[_Sample] = deque()
        # Time at which the present pose came first [s].
        self._pose_since = 0.0

    def check(self, odometry: Odometry) -> SafetyReport | None:
        """
        Take in odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: ``SafetyReport``, or None where it agrees with itself.
        """
        last, self._last = self._last, odometry
        if last is None:
            self._restart(odometry)
            return None
        if odometry.time <= last.time:
            self._last = last
            return None
        step = integrated_step(last, odometry)
        fault = self._jump(last, odometry, step)
        if fault is not None or odometry.time - last.time > LONG_STEP:
            self._restart(odometry)
            return fault
        samples = self._samples
        samples.append(_Sample(odometry.time, odometry.pose, samples[-1].integrated @ step))
        while len(samples) > 2 and samples[1].time <= odometry.time - WINDOW:
            samples.popleft()
        return self._repetition(last, odometry) or self._contradiction()

    def _restart(self, odometry: Odometry) -> None:
        self._samples.clear()
        self._samples.append(_Sample(odometry.time, odometry.pose, Pose(0.0, 0.0, 0.0)))
        self._pose_since = odometry.time

    def _repetition(self, last: Odometry, odometry: Odometry) -> SafetyReport | None:
        v_x, v_y, omega = odometry.twist
        moves = math.hypot(v_x, v_y) > MOVING_SPEED or abs(omega) > MOVING_YAW_RATE
        if odometry.pose != last.pose or not moves:
            self._pose_since = odometry.time
        duration = odometry.time - self._pose_since
        if duration <= REPETITION_TIME:
            return None
        return SafetyReason.ODOMETRY_FROZEN.report(duration=duration)

    def _jump(self, last: Odometry, odometry: Odometry, expected: Pose) -> SafetyReport | None:
        distance_limit, rotation_limit = (
            (ABSOLUTE_JUMP_DISTANCE, ABSOLUTE_JUMP_ROTATION) if self._is_absolute
            else (JUMP_DISTANCE, JUMP_ROTATION))
        moved, duration = last.pose.inverse() @ odometry.pose, odometry.time - last.time
        travelled, rotated = math.hypot(expected.x, expected.y), abs(expected.theta)
        if duration > LONG_STEP:
            travelled = max(travelled, self._robot.max_speed * duration)
            rotated = max(rotated, self._robot.max_yaw_rate * duration)
        distance, rotation = _difference(moved, expected)
        if (distance <= distance_limit + JUMP_RATIO * travelled
                and rotation <= rotation_limit + JUMP_RATIO * rotated):
            return None
        return SafetyReason.ODOMETRY_JUMPED.report(distance=distance,
                                                   rotation=math.degrees(rotation))

    def _contradiction(self) -> SafetyReport | None:
        first, last = self._samples[0], self._samples[-1]
        moved = first.pose.inverse() @ last.pose
        expected = first.integrated.inverse() @ last.integrated
        distance, rotation = _difference(moved, expected)
        distances = math.hypot(moved.x, moved.y), math.hypot(expected.x, expected.y)
        rotations = abs(wrap_angle(moved.theta)), abs(wrap_angle(expected.theta))
        if (distance <= WINDOW_DISTANCE + WINDOW_RATIO * max(distances)
                and rotation <= WINDOW_ROTATION + WINDOW_RATIO * max(rotations)):
            return None
        return SafetyReason.ODOMETRY_CONTRADICTORY.report(
            moved=distances[0], rotated=math.degrees(rotations[0]), expected=distances[1],
            rotation=math.degrees(rotations[1]), duration=last.time - first.time)


def integrated_step(last: Odometry, odometry: Odometry) -> Pose:
    """
    Integrate the twist of odometry from one message to the next.

    :param last: ``Odometry``.
    :param odometry: the one after it.
    :return: motion of the robot as ``Pose`` in its axes before.
    """
    duration = odometry.time - last.time
    v_x, v_y, omega = (0.5 * (a + b) for a, b in zip(last.twist, odometry.twist))
    rotation = wrap_angle(omega * duration)
    # Along the chord of the arc.
    x, y = Pose(0.0, 0.0, 0.5 * rotation).rotate((v_x * duration, v_y * duration))
    return Pose(x, y, rotation)


def _difference(pose: Pose, other: Pose) -> tuple[float, float]:
    return (math.hypot(pose.x - other.x, pose.y - other.y),
            abs(wrap_angle(pose.theta - other.theta)))
