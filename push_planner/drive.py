"""How the robot turns while it gives the contact a wanted velocity, by drive."""

import casadi as ca


def yaw_rate(drive, radius, pushing_angle, heading_offset, object_rate):
    """
    Yaw rate of the robot per speed of the contact.

    A differential drive has no choice: ``v = v_c cos b / cos d`` and
    ``omega_p = (v_c sin b + v sin d) / R_p``. A holonomic robot turns with the object, so that the
    contact stays where it is on both.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param radius: R_p [m].
    :param pushing_angle: b, from the normal to the velocity at the contact [rad].
    :param heading_offset: d = gamma - phi [rad].
    :param object_rate: the object's yaw rate per speed of the contact [rad/m].
    :return: robot yaw rate per speed of the contact [rad/m]; casadi symbols pass through.
    """
    if drive == 'holonomic':
        return object_rate
    return ca.sin(pushing_angle + heading_offset) / (radius * ca.cos(heading_offset))


def center_velocity(radius, pushing_angle, robot_rate):
    """
    Velocity of the robot's centre per speed of the contact, ``v_P = v_C - omega_p R_p t``.

    :param radius: R_p [m].
    :param pushing_angle: from the normal to the velocity at the contact [rad].
    :param robot_rate: robot yaw rate per speed of the contact [rad/m].
    :return: components along n and along t [-].
    """
    return ca.cos(pushing_angle), ca.sin(pushing_angle) - robot_rate * radius
