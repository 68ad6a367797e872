"""
Steering at one contact: what contact and drive allow, and the command that gives a curvature of z.

Angles at the contact, all in the object frame: ``zeta`` from the line C->F to the normal n,
``alpha`` from C->F to the velocity imposed at C, and so ``alpha - zeta`` from n to that velocity.
"""

import math
from typing import NamedTuple

from push_control.estimation.contact_site import ContactSite
from push_control.estimation.limit_surface_table import LimitSurfaceTable
from push_control.estimation.monitors import jackknife_fault
from push_control.estimation.push_motion import PushState
from push_control.events import EventReport
from push_control.laws.command import differential_command, holonomic_command, limit_command
from push_control.laws.curvature_limits import (
    friction_cone_limits, jackknife_limits, vertex_limits,
)
from push_control.path.path import CurvatureLimits
from push_control.settings import ControlSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.quasi_static import Vehicle
from push_model.signals import STOP, Twist

# What a rolled contact keeps from the end of a face [m], and from the edges of a vertex [rad].
# Chosen: the contact is known to some millimetres, the normal to some hundredths.
FACE_END_MARGIN = 0.02
ROLLED_VERTEX_MARGIN = 0.05
# Fraction of the friction cone that a round contact may be off centre, as it must roll far for
# little. Chosen.
ROUND_CONE_FRACTION = 0.3
# Smallest distance of the centre of friction from that of a disc, against division by 0 [m].
MIN_CENTER_DISTANCE = 1e-9


class ContactPosture(NamedTuple):
    """
    The contact normal relative to the line C->F.

    :param zeta: angle from that line to the normal [rad].
    :param zeta_rest: where zeta comes to rest on a straight path [rad].
    :param zeta_limits: (lowest, highest) zeta at which the contact stays on its feature [rad].
    """

    zeta: float
    zeta_rest: float
    zeta_limits: tuple[float, float]


class SteeringCommand(NamedTuple):
    """
    What the robot is to do.

    :param twist: ``Twist`` in the robot's axes; STOP where there is a fault.
    :param fault: ``EventReport`` of a contact that cannot be steered any more, or None.
    """

    twist: Twist
    fault: EventReport | None = None


class ContactSteering:
    """One robot at one contact."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 site: ContactSite, supports: LimitSurfaceTable):
        """
        Check that this robot can steer there.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param site: the ``ContactSite`` at the start.
        :param supports: the ``LimitSurfaceTable``.
        :raises ValueError: where it cannot.
        """
        self._is_differential = robot.drive == 'differential'
        if self._is_differential and site.kind != 'vertex':
            raise ValueError(f'target: got a contact of kind {site.kind!r} for a differential '
                             'drive, which cannot steer there, expected a vertex')
        self._robot = robot
        self._settings = settings
        self._supports = supports
        self._cone_angle = math.atan(settings.friction_fraction
                                     * obj.contact_friction_coefficient)

    def cone_angle(self, cone_fraction: float) -> float:
        """
        Half angle of a part of the friction cone.

        :param cone_fraction: fraction of the cone that may be used.
        :return: angle [rad].
        """
        return cone_fraction * self._cone_angle

    def limits(self, site: ContactSite, vehicle: Vehicle, normal: float,
               cone_fraction: float) -> CurvatureLimits:
        """
        Curvatures that the contact survives.

        :param site: the ``ContactSite``.
        :param vehicle: the object as ``Vehicle``, as estimated.
        :param normal: angle of the contact normal in the object frame [rad].
        :param cone_fraction: fraction of the friction cone that may be used.
        :return: ``CurvatureLimits``.
        """
        cone_angle = self.cone_angle(cone_fraction)
        if not self._is_differential:
            return friction_cone_limits(self._supports, vehicle, normal, cone_angle)
        radius, heading_offset = self._robot.radius, site.heading_offset
        steady = jackknife_limits(vehicle, radius, heading_offset, cone_angle)
        return steady.intersection(vertex_limits(vehicle, radius, heading_offset,
                                                 zeta_limits(site, vehicle, normal)))

    def posture(self, site: ContactSite, vehicle: Vehicle, normal: float,
                state: PushState) -> ContactPosture:
        """
        Where the normal is, where it comes to rest on a straight path, and where it may be.

        :param site: the ``ContactSite``.
        :param vehicle: the object as ``Vehicle``, as estimated.
        :param normal: angle of the contact normal in the object frame [rad].
        :param state: ``PushState`` now.
        :return: ``ContactPosture``.
        """
        zeta = math.remainder(normal - vehicle.angle, 2.0 * math.pi)
        rest = site.heading_offset
        if not self._is_differential:
            centered = site.contact_at(site.heading + self._centering_rotation(site, state))
            to_center = math.atan2(state.p_y - centered.y, state.p_x - centered.x)
            rest = math.remainder(centered.normal - to_center, 2.0 * math.pi)
        return ContactPosture(zeta, rest, zeta_limits(site, vehicle, normal))

    def approach(self, site: ContactSite, state: PushState) -> Twist:
        """
        Compute the command that closes a gap slowly, along the contact normal.

        :param site: the ``ContactSite``.
        :param state: ``PushState`` one drive lag ahead.
        :return: ``Twist`` in the robot's axes.
        """
        normal = site.contact_at(state.relative_heading).normal
        heading_offset = state.theta + normal - state.phi
        direction = 0.0 if self._is_differential else heading_offset
        return limit_command(
            holonomic_command(self._settings.start_speed, 0.0, direction, 0.0, 0.0), self._robot)

    def command(self, site: ContactSite, vehicle: Vehicle, normal: float, state: PushState, *,
                curvature: float, speed: float) -> SteeringCommand:
        """
        Compute the command that gives z a curvature.

        :param site: the ``ContactSite``.
        :param vehicle: the object as ``Vehicle``, as estimated.
        :param normal: angle of the contact normal in the object frame [rad].
        :param state: ``PushState`` one drive lag ahead.
        :param curvature: of z [1/m].
        :param speed: of the contact [m/s].
        :return: ``SteeringCommand``.
        """
        alpha = self._supports.push_angle(vehicle, curvature)
        angle = vehicle.angle + alpha - normal
        heading_offset = state.theta + normal - state.phi
        fault = jackknife_fault(site, normal, angle)
        if fault is not None:
            return SteeringCommand(STOP, fault)
        radius = self._robot.radius
        if self._is_differential:
            command = differential_command(speed, angle, heading_offset, radius)
        else:
            # The robot turns with the object, and rolls its contact to where it is centred.
            forward = speed * math.cos(alpha)
            rotation = state.phi - state.theta - site.heading
            centering = self._centering_rotation(site, state)
            omega = (forward * curvature
                     + self._settings.rolling_gain * speed * (centering - rotation))
            command = holonomic_command(speed, angle, heading_offset, radius, omega)
        return SteeringCommand(limit_command(command, self._robot))

    def _centering_rotation(self, site: ContactSite, state: PushState) -> float:
        rotation = state.phi - state.theta - site.heading
        return centering_rotation(site, state.center, ROUND_CONE_FRACTION * self._cone_angle,
                                  rotation)


def zeta_limits(site: ContactSite, vehicle: Vehicle, normal: float) -> tuple[float, float]:
    """
    Zeta between which the contact stays on its feature.

    :param site: the ``ContactSite``.
    :param vehicle: the object as ``Vehicle``, as estimated.
    :param normal: angle of the contact normal in the object frame [rad].
    :return: (lowest, highest) zeta, within -pi and pi [rad].
    """
    zeta = math.remainder(normal - vehicle.angle, 2.0 * math.pi)
    low, high = site.normal_limits
    return (min(math.pi, max(-math.pi, zeta + low - normal)),
            min(math.pi, max(-math.pi, zeta + high - normal)))


def centering_rotation(site: ContactSite, center: tuple[float, float], max_zeta: float,
                       rotation: float) -> float:
    """
    Rotation of the robot relative to the object, since the start, that centres the contact.

    A contact whose normal runs through the centre of friction F has the whole cone to either side.
    At a vertex n rotates with the robot, on a face C moves by ``-R_p`` times the rotation, on a
    round outline n rotates by ``1 - lam`` times it. A disc must roll far for little: with p the
    distance of F from its centre and d the angle from n to that direction,
    ``tan(zeta) = -p sin(d) / (R_s + p cos(d))``; so only what exceeds ``max_zeta`` is rolled away,
    ``sin(d - zeta) = R_s sin(zeta) / p``.

    :param site: the ``ContactSite``.
    :param center: centre of friction F in the object frame (x, y) [m].
    :param max_zeta: zeta that a round contact may keep [rad].
    :param rotation: the present rotation, from which a round contact takes the shorter path [rad].
    :return: the rotation, bounded by the ends of the vertex or the face [rad].
    """
    if site.kind == 'vertex':
        return _vertex_rotation(site, center)
    if site.kind == 'face':
        return _face_rotation(site, center)
    normal = site.normal + (1.0 - site.normal_ratio) * rotation
    return rotation + _round_rotation(site, center, max_zeta, normal)


def _vertex_rotation(site: ContactSite, center: tuple[float, float]) -> float:
    """Rotate the normal into the line C->F, as far as the vertex allows."""
    to_center = math.atan2(center[1] - site.point[1], center[0] - site.point[0])
    low, high = site.normal_limits
    middle, reach = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - ROLLED_VERTEX_MARGIN)
    offset = math.remainder(to_center - middle, 2.0 * math.pi)
    return middle + min(reach, max(-reach, offset)) - site.normal


def _face_rotation(site: ContactSite, center: tuple[float, float]) -> float:
    """Roll C to the foot of F on the face, as far as the face allows."""
    n = site.normal
    present, foot = (y * math.cos(n) - x * math.sin(n) for x, y in (site.point, center))
    low, high = site.edges
    middle, reach = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - FACE_END_MARGIN)
    if math.isfinite(reach):
        foot = middle + min(reach, max(-reach, foot - middle))
    return (present - foot) / site.robot_radius


def _round_rotation(site: ContactSite, center: tuple[float, float], max_zeta: float,
                    normal: float) -> float:
    """Roll a disc until zeta is small enough: the further rotation of the robot."""
    distance = math.hypot(*center)
    from_center = math.remainder(math.atan2(center[1], center[0]) - normal, 2.0 * math.pi)
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
