"""
Pushing location: where an object is pushed straight ahead, and how it rotates there.

The robot moves with constant velocity and does not rotate; the contact rolls. Then the rotation of
the object, theta, is all that changes: the normal rotates by ``lam theta``, the contact travels by
``R_e theta`` along t. Rotation 0 is the reference, where the push makes the pushing angle ``rho``
with the normal.

    rho(theta) = rho_0 - lam theta,    alpha = angle from the line C to F to the push
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_model.analysis.planar import rotated
from push_model.contact import (
    contact_point, curvature_radius, face_length, normal_range, rolling_constants,
    RollingConstants,
)
from push_model.friction import friction_center
from push_model.parameters import Contact, PushedObject


class PushingLocation(NamedTuple):
    """
    Contact of an object and a robot, at the reference.

    :param robot_radius: R_p [m], 0 to infinite.
    :param object_radius: R_s [m], 0 to infinite.
    :param normal_distance: from C to the centre of friction F along the normal n [m].
    :param tangential_distance: the same along t, the normal rotated by +90 degrees [m].
    :param pushing_angle: rho at the reference, from n to the push [rad].
    :param rotation_range: least and greatest rotation of the object before the contact leaves the
        face or vertex [rad].
    :param push_direction: direction of the push at the reference, object frame [rad].
    """

    robot_radius: float
    object_radius: float
    normal_distance: float
    tangential_distance: float = 0.0
    pushing_angle: float = 0.0
    rotation_range: tuple[float, float] = (-math.inf, math.inf)
    push_direction: float = 0.0

    @property
    def rolling(self) -> RollingConstants:
        """The ``RollingConstants`` (lam, R_e [m])."""
        return rolling_constants(self.robot_radius, self.object_radius)

    def rho(self, rotation: Any) -> Any:
        """
        Pushing angle, from the normal to the push [rad].

        :param rotation: of the object from the reference [rad], number or array.
        """
        return self.pushing_angle - self.rolling.normal_ratio * rotation

    def rotation_at(self, rho: Any) -> Any:
        """
        Rotation of the object at which the pushing angle is rho [rad].

        :param rho: pushing angle [rad], number or array.
        :raises ValueError: where the pushing angle does not change (vertex or flat pusher).
        """
        normal_ratio = self.rolling.normal_ratio
        if normal_ratio == 0.0:
            raise ValueError('rho: the normal of a vertex or a flat pusher does not rotate with '
                             'the object, expected a face or two round surfaces')
        return (self.pushing_angle - rho) / normal_ratio

    def friction_center(self, rotation: Any) -> tuple[Any, Any]:
        """
        Position of F from C, in axes along the push and to its left (x, y) [m].

        :param rotation: of the object from the reference [rad], number or array.
        """
        normal_ratio, effective_radius = self.rolling
        normal = normal_ratio * rotation - self.pushing_angle
        if math.isinf(self.object_radius):
            return rotated(normal, self.normal_distance,
                           self.tangential_distance - effective_radius * rotation)
        # The centre of curvature is fixed in the object: R_s from C along the normal.
        radius = self.object_radius
        x, y = rotated(rotation - self.pushing_angle, self.normal_distance - radius,
                       self.tangential_distance)
        return x + radius * np.cos(normal), y + radius * np.sin(normal)

    def alpha(self, rotation: Any) -> Any:
        """
        Angle from the line C to F to the push [rad]; above 0 it rotates the object clockwise.

        :param rotation: of the object from the reference [rad], number or array.
        """
        x, y = self.friction_center(rotation)
        return -np.arctan2(y, x)


def pushing_location(obj: PushedObject, contact: Contact, robot_radius: float,
                     normal: float | None = None, pushing_angle: float = 0.0) -> PushingLocation:
    """
    Find the pushing location of a contact.

    :param obj: the ``PushedObject``.
    :param contact: where it is touched.
    :param robot_radius: R_p [m], 0 to infinite.
    :param normal: angle of n in the object frame, within its range at a vertex [rad]; None for the
        middle of its range.
    :param pushing_angle: from n to the push [rad].
    :return: ``PushingLocation``.
    """
    low, high = normal_range(obj, contact)
    normal = 0.5 * (low + high) if normal is None else normal
    x_f, y_f = friction_center(obj)
    x_c, y_c = contact_point(obj, contact)
    normal_distance, tangential_distance = rotated(-normal, x_f - x_c, y_f - y_c)
    rotation_range = -math.inf, math.inf
    if contact.kind == 'vertex':
        rotation_range = normal - high, normal - low
    elif contact.kind == 'face' and robot_radius > 0.0:
        half = 0.5 * face_length(obj, contact.index)
        rotation_range = ((-half - contact.offset) / robot_radius,
                          (half - contact.offset) / robot_radius)
    return PushingLocation(robot_radius, curvature_radius(obj, contact), float(normal_distance),
                           float(tangential_distance), pushing_angle, rotation_range,
                           normal + pushing_angle)
