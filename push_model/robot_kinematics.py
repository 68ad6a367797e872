"""
What the robot must do to give the contact a wanted velocity, by drive.

Written without division by speed: rates are per speed of the contact where ``speed`` is left at
1. Numbers and casadi symbols serve alike.
"""

import casadi as ca


def yaw_rate(drive, radius, pushing_angle, heading_offset, object_rate, speed=1.0):
    """
    Yaw rate omega_p of the robot.

    A differential drive has no choice: ``v = v_c cos b / cos d`` and
    ``omega_p = (v_c sin b + v sin d) / R_p``. A holonomic robot turns with the object, so that the
    contact stays where it is on both.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param radius: R_p [m].
    :param pushing_angle: b, from the normal to the velocity at the contact [rad].
    :param heading_offset: d = gamma - phi [rad].
    :param object_rate: the object's yaw rate [rad/s, or rad/m per speed].
    :param speed: v_c, of the contact [m/s, or 1].
    :return: robot yaw rate [rad/s, or rad/m per speed].
    """
    if drive == 'holonomic':
        return object_rate
    return speed * ca.sin(pushing_angle + heading_offset) / (radius * ca.cos(heading_offset))


def center_velocity(radius, pushing_angle, robot_rate, speed=1.0):
    """
    Velocity of the robot's centre, ``v_P = v_C - omega_p R_p t``.

    :param radius: R_p [m].
    :param pushing_angle: b, from the normal to the velocity at the contact [rad].
    :param robot_rate: omega_p [rad/s, or rad/m per speed].
    :param speed: v_c, of the contact [m/s, or 1].
    :return: components along n and along t [m/s, or per speed].
    """
    return speed * ca.cos(pushing_angle), speed * ca.sin(pushing_angle) - robot_rate * radius
