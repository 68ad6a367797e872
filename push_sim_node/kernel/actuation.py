"""
From command to motion: limits of the drive, first-order lag, arcs.

In the robot's own axes, ``v' = (v_c - v) / T``, its magnitude at most the acceleration limit.
The direction of ``v_c - v`` does not change while the command stands, so that the whole law is
one scalar decay, which is solved exactly.
"""

import math

from push_model.signals import Twist
from push_sim_node.kernel.compiled import compiled


def limit_command(robot, twist):
    """
    Check a command and bring it within the limits of the drive.

    Translation is shortened as a vector, so that its direction stays.

    :param robot: the ``RoundRobot``.
    :param twist: commanded ``Twist`` in the robot's own axes.
    :return: ``Twist`` within the limits.
    :raises ValueError: where a component is not finite, or asks a differential drive to move
        sideways.
    """
    twist = Twist(*(float(value) for value in twist))
    for name, value in zip(Twist._fields, twist):
        if not math.isfinite(value):
            raise ValueError(f'command.{name}: got {value}, expected a finite number')
    if robot.drive == 'differential' and twist.v_y != 0.0:
        raise ValueError(f'command.v_y: got {twist.v_y:g} m/s, expected 0 from a differential '
                         'drive')
    speed = math.hypot(twist.v_x, twist.v_y)
    share = min(1.0, robot.max_speed / speed) if speed > 0.0 else 1.0
    omega = min(robot.max_yaw_rate, max(-robot.max_yaw_rate, twist.omega))
    return Twist(twist.v_x * share, twist.v_y * share, omega)


@compiled
def decay(distance, time_constant, limit, duration):
    """
    Let a velocity error decay: ``d' = -min(d / T, a)``.

    :param distance: d at the start [m/s or rad/s], at least 0.
    :param time_constant: T [s]; 0 for a drive without lag.
    :param limit: a [m/s^2 or rad/s^2], above 0.
    :param duration: how long [s], above 0.
    :return: (d at the end, mean of d over the duration).
    """
    knee = limit * time_constant
    ramp = 0.0
    total = 0.0
    if distance > knee:
        ramp = min(duration, (distance - knee) / limit)
        end = distance - limit * ramp
        total = 0.5 * (distance + end) * ramp
        distance = end
    if ramp >= duration:
        return distance, total / duration
    if time_constant == 0.0:
        return 0.0, total / duration
    fallen = -math.expm1((ramp - duration) / time_constant) * distance
    return distance - fallen, (total + fallen * time_constant) / duration


@compiled
def track_command(v_x, v_y, omega, command, drive, duration):
    """
    Follow a constant command for a while.

    :param v_x: twist at the start, own axes, x [m/s].
    :param v_y: the same, y [m/s].
    :param omega: yaw rate at the start [rad/s].
    :param command: (v_x, v_y, omega) within the limits.
    :param drive: (time constant [s], acceleration limit [m/s^2], yaw acceleration limit
        [rad/s^2]).
    :param duration: how long [s].
    :return: (v_x, v_y, omega) at the end, and their means over the duration.
    """
    to_x, to_y, to_omega = command[0] - v_x, command[1] - v_y, command[2] - omega
    speed = math.sqrt(to_x * to_x + to_y * to_y)
    end, mean = 0.0, 0.0
    if speed > 0.0:
        end, mean = decay(speed, drive[0], drive[1], duration)
        end, mean = end / speed, mean / speed
    yaw_end, yaw_mean = decay(abs(to_omega), drive[0], drive[2], duration)
    yaw_end, yaw_mean = math.copysign(yaw_end, to_omega), math.copysign(yaw_mean, to_omega)
    return (command[0] - end * to_x, command[1] - end * to_y, command[2] - yaw_end,
            command[0] - mean * to_x, command[1] - mean * to_y, command[2] - yaw_mean)


@compiled
def chord_velocity(phi, v_x, v_y, omega, duration):
    """
    Mean velocity along the arc that a constant twist draws.

    :param phi: heading at the start [rad].
    :param v_x: twist, own axes, x [m/s].
    :param v_y: the same, y [m/s].
    :param omega: yaw rate [rad/s].
    :param duration: how long [s].
    :return: (x, y), displacement over duration, in the frame of ``phi`` [m/s].
    """
    half = 0.5 * omega * duration
    shrink = math.sin(half) / half if abs(half) > 1e-8 else 1.0
    c, s = shrink * math.cos(phi + half), shrink * math.sin(phi + half)
    return c * v_x - s * v_y, s * v_x + c * v_y
