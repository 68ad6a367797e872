"""From a wanted contact velocity to the robot's command (model: section 6)."""

import math

from push_model.signals import Twist


def differential_command(speed, angle, lead, robot_radius):
    """
    Command of a differential drive; valid while the contact sticks.

    ``v = v_c cos b / cos d``, ``omega_p = (v_c sin b + v sin d) / R_p``.

    :param speed: v_c, of the wanted contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param lead: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :return: ``Twist``.
    """
    forward = speed * math.cos(angle) / math.cos(lead)
    turn = (speed * math.sin(angle) + forward * math.sin(lead)) / robot_radius
    return Twist(forward, 0.0, turn)


def holonomic_command(speed, angle, lead, robot_radius, omega):
    """
    Command of a holonomic base that turns at a chosen rate, ``v_P = v_C - omega_p R_p t``.

    :param speed: v_c, of the wanted contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param lead: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :param omega: omega_p, chosen yaw rate [rad/s].
    :return: ``Twist``.
    """
    spin = omega * robot_radius
    return Twist(speed * math.cos(lead + angle) + spin * math.sin(lead),
                 speed * math.sin(lead + angle) - spin * math.cos(lead), omega)


def limited(command, robot):
    """
    Scale a command into the robot's limits; the contact keeps its direction.

    :param command: ``Twist``.
    :param robot: the ``RoundRobot``.
    :return: ``Twist``.
    """
    excess = max(1.0, math.hypot(command.v_x, command.v_y) / robot.max_speed,
                 abs(command.omega) / robot.max_yaw_rate)
    return Twist(*(value / excess for value in command))


def mean_motion(twist, command, time_constant):
    """
    Mean motion over one time constant while a first-order drive follows a command.

    :param twist: motion now.
    :param command: ``Twist`` that it follows.
    :param time_constant: of the drive [s].
    :return: ``Twist``, to be applied for ``time_constant``.
    """
    if time_constant == 0.0:
        return Twist(*command)
    share = 1.0 - math.exp(-1.0)
    return Twist(*(b + (a - b) * share for a, b in zip(twist, command)))
