"""
From command to motion of the robot: limits of the drive, first-order lag, arcs.

In the robot's own axes ``v' = (v_c - v) / T``, its magnitude at most the acceleration limit. The
direction of ``v_c - v`` does not change while the command stands; hence the whole law is one
scalar decay, which is solved exactly.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled
from push_dynamics.layout import MAX_ACCELERATION, MAX_YAW_ACCELERATION, TIME_CONSTANT
from push_model.parameters import RoundRobot
from push_model.signals import Twist


class TrackedCommand(NamedTuple):
    """
    Motion of the robot under a constant command for a while, own axes [m/s, rad/s].

    :param end_x: velocity at the end, x.
    :param end_y: velocity at the end, y.
    :param end_omega: yaw rate at the end.
    :param mean_x: mean velocity over the duration, x.
    :param mean_y: mean velocity over the duration, y.
    :param mean_omega: mean yaw rate over the duration.
    """

    end_x: float
    end_y: float
    end_omega: float
    mean_x: float
    mean_y: float
    mean_omega: float


def limit_command(robot: RoundRobot, command: Twist) -> Twist:
    """
    Check a command and bring it within the limits of the drive.

    Translation is shortened as a vector, so that its direction stays.

    :param command: commanded ``Twist`` in the robot's own axes.
    :return: ``Twist`` within the limits.
    :raises ValueError: where a component is not finite, or asks a differential drive to move
        sideways.
    """
    v_x, v_y, omega = map(float, command)
    if not (math.isfinite(v_x) and math.isfinite(v_y) and math.isfinite(omega)):
        name, value = next(field for field in zip(Twist._fields, (v_x, v_y, omega))
                           if not math.isfinite(field[1]))
        raise ValueError(f'command.{name}: got {value}, expected a finite number')
    if robot.drive == 'differential' and v_y != 0.0:
        raise ValueError(f'command.v_y: got {v_y:g} m/s, expected 0 from a differential drive')
    speed = math.hypot(v_x, v_y)
    ratio = min(1.0, robot.max_speed / speed) if speed > 0.0 else 1.0
    return Twist(v_x * ratio, v_y * ratio,
                 min(robot.max_yaw_rate, max(-robot.max_yaw_rate, omega)))


@compiled
def decay(error: float, time_constant: float, limit: float,
          duration: float) -> tuple[float, float]:
    """
    Let a velocity error decay: ``e' = -min(e / T, a)``.

    :param error: e at the start [m/s or rad/s], at least 0.
    :param time_constant: T [s]; 0 for a drive without lag.
    :param limit: a [m/s^2 or rad/s^2], above 0.
    :param duration: how long [s], above 0.
    :return: (e at the end, mean of e over the duration).
    """
    if error == 0.0:
        return 0.0, 0.0
    # Above a T the error falls at constant rate, below it exponentially.
    knee = limit * time_constant
    ramp = 0.0
    total = 0.0
    if error > knee:
        ramp = min(duration, (error - knee) / limit)
        end = error - limit * ramp
        total = 0.5 * (error + end) * ramp
        error = end
    if ramp >= duration:
        return error, total / duration
    if time_constant == 0.0:
        return 0.0, total / duration
    fallen = -math.expm1((ramp - duration) / time_constant) * error
    return error - fallen, (total + fallen * time_constant) / duration


@compiled
def track_command(v_x: float, v_y: float, omega: float, command: Any, drive: Any,
                  duration: float) -> TrackedCommand:
    """
    Follow a constant command for a while.

    :param v_x: velocity at the start, own axes, x [m/s].
    :param v_y: velocity at the start, y [m/s].
    :param omega: yaw rate at the start [rad/s].
    :param command: (v_x, v_y, omega) within the limits.
    :param drive: numbers in the order of ``layout``.
    :param duration: how long [s].
    """
    to_x, to_y, to_omega = command[0] - v_x, command[1] - v_y, command[2] - omega
    speed = math.sqrt(to_x * to_x + to_y * to_y)
    end, mean = 0.0, 0.0
    if speed > 0.0:
        end, mean = decay(speed, drive[TIME_CONSTANT], drive[MAX_ACCELERATION], duration)
        end, mean = end / speed, mean / speed
    yaw_end, yaw_mean = decay(abs(to_omega), drive[TIME_CONSTANT], drive[MAX_YAW_ACCELERATION],
                              duration)
    yaw_end, yaw_mean = math.copysign(yaw_end, to_omega), math.copysign(yaw_mean, to_omega)
    return TrackedCommand(
        command[0] - end * to_x, command[1] - end * to_y, command[2] - yaw_end,
        command[0] - mean * to_x, command[1] - mean * to_y, command[2] - yaw_mean)


@compiled
def track_commands(velocities: Any, commands: Any, drives: Any, duration: float) -> None:
    """
    Let several robots, or models of one, each follow a constant command for a while.

    :param velocities: own axes, shape (m, 3), is written [m/s, m/s, rad/s].
    :param commands: within the limits, shape (m, 3).
    :param drives: as of ``track_command``, shape (m, 3); or (1, 3) for all of them.
    :param duration: how long [s].
    """
    for i in range(len(velocities)):
        velocity = velocities[i]
        tracked = track_command(velocity[0], velocity[1], velocity[2], commands[i],
                                drives[min(i, len(drives) - 1)], duration)
        velocity[0], velocity[1], velocity[2] = (tracked.end_x, tracked.end_y, tracked.end_omega)


@compiled
def chord_velocity(theta: float, v_x: float, v_y: float, omega: float,
                   duration: float) -> tuple[float, float]:
    """
    Compute the mean velocity along the arc that a constant twist draws.

    :param theta: heading at the start [rad].
    :param v_x: velocity, own axes, x [m/s].
    :param v_y: velocity, own axes, y [m/s].
    :param omega: yaw rate [rad/s].
    :param duration: how long [s].
    :return: (x, y), displacement over duration, in the frame of ``theta`` [m/s].
    """
    half = 0.5 * omega * duration
    # sin(h) / h differs from 1 by h^2 / 6, which is nothing below 1e-8.
    ratio = math.sin(half) / half if abs(half) > 1e-8 else 1.0
    c, s = ratio * math.cos(theta + half), ratio * math.sin(theta + half)
    return c * v_x - s * v_y, s * v_x + c * v_y
