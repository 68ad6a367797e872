"""How fast the legs of a way are driven: trapezoids of speed, with stops where it must stop."""

import math

from push_model.geometry import wrap_angle

SAME_DIRECTION = 1e-3
ACROSS = 0.7
# What the end of a leg takes longer because speed fades out there.
STOP_DURATION = 0.15


def segment_limits(segment, limits):
    """
    Speed and acceleration along a leg.

    The yaw rate bounds them on a leg with a turn. Where the velocity turns, in the world or in
    the robot's own axes, they leave room for each other within the acceleration limit.

    :param segment: the ``PathSegment``, with a length above 0.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: (speed [m/s], acceleration [m/s^2]).
    """
    speed, acceleration = limits.speed, limits.acceleration
    length, arc_angle, heading_change = segment.length, abs(segment.arc_angle), abs(segment.heading_change)
    if heading_change > 0.0:
        speed = min(speed, limits.yaw_rate * length / heading_change)
        acceleration = min(acceleration, limits.yaw_acceleration * length / heading_change)
    turned = max(arc_angle, abs(segment.arc_angle - segment.heading_change)) / length
    if turned > 0.0:
        speed = min(speed, math.sqrt(ACROSS * limits.acceleration / turned))
        across = speed * speed * turned
        acceleration = min(acceleration, math.sqrt(limits.acceleration ** 2 - across ** 2))
    return speed, acceleration


def is_continuous(before, after):
    """
    Tell whether the robot need not stop between two legs.

    :param before: ``PathSegment``.
    :param after: the ``PathSegment`` that follows.
    """
    if before.length == 0.0 or after.length == 0.0:
        return False
    return abs(wrap_angle(after.directions[0] - before.directions[1])) < SAME_DIRECTION


def joint_speeds(segments, limits):
    """
    Greatest speeds at the ends of the legs.

    :param segments: ``PathSegment`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: speeds [m/s], one more than legs; 0 where the robot stops.
    """
    pace = [segment_limits(segment, limits) if segment.length else (0.0, 0.0) for segment in segments]
    squares = [0.0] * (len(segments) + 1)
    for i in range(1, len(segments)):
        if is_continuous(segments[i - 1], segments[i]):
            squares[i] = min(pace[i - 1][0], pace[i][0]) ** 2
    for i, segment in enumerate(segments):
        squares[i + 1] = min(squares[i + 1], squares[i] + 2.0 * pace[i][1] * segment.length)
    for i in reversed(range(len(segments))):
        squares[i] = min(squares[i], squares[i + 1] + 2.0 * pace[i][1] * segments[i].length)
    return [math.sqrt(square) for square in squares]


def total_time(segments, limits, lag):
    """
    Time that legs take, from rest to rest [s].

    :param segments: ``PathSegment`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param lag: of the drive behind its commands, once at each stop [s].
    """
    speeds = joint_speeds(segments, limits)
    time = 0.0
    for segment, first, last in zip(segments, speeds, speeds[1:]):
        if last == 0.0 and (segment.length or segment.heading_change):
            time += lag + STOP_DURATION
        if segment.length:
            time += _trapezoid(segment.length, first, last, *segment_limits(segment, limits))
        elif segment.heading_change:
            time += _trapezoid(abs(segment.heading_change), 0.0, 0.0, limits.yaw_rate, limits.yaw_acceleration)
    return time


def _trapezoid(way, first, last, speed, acceleration):
    half = 0.5 * (first * first + last * last)
    peak = min(speed, math.sqrt(half + acceleration * way))
    even = way - (peak * peak - half) / acceleration
    return (2.0 * peak - first - last) / acceleration + even / peak
