"""
How long a candidate takes: limits of its segments, speeds at their joints, and the sum.

The same as ``push_navigation.speed_profile`` computes for a ``Path``, on rows of numbers.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.approach.encoding import (
    ACCELERATION, ANGLE, ApproachProblem, JOINT_SPEED, LENGTH, RAMP, REVERSES, TOP_SPEED, WINDOW,
)
from push_navigation.path import MIN_ROTATION
from push_navigation.speed_profile import (
    CORNER_CUT_AT_REST, FADE_TIME, LATERAL_FRACTION, MAX_CORNER_CUT, MIN_WINDOW, PASSING_ROOM,
    YAW_FRACTION,
)


@compiled
def limit_segment(problem: ApproachProblem, row: Any) -> None:
    """
    Find speed and acceleration limits of a segment, as ``speed_profile.segment_limits`` does.

    :param row: of the segment, changed.
    """
    speed, acceleration = problem.speed, problem.acceleration
    angle = abs(row[ANGLE])
    if row[LENGTH] > 0.0 and angle > 0.0:
        radius = row[LENGTH] / angle
        if not problem.is_holonomic:
            speed = min(speed, problem.yaw_rate * radius)
            acceleration = min(acceleration, problem.yaw_acceleration * radius)
        speed = min(speed, math.sqrt(LATERAL_FRACTION * problem.acceleration * radius))
        lateral = speed * speed / radius
        acceleration = min(acceleration,
                           math.sqrt(problem.acceleration * problem.acceleration
                                     - lateral * lateral))
    row[TOP_SPEED], row[ACCELERATION] = speed, acceleration


@compiled
def moves_on(problem: ApproachProblem, segments: Any, index: int, count: int) -> bool:
    """
    Tell whether the robot need not stop at the end of a segment.

    :param segments: shape (s, SEGMENT_SIZE).
    :param index: of the segment, -1 for the beginning of the first.
    :param count: of segments.
    """
    if index < 0:
        return False
    if index + 1 == count:
        return problem.end_speed > 0.0
    before, after = segments[index], segments[index + 1]
    return before[LENGTH] > 0.0 and after[LENGTH] > 0.0 and before[REVERSES] == after[REVERSES]


@compiled
def limit_joint(problem: ApproachProblem, segments: Any, index: int, count: int) -> None:
    """
    Bound the speed between two segments, as ``speed_profile.joint_speed_limit`` does.

    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param index: of the first of them.
    :param count: of segments.
    """
    before, after = segments[index], segments[index + 1]
    top = min(before[TOP_SPEED], after[TOP_SPEED])
    before[JOINT_SPEED] = top * top
    if problem.is_holonomic:
        return
    jump = abs(after[ANGLE] / after[LENGTH] - before[ANGLE] / before[LENGTH])
    window = top * top * jump / (2.0 * YAW_FRACTION * problem.yaw_acceleration)
    if window < MIN_WINDOW:
        return
    goes_on = moves_on(problem, segments, index + 1, count)
    cut = MAX_CORNER_CUT
    if not (goes_on and moves_on(problem, segments, index - 1, count)):
        cut *= CORNER_CUT_AT_REST
    passes = goes_on and index + 2 == count
    longest = min(0.5 * before[LENGTH], (PASSING_ROOM if passes else 0.5) * after[LENGTH],
                  math.sqrt(6.0 * cut / jump))
    before[WINDOW] = min(window, longest)
    before[JOINT_SPEED] *= before[WINDOW] / window


@compiled
def ramp_time(length: float, first: float, last: float, speed: float,
              acceleration: float) -> float:
    """
    Time of a trapezoid of speed [s].

    :param length: [m or rad].
    :param first: squared speed at its beginning.
    :param last: squared speed at its end.
    :param speed: limit.
    :param acceleration: limit.
    """
    half = 0.5 * (first + last)
    peak = min(speed, math.sqrt(half + acceleration * length))
    even = length - (peak * peak - half) / acceleration
    return (2.0 * peak - math.sqrt(first) - math.sqrt(last)) / acceleration + even / peak


@compiled
def limit_joints(problem: ApproachProblem, segments: Any, count: int) -> None:
    """
    Find the greatest speeds at the joints of segments, as ``speed_profile.joint_speeds`` does.

    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments, at least one.
    """
    for i in range(count):
        limit_segment(problem, segments[i])
        segments[i, JOINT_SPEED], segments[i, WINDOW] = 0.0, 0.0
    for i in range(count - 1):
        if moves_on(problem, segments, i, count):
            limit_joint(problem, segments, i, count)
    if segments[count - 1, LENGTH] > 0.0:
        segments[count - 1, JOINT_SPEED] = min(problem.end_speed,
                                               segments[count - 1, TOP_SPEED]) ** 2
    before, window = 0.0, 0.0
    for i in range(count):
        row = segments[i]
        row[RAMP] = max(0.0, row[LENGTH] - window - row[WINDOW])
        before = min(row[JOINT_SPEED], before + 2.0 * row[ACCELERATION] * row[RAMP])
        row[JOINT_SPEED], window = before, row[WINDOW]
    for i in range(count - 1, 0, -1):
        row = segments[i]
        segments[i - 1, JOINT_SPEED] = min(
            segments[i - 1, JOINT_SPEED], row[JOINT_SPEED] + 2.0 * row[ACCELERATION] * row[RAMP])


@compiled
def duration(problem: ApproachProblem, segments: Any, count: int) -> float:
    """
    Compute the time of a candidate from rest, as ``speed_profile.travel_time`` does [s].

    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments, at least one.
    """
    limit_joints(problem, segments, count)
    time = problem.time_constant if segments[count - 1, JOINT_SPEED] > 0.0 else 0.0
    before = 0.0
    for i in range(count):
        row = segments[i]
        last = row[JOINT_SPEED]
        if row[LENGTH] > 0.0:
            time += ramp_time(row[RAMP], before, last, row[TOP_SPEED], row[ACCELERATION])
            if last == 0.0:
                time += problem.time_constant + FADE_TIME
            elif row[WINDOW] > 0.0:
                time += 2.0 * row[WINDOW] / math.sqrt(last)
        elif not problem.is_holonomic and abs(row[ANGLE]) > MIN_ROTATION:
            time += (ramp_time(abs(row[ANGLE]), 0.0, 0.0, problem.yaw_rate,
                               problem.yaw_acceleration)
                     + problem.time_constant + FADE_TIME)
        before = last
    return time
