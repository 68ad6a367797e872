"""
Steering at one contact: what contact and drive allow, and the command that gives a curvature of z.

Angles at the contact, all in the object frame: ``zeta`` from the line C->F to the normal n,
``alpha`` from C->F to the velocity imposed at C, and so ``alpha - zeta`` from n to that velocity.
The functions are compiled: a control step takes a few of them.
"""

import math
from typing import Any, NamedTuple

from push_control.steered.estimation.contact_site import rolled_contact, RollingContact
from push_control.steered.estimation.limit_surface_table import angle_of_curvature
from push_control.steered.estimation.push_motion import MotionState
from push_control.steered.laws.command import (
    differential_command, holonomic_command, scaled_command)
from push_control.steered.laws.curvature_limits import (
    friction_cone_limits, jackknife_limits, vertex_limits)
from push_control.steered.monitors import jackknife_mode, STEERABLE
from push_control.steered.path.path import CurvatureLimits
from push_dynamics.compiled import compiled, wrap_angles
from push_model.quasi_static import Vehicle
from push_model.signals import Twist

# What a rolled contact keeps from the end of a face [m], and from the edges of a vertex [rad].
# Chosen: the contact is known to some millimetres, the normal to some hundredths.
FACE_END_MARGIN = 0.02
ROLLED_VERTEX_MARGIN = 0.05
# Fraction of the friction cone that a round contact may be off centre, as it must roll far for
# little. Chosen.
ROUND_CONE_FRACTION = 0.3
# Smallest distance of the centre of friction from that of a disc, against division by 0 [m].
MIN_CENTER_DISTANCE = 1e-9


class Steering(NamedTuple):
    """
    Parameters of steering at a contact, constant during a push.

    :param is_differential: whether its base is a differential drive.
    :param cone_angle: half angle of the whole friction cone that is relied on [rad].
    :param rolling_gain: of a holonomic base, yaw per path length [1/m].
    :param max_speed: of the robot [m/s].
    :param max_yaw_rate: of the robot [rad/s].
    :param c_squared: ``LimitSurfaceTable.values`` of the contact [m^2].
    :param forces: ``LimitSurfaceTable.forces`` of the contact [rad].
    """

    is_differential: bool
    cone_angle: float
    rolling_gain: float
    max_speed: float
    max_yaw_rate: float
    c_squared: Any
    forces: Any


class SteeringCommand(NamedTuple):
    """
    Command of the steering, and what it expects.

    :param twist: ``Twist`` in the robot's axes; STOP where the contact cannot be steered.
    :param mode: of ``monitors.jackknife_mode``.
    """

    twist: Twist
    mode: int


@compiled
def curvature_limits(steering: Steering, site: RollingContact, vehicle: Vehicle, normal: float,
                     cone_fraction: float) -> CurvatureLimits:
    """
    Curvatures that the contact survives.

    :param vehicle: the object as ``Vehicle``, as estimated.
    :param normal: angle of the contact normal in the object frame [rad].
    :param cone_fraction: fraction of the friction cone that may be used.
    """
    cone_angle = cone_fraction * steering.cone_angle
    if not steering.is_differential:
        return friction_cone_limits(steering.c_squared, steering.forces, vehicle, normal,
                                    cone_angle)
    radius, offset = site.robot_radius, initial_offset(site)
    steady = jackknife_limits(vehicle, radius, offset, cone_angle)
    rolled = vertex_limits(vehicle, radius, offset, zeta_limits(site, vehicle, normal))
    return CurvatureLimits(max(steady.low, rolled.low), min(steady.high, rolled.high))


@compiled
def initial_offset(site: RollingContact) -> float:
    """D, angle from the robot's heading to the contact normal at the start [rad]."""
    return wrap_angles(site.normal - site.heading)


@compiled
def zeta_at_rest(steering: Steering, site: RollingContact, state: MotionState) -> float:
    """
    Compute the equilibrium of zeta on a straight path [rad].

    :param state: ``MotionState`` now.
    """
    if steering.is_differential:
        return initial_offset(site)
    heading = site.heading + centering_of(steering, site, state)
    centered = rolled_contact(site, heading)
    to_center = math.atan2(state.p_y - centered.y, state.p_x - centered.x)
    return wrap_angles(centered.normal - to_center)


@compiled
def approach_command(steering: Steering, normal: float, state: MotionState, speed: float) -> Twist:
    """
    Compute the command that closes a gap slowly, along the contact normal.

    :param normal: angle of the contact normal in the object frame [rad].
    :param state: ``MotionState`` one drive lag ahead.
    :param speed: of the robot [m/s].
    :return: ``Twist`` in the robot's axes.
    """
    direction = 0.0 if steering.is_differential else state.theta + normal - state.phi
    command = holonomic_command(speed, 0.0, direction, 0.0, 0.0)
    return scaled_command(command, steering.max_speed, steering.max_yaw_rate)


@compiled
def steering_command(steering: Steering, site: RollingContact, vehicle: Vehicle,
                     state: MotionState, curvature: float, speed: float) -> SteeringCommand:
    """
    Compute the command that gives z a curvature.

    :param vehicle: the object as ``Vehicle``, as estimated.
    :param state: ``MotionState`` one drive lag ahead.
    :param curvature: of z [1/m].
    :param speed: of the contact [m/s].
    """
    normal = rolled_contact(site, state.phi - state.theta).normal
    alpha = angle_of_curvature(steering.c_squared, vehicle.arm, vehicle.c_squared, curvature)
    angle = vehicle.angle + alpha - normal
    heading_offset = state.theta + normal - state.phi
    mode = jackknife_mode(site, normal, angle)
    if mode != STEERABLE:
        return SteeringCommand(Twist(0.0, 0.0, 0.0), mode)
    radius = site.robot_radius
    if steering.is_differential:
        command = differential_command(speed, angle, heading_offset, radius)
    else:
        # The robot turns with the object, and rolls its contact to where it is centred.
        forward = speed * math.cos(alpha)
        rotation = state.phi - state.theta - site.heading
        centering = centering_of(steering, site, state)
        omega = forward * curvature + steering.rolling_gain * speed * (centering - rotation)
        command = holonomic_command(speed, angle, heading_offset, radius, omega)
    return SteeringCommand(scaled_command(command, steering.max_speed, steering.max_yaw_rate),
                           mode)


@compiled
def centering_of(steering: Steering, site: RollingContact, state: MotionState) -> float:
    """Rotation of the robot on the object, since the start, that centres the contact [rad]."""
    return centering_rotation(site, (state.p_x, state.p_y),
                              ROUND_CONE_FRACTION * steering.cone_angle,
                              state.phi - state.theta - site.heading)


@compiled
def zeta_limits(site: RollingContact, vehicle: Vehicle, normal: float) -> tuple[float, float]:
    """
    Zeta between which the contact stays on its feature.

    :param vehicle: the object as ``Vehicle``, as estimated.
    :param normal: angle of the contact normal in the object frame [rad].
    :return: (lowest, highest) zeta, within -pi and pi [rad].
    """
    zeta = wrap_angles(normal - vehicle.angle)
    low, high = site.normal_limits
    return (min(math.pi, max(-math.pi, zeta + low - normal)),
            min(math.pi, max(-math.pi, zeta + high - normal)))


@compiled
def centering_rotation(site: RollingContact, center: tuple[float, float], max_zeta: float,
                       rotation: float) -> float:
    """
    Rotation of the robot relative to the object, since the start, that centres the contact.

    A contact whose normal runs through the centre of friction F has the whole cone to either side.
    At a vertex n rotates with the robot, on a face C moves by ``-R_p`` times the rotation, on a
    round outline n rotates by ``1 - lam`` times it. A disc must roll far for little: with p the
    distance of F from its centre and d the angle from n to that direction,
    ``tan(zeta) = -p sin(d) / (R_s + p cos(d))``; so only what exceeds ``max_zeta`` is rolled away,
    ``sin(d - zeta) = R_s sin(zeta) / p``.

    :param center: centre of friction F in the object frame (x, y) [m].
    :param max_zeta: zeta that a round contact may keep [rad].
    :param rotation: the present rotation, from which a round contact takes the shorter path [rad].
    :return: the rotation, bounded by the ends of the vertex or the face [rad].
    """
    if site.object_radius == 0.0:
        return vertex_rotation(site, center)
    if math.isinf(site.object_radius):
        return face_rotation(site, center)
    normal = site.normal + (1.0 - site.normal_ratio) * rotation
    return rotation + round_rotation(site, center, max_zeta, normal)


@compiled
def vertex_rotation(site: RollingContact, center: tuple[float, float]) -> float:
    """
    Rotate the normal into the line C->F, as far as the vertex allows.

    :param center: of friction, F [m].
    :return: rotation of the robot since the start [rad].
    """
    to_center = math.atan2(center[1] - site.point[1], center[0] - site.point[0])
    low, high = site.normal_limits
    middle, half_range = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - ROLLED_VERTEX_MARGIN)
    offset = wrap_angles(to_center - middle)
    return middle + min(half_range, max(-half_range, offset)) - site.normal


@compiled
def face_rotation(site: RollingContact, center: tuple[float, float]) -> float:
    """
    Roll C to the foot of F on the face, as far as the face allows.

    :param center: of friction, F [m].
    :return: rotation of the robot since the start [rad].
    """
    cosine, sine = math.cos(site.normal), math.sin(site.normal)
    present = site.point[1] * cosine - site.point[0] * sine
    foot = center[1] * cosine - center[0] * sine
    low, high = site.edges
    middle, half_range = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - FACE_END_MARGIN)
    if math.isfinite(half_range):
        foot = middle + min(half_range, max(-half_range, foot - middle))
    return (present - foot) / site.robot_radius


@compiled
def round_rotation(site: RollingContact, center: tuple[float, float], max_zeta: float,
                   normal: float) -> float:
    """
    Roll a disc until zeta is small enough.

    :param center: of friction, F [m].
    :param max_zeta: zeta that may stay [rad].
    :param normal: present angle of the normal in the object frame [rad].
    :return: further rotation of the robot [rad].
    """
    distance = math.hypot(center[0], center[1])
    from_center = wrap_angles(math.atan2(center[1], center[0]) - normal)
    sine = site.object_radius * math.sin(max_zeta) / max(distance, MIN_CENTER_DISTANCE)
    if sine >= 1.0:
        return 0.0
    # Zeta is small where F lies nearly ahead of C, and where it lies nearly behind.
    ahead, behind = max_zeta + math.asin(sine), max_zeta + math.pi - math.asin(sine)
    apart = abs(from_center)
    if apart <= ahead or apart >= behind:
        return 0.0
    nearest = ahead if apart - ahead <= behind - apart else behind
    return math.copysign(apart - nearest, from_center * (apart - nearest)) / (
        1.0 - site.normal_ratio)
