"""
A place where an object is pushed straight ahead, and how it turns there while it rolls.

The robot moves with constant velocity and does not spin. Then the turn of the object, theta, is
all that changes: the normal turns by ``lam theta``, the contact travels by ``R_e theta`` along t.
Turn 0 is the reference, where the push makes the pushing angle ``rho`` with the normal.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.contact import (
    contact_point, curvature_radius, face_length, normal_range, rolling_constants,
)
from push_model.friction import friction_center


class PushingLocation(NamedTuple):
    """
    Contact of an object and a robot, at the reference.

    :param robot_radius: R_p [m], 0 to infinite.
    :param object_radius: R_s [m], 0 to infinite.
    :param ahead: distance from C to the friction centre F along the normal n [m].
    :param aside: the same along t, the normal turned by +90 degrees [m].
    :param pushing_angle: rho at the reference, from n to the push [rad].
    :param turns: least and greatest turn of the object before the contact leaves the face or
        vertex [rad].
    :param forward: direction of the push at the reference, object frame [rad].
    """

    robot_radius: float
    object_radius: float
    ahead: float
    aside: float = 0.0
    pushing_angle: float = 0.0
    turns: tuple = (-math.inf, math.inf)
    forward: float = 0.0

    @property
    def rolling(self):
        """The pair (lam, R_e [m])."""
        return rolling_constants(self.robot_radius, self.object_radius)

    def rho(self, turn):
        """
        Pushing angle, from the normal to the push [rad].

        :param turn: of the object from the reference [rad], number or array.
        """
        return self.pushing_angle - self.rolling[0] * turn

    def rotation_at(self, rho):
        """
        Turn of the object at which the pushing angle is rho [rad].

        :param rho: pushing angle [rad], number or array.
        :raises ValueError: where the pushing angle does not change (vertex or fence).
        """
        share = self.rolling[0]
        if share == 0.0:
            raise ValueError('rho: the normal of a vertex or a fence does not turn with the '
                             'object, expected a face or two round surfaces')
        return (self.pushing_angle - rho) / share

    def friction_center(self, turn):
        """
        Place of F from C, in axes along the push and to its left (x, y) [m].

        :param turn: of the object from the reference [rad], number or array.
        """
        share, effective = self.rolling
        normal = share * turn - self.pushing_angle
        if math.isinf(self.object_radius):
            return _rotated(normal, self.ahead, self.aside - effective * turn)
        # The centre of curvature is fixed in the object: R_s ahead of C along the normal.
        radius = self.object_radius
        x, y = _rotated(turn - self.pushing_angle, self.ahead - radius, self.aside)
        return x + radius * np.cos(normal), y + radius * np.sin(normal)

    def alpha(self, turn):
        """
        Angle from the line C to F to the push [rad]; above 0 it turns the object clockwise.

        :param turn: of the object from the reference [rad], number or array.
        """
        x, y = self.friction_center(turn)
        return -np.arctan2(y, x)


def pushing_location(obj, contact, robot_radius, normal=None, pushing_angle=0.0):
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
    ahead, aside = _rotated(-normal, x_f - x_c, y_f - y_c)
    turns = -math.inf, math.inf
    if contact.kind == 'vertex':
        turns = normal - high, normal - low
    elif contact.kind == 'face' and robot_radius > 0.0:
        half = 0.5 * face_length(obj, contact.index)
        turns = (-half - contact.offset) / robot_radius, (half - contact.offset) / robot_radius
    return PushingLocation(robot_radius, curvature_radius(obj, contact), float(ahead),
                           float(aside), pushing_angle, turns, normal + pushing_angle)


def _rotated(angle, x, y):
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
