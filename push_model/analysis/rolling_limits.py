"""
How far a pushed object may be turned before the contact force, not rho, leaves the cone.

A turned object turns back as it is pushed, and that turn moves F sideways: the force, which
opposes the friction of the supports, is inclined further out of the cone than the push. So the
contact slides before ``|rho| = atan(mu_c)``.
"""

import dataclasses
import math

from push_model.analysis.stability import equilibrium_at, Tolerance, tolerances
from push_model.contact import contact_point, normal_range
from push_model.friction import friction_weight
from push_model.geometry import Pose
from push_model.quasi_static import quasi_static_yaw_rate
from scipy.optimize import brentq

ACCURACY = 1e-6
SMOOTHING = 1e-9


def rolled_contact(obj, contact, location, turn):
    """
    Find the contact after the object has turned while it rolls on a robot that does not spin.

    :param obj: the ``PushedObject``.
    :param contact: on a face or a round outline, before.
    :param location: the ``PushingLocation`` there.
    :param turn: of the object [rad].
    :return: ``Contact``.
    """
    travel = location.rolling[1] * turn
    if contact.kind == 'round':
        return dataclasses.replace(contact, offset=contact.offset - travel / obj.radius)
    return dataclasses.replace(contact, offset=contact.offset + travel)


def quasi_static_force(obj, place, v_x, v_y):
    """
    Force of the robot on an object that it pushes slowly, ``sum q_i v_i / |v_i|`` [N].

    :param obj: the ``PushedObject``.
    :param place: C in the object frame (x, y) [m].
    :param v_x: velocity imposed at C, object frame, x [m/s].
    :param v_y: the same, y [m/s].
    :return: (x, y) in the object frame.
    """
    omega = quasi_static_yaw_rate(obj, place, v_x, v_y)
    smoothing = SMOOTHING * math.hypot(v_x, v_y)
    force_x = force_y = 0.0
    for foot, capacity in zip(obj.supports, obj.capacities):
        slide = v_x - omega * (foot.y - place[1]), v_y + omega * (foot.x - place[0])
        weight = friction_weight(capacity, *slide, smoothing)
        force_x, force_y = force_x + weight * slide[0], force_y + weight * slide[1]
    return force_x, force_y


def force_tolerances(obj, contact, location):
    """
    Tell how far the object may be turned and still return, with the force in the cone.

    :param obj: the ``PushedObject``.
    :param contact: on a face or a round outline, at the reference.
    :param location: the ``PushingLocation`` there, whose reference is an equilibrium.
    :return: ``Tolerance`` clockwise and counter-clockwise, as of ``stability.tolerances``.
    """
    cone = math.atan(obj.contact_friction_coefficient)

    def inside(turn):
        now = rolled_contact(obj, contact, location, turn)
        forward = location.forward - turn
        force = quasi_static_force(obj, contact_point(obj, now), math.cos(forward),
                                   math.sin(forward))
        normal, tangential = Pose(0.0, 0.0, -normal_range(obj, now)[0]).rotate(force)
        return cone - abs(math.atan2(tangential, normal))

    result = []
    for found in tolerances(location, equilibrium_at(location, 0.0),
                            obj.contact_friction_coefficient):
        # Just inside: at the end of a face rounding may put the contact beyond it.
        furthest = found.turn * (1.0 - ACCURACY)
        if found.turn and inside(furthest) < 0.0:
            turn = brentq(inside, 0.0, furthest, xtol=ACCURACY)
            found = Tolerance(turn, -location.rolling[0] * turn, 'cone')
        result.append(found)
    return tuple(result)


def min_robot_radius(obj, location):
    """
    Find the radius above which a robot pushes stably at a place, ``R_e cos(rho) = h``.

    :param obj: the ``PushedObject``.
    :param location: the ``PushingLocation`` there for any robot, its reference an equilibrium.
    :return: R_p [m]; infinite where no robot does, or where rho is outside the cone.
    """
    rho, surface = location.pushing_angle, location.object_radius
    if abs(rho) >= math.atan(obj.contact_friction_coefficient):
        return math.inf
    effective = equilibrium_at(location, 0.0).arm / math.cos(rho)
    if math.isinf(surface):
        return effective
    # R_e stays below R_s: a centre behind the middle of a disc is out of every robot's reach.
    if effective >= surface * (1.0 - ACCURACY):
        return math.inf
    return surface * effective / (surface - effective)
