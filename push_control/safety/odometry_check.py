"""
Does odometry agree with itself: steps of its pose and its twist compared.

The twist v at both ends of a step of duration dt means that the pose moves by about ``v dt``. One
step that is far off is a jump: a base that has restarted, another source, a slip of a map. Small
differences that add up, within a sliding window, are a contradiction: values that are frozen, a
twist that is not filled in, or in other units or axes than the pose. A pose whose heading is off
leads along another direction than its twist, which shows over a distance, however fast it is.
"""

from collections import deque
import math
from typing import NamedTuple

from push_control.safety.odometry_rows import (
    compare_motions, continue_row, EXPECTED_X, Motions, row_of, TIME, TRAVELLED, X,
)
from push_control.safety.status import SafetyReason, SafetyReport
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist

# What a step may differ from its twist: constant part [m], [rad], and over what twist, or the
# limits of the robot where the step is long, mean; chosen: the rounding of bases, and one step of
# acceleration.
JUMP_DISTANCE = 0.03
JUMP_ROTATION = 0.08
JUMP_RATIO = 1.0
# What a robot may move over what it was commanded to; chosen: it follows with a lag.
COMMAND_RATIO = 1.5
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
# Distance over which the direction of the steps is compared with that of the twist [m], and what
# the two may differ by: constant part [m], and over the distance, along it and to its side;
# chosen: wheels that are not quite of the stated size, and 6 deg between the axes.
DIRECTION_DISTANCE = 0.3
DIRECTION_TOLERANCE = 0.03
DIRECTION_RATIO = 0.2
LATERAL_RATIO = 0.1
# The same where the robot does not move as commanded, which may be a mistake of odometry: over the
# last centimetres, the more of them the closer; chosen: what shows before the motion is a fault.
EARLY_TOLERANCE = 0.003
EARLY_RATIOS = {0.01: 0.4, 0.02: 0.14, 0.05: 0.12}
# Angle from which on it is the direction that is wrong, and not the unit [rad]; chosen.
LEAST_DIRECTION_ERROR = 0.2
# Part of the distance travelled that twists must add up to for them to have a direction; chosen.
LEAST_EXPECTED_RATIO = 0.2
# Time for which the same pose may come again from a robot that moves [s], and what counts as that
# [m/s], [rad/s]; chosen: messages may be more frequent than what they are made of.
REPETITION_TIME = 0.15
MOVING_SPEED = 0.01
MOVING_YAW_RATE = 0.05
# How far it has to have moved meanwhile by its twist, over the last step of the pose, and the
# greatest that counts [m], [rad]; chosen: half a diagonal more than poses that are rounded need,
# and the coarsest rounding that is common.
REPETITION_RATIO = 2.0
COARSEST_STEP = 0.01, 0.02
# A step longer than this may begin and end at any velocity [s]; chosen: some lost messages.
LONG_STEP = 0.25
# What a step counts as whose duration is not known, as the clock has fallen back in it [s];
# chosen: the shortest that may have any velocity.
UNKNOWN_STEP = 1.01 * LONG_STEP
# Odometry of a robot that stands.
STILL = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)


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
        # Rows of the sliding window of time, and of that of distance.
        self._window: deque[FloatArray] = deque()
        self._course: deque[FloatArray] = deque()
        # Time at which the present pose came first [s].
        self._pose_since = 0.0
        # Step of the pose when it last changed [m], [rad], no more than the coarsest.
        self._last_step = COARSEST_STEP
        # Command that was sent last, and when [s]; and what commands add up to since the pose of
        # odometry has last changed [m], [rad].
        self._commanded = STOP, 0.0
        self._commanded_distance = self._commanded_rotation = 0.0
        # Newest of those that came after ``_last`` with stamps before it, and whether each pose
        # continues the one before.
        self._late: Odometry | None = None
        self._is_continuous = True
        # Changes nothing; but loads machine code before the robot moves.
        compare_motions(row_of(STILL), row_of(STILL))
        continue_row(row_of(STILL), row_of(STILL))

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command, which tells where the robot may have come while odometry stands still.

        :param command: ``Twist``, finite, that was sent.
        :param time: when [s].
        """
        (before, since), self._commanded = self._commanded, (command, time)
        duration = min(max(0.0, time - since), LONG_STEP)
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
        fault = self._judge_step(continue_row(self._window[-1], row), duration)
        late, is_continuous = self._late, self._is_continuous
        self._late, self._is_continuous = None, True
        if late is not None and fault is not None and is_continuous:
            # Its clock had fallen back: what looks like a jump was driven meanwhile.
            fault = self._jump(late, odometry)
            self.restart(odometry)
            return fault
        has_moved = odometry.pose != last.pose
        # Odometry that had stood still, and has caught up, is judged from here on.
        has_caught_up = (fault is not None and has_moved
                         and self._explains(last.pose.inverse() @ odometry.pose))
        if has_moved:
            self._commanded_distance = self._commanded_rotation = 0.0
        if fault is not None or duration > LONG_STEP:
            self.restart(odometry)
            return None if has_caught_up else fault
        self._extend(row)
        fault = self._repetition(last, odometry) or self._contradiction()
        return fault or self._check_direction(odometry)

    def restart(self, odometry: Odometry) -> None:
        """
        Forget what was covered before, which has been judged.

        :param odometry: the newest ``Odometry``.
        """
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
        self._last_step = (min(COARSEST_STEP[0], step or last_distance),
                           min(COARSEST_STEP[1], rotation or last_rotation))

    def _jump(self, last: Odometry, odometry: Odometry) -> SafetyReport | None:
        """Judge the step from one message to another."""
        return self._judge_step(continue_row(row_of(last), row_of(odometry)),
                                odometry.time - last.time)

    def _judge_step(self, step: Motions, duration: float) -> SafetyReport | None:
        distance_limit, rotation_limit = (
            (ABSOLUTE_JUMP_DISTANCE, ABSOLUTE_JUMP_ROTATION) if self._is_absolute
            else (JUMP_DISTANCE, JUMP_ROTATION))
        offset, rotation, _, _, travelled, rotated = step
        if duration > LONG_STEP:
            travelled = max(travelled, self._robot.max_speed * duration)
            rotated = max(rotated, self._robot.max_yaw_rate * duration)
        if (offset <= distance_limit + JUMP_RATIO * travelled
                and rotation <= rotation_limit + JUMP_RATIO * rotated):
            return None
        return SafetyReason.ODOMETRY_JUMPED.report(distance=offset,
                                                   rotation=math.degrees(rotation))

    def _explains(self, moved: Pose) -> bool:
        """Tell whether the commands since odometry has stood still may have moved the robot so."""
        return (math.hypot(moved.x, moved.y)
                <= JUMP_DISTANCE + COMMAND_RATIO * self._commanded_distance
                and abs(wrap_angle(moved.theta))
                <= JUMP_ROTATION + COMMAND_RATIO * self._commanded_rotation)

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
        begin = row[TIME] - WINDOW
        while len(window) > 2 and window[1][TIME] <= begin:
            window.popleft()
        travelled = row[TRAVELLED]
        if len(course) > 1 and course[-1][TRAVELLED] == travelled:
            # A robot that stands adds nothing to its course.
            course.pop()
        course.append(row)
        while len(course) > 2 and travelled - course[1][TRAVELLED] >= DIRECTION_DISTANCE:
            course.popleft()

    def early_contradiction(self) -> SafetyReport | None:
        """
        Tell what is wrong with odometry, where something is wrong that may be this.

        :return: ``SafetyReport`` where its pose moves quite otherwise than its twist, over
            however short a distance; else None.
        """
        last = self._course[-1][TRAVELLED]
        for least_distance, ratio in EARLY_RATIOS.items():
            first = next((course for course in reversed(self._course)
                          if last - course[TRAVELLED] >= least_distance), None)
            if first is None:
                continue
            fault = _direction_error(_course_from(first, self._course[-1]), EARLY_TOLERANCE, ratio)
            if fault and self._last is not None:
                self.restart(self._last)
                return fault
        return None

    def _check_direction(self, odometry: Odometry) -> SafetyReport | None:
        course = _course_from(self._course[0], self._course[-1])
        if course.travelled < DIRECTION_DISTANCE:
            return None
        constant = ABSOLUTE_JUMP_DISTANCE if self._is_absolute else DIRECTION_TOLERANCE
        fault = (_direction_error(course, constant, DIRECTION_RATIO)
                 or _lateral_error(course, constant))
        if fault is not None:
            # A robot that stands adds nothing to its course, in which the error would stay.
            self.restart(odometry)
        return fault


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
    has_direction = math.hypot(*expected) > LEAST_EXPECTED_RATIO * travelled
    if abs(angle) < LEAST_DIRECTION_ERROR or not has_direction:
        return SafetyReason.ODOMETRY_SCALE.report(moved=math.hypot(*moved),
                                                  expected=math.hypot(*expected))
    return SafetyReason.ODOMETRY_DIRECTION.report(moved=math.hypot(*moved),
                                                  angle=math.degrees(angle))
