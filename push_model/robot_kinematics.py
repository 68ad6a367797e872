"""
Kinematics of a robot in contact: robot motion to contact velocity, and back.

``v_C = v_P + omega_p R_p t``. The pushing angle rho is measured from the contact normal; D is the
angle from the robot's heading to the normal. Robot motion is written without division by speed:
rates are per speed of the contact where ``speed`` is left at 1. There numbers and casadi symbols
serve alike.
"""

import math
from typing import Any

from push_model.geometry import Coordinates
from push_model.parameters import Drive
from push_model.trigonometry import cos_and_sin


def yaw_rate(drive: Drive, radius: Any, pushing_angle: Any, heading_offset: Any, object_rate: Any,
             speed: Any = 1.0) -> Any:
    """
    Yaw rate omega_p of a robot whose contact has a given velocity.

    A differential drive has no choice: its speed is ``v = v_c cos(rho) / cos(D)``, and
    ``omega_p = (v_c sin(rho) + v sin(D)) / R_p = v_c sin(rho + D) / (R_p cos(D))``. A holonomic
    robot rotates with the object, so that the contact stays where it is on both.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param radius: R_p [m].
    :param pushing_angle: rho, from the normal to the velocity at the contact [rad].
    :param heading_offset: ``D = gamma - phi`` [rad].
    :param object_rate: the object's yaw rate [rad/s, or rad/m per speed].
    :param speed: v_c, of the contact [m/s, or 1].
    :return: robot yaw rate [rad/s, or rad/m per speed].
    """
    if drive == 'holonomic':
        return object_rate
    _, sine = cos_and_sin(pushing_angle + heading_offset)
    cosine, _ = cos_and_sin(heading_offset)
    return differential_yaw_rate(radius, speed * sine, cosine)


def differential_yaw_rate(radius: Any, across: Any, cosine: Any) -> Any:
    """
    Yaw rate of a differential drive, whose centre cannot move sideways.

    :param radius: R_p [m].
    :param across: velocity of the contact to the left of the robot's heading [m/s].
    :param cosine: of the heading offset D.
    :return: ``v_c sin(rho + D) / (R_p cos(D))`` [rad/s].
    """
    return across / (radius * cosine)


def center_velocity(radius: Any, pushing_angle: Any, robot_rate: Any,
                    speed: Any = 1.0) -> tuple[Any, Any]:
    """
    Velocity of the robot's centre, ``v_P = v_C - omega_p R_p t``.

    :param radius: R_p [m].
    :param pushing_angle: rho, from the normal to the velocity at the contact [rad].
    :param robot_rate: omega_p [rad/s, or rad/m per speed].
    :param speed: v_c, of the contact [m/s, or 1].
    :return: components along n and along t [m/s, or per speed].
    """
    cosine, sine = cos_and_sin(pushing_angle)
    return speed * cosine, speed * sine - robot_rate * radius


def base_velocity(heading_offset: float, robot_radius: float, velocity: Coordinates,
                  yaw_rate: float) -> tuple[float, float]:
    """
    Velocity of the robot's centre from that of its contact, ``v_P = v_C - omega_p R_p t``.

    :param heading_offset: D, from the robot's heading to the contact normal [rad].
    :param robot_radius: R_p [m].
    :param velocity: of the contact (x, y), body axes [m/s].
    :param yaw_rate: omega_p [rad/s].
    :return: (v_x, v_y), body axes [m/s].
    """
    spin = yaw_rate * robot_radius
    return (velocity[0] + spin * math.sin(heading_offset),
            velocity[1] - spin * math.cos(heading_offset))


def contact_velocity(phi: float, gamma: float, robot_radius: float,
                     twist: Coordinates) -> tuple[float, float]:
    """
    Velocity of the robot's material at the contact, ``v_C = v_P + omega_p R_p t``.

    :param phi: robot heading [rad].
    :param gamma: angle of the contact normal in the world [rad].
    :param robot_radius: R_p [m].
    :param twist: robot (v_x, v_y, omega_p), body axes.
    :return: (v_x, v_y), world axes [m/s].
    """
    cosine, sine = math.cos(phi), math.sin(phi)
    spin = twist[2] * robot_radius
    return (cosine * twist[0] - sine * twist[1] - spin * math.sin(gamma),
            sine * twist[0] + cosine * twist[1] + spin * math.cos(gamma))
