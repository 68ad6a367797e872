"""From a velocity of the contact to the robot's command (model: section 6)."""

import math

from push_control.settings import ControlSettings
from push_dynamics.compiled import compiled, interpreted
from push_model import robot_kinematics
from push_model.parameters import RoundRobot
from push_model.signals import Twist

base_velocity = compiled(robot_kinematics.base_velocity)
differential_yaw_rate = compiled(robot_kinematics.differential_yaw_rate)

# Mean of exp(-t / T) over the time constant T.
MEAN_DECAY = 1.0 - math.exp(-1.0)


@compiled
def differential_command(speed: float, angle: float, heading_offset: float,
                         robot_radius: float) -> Twist:
    """
    Command of a differential drive; valid while the contact sticks.

    :param speed: v_c, of the contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param heading_offset: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :return: ``Twist`` in the robot's axes.
    """
    across = speed * math.sin(heading_offset + angle)
    omega = differential_yaw_rate(robot_radius, across, math.cos(heading_offset))
    command = holonomic_command(speed, angle, heading_offset, robot_radius, omega)
    return Twist(command.v_x, 0.0, omega)


@compiled
def holonomic_command(speed: float, angle: float, heading_offset: float, robot_radius: float,
                      omega: float) -> Twist:
    """
    Command of a holonomic base that turns at a chosen rate.

    :param speed: v_c, of the contact velocity [m/s].
    :param angle: b, from the contact normal to that velocity [rad].
    :param heading_offset: d, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :param omega: omega_p, chosen yaw rate [rad/s].
    :return: ``Twist`` in the robot's axes.
    """
    direction = heading_offset + angle
    velocity = speed * math.cos(direction), speed * math.sin(direction)
    v_x, v_y = base_velocity(heading_offset, robot_radius, velocity, omega)
    return Twist(v_x, v_y, omega)


@compiled
def scaled_command(command: Twist, max_speed: float, max_yaw_rate: float) -> Twist:
    """
    Scale a command into limits; the contact keeps its direction.

    :param command: ``Twist`` in the robot's axes.
    :param max_speed: of the robot [m/s].
    :param max_yaw_rate: of the robot [rad/s].
    :return: ``Twist`` in the robot's axes.
    """
    excess = max(1.0, math.hypot(command.v_x, command.v_y) / max_speed,
                 abs(command.omega) / max_yaw_rate)
    return Twist(command.v_x / excess, command.v_y / excess, command.omega / excess)


def limit_command(command: Twist, robot: RoundRobot) -> Twist:
    """
    Scale a command into the robot's limits; the contact keeps its direction.

    :param command: ``Twist`` in the robot's axes.
    :return: ``Twist`` in the robot's axes.
    """
    return interpreted(scaled_command)(command, robot.max_speed, robot.max_yaw_rate)


@compiled
def mean_twist(twist: Twist, command: Twist, time_constant: float) -> Twist:
    """
    Mean motion over one time constant while a first-order drive follows a command.

    :param twist: ``Twist`` of the robot now.
    :param command: ``Twist`` that it follows.
    :param time_constant: of the drive [s].
    :return: ``Twist``, to be applied for ``time_constant``.
    """
    if time_constant == 0.0:
        return command
    return Twist(command.v_x + (twist.v_x - command.v_x) * MEAN_DECAY,
                 command.v_y + (twist.v_y - command.v_y) * MEAN_DECAY,
                 command.omega + (twist.omega - command.omega) * MEAN_DECAY)


def contact_speed(elapsed: float, remaining_distance: float, max_speed: float,
                  settings: ControlSettings) -> float:
    """
    Speed of the contact: rises after the start, falls towards the goal.

    :param elapsed: time since the robot set out [s].
    :param remaining_distance: path length of z that is left [m].
    :param max_speed: of the plan [m/s].
    :return: speed [m/s].
    """
    start = settings.start_speed
    braking = math.sqrt(start ** 2 + 2.0 * settings.deceleration * max(0.0, remaining_distance))
    return min(max_speed, start + settings.acceleration * elapsed, braking)
