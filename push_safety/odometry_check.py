"""
Third check: odometry against itself, the steps of its pose and its twist compared.

The twist v at both ends of a step of duration dt means that the pose moves by about ``v dt``. One
step that is far off is a jump: a base that has restarted, another source, a slip of a map. Small
differences that add up, within a sliding window, are a contradiction: values that are frozen, a
twist that is not filled in, or in other units or axes than the pose. A pose whose heading is off
leads along another direction than its twist, which shows over a distance, however fast it is.

A message is a row of numbers, with what the messages before it add up to since some start: the
poses that the twists lead to, the path length of the poses, and the sum of the twists, each along
the heading of the pose at that time. Compiled functions compare two rows.
"""

from collections import deque
import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled, wrap_angles
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.status import SafetyReason, SafetyReport
from push_safety.tolerances import (
    ABSOLUTE_JUMP_DISTANCE, ABSOLUTE_JUMP_ROTATION, ABSOLUTE_JUMP_SIGMAS, CATCH_UP_RATIO,
    CORRECTION_PERIOD, DIRECTION_DISTANCE, DIRECTION_PATH, DIRECTION_RATIO, EARLY_DISTANCE,
    EARLY_RATIOS, LATERAL_LEVER, LATERAL_RATIO, LATERAL_SPEED, MAX_CORRECTION_DISTANCE,
    MAX_CORRECTION_ROTATION,
    MAX_ODOMETRY_STEP, MAX_ROUNDING, MIN_CORRECTION_DISTANCE, MIN_CORRECTION_ROTATION,
    ODOMETRY_JUMP_DISTANCE, ODOMETRY_JUMP_RATIO, ODOMETRY_JUMP_ROTATION, REPETITION_RATIO,
    REPETITION_TIME, WINDOW_DISTANCE, WINDOW_RATIO, WINDOW_ROTATION, WINDOW_TIME)

# Angle from which on it is the direction that is wrong, and not the unit [rad]; chosen.
MIN_DIRECTION_ERROR = 0.2
# Part of the path length that twists must add up to for them to have a direction; chosen.
MIN_EXPECTED_RATIO = 0.2
# Twist of a robot that moves, so that its pose has to change [m/s], [rad/s]; chosen.
MOVING_SPEED = 0.01
MOVING_YAW_RATE = 0.05
# What a step counts as whose duration is not known, as the clock has fallen back in it [s];
# chosen: the shortest that may have any velocity.
UNKNOWN_STEP = 1.01 * MAX_ODOMETRY_STEP
# Odometry of a robot at rest.
AT_REST = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)
# Columns of a row: time [s]; pose (x, y, theta) [m, m, rad]; twist in the robot's axes [m/s, m/s,
# rad/s]; sum of the twists as a pose; path length of the poses [m]; sum of the twists along the
# headings of the poses (x, y) [m].
TIME, X, Y, THETA, V_X, V_Y, OMEGA = range(7)
SUM_X, SUM_Y, SUM_THETA, TRAVELLED, EXPECTED_X, EXPECTED_Y = range(7, 13)
# Motion by poses and motion by twists, over the same time: distance between where they lead to
# [m], and the same of the headings [rad]; distance [m] and rotation [rad] by the poses; the same
# by the twists. Not a named tuple: compiled functions take three times as long to return one.
Motions = tuple[float, float, float, float, float, float]


def row_of(odometry: Odometry) -> FloatArray:
    """Make the row of a message, with sums that start there."""
    sums = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return np.array((odometry.time, *odometry.pose, *odometry.twist, *sums), dtype=np.float64)


@compiled
def add_step(last: Any, row: Any) -> None:
    """
    Continue the sums by a step, along the chord of the arc that the mean of both twists makes.

    :param last: row before it.
    :param row: its own; its sums are written.
    """
    duration = row[TIME] - last[TIME]
    v_x, v_y = 0.5 * (last[V_X] + row[V_X]), 0.5 * (last[V_Y] + row[V_Y])
    rotation = 0.5 * (last[OMEGA] + row[OMEGA]) * duration
    heading = last[SUM_THETA] + 0.5 * rotation
    c, s = duration * math.cos(heading), duration * math.sin(heading)
    row[SUM_X] = last[SUM_X] + c * v_x - s * v_y
    row[SUM_Y] = last[SUM_Y] + s * v_x + c * v_y
    row[SUM_THETA] = last[SUM_THETA] + rotation
    d_x, d_y = row[X] - last[X], row[Y] - last[Y]
    row[TRAVELLED] = last[TRAVELLED] + math.sqrt(d_x * d_x + d_y * d_y)
    heading = last[THETA] + 0.5 * wrap_angles(row[THETA] - last[THETA])
    c, s = duration * math.cos(heading), duration * math.sin(heading)
    row[EXPECTED_X] = last[EXPECTED_X] + c * v_x - s * v_y
    row[EXPECTED_Y] = last[EXPECTED_Y] + s * v_x + c * v_y


@compiled
def compare_motions(first: Any, row: Any) -> Motions:
    """
    Compare what the robot has moved since a row by the poses and by the twists.

    :param first: row at the start.
    :param row: row at the end.
    """
    c, s = math.cos(first[THETA]), math.sin(first[THETA])
    d_x, d_y = row[X] - first[X], row[Y] - first[Y]
    x, y = c * d_x + s * d_y, c * d_y - s * d_x
    c, s = math.cos(first[SUM_THETA]), math.sin(first[SUM_THETA])
    d_x, d_y = row[SUM_X] - first[SUM_X], row[SUM_Y] - first[SUM_Y]
    e_x, e_y = c * d_x + s * d_y, c * d_y - s * d_x
    rotated, turned = row[THETA] - first[THETA], row[SUM_THETA] - first[SUM_THETA]
    return (math.sqrt((x - e_x) ** 2 + (y - e_y) ** 2), abs(wrap_angles(rotated - turned)),
            math.sqrt(x * x + y * y), abs(wrap_angles(rotated)),
            math.sqrt(e_x * e_x + e_y * e_y), abs(wrap_angles(turned)))


@compiled
def continue_row(last: Any, row: Any) -> Motions:
    """
    Continue the sums by a step, and compare its motions.

    :param last: row before it.
    :param row: its own; its sums are written.
    :return: ``Motions`` of the step.
    """
    add_step(last, row)
    return compare_motions(last, row)


class OdometryCheck:
    """Compares the steps of odometry with its twists."""

    def __init__(self, robot: RoundRobot, *, is_absolute: bool = False) -> None:
        """
        Start before the first odometry.

        :param is_absolute: whether the pose is measured in the world, and corrects itself.
        """
        self._robot = robot
        self._is_absolute = is_absolute
        self._last: Odometry | None = None
        # Rows of the sliding window of time, and of that of distance.
        self._window: deque[FloatArray] = deque()
        self._course: deque[FloatArray] = deque()
        # Time of the last correction of a pose in the world [s].
        self._corrected_at = -math.inf
        # Time at which the present pose came first [s].
        self._pose_since = 0.0
        # Step of the pose when it last changed [m], [rad], no more than the coarsest.
        self._last_step = MAX_ROUNDING
        # Command that was sent last, and when [s]; and what commands add up to since the pose of
        # odometry has last changed [m], [rad].
        self._commanded = STOP, 0.0
        self._commanded_distance = self._commanded_rotation = 0.0
        # Newest of those that came after ``_last`` with stamps before it, and whether each pose
        # continues the one before.
        self._late: Odometry | None = None
        self._is_continuous = True
        # Changes nothing; but loads machine code before the robot moves.
        compare_motions(row_of(AT_REST), row_of(AT_REST))
        continue_row(row_of(AT_REST), row_of(AT_REST))

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command, which tells where the robot may have come while odometry does not change.

        :param command: ``Twist``, finite, that was sent.
        :param time: when [s].
        """
        (before, since), self._commanded = self._commanded, (command, time)
        duration = min(max(0.0, time - since), MAX_ODOMETRY_STEP)
        self._commanded_distance += duration * math.hypot(before.v_x, before.v_y)
        self._commanded_rotation += duration * abs(before.omega)

    def continue_late(self, odometry: Odometry) -> None:
        """
        Note where the robot is while a clock that has fallen back catches up.

        :param odometry: ``Odometry``, finite, with a stamp before the newest.
        """
        last, late = self._last, self._late
        if last is None:
            return
        if late is None:
            # How long this step takes is not known.
            fault = self._jump(last._replace(twist=STOP), odometry._replace(
                time=last.time + UNKNOWN_STEP, twist=STOP))
        else:
            fault = self._jump(late, odometry)
        self._late = odometry
        self._is_continuous = self._is_continuous and fault is None

    def check(self, odometry: Odometry) -> SafetyReport | None:
        """
        Take in odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: ``SafetyReport``, or None where it agrees with itself.
        """
        last, self._last = self._last, odometry
        if last is None:
            self.restart(odometry)
            return None
        if odometry.time <= last.time:
            self._last = last
            return None
        row = row_of(odometry)
        duration = odometry.time - last.time
        step = continue_row(self._window[-1], row)
        if self._is_correction(step, odometry):
            self._corrected_at = odometry.time
            self.restart(odometry)
            return None
        fault = self._check_step(step, duration)
        late, is_continuous = self._late, self._is_continuous
        self._late, self._is_continuous = None, True
        if late is not None and fault is not None and is_continuous:
            # Its clock had fallen back: what looks like a jump was driven meanwhile.
            fault = self._jump(late, odometry)
            self.restart(odometry)
            return fault
        has_moved = odometry.pose != last.pose
        # Odometry that had not changed, and has caught up, is compared from here on.
        has_caught_up = (fault is not None and has_moved
                         and self._explains(last.pose.inverse() @ odometry.pose))
        if has_moved:
            self._commanded_distance = self._commanded_rotation = 0.0
        if fault is not None or duration > MAX_ODOMETRY_STEP:
            self.restart(odometry)
            return None if has_caught_up else fault
        self._extend(row)
        fault = self._repetition(last, odometry) or self._contradiction()
        return fault or self._check_direction(odometry)

    def restart(self, odometry: Odometry) -> None:
        """Forget what was driven before the newest odometry, which has been compared."""
        row = row_of(odometry)
        for rows in (self._window, self._course):
            rows.clear()
            rows.append(row)
        self._pose_since = odometry.time

    def _repetition(self, last: Odometry, odometry: Odometry) -> SafetyReport | None:
        speed, yaw_rate = math.hypot(*odometry.twist[:2]), abs(odometry.twist.omega)
        if odometry.pose != last.pose:
            self._note_step(last.pose, odometry.pose)
            self._pose_since = odometry.time
        if speed <= MOVING_SPEED and yaw_rate <= MOVING_YAW_RATE:
            self._pose_since = odometry.time
        duration = odometry.time - self._pose_since
        last_distance, last_rotation = self._last_step
        has_moved = (speed * duration > REPETITION_RATIO * last_distance
                     or yaw_rate * duration > REPETITION_RATIO * last_rotation)
        if duration <= REPETITION_TIME or not has_moved:
            return None
        return SafetyReason.ODOMETRY_FROZEN.report(duration=duration)

    def _note_step(self, before: Pose, pose: Pose) -> None:
        """Learn to what poses are rounded, from a step between two that differ."""
        step, rotation = distance(before, pose), abs(wrap_angle(pose.theta - before.theta))
        last_distance, last_rotation = self._last_step
        self._last_step = (min(MAX_ROUNDING[0], step or last_distance),
                           min(MAX_ROUNDING[1], rotation or last_rotation))

    def _jump(self, last: Odometry, odometry: Odometry) -> SafetyReport | None:
        """Check the step from one message to another."""
        return self._check_step(continue_row(row_of(last), row_of(odometry)),
                                odometry.time - last.time)

    def _check_step(self, step: Motions, duration: float) -> SafetyReport | None:
        distance_limit, rotation_limit = (
            (ABSOLUTE_JUMP_DISTANCE, ABSOLUTE_JUMP_ROTATION) if self._is_absolute
            else (ODOMETRY_JUMP_DISTANCE, ODOMETRY_JUMP_ROTATION))
        offset, rotation, _, _, travelled, rotated = step
        if duration > MAX_ODOMETRY_STEP:
            travelled = max(travelled, self._robot.max_speed * duration)
            rotated = max(rotated, self._robot.max_yaw_rate * duration)
        if (offset <= distance_limit + ODOMETRY_JUMP_RATIO * travelled
                and rotation <= rotation_limit + ODOMETRY_JUMP_RATIO * rotated):
            return None
        return SafetyReason.ODOMETRY_JUMPED.report(distance=offset,
                                                   rotation=math.degrees(rotation))

    def _is_correction(self, step: Motions, odometry: Odometry) -> bool:
        """Tell whether a pose in the world has corrected itself, as far as it states to err."""
        covariance = odometry.covariance
        if not self._is_absolute or covariance is None:
            return False
        offset, rotation = step[:2]
        if offset <= MIN_CORRECTION_DISTANCE and rotation <= MIN_CORRECTION_ROTATION:
            return False
        largest = min(MAX_CORRECTION_DISTANCE,
                      ABSOLUTE_JUMP_SIGMAS * covariance.position_deviation)
        largest_rotation = min(MAX_CORRECTION_ROTATION,
                               ABSOLUTE_JUMP_SIGMAS * covariance.heading_deviation)
        return (odometry.time - self._corrected_at >= CORRECTION_PERIOD
                and offset <= largest and rotation <= largest_rotation)

    def _explains(self, moved: Pose) -> bool:
        """Tell whether the commands since odometry last changed may have moved the robot so."""
        return (math.hypot(moved.x, moved.y)
                <= ODOMETRY_JUMP_DISTANCE + CATCH_UP_RATIO * self._commanded_distance
                and abs(wrap_angle(moved.theta))
                <= ODOMETRY_JUMP_ROTATION + CATCH_UP_RATIO * self._commanded_rotation)

    def _contradiction(self) -> SafetyReport | None:
        first, last = self._window[0], self._window[-1]
        offset, rotation, moved, rotated, expected, turned = compare_motions(first, last)
        if (offset <= WINDOW_DISTANCE + WINDOW_RATIO * max(moved, expected)
                and rotation <= WINDOW_ROTATION + WINDOW_RATIO * max(rotated, turned)):
            return None
        return SafetyReason.ODOMETRY_CONTRADICTORY.report(
            moved=moved, rotated=math.degrees(rotated), expected=expected,
            rotation=math.degrees(turned),
            duration=float(last[TIME] - first[TIME]))

    def _extend(self, row: FloatArray) -> None:
        """Add a row to both windows, and drop what is too old, or too far back."""
        window, course = self._window, self._course
        window.append(row)
        start = row[TIME] - WINDOW_TIME
        while len(window) > 2 and window[1][TIME] <= start:
            window.popleft()
        travelled = row[TRAVELLED]
        if len(course) > 1 and course[-1][TRAVELLED] == travelled:
            # A robot at rest adds nothing to its course.
            course.pop()
        course.append(row)
        while len(course) > 2 and travelled - course[1][TRAVELLED] >= DIRECTION_PATH:
            course.popleft()

    def early_contradiction(self) -> SafetyReport | None:
        """
        Tell what is wrong with odometry, where something is wrong that may be this.

        :return: ``SafetyReport`` where its pose moves quite otherwise than its twist, over
            however short a distance, or its twist is none of its drive; else None.
        """
        if self._is_lateral and self._last is not None:
            return SafetyReason.ODOMETRY_LATERAL.report(speed=abs(self._last.twist.v_y))
        last = self._course[-1][TRAVELLED]
        for least_distance, ratio in EARLY_RATIOS.items():
            first = next((course for course in reversed(self._course)
                          if last - course[TRAVELLED] >= least_distance), None)
            if first is None:
                continue
            fault = _direction_error(_course_from(first, self._course[-1]), EARLY_DISTANCE, ratio)
            if fault and self._last is not None:
                self.restart(self._last)
                return fault
        return None

    @property
    def _is_lateral(self) -> bool:
        """Whether the robot moves to the side by its twist, which its wheels cannot."""
        if self._last is None or self._robot.drive != 'differential':
            return False
        _, v_y, omega = self._last.twist
        return abs(v_y) > LATERAL_SPEED + LATERAL_LEVER * abs(omega)

    def _check_direction(self, odometry: Odometry) -> SafetyReport | None:
        course = _course_from(self._course[0], self._course[-1])
        if course.travelled < DIRECTION_PATH:
            return None
        constant = ABSOLUTE_JUMP_DISTANCE if self._is_absolute else DIRECTION_DISTANCE
        fault = (_direction_error(course, constant, DIRECTION_RATIO)
                 or _lateral_error(course, constant))
        if fault is not None:
            # A robot at rest adds nothing to its course, in which the error would stay.
            self.restart(odometry)
        return fault


def integrated_step(last: Odometry, odometry: Odometry) -> Pose:
    """
    Integrate the twist of odometry from one message to the next.

    :return: motion of the robot as ``Pose`` in its axes before.
    """
    duration = odometry.time - last.time
    v_x, v_y, omega = (0.5 * (a + b) for a, b in zip(last.twist, odometry.twist))
    rotation = wrap_angle(omega * duration)
    # Along the chord of the arc.
    x, y = Pose(0.0, 0.0, 0.5 * rotation).rotate((v_x * duration, v_y * duration))
    return Pose(x, y, rotation)


class _Course(NamedTuple):
    """Path length between two rows [m], and motion by poses and by twists, in the world [m]."""

    travelled: float
    moved: tuple[float, float]
    expected: tuple[float, float]


def _course_from(first: FloatArray, last: FloatArray) -> _Course:
    difference: list[float] = (last - first).tolist()
    x, y = difference[X:X + 2]
    expected_x, expected_y = difference[EXPECTED_X:EXPECTED_X + 2]
    return _Course(difference[TRAVELLED], (x, y), (expected_x, expected_y))


def _lateral_error(course: _Course, constant: float) -> SafetyReport | None:
    """Compare a course with its twists, across the direction of these."""
    heading = math.atan2(course.expected[1], course.expected[0])
    along, lateral = Pose(0.0, 0.0, -heading).rotate(course.moved)
    if abs(lateral) <= constant + LATERAL_RATIO * course.travelled:
        return None
    return SafetyReason.ODOMETRY_DIRECTION.report(
        moved=math.hypot(*course.moved), angle=math.degrees(math.atan2(lateral, along)))


def _direction_error(course: _Course, constant: float, ratio: float) -> SafetyReport | None:
    """Compare a course with its twists, to a tolerance."""
    travelled, moved, expected = course
    if distance(moved, expected) <= constant + ratio * travelled:
        return None
    angle = wrap_angle(math.atan2(moved[1], moved[0]) - math.atan2(expected[1], expected[0]))
    has_direction = math.hypot(*expected) > MIN_EXPECTED_RATIO * travelled
    if abs(angle) < MIN_DIRECTION_ERROR or not has_direction:
        return SafetyReason.ODOMETRY_SCALE.report(moved=math.hypot(*moved),
                                                  expected=math.hypot(*expected))
    return SafetyReason.ODOMETRY_DIRECTION.report(moved=math.hypot(*moved),
                                                  angle=math.degrees(angle))
