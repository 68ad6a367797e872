"""
Contact between a round robot and an object: where it is, and how it rolls.

Symbols: n is the unit normal from robot to object, t is n rotated by +90 degrees, gamma the angle
of n in the world.
"""

import math
from typing import Any, NamedTuple

from push_model.geometry import boundary_point, Coordinates, lowest_vertex, Pose
from push_model.parameters import Contact, PushedObject

# Chosen: a contact this near to a vertex [m] counts as one at the vertex. Far below what a
# localization resolves, far above rounding.
VERTEX_TOLERANCE = 1e-3


class RollingConstants(NamedTuple):
    """
    Constants of the motion of normal and contact under rotation: numbers, or casadi symbols.

    :param normal_ratio: ``lam = R_s / (R_p + R_s)``, fraction of the object's rotation that the
        normal takes part in [-]; it follows the robot's rotation with ``1 - lam``.
    :param effective_radius: ``R_e = R_p R_s / (R_p + R_s)``, travel of the contact per relative
        rotation [m].
    """

    normal_ratio: Any
    effective_radius: Any


class NearestContact(NamedTuple):
    """
    Point at which a robot touches an object, or would touch it first.

    :param contact: the ``Contact``.
    :param gamma: angle of the normal in the world [rad].
    :param gap: distance between robot and object, negative on overlap [m].
    """

    contact: Contact
    gamma: float
    gap: float


def rolling_constants(robot_radius: float, object_radius: float) -> RollingConstants:
    """
    Find the rolling constants of two surfaces.

    They have limits for a vertex (R_s = 0), a flat face (R_s infinite), a point robot (R_p = 0)
    and a flat pusher (R_p infinite).

    :param robot_radius: R_p, robot's radius of curvature at the contact [m], 0 to infinite.
    :param object_radius: R_s, object's radius of curvature at the contact [m], 0 to infinite.
    :raises ValueError: where both radii are 0 or both infinite, or one is negative.
    """
    for name, value in (('robot_radius', robot_radius), ('object_radius', object_radius)):
        if not value >= 0.0:
            raise ValueError(f'{name}: got {value!r}, expected a radius of at least 0 [m]')
    if robot_radius == object_radius and (robot_radius == 0.0 or math.isinf(robot_radius)):
        raise ValueError(f'robot_radius and object_radius: got {robot_radius} for both, expected '
                         'at least one curved surface')
    if math.isinf(object_radius):
        return RollingConstants(1.0, robot_radius)
    if math.isinf(robot_radius):
        return RollingConstants(0.0, object_radius)
    total = robot_radius + object_radius
    return RollingConstants(object_radius / total, robot_radius * object_radius / total)


def curvature_radius(obj: PushedObject, contact: Contact) -> float:
    """Radius of curvature R_s of the object's outline at a contact [m]."""
    return {'vertex': 0.0, 'face': math.inf, 'round': obj.radius}[contact.kind]


def contact_point(obj: PushedObject, contact: Contact) -> tuple[float, float]:
    """
    Contact point C in the object frame, (x, y) [m].

    :raises ValueError: where the outline has no such feature.
    """
    _check_feature(obj, contact)
    if contact.kind == 'round':
        return obj.radius * math.cos(contact.offset), obj.radius * math.sin(contact.offset)
    x0, y0 = obj.outline[contact.index]
    if contact.kind == 'vertex':
        return x0, y0
    x1, y1 = obj.outline[(contact.index + 1) % len(obj.outline)]
    length = math.hypot(x1 - x0, y1 - y0)
    fraction = 0.5 - contact.offset / length
    return x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0)


def normal_range(obj: PushedObject, contact: Contact) -> tuple[float, float]:
    """
    Angles that the normal n can have at a contact, in the object frame.

    :return: (lowest, highest) angle of n [rad], highest - lowest in [0, pi]; equal except at a
        vertex.
    :raises ValueError: where the outline has no such feature.
    """
    _check_feature(obj, contact)
    if contact.kind == 'round':
        return contact.offset + math.pi, contact.offset + math.pi
    high = face_normal(obj, contact.index)
    if contact.kind == 'face':
        return high, high
    low = face_normal(obj, contact.index - 1)
    return low, low + (high - low) % (2 * math.pi)


def face_normal(obj: PushedObject, index: int) -> float:
    """
    Angle of the inward normal of a face in the object frame [rad].

    :param obj: the ``PushedObject``, with a polygonal outline.
    :param index: number of the face.
    """
    x0, y0 = obj.outline[index % len(obj.outline)]
    x1, y1 = obj.outline[(index + 1) % len(obj.outline)]
    return math.atan2(x1 - x0, y0 - y1)


def face_length(obj: PushedObject, index: int) -> float:
    """
    Length of a face [m].

    :param obj: the ``PushedObject``, with a polygonal outline.
    :param index: number of the face.
    """
    x0, y0 = obj.outline[index % len(obj.outline)]
    x1, y1 = obj.outline[(index + 1) % len(obj.outline)]
    return math.hypot(x1 - x0, y1 - y0)


def find_contact(obj: PushedObject, object_pose: Coordinates, robot_pose: Coordinates,
                 robot_radius: float) -> NearestContact:
    """
    Find where a round robot touches the object, or would touch it first.

    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: (x, y) of the robot's centre in the world [m]; a flat pusher needs its
        ``Pose``.
    :param robot_radius: R_p [m]; infinite for a flat pusher.
    :raises ValueError: for a flat pusher without heading.
    """
    object_pose = Pose(*object_pose)
    x, y = object_pose.inverse().transform(robot_pose[:2])
    if math.isinf(robot_radius):
        if len(robot_pose) < 3:
            raise ValueError(f'robot_pose: got {tuple(robot_pose)}, expected (x, y, theta) of a '
                             'flat pusher')
        pusher = Pose(x, y, robot_pose[2] - object_pose.theta)
        contact, gap = _find_flat_pusher_contact(obj, pusher)
        return NearestContact(contact, robot_pose[2], gap)
    if not obj.outline:
        angle = math.atan2(y, x)
        gap = math.hypot(x, y) - obj.radius - robot_radius
        return NearestContact(Contact('round', 0, angle), object_pose.theta + angle + math.pi, gap)
    closest = boundary_point(obj.outline, x, y)
    gamma = object_pose.theta + math.atan2(closest.normal_y, closest.normal_x)
    gap = closest.signed_distance - robot_radius
    length = face_length(obj, closest.face)
    if min(closest.fraction, 1.0 - closest.fraction) * length < VERTEX_TOLERANCE:
        at_end = closest.fraction > 0.5
        index = (closest.face + 1 if at_end else closest.face) % len(obj.outline)
        return NearestContact(Contact('vertex', index), gamma, gap)
    offset = (0.5 - closest.fraction) * length
    return NearestContact(Contact('face', closest.face, offset), gamma, gap)


def robot_gap(obj: PushedObject, object_pose: Coordinates, robot_pose: Coordinates,
              robot_radius: float) -> float:
    """
    Distance between a round robot and the object, negative on overlap [m].

    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: (x, y) of the robot's centre in the world [m]; a flat pusher needs its
        ``Pose``.
    :param robot_radius: R_p [m]; infinite for a flat pusher.
    :raises ValueError: for a flat pusher without heading.
    """
    if math.isinf(robot_radius):
        return find_contact(obj, object_pose, robot_pose, robot_radius).gap
    x, y = Pose(*object_pose).inverse().transform(robot_pose[:2])
    if not obj.outline:
        return math.hypot(x, y) - obj.radius - robot_radius
    return boundary_point(obj.outline, x, y).signed_distance - robot_radius


def _find_flat_pusher_contact(obj: PushedObject, pusher: Pose) -> tuple[Contact, float]:
    """Contact and gap of a flat pusher that faces along its heading, in the object frame."""
    n_x, n_y = math.cos(pusher.theta), math.sin(pusher.theta)
    contact = Contact('round', 0, pusher.theta + math.pi)
    if obj.outline:
        contact = Contact('vertex', lowest_vertex(obj.outline, n_x, n_y))
    c_x, c_y = contact_point(obj, contact)
    return contact, n_x * (c_x - pusher.x) + n_y * (c_y - pusher.y)


def _check_feature(obj: PushedObject, contact: Contact) -> None:
    if (contact.kind == 'round') != (not obj.outline):
        shape = 'a polygon' if obj.outline else 'a disc'
        raise ValueError(f'Contact.kind: got {contact.kind!r}, expected a feature of {shape}')
    if obj.outline and contact.index >= len(obj.outline):
        raise ValueError(f'Contact.index: got {contact.index}, expected 0 to '
                         f'{len(obj.outline) - 1}')
    if contact.kind == 'face' and abs(contact.offset) > face_length(obj, contact.index) / 2:
        raise ValueError(f'Contact.offset: got {contact.offset:g} m, expected at most half the '
                         f'face, {face_length(obj, contact.index) / 2:g} m')
