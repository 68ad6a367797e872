"""How fast the legs of a way are driven: trapezoids of speed, with stops where it must stop."""

import math

from push_model.geometry import wrap_angle

SAME_DIRECTION = 1e-3
ACROSS = 0.7
# What the end of a leg takes longer because speed fades out there.
SETTLING = 0.15


def leg_limits(leg, limits):
    """
    Speed and acceleration along a leg.

    The yaw rate bounds them on a leg with a turn. Where the velocity turns, in the world or in
    the robot's own axes, they leave room for each other within the acceleration limit.

    :param leg: the ``Leg``, with a length above 0.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: (speed [m/s], acceleration [m/s^2]).
    """
    speed, acceleration = limits.speed, limits.acceleration
    length, bend, turn = leg.length, abs(leg.bend), abs(leg.turn)
    if turn > 0.0:
        speed = min(speed, limits.yaw_rate * length / turn)
        acceleration = min(acceleration, limits.yaw_acceleration * length / turn)
    turned = max(bend, abs(leg.bend - leg.turn)) / length
    if turned > 0.0:
        speed = min(speed, math.sqrt(ACROSS * limits.acceleration / turned))
        across = speed * speed * turned
        acceleration = min(acceleration, math.sqrt(limits.acceleration ** 2 - across ** 2))
    return speed, acceleration


def goes_on(before, after):
    """
    Tell whether the robot need not stop between two legs.

    :param before: ``Leg``.
    :param after: the ``Leg`` that follows.
    """
    if before.length == 0.0 or after.length == 0.0:
        return False
    return abs(wrap_angle(after.directions[0] - before.directions[1])) < SAME_DIRECTION


def joint_speeds(legs, limits):
    """
    Greatest speeds at the ends of the legs.

    :param legs: ``Leg`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: speeds [m/s], one more than legs; 0 where the robot stops.
    """
    pace = [leg_limits(leg, limits) if leg.length else (0.0, 0.0) for leg in legs]
    squares = [0.0] * (len(legs) + 1)
    for i in range(1, len(legs)):
        if goes_on(legs[i - 1], legs[i]):
            squares[i] = min(pace[i - 1][0], pace[i][0]) ** 2
    for i, leg in enumerate(legs):
        squares[i + 1] = min(squares[i + 1], squares[i] + 2.0 * pace[i][1] * leg.length)
    for i in reversed(range(len(legs))):
        squares[i] = min(squares[i], squares[i + 1] + 2.0 * pace[i][1] * legs[i].length)
    return [math.sqrt(square) for square in squares]


def total_time(legs, limits, lag):
    """
    Time that legs take, from rest to rest [s].

    :param legs: ``Leg`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param lag: of the drive behind its commands, once at each stop [s].
    """
    speeds = joint_speeds(legs, limits)
    time = 0.0
    for leg, first, last in zip(legs, speeds, speeds[1:]):
        if last == 0.0 and (leg.length or leg.turn):
            time += lag + SETTLING
        if leg.length:
            time += _trapezoid(leg.length, first, last, *leg_limits(leg, limits))
        elif leg.turn:
            time += _trapezoid(abs(leg.turn), 0.0, 0.0, limits.yaw_rate, limits.yaw_acceleration)
    return time


def _trapezoid(way, first, last, speed, acceleration):
    half = 0.5 * (first * first + last * last)
    peak = min(speed, math.sqrt(half + acceleration * way))
    even = way - (peak * peak - half) / acceleration
    return (2.0 * peak - first - last) / acceleration + even / peak
