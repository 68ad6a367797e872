"""
What a push may do when nobody knows how the supports share the weight.

Statics gives three equations, so that more than three supports leave the loads open: a stiff
object on a real floor stands on three of them, and four feet rock on a diagonal. All loads that do
not pull and balance the weight about the mass centre form a convex set. Its corners, the basic
solutions of that linear program, are the object on three of its supports each.
"""

import dataclasses
import itertools
from typing import NamedTuple

from push_model.geometry import Coordinates
from push_model.parameters import PushedObject
from push_model.quasi_static import Vehicle, vehicle


class Interval(NamedTuple):
    """Least and greatest value."""

    low: float
    high: float


class UnknownLoads(NamedTuple):
    """
    Ranges of the vehicle of a push over unknown loads.

    :param wheelbase: L [m].
    :param c_squared: c^2 [m^2].
    :param center_x: centre of friction in the object frame, x [m].
    :param center_y: the same, y [m].
    """

    wheelbase: Interval
    c_squared: Interval
    center_x: Interval
    center_y: Interval


def extreme_objects(obj: PushedObject) -> tuple[PushedObject, ...]:
    """
    List the object as it stands on few supports: the corners of all loads that balance it.

    :param obj: the ``PushedObject``.
    :return: ``PushedObject`` on up to three supports each; the object itself where it has no more.
    """
    if len(obj.supports) <= 3:
        return (obj,)
    objects: list[PushedObject] = []
    for supports in itertools.combinations(obj.supports, 3):
        try:
            objects.append(dataclasses.replace(obj, supports=tuple(
                dataclasses.replace(support, load_fraction=0.0) for support in supports)))
        except ValueError:
            # The mass centre lies outside of this triangle.
            continue
    return tuple(objects)


def unknown_loads(obj: PushedObject, contact_point: Coordinates) -> UnknownLoads:
    """
    Find the ranges of a push's vehicle over all loads that balance the object.

    For supports of one friction coefficient the centre of friction stays below the mass centre, L
    and c^2 are linear in the loads, and the corners are exact bounds. Where coefficients differ,
    that of supports at twice that of others, L may leave them by some centimetres.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :return: ``UnknownLoads``.
    """
    views = [vehicle(one, contact_point) for one in (obj, *extreme_objects(obj))]
    centers = [_center(view) for view in views]
    return UnknownLoads(
        _interval([view.wheelbase for view in views]),
        _interval([view.c_squared for view in views]),
        _interval([x for x, _ in centers]), _interval([y for _, y in centers]))


def _interval(values: list[float]) -> Interval:
    return Interval(min(values), max(values))


def _center(view: Vehicle) -> tuple[float, float]:
    """Centre of friction of a vehicle: at the distance r from C towards z."""
    fraction = view.arm / view.wheelbase
    (c_x, c_y), (z_x, z_y) = view.contact_point, view.flat_output
    return c_x + fraction * (z_x - c_x), c_y + fraction * (z_y - c_y)
