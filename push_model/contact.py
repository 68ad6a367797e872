"""
The contact between a round robot and an object: where it is, and how it rolls.

Symbols: n is the unit normal from robot to object, t is n turned by +90 degrees, gamma the world
angle of n.
"""

import math

from push_model.geometry import closest_on_polygon, lowest_vertex, Pose
from push_model.parameters import Contact

VERTEX_TOLERANCE = 1e-3


def rolling_constants(robot_radius, object_radius):
    """
    Share of the object in the turn of the normal, and effective radius.

    ``lam = R_s / (R_p + R_s)``, ``R_e = R_p R_s / (R_p + R_s)``, with their limits for a vertex
    (R_s = 0), a flat face (R_s infinite), a point robot (R_p = 0) and a flat fence (R_p infinite).

    :param robot_radius: R_p, robot's radius of curvature at the contact [m], 0 to infinite.
    :param object_radius: R_s, object's radius of curvature at the contact [m], 0 to infinite.
    :return: (lam [-], R_e [m]).
    :raises ValueError: where both radii are 0 or both infinite, or one is negative.
    """
    for name, value in (('robot_radius', robot_radius), ('object_radius', object_radius)):
        if not value >= 0.0:
            raise ValueError(f'{name}: got {value!r}, expected a radius of at least 0 [m]')
    if robot_radius == object_radius and (robot_radius == 0.0 or math.isinf(robot_radius)):
        raise ValueError(f'robot_radius and object_radius: got {robot_radius} for both, expected '
                         'at least one curved surface')
    if math.isinf(object_radius):
        return 1.0, robot_radius
    if math.isinf(robot_radius):
        return 0.0, object_radius
    total = robot_radius + object_radius
    return object_radius / total, robot_radius * object_radius / total


def curvature_radius(obj, contact):
    """
    Radius of curvature R_s of the object's outline at a contact [m].

    :param obj: the ``PushedObject``.
    :param contact: the ``Contact``.
    """
    return {'vertex': 0.0, 'face': math.inf, 'round': obj.radius}[contact.kind]


def contact_point(obj, contact):
    """
    Contact point C in the object frame, (x, y) [m].

    :param obj: the ``PushedObject``.
    :param contact: the ``Contact``.
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
    along = 0.5 - contact.offset / length
    return x0 + along * (x1 - x0), y0 + along * (y1 - y0)


def normal_range(obj, contact):
    """
    Angles that the normal n can take at a contact, in the object frame.

    :param obj: the ``PushedObject``.
    :param contact: the ``Contact``.
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


def face_normal(obj, index):
    """
    Angle of the inward normal of a face in the object frame [rad].

    :param obj: the ``PushedObject``, with a polygonal outline.
    :param index: number of the face.
    """
    x0, y0 = obj.outline[index % len(obj.outline)]
    x1, y1 = obj.outline[(index + 1) % len(obj.outline)]
    return math.atan2(x1 - x0, y0 - y1)


def face_length(obj, index):
    """
    Length of a face [m].

    :param obj: the ``PushedObject``, with a polygonal outline.
    :param index: number of the face.
    """
    x0, y0 = obj.outline[index % len(obj.outline)]
    x1, y1 = obj.outline[(index + 1) % len(obj.outline)]
    return math.hypot(x1 - x0, y1 - y0)


def find_contact(obj, object_pose, robot_pose, robot_radius):
    """
    Find where a round robot touches the object, or would first touch it.

    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: (x, y) of the robot's centre in the world [m]; a fence needs its ``Pose``.
    :param robot_radius: R_p [m]; infinite for a fence.
    :return: (``Contact``, gamma in the world [rad], gap [m]; the gap is negative on overlap).
    :raises ValueError: for a fence without heading.
    """
    x, y = Pose(*object_pose).inverse().transform(robot_pose[:2])
    if math.isinf(robot_radius):
        if len(robot_pose) < 3:
            raise ValueError(f'robot_pose: got {tuple(robot_pose)}, expected (x, y, theta) of a '
                             'fence')
        return _find_fence_contact(obj, x, y, robot_pose[2] - object_pose[2], robot_pose[2])
    if not obj.outline:
        angle = math.atan2(y, x)
        gap = math.hypot(x, y) - obj.radius - robot_radius
        return Contact('round', 0, angle), object_pose[2] + angle + math.pi, gap
    _, _, nx, ny, signed, face, along = closest_on_polygon(obj.outline, x, y)
    gamma = object_pose[2] + math.atan2(ny, nx)
    length = face_length(obj, face)
    if min(along, 1.0 - along) * length < VERTEX_TOLERANCE:
        index = (face + (along > 0.5)) % len(obj.outline)
        return Contact('vertex', index), gamma, signed - robot_radius
    return Contact('face', face, (0.5 - along) * length), gamma, signed - robot_radius


def contact_velocity(phi, gamma, robot_radius, twist):
    """
    Material velocity that the robot imposes at C, ``v_C = v_P + omega_p R_p t``.

    :param phi: robot heading [rad].
    :param gamma: world angle of the contact normal [rad].
    :param robot_radius: R_p [m].
    :param twist: robot (v_x, v_y, omega_p), body axes.
    :return: (v_x, v_y), world axes [m/s].
    """
    cosine, sine = math.cos(phi), math.sin(phi)
    spin = twist[2] * robot_radius
    return (cosine * twist[0] - sine * twist[1] - spin * math.sin(gamma),
            sine * twist[0] + cosine * twist[1] + spin * math.cos(gamma))


def _find_fence_contact(obj, x, y, local, heading):
    n_x, n_y = math.cos(local), math.sin(local)
    contact = Contact('round', 0, local + math.pi)
    if obj.outline:
        contact = Contact('vertex', lowest_vertex(obj.outline, n_x, n_y))
    c_x, c_y = contact_point(obj, contact)
    return contact, heading, n_x * (c_x - x) + n_y * (c_y - y)


def _check_feature(obj, contact):
    if (contact.kind == 'round') != (not obj.outline):
        shape = 'a polygon' if obj.outline else 'a disc'
        raise ValueError(f'Contact.kind: got {contact.kind!r}, expected a feature of {shape}')
    if obj.outline and contact.index >= len(obj.outline):
        raise ValueError(f'Contact.index: got {contact.index}, expected 0 to '
                         f'{len(obj.outline) - 1}')
    if contact.kind == 'face' and abs(contact.offset) > face_length(obj, contact.index) / 2:
        raise ValueError(f'Contact.offset: got {contact.offset:g} m, expected at most half the '
                         f'face, {face_length(obj, contact.index) / 2:g} m')
