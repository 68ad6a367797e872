"""
Steering range of a drive: the steady turns in which object and robot move as one.

A holonomic robot holds the contact normal, and any direction of the push. A differential drive
cannot move sideways: ``omega_p = v_C sin(b) / (R_p cos D)``, b from its heading to the push and
``D = gamma - phi``. Where it holds a turn, ``omega_p = omega``, b follows from the contact alone:

    kappa (R_p + L) = D - zeta,    zeta = gamma - (direction from C to F), small angles

At a vertex D is kept and zeta is free, so that the cone bounds kappa to ``(D -+ beta)/(r + R_p)``.
On a face the normal is fixed, and rolling without slip conserves ``offset + R_p (phi - theta)``:
with F ahead of the face by n_f, ``kappa (R_p + L) = D_0 - zeta_0 - (offset - offset_0)
(1/n_f - 1/R_p)``. Nothing steers where R_p = n_f: the contact where it starts decides the turn.
"""

from collections.abc import Callable
import math
from typing import cast, NamedTuple

import numpy as np
from push_model.contact import contact_point, normal_range
from push_model.friction import friction_center
from push_model.geometry import Coordinates, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.robot_kinematics import center_velocity, yaw_rate
from scipy.optimize import brentq
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.analysis.steady_turn import steady_force, steady_yaw_rate

# Steady pushes that are tried over the whole range. Chosen: 7 degrees apart.
SAMPLES = 25
# A push at a right angle to the line from C to F steers without end; just short of it [rad].
RIGHT_ANGLE = 0.5 * math.pi - 1e-3
# Rounding of angles, yaw rates and speeds [rad, rad/s, m/s].
ROUNDING = 1e-9


class SteadyPush(NamedTuple):
    """
    A steady turn of object and robot as one, in the object frame.

    :param curvature: of the path of the flat output z, yaw rate over speed from C to F [1/m];
        above 0 to the left.
    :param contact_point: C (x, y) [m].
    :param normal: angle of n [rad].
    :param heading: of the robot [rad].
    :param twist: (v_x, v_y, omega) of the robot, robot axes [m/s, rad/s].
    :param force_angle: from n to the force on the object [rad].
    """

    curvature: float
    contact_point: tuple[float, float]
    normal: float
    heading: float
    twist: tuple[float, float, float]
    force_angle: float


class _PushGeometry(NamedTuple):
    """
    Geometry of a push, in the object frame.

    :param contact_point: C (x, y) [m].
    :param normal: angle of n [rad].
    :param heading: of the robot [rad].
    :param direction: of the push [rad].
    """

    contact_point: tuple[float, float]
    normal: float
    heading: float
    direction: float


def steering_range(obj: PushedObject, contact: Contact, robot: RoundRobot, speed: float,
                   heading_offset: float = 0.0) -> tuple[SteadyPush, SteadyPush] | None:
    """
    Find the sharpest steady turns that the contact, and the limits of the drive, bear.

    :param obj: the ``PushedObject``.
    :param contact: where the push starts; a differential drive may roll on from there.
    :param robot: the ``RoundRobot``.
    :param speed: of the contact [m/s], above 0.
    :param heading_offset: D at the start, from the robot's heading to n [rad]; without effect on a
        holonomic robot.
    :return: ``SteadyPush`` of lowest and of highest curvature; None where none holds.
    :raises ValueError: for a flat pusher, or a differential drive without radius.
    """
    if math.isinf(robot.radius) or robot.drive == 'differential' and robot.radius == 0.0:
        raise ValueError(f'robot.radius: got {robot.radius:g}, expected a round robot')
    if robot.drive == 'differential':
        location = pushing_location(obj, contact, robot.radius, None, -heading_offset)
        ends = _rotation_range(location)

        def rolled_push(rotation: float) -> SteadyPush | None:
            return steady_differential_push(obj, location, rotation, speed)

        push_at = rolled_push
    else:
        normal, toward = _facing(obj, contact)
        ends = toward - RIGHT_ANGLE, toward + RIGHT_ANGLE

        def held_push(direction: float) -> SteadyPush | None:
            geometry = _PushGeometry(contact_point(obj, contact), normal, normal, direction)
            return _steady_push(obj, geometry, speed, robot.radius)

        push_at = held_push

    holding = _holding(push_at, ends, lambda push: _reserve(obj, robot, push))
    if not holding:
        return None
    return (min(holding, key=lambda push: push.curvature),
            max(holding, key=lambda push: push.curvature))


def steady_differential_push(obj: PushedObject, location: PushingLocation, rotation: float,
                             speed: float) -> SteadyPush | None:
    """
    Find the steady turn that a differential drive holds, once it has rolled to a contact.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` of the start, where the push is along the heading.
    :param rotation: of the object from there, as the robot sees it [rad].
    :param speed: of the contact [m/s].
    :return: ``SteadyPush``; None where it cannot push straight ahead, or towards F.
    """
    heading, offset = location.push_direction - rotation, -float(location.rho(rotation))
    center_x, center_y = map(float, location.friction_center(rotation))
    x_f, y_f = friction_center(obj)
    x, y = Pose(0.0, 0.0, heading).rotate((center_x, center_y))
    point, toward = (x_f - x, y_f - y), math.atan2(center_y, center_x)
    if not all(_is_ahead(obj, point, heading + angle) for angle in (0.0, toward)):
        return None

    def residual(angle: float) -> float:
        return (steady_yaw_rate(obj, point, heading + angle, speed)
                - float(yaw_rate('differential', location.robot_radius, angle - offset, offset,
                                 0.0, speed)))

    # Pushed straight ahead it rotates and the robot does not; towards F, the other way round.
    slack = math.copysign(ROUNDING, toward)
    angle = cast(float, brentq(residual, -slack, toward + slack, xtol=1e-13))
    geometry = _PushGeometry(point, heading + offset, heading, heading + angle)
    push = _steady_push(obj, geometry, speed, location.robot_radius)
    if push is None:
        return None
    v_x, _, omega = push.twist
    return push._replace(twist=(v_x, 0.0, omega))


def _steady_push(obj: PushedObject, geometry: _PushGeometry, speed: float,
                 robot_radius: float) -> SteadyPush | None:
    """Find the steady turn of a push; None for one away from the mass or friction centre."""
    point, normal, heading, direction = geometry
    if not _is_ahead(obj, point, direction):
        return None
    x_f, y_f = friction_center(obj)
    along = math.cos(direction - math.atan2(y_f - point[1], x_f - point[0]))
    omega = steady_yaw_rate(obj, point, direction, speed)
    force_n, force_t = steady_force(obj, point, direction, speed, normal)
    velocity_n, velocity_t = center_velocity(robot_radius, direction - normal, omega, speed)
    v_x, v_y = Pose(0.0, 0.0, normal - heading).rotate((float(velocity_n), float(velocity_t)))
    return SteadyPush(omega / (speed * along), point, normal, heading, (v_x, v_y, omega),
                      math.atan2(force_t, force_n))


def _is_ahead(obj: PushedObject, point: Coordinates, direction: float) -> bool:
    return all(math.cos(direction - math.atan2(y - point[1], x - point[0])) > ROUNDING
               for x, y in (friction_center(obj), obj.center_of_mass))


def _facing(obj: PushedObject, contact: Contact) -> tuple[float, float]:
    """Find the normal at a contact that is nearest to the direction from C to F, and that."""
    (x_c, y_c), (x_f, y_f) = contact_point(obj, contact), friction_center(obj)
    toward = math.atan2(y_f - y_c, x_f - x_c)
    low, high = normal_range(obj, contact)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return middle + min(half, max(-half, wrap_angle(toward - middle))), toward


def _rotation_range(location: PushingLocation) -> tuple[float, float]:
    low, high = location.rotation_range
    normal_ratio = location.rolling.normal_ratio
    if normal_ratio > 0.0:
        low = max(low, (location.pushing_angle - RIGHT_ANGLE) / normal_ratio)
        high = min(high, (location.pushing_angle + RIGHT_ANGLE) / normal_ratio)
    return low, high


def _reserve(obj: PushedObject, robot: RoundRobot, push: SteadyPush | None) -> float:
    """Find the least of what is left of angle, yaw rate and speed; below 0 it does not hold."""
    if push is None:
        return -1.0
    cone = math.atan(obj.contact_friction_coefficient)
    return min(cone - abs(push.force_angle), robot.max_yaw_rate - abs(push.twist[2]),
               robot.max_speed - math.hypot(*push.twist[:2])) + ROUNDING


def _holding(push_at: Callable[[float], SteadyPush | None], ends: tuple[float, float],
             reserve: Callable[[SteadyPush | None], float]) -> list[SteadyPush]:
    """List the sampled pushes that hold, and those where holding begins and ends."""
    samples = np.linspace(*ends, SAMPLES)
    reserves = np.array([reserve(push_at(sample)) for sample in samples])
    edges = [cast(float, brentq(lambda at: reserve(push_at(at)), samples[i], samples[i + 1],
                                xtol=1e-10))
             for i in np.flatnonzero((reserves[:-1] < 0.0) != (reserves[1:] < 0.0))]
    pushes = map(push_at, [*samples[reserves >= 0.0], *edges])
    return [push for push in pushes if push is not None]
