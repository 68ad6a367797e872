"""Where rolling ends, and how a round object that slides on a round robot moves on."""

import math
from typing import Any, NamedTuple

import numpy as np
from push_model.analysis.planar import rotated
from push_model.analysis.sliding_contact import contact_motion, ContactMotion, SupportArrays
from push_model.geometry import FloatArray
from studies.analysis.pushing_location import PushingLocation
from studies.framework.parameters import Parameter

CONTACT_FRICTION = Parameter('contact_friction', '', 'friction coefficient at the contact')
SUPPORT_SPREAD = Parameter('support_spread', 'm', 'distance of the four support points from the '
                           'centre of friction, ahead, behind and aside')
# Chosen: rotations at which the force is compared with the cone, a milliradian apart or less.
SAMPLES = 1201


def cross(distance: float) -> SupportArrays:
    """
    Place four support points in a cross about the centre of friction, at the origin.

    :param distance: of the support points from the middle [m].
    :return: the support points; how great their friction is does not matter here.
    """
    points = ((distance, 0.0), (0.0, distance), (-distance, 0.0), (0.0, -distance))
    return SupportArrays(np.array(points), np.ones(len(points)))


def slow_motion(location: PushingLocation, support_distance: float, contact_friction: float,
                rotations: FloatArray, rho: FloatArray) -> ContactMotion:
    """
    Find the motion of a slowly pushed object at several states, in the axes of the push.

    :param location: where the object is pushed, at pushing angle 0 at the reference.
    :param support_distance: of its support points [m].
    :param contact_friction: mu_c.
    :param rotations: of the object from the reference, shape (n,) [rad].
    :param rho: pushing angles, shape (n,) [rad]; those of ``location.rho`` where the contact has
        rolled from the reference.
    :return: motion at pushing speed 1, in axes along the push and to its left.
    """
    center = _center_from_contact(location, rotations, rho)
    points = -_rotated_rows(-rotations, *center)
    pushes = _rotated_rows(-rotations, np.ones_like(rotations), np.zeros_like(rotations))
    motion = contact_motion(cross(support_distance), points, -rho - rotations, pushes,
                            contact_friction)
    return motion._replace(velocities=_rotated_rows(rotations, *motion.velocities.T),
                           forces=_rotated_rows(rotations, *motion.forces.T))


class RollingRange(NamedTuple):
    """
    Pushing angles between which a contact that has rolled from the reference rolls on.

    :param low: least pushing angle [rad].
    :param high: greatest pushing angle [rad].
    """

    low: float
    high: float


def rolling_range(location: PushingLocation, support_distance: float, contact_friction: float,
                  max_rho: float) -> RollingRange:
    """
    Find where the contact force leaves the friction cone.

    :param location: where the object is pushed.
    :param support_distance: of its support points [m].
    :param contact_friction: mu_c.
    :param max_rho: range that is searched [rad].
    :return: nearest pushing angles to 0 with sliding, or the ends of the range.
    """
    rho = np.linspace(-max_rho, max_rho, SAMPLES, dtype=np.float64)
    motion = slow_motion(location, support_distance, contact_friction, location.rotation_at(rho),
                         rho)
    slides = motion.slides != 0
    below, above = rho[slides & (rho < 0.0)], rho[slides & (rho > 0.0)]
    return RollingRange(float(below.max(initial=-max_rho)), float(above.min(initial=max_rho)))


class Releases(NamedTuple):
    """
    Slow pushes from several states, over the distance that the robot moves.

    :param distances: shape (n,) [m].
    :param rho: pushing angles, shape (n, k) [rad].
    :param slides: whether the contact slides, shape (n, k).
    """

    distances: FloatArray
    rho: FloatArray
    slides: Any


def push_from(location: PushingLocation, support_distance: float, contact_friction: float,
              initial_rho: FloatArray, distances: FloatArray) -> Releases:
    """
    Integrate slow pushes of a round object by a round robot, rolling and sliding.

    The normal points from the robot's centre P to the object's centre of curvature O, so that
    ``gamma' = (v_O - v_P) . t / (R_p + R_s)``, and ``v_O . t = v_C . t + omega R_s``.

    :param location: of two round surfaces.
    :param support_distance: of the support points [m].
    :param contact_friction: mu_c.
    :param initial_rho: pushing angles of the release, rolled from the reference, shape (k,) [rad].
    :param distances: of the robot, ascending and evenly spaced, shape (n,) [m].
    :return: the pushes; a pushing angle stays at 90 degrees, where the robot has passed.
    """
    total = location.robot_radius + location.object_radius

    def slope(state: FloatArray) -> tuple[FloatArray, Any]:
        rotations, rho = state
        motion = slow_motion(location, support_distance, contact_friction, rotations, rho)
        tangents = np.column_stack([np.sin(rho), np.cos(rho)])
        slip = (motion.velocities * tangents).sum(axis=1) - np.sin(rho)
        gamma_rate = (slip + motion.yaw_rates * location.object_radius) / total
        passed = np.abs(rho) >= 0.5 * math.pi
        return np.where(passed, 0.0, [motion.yaw_rates, -gamma_rate]), motion.slides != 0

    state = np.array([location.rotation_at(initial_rho), initial_rho])
    rho, slides = [], []
    step = distances[1] - distances[0]
    for _ in distances:
        rate, sliding = slope(state)
        rho.append(state[1])
        slides.append(sliding)
        state = state + step * slope(state + 0.5 * step * rate)[0]
    return Releases(distances, np.array(rho), np.array(slides))


def _center_from_contact(location: PushingLocation, rotations: FloatArray,
                         rho: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Find F from C, in axes along the push; the contact need not have rolled there."""
    if math.isinf(location.object_radius):
        x, y = location.friction_center(rotations)
        return np.asarray(x), np.asarray(y)
    radius = location.object_radius
    x, y = rotated(rotations, location.normal_distance - radius, location.tangential_distance)
    return x + radius * np.cos(rho), y - radius * np.sin(rho)


def _rotated_rows(angles: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    return np.column_stack(rotated(angles, x, y))
