"""Places round the perimeter of an object, where a robot pushes straight through F."""

import math
from typing import NamedTuple

from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.stability import equilibrium_at
from push_model.contact import contact_point, face_length, normal_range
from push_model.friction import friction_center
from push_model.geometry import wrap_angle
from push_model.parameters import Contact


class Place(NamedTuple):
    """
    A stretch of the outline, pushed in its middle.

    :param contact: the ``Contact`` in the middle.
    :param along: way of the middle along the outline, counter-clockwise from vertex 0, or on a
        disc from the x axis [m].
    :param length: of the stretch [m].
    """

    contact: Contact
    along: float
    length: float


def places(obj, count):
    """
    Divide the perimeter of an object, each face by itself.

    :param obj: the ``PushedObject``.
    :param count: number of places, about; every face has at least one.
    :return: list of ``Place``, counter-clockwise.
    """
    if not obj.outline:
        step = 2.0 * math.pi / count
        return [Place(Contact('round', 0, (i + 0.5) * step), (i + 0.5) * step * obj.radius,
                      step * obj.radius) for i in range(count)]
    lengths = [face_length(obj, face) for face in range(len(obj.outline))]
    result, begin = [], 0.0
    for face, length in enumerate(lengths):
        parts = max(1, round(count * length / sum(lengths)))
        for i in range(parts):
            along = (i + 0.5) / parts * length
            result.append(Place(Contact('face', face, 0.5 * length - along), begin + along,
                                length / parts))
        begin += length
    return result


def ends(obj, place):
    """
    Points of the outline between which a place lies, object frame.

    :param obj: the ``PushedObject``.
    :param place: one of its ``places``.
    :return: ((x, y), (x, y)) [m], counter-clockwise.
    """
    contact, half = place.contact, 0.5 * place.length
    if contact.kind == 'round':
        angles = [contact.offset + side * half / obj.radius for side in (-1.0, 1.0)]
        return tuple((obj.radius * math.cos(angle), obj.radius * math.sin(angle))
                     for angle in angles)
    x, y = contact_point(obj, contact)
    along = normal_range(obj, contact)[0] - 0.5 * math.pi
    step = half * math.cos(along), half * math.sin(along)
    return (x - step[0], y - step[1]), (x + step[0], y + step[1])


def push_through_center(obj, contact, robot_radius):
    """
    Find the pushing location of a push from a contact straight through the friction centre.

    :param obj: the ``PushedObject``.
    :param contact: where it is touched, on a face or a round outline.
    :param robot_radius: of the robot [m].
    :return: ``PushingLocation``; its reference, turn 0, is an equilibrium. Where F is not ahead of
        the contact, the pushing angle is 90 degrees or more.
    """
    x_c, y_c = contact_point(obj, contact)
    x_f, y_f = friction_center(obj)
    normal = normal_range(obj, contact)[0]
    rho = wrap_angle(math.atan2(y_f - y_c, x_f - x_c) - normal)
    return pushing_location(obj, contact, robot_radius, normal, rho)


def is_stable(obj, contact, robot_radius):
    """
    Tell whether an object that is slightly turned returns, by ``h < R_e cos(rho)`` and the cone.

    :param obj: the ``PushedObject``.
    :param contact: where it is touched, on a face or a round outline.
    :param robot_radius: of the robot [m].
    """
    location = push_through_center(obj, contact, robot_radius)
    cone = math.atan(obj.contact_friction_coefficient)
    return (abs(location.pushing_angle) < cone
            and equilibrium_at(location, 0.0).is_stable)


def borders(obj, robot_radius, count):
    """
    Find where stable stretches begin and end.

    :param obj: the ``PushedObject``.
    :param robot_radius: of the robot [m].
    :param count: number of places to look at.
    :return: (share of the perimeter that is stable, list of points (x, y) [m] of the outline).
    """
    fine = places(obj, count)
    stable = [is_stable(obj, place.contact, robot_radius) for place in fine]
    share = (sum(place.length for place, yes in zip(fine, stable) if yes)
             / sum(place.length for place in fine))
    return share, [ends(obj, place)[0] for i, place in enumerate(fine)
                   if stable[i] != stable[i - 1]]
