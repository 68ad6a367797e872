"""Which way an object turns in a straight push whose contact may slide."""

import math

import numpy as np


def force_alpha(location, turn, contact_friction):
    """
    Angle from the line C to F to what decides the sense of rotation.

    The push and the edges of the friction cone vote, each by the side on which it passes F
    (M. T. Mason, Mechanics and planning of manipulator pushing operations, 1986): the middle one
    of the three decides. That is the push itself while it lies inside the cone, where it is at
    angle alpha; else the nearer edge. With rho the pushing angle,

        alpha - (rho - clip(rho, -atan(mu_c), atan(mu_c)))

    :param location: ``PushingLocation``.
    :param turn: of the object from the reference [rad], number or array.
    :param contact_friction: mu_c, 0 to infinite.
    :return: angle [rad]; above 0 the object turns clockwise, without regard to inertia.
    """
    rho, cone = location.rho(turn), math.atan(contact_friction)
    return location.alpha(turn) - (rho - np.clip(rho, -cone, cone))
