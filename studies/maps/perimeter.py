"""Locations round the perimeter of an object, where a robot pushes through the friction centre."""

import math
from typing import NamedTuple

from push_model.contact import contact_point, face_length, normal_range
from push_model.friction import friction_center
from push_model.geometry import wrap_angle
from push_model.parameters import Contact, PushedObject
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.analysis.stability import equilibrium_at

Point = tuple[float, float]


class PerimeterLocation(NamedTuple):
    """
    A section of the outline, pushed in its middle.

    :param contact: in the middle of the section.
    :param s: arc length of the middle along the outline, counter-clockwise from vertex 0, or on a
        disc from the x axis [m].
    :param length: of the section [m].
    """

    contact: Contact
    s: float
    length: float


class Borders(NamedTuple):
    """
    Ends of the stable part of a perimeter.

    :param stable_fraction: of the perimeter.
    :param points: (x, y) on the outline, object frame [m].
    """

    stable_fraction: float
    points: list[Point]


def perimeter_locations(obj: PushedObject, count: int) -> list[PerimeterLocation]:
    """
    Divide the perimeter of an object, each face by itself.

    :param obj: the object.
    :param count: approximate number of locations; every face has at least one.
    :return: locations, counter-clockwise.
    """
    if not obj.outline:
        step = 2.0 * math.pi / count
        return [PerimeterLocation(Contact('round', 0, (i + 0.5) * step),
                                  (i + 0.5) * step * obj.radius, step * obj.radius)
                for i in range(count)]
    lengths = [face_length(obj, face) for face in range(len(obj.outline))]
    locations: list[PerimeterLocation] = []
    start = 0.0
    for face, length in enumerate(lengths):
        sections = max(1, round(count * length / sum(lengths)))
        for i in range(sections):
            along = (i + 0.5) / sections * length
            locations.append(PerimeterLocation(Contact('face', face, 0.5 * length - along),
                                               start + along, length / sections))
        start += length
    return locations


def section_ends(obj: PushedObject, location: PerimeterLocation) -> tuple[Point, Point]:
    """
    Find the points of the outline between which the section of a location lies.

    :param obj: the object.
    :param location: one of its locations.
    :return: both points (x, y), object frame, counter-clockwise [m].
    """
    contact, half = location.contact, 0.5 * location.length
    if contact.kind == 'round':
        first, second = (contact.offset + side * half / obj.radius for side in (-1.0, 1.0))
        return ((obj.radius * math.cos(first), obj.radius * math.sin(first)),
                (obj.radius * math.cos(second), obj.radius * math.sin(second)))
    x, y = contact_point(obj, contact)
    along = normal_range(obj, contact)[0] - 0.5 * math.pi
    step_x, step_y = half * math.cos(along), half * math.sin(along)
    return (x - step_x, y - step_y), (x + step_x, y + step_y)


def push_through_center(obj: PushedObject, contact: Contact,
                        robot_radius: float) -> PushingLocation:
    """
    Find the pushing location of a push from a contact through the centre of friction.

    :param obj: the object.
    :param contact: on a face or a round outline.
    :param robot_radius: of the robot [m].
    :return: pushing location; its reference, rotation 0, is an equilibrium. Where F is not ahead
        of the contact, the pushing angle is 90 degrees or more.
    """
    x_c, y_c = contact_point(obj, contact)
    x_f, y_f = friction_center(obj)
    normal = normal_range(obj, contact)[0]
    rho = wrap_angle(math.atan2(y_f - y_c, x_f - x_c) - normal)
    return pushing_location(obj, contact, robot_radius, normal, rho)


def is_stable(obj: PushedObject, contact: Contact, robot_radius: float) -> bool:
    """
    Decide whether a slightly rotated object returns: ``r < R_e cos(rho)``, within the cone.

    :param obj: the object.
    :param contact: on a face or a round outline.
    :param robot_radius: of the robot [m].
    :return: whether the push through the centre of friction is stable.
    """
    location = push_through_center(obj, contact, robot_radius)
    cone = math.atan(obj.contact_friction_coefficient)
    return abs(location.pushing_angle) < cone and equilibrium_at(location, 0.0).is_stable


def stable_borders(obj: PushedObject, robot_radius: float, count: int) -> Borders:
    """
    Find where the stable part of the perimeter begins and ends.

    :param obj: the object.
    :param robot_radius: of the robot [m].
    :param count: number of locations to evaluate.
    :return: its borders.
    """
    locations = perimeter_locations(obj, count)
    stable = [is_stable(obj, location.contact, robot_radius) for location in locations]
    fraction = (sum(location.length for location, holds in zip(locations, stable) if holds)
                / sum(location.length for location in locations))
    return Borders(fraction, [section_ends(obj, location)[0]
                              for i, location in enumerate(locations)
                              if stable[i] != stable[i - 1]])
