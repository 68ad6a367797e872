"""
Limits of rolling: how far a pushed object may be rotated before the contact force leaves the cone.

A rotated object rotates back as it is pushed, and that moves F sideways: the force, which opposes
the friction of the supports, is inclined further out of the cone than the push. So the contact
slides before ``|rho| = atan(mu_c)``.
"""

import dataclasses
import math
from typing import cast

from push_model.contact import contact_point, normal_range
from push_model.friction import friction_weight
from push_model.geometry import Coordinates, Pose
from push_model.parameters import Contact, PushedObject
from push_model.quasi_static import quasi_static_yaw_rate, SMOOTHING_RATIO
from scipy.optimize import brentq
from studies.analysis.pushing_location import PushingLocation
from studies.analysis.stability import equilibrium_at, Tolerance, tolerances

# Rotations are found to this accuracy [rad], radii and face ends to this fraction. Chosen: below
# what a plot shows.
ACCURACY = 1e-6


def rolled_contact(obj: PushedObject, contact: Contact, location: PushingLocation,
                   rotation: float) -> Contact:
    """
    Find the contact after the object has rotated, rolling on a robot that does not rotate.

    :param obj: the ``PushedObject``.
    :param contact: on a face or a round outline, before.
    :param location: the ``PushingLocation`` there.
    :param rotation: of the object [rad].
    :return: ``Contact``.
    """
    travel = location.rolling.effective_radius * rotation
    if contact.kind == 'round':
        return dataclasses.replace(contact, offset=contact.offset - travel / obj.radius)
    return dataclasses.replace(contact, offset=contact.offset + travel)


def quasi_static_force(obj: PushedObject, point: Coordinates, v_x: float,
                       v_y: float) -> tuple[float, float]:
    """
    Force of the robot on an object that it pushes slowly, ``sum q_i v_i / |v_i|`` [N].

    :param obj: the ``PushedObject``.
    :param point: C in the object frame (x, y) [m].
    :param v_x: velocity imposed at C, object frame, x [m/s].
    :param v_y: velocity imposed at C, object frame, y [m/s].
    :return: (x, y) in the object frame.
    """
    omega = quasi_static_yaw_rate(obj, point, v_x, v_y)
    smoothing = SMOOTHING_RATIO * math.hypot(v_x, v_y)
    force_x = force_y = 0.0
    for support, capacity in zip(obj.supports, obj.capacities):
        slide_x = v_x - omega * (support.y - point[1])
        slide_y = v_y + omega * (support.x - point[0])
        weight = friction_weight(capacity, slide_x, slide_y, smoothing)
        force_x, force_y = force_x + weight * slide_x, force_y + weight * slide_y
    return force_x, force_y


def force_tolerances(obj: PushedObject, contact: Contact,
                     location: PushingLocation) -> tuple[Tolerance, ...]:
    """
    Tell how far the object may be rotated and still return, with the force in the cone.

    :param obj: the ``PushedObject``.
    :param contact: on a face or a round outline, at the reference.
    :param location: the ``PushingLocation`` there, whose reference is an equilibrium.
    :return: ``Tolerance`` clockwise and counter-clockwise, as of ``stability.tolerances``.
    """
    cone = math.atan(obj.contact_friction_coefficient)

    def reserve(rotation: float) -> float:
        """Angle that is left between the force and the edge of the cone."""
        now = rolled_contact(obj, contact, location, rotation)
        direction = location.push_direction - rotation
        force = quasi_static_force(obj, contact_point(obj, now), math.cos(direction),
                                   math.sin(direction))
        normal, tangential = Pose(0.0, 0.0, -normal_range(obj, now)[0]).rotate(force)
        return cone - abs(math.atan2(tangential, normal))

    result: list[Tolerance] = []
    for tolerance in tolerances(location, equilibrium_at(location, 0.0),
                                obj.contact_friction_coefficient):
        # Just inside: at the end of a face rounding may put the contact beyond it.
        furthest = tolerance.rotation * (1.0 - ACCURACY)
        if tolerance.rotation and reserve(furthest) < 0.0:
            rotation = cast(float, brentq(reserve, 0.0, furthest, xtol=ACCURACY))
            tolerance = Tolerance(rotation, -location.rolling.normal_ratio * rotation, 'cone')
        result.append(tolerance)
    return tuple(result)


def min_robot_radius(obj: PushedObject, location: PushingLocation) -> float:
    """
    Find the radius above which a robot pushes stably at a location, ``R_e cos(rho) = r``.

    :param obj: the ``PushedObject``.
    :param location: the ``PushingLocation`` there for any robot, its reference an equilibrium.
    :return: R_p [m]; infinite where no robot does, or where rho is outside the cone.
    """
    rho, surface_radius = location.pushing_angle, location.object_radius
    if abs(rho) >= math.atan(obj.contact_friction_coefficient):
        return math.inf
    effective_radius = equilibrium_at(location, 0.0).arm / math.cos(rho)
    if math.isinf(surface_radius):
        return effective_radius
    # R_e stays below R_s: a centre behind the middle of a disc is out of every robot's reach.
    if effective_radius >= surface_radius * (1.0 - ACCURACY):
        return math.inf
    return surface_radius * effective_radius / (surface_radius - effective_radius)
