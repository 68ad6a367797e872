"""From a wanted contact velocity to the robot's command (model: section 6)."""

import math

from push_model.geometry import Pose
from push_model.robot_kinematics import center_velocity, yaw_rate
from push_model.signals import Twist


def differential_command(speed, angle, heading_offset, robot_radius):
    """
    Command of a differential drive; valid while the contact sticks.

    :param speed: v_c, of the wanted contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param heading_offset: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :return: ``Twist``.
    """
    omega = yaw_rate('differential', robot_radius, angle, heading_offset, 0.0, speed)
    return holonomic_command(speed, angle, heading_offset, robot_radius, omega)._replace(v_y=0.0)


def holonomic_command(speed, angle, heading_offset, robot_radius, omega):
    """
    Command of a holonomic base that turns at a chosen rate.

    :param speed: v_c, of the wanted contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param heading_offset: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :param omega: omega_p, chosen yaw rate [rad/s].
    :return: ``Twist``.
    """
    along, across = center_velocity(robot_radius, angle, omega, speed)
    return Twist(*Pose(0.0, 0.0, heading_offset).rotate((along, across)), omega)


def limit_command(command, robot):
    """
    Scale a command into the robot's limits; the contact keeps its direction.

    :param command: ``Twist``.
    :param robot: the ``RoundRobot``.
    :return: ``Twist``.
    """
    excess = max(1.0, math.hypot(command.v_x, command.v_y) / robot.max_speed,
                 abs(command.omega) / robot.max_yaw_rate)
    return Twist(*(value / excess for value in command))


def mean_twist(twist, command, time_constant):
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


def contact_speed(elapsed, remaining_distance, fastest, settings):
    """
    Speed of the contact: rises after the start, falls towards the goal.

    :param elapsed: time since the robot set out [s].
    :param remaining_distance: way of z that is left [m].
    :param fastest: speed of the plan [m/s].
    :param settings: ``ControlSettings``.
    :return: speed [m/s].
    """
    start = settings.start_speed
    braking = math.sqrt(start ** 2 + 2.0 * settings.deceleration * max(0.0, remaining_distance))
    return min(fastest, start + settings.acceleration * elapsed, braking)
