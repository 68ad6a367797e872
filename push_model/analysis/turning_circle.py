"""
Circle on which an object goes round while its velocity stays the same in its own frame.

With the velocity v at the contact C and the turning rate omega, both constant in the object
frame, one point K of the object stands still: ``K = C + k x v / omega``.
"""

import math

from push_model.geometry import Pose


def rotation_center(contact_point, direction, speed, omega):
    """
    Find the point about which the object turns, in the object frame (x, y) [m].

    :param contact_point: C in the object frame (x, y) [m].
    :param direction: of the velocity at C, in the object frame [rad].
    :param speed: of the contact [m/s].
    :param omega: turning rate [rad/s], not 0.
    :raises ValueError: for a turning rate of 0, which has no such point.
    """
    if omega == 0.0:
        raise ValueError('omega: got 0, expected a turning rate: straight motion has no centre')
    return (contact_point[0] - speed * math.sin(direction) / omega,
            contact_point[1] + speed * math.cos(direction) / omega)


def rotated_about(center, angle):
    """
    Pose of an object that was at the world's origin and turned about a point of its own.

    :param center: the point, in the object frame and at the start in the world (x, y) [m].
    :param angle: of the turn [rad].
    :return: ``Pose``.
    """
    x, y = center
    return Pose(x, y, angle) @ Pose(-x, -y, 0.0)
