"""
Discs whose contact is slippery: what their primitives and their cost-to-go are made for.

Without contact friction every push on a disc goes through its middle O, and only its centre of
friction turns it, which trails behind: on the path of O, the direction psi from O to that centre
follows the direction phi of motion by

    d psi / d s = (p / c^2) sin(psi - phi)

with its distance p and the radius of gyration c of the supports. Pushed there and back, the disc
turns there and back; only going round turns it for good. A cost-to-go that counts on contact
friction repeats pushes that do not turn it.

The table is made for the centre of friction as it is known, rounded. The cost-to-go, which takes
longer, is made for supports in a ring, which turn alike in all directions: so one for each
distance p will do, and is rotated to where the centre of friction is.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_model.friction import with_friction_center
from push_model.parameters import PushedObject, Support
from push_primitives.cost_to_go import CostToGo
from push_primitives.weights import FrictionBelief

# Contact friction up to which a disc is slippery, and the deviation up to which that is known;
# chosen: above it the contact turns a disc by more than its centre of friction.
SLIPPERY_FRICTION = 0.125
FRICTION_DEVIATION = 0.06
# Steps to which contact friction and centre of friction [m] are rounded for the table; chosen:
# about what a few pushes leave unknown.
FRICTION_STEP = 0.05
CENTER_STEP = 0.004
# Distances of the centre of friction from the middle over the radius, the ratio from one to the
# next, and the supports in a ring, for the cost-to-go; chosen: nearer to the middle hardly
# anything turns the disc, and in between it turns up to 20 % faster or slower.
MIN_DISTANCE = 0.02
MAX_DISTANCE = 0.23
DISTANCE_RATIO = math.sqrt(2.0)
RING_SUPPORTS = 12
# Step to which its direction is rounded [rad]; chosen: less than is known of it.
DIRECTION_STEP = math.radians(2.0)


class SlipperyDisc(NamedTuple):
    """
    Knowledge of a slippery disc, rounded.

    :param obj: ``PushedObject`` with the friction that is known.
    :param ring: the same on a ring of supports, with the centre of friction on the x axis.
    :param direction: of the centre of friction in the object frame [rad].
    """

    obj: PushedObject
    ring: PushedObject
    direction: float


def slippery_disc(obj: PushedObject, belief: FrictionBelief) -> SlipperyDisc | None:
    """
    Round what is known of a slippery disc.

    :param obj: the ``PushedObject``, with common values of friction.
    :param belief: what is known of friction.
    :return: ``SlipperyDisc``; None for objects that the contact turns.
    """
    if (obj.radius == 0.0 or belief.contact_friction > SLIPPERY_FRICTION
            or belief.contact_friction_deviation > FRICTION_DEVIATION):
        return None
    center_x, center_y = belief.center
    friction = _rounded(belief.contact_friction, FRICTION_STEP)
    obj = dataclasses.replace(obj, contact_friction_coefficient=friction)
    ratio = math.hypot(center_x, center_y) / (obj.radius * MIN_DISTANCE)
    steps = round(math.log(max(1.0, ratio)) / math.log(DISTANCE_RATIO))
    distance = min(MAX_DISTANCE, MIN_DISTANCE * DISTANCE_RATIO ** steps) * obj.radius
    known_center = _rounded(center_x, CENTER_STEP), _rounded(center_y, CENTER_STEP)
    return SlipperyDisc(with_friction_center(obj, known_center),
                        with_friction_center(_on_ring(obj), (distance, 0.0)),
                        _rounded(math.atan2(center_y, center_x), DIRECTION_STEP))


def rotated(cost_to_go: CostToGo, angle: float) -> CostToGo:
    """
    Rotate the cost-to-go of a disc; linear between the bearings of its grid.

    :param angle: counter-clockwise [rad].
    """
    values = cost_to_go.values
    faces, bearings = values.shape[0], values.shape[2]
    values = np.roll(values, round(angle * faces / math.tau), axis=0)
    steps = angle * bearings / math.tau
    whole = math.floor(steps)
    fraction = steps - whole
    values = ((1.0 - fraction) * np.roll(values, whole, axis=2)
              + fraction * np.roll(values, whole + 1, axis=2))
    return dataclasses.replace(cost_to_go, values=values.astype(cost_to_go.values.dtype))


def _on_ring(obj: PushedObject) -> PushedObject:
    """Put an object on equal supports in a ring, with the same radius of gyration."""
    squared = [support.x ** 2 + support.y ** 2 for support in obj.supports]
    radius = math.sqrt(sum(squared) / len(squared))
    angles = (math.tau * index / RING_SUPPORTS for index in range(RING_SUPPORTS))
    friction = obj.supports[0].friction_coefficient
    return dataclasses.replace(obj, supports=tuple(
        Support(radius * math.cos(angle), radius * math.sin(angle), friction)
        for angle in angles))


def _rounded(value: float, step: float) -> float:
    # Without the sign of a zero, which would be another object.
    return step * round(value / step) + 0.0
