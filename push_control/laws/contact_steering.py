"""What contact and drive allow, and the command that gives a curvature of z."""

import math

from push_control.estimation.monitors import jackknifed
from push_control.laws.command import differential_command, holonomic_command, limit_command
from push_control.laws.curvature_limits import (
    friction_cone_limits, jackknife_limits, vertex_limits,
)

EDGE_RESERVE = 0.02
VERTEX_RESERVE = 0.05


def centering_rotation(site, center, allowed, rolled):
    """
    Turn of the robot in the object, since the start, that centres the contact.

    A contact whose normal runs through the friction centre F has the whole cone to either side.
    At a vertex n turns by the turn of the robot, on a face C moves by ``-R_p`` times it, on a
    round outline n turns by ``1 - lam`` times it. A disc must roll far for little: with p the
    distance of F from its centre and d the angle from n to that direction,
    ``tan(zeta) = -p sin(d) / (R_s + p cos(d))``; so only what exceeds ``allowed`` is rolled away,
    ``sin(d - zeta) = R_s sin(zeta) / p``.

    :param site: the contact ``ContactSite``.
    :param center: friction centre F in the object frame (x, y) [m].
    :param allowed: zeta that a round contact may keep [rad].
    :param rolled: the present turn, from which a round contact takes the nearer way [rad].
    :return: the turn, bounded by the ends of the vertex or the face [rad].
    """
    n = site.normal
    if site.kind == 'vertex':
        ahead = math.atan2(center[1] - site.point[1], center[0] - site.point[0])
        low, high = site.normal_limits
        middle, room = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - VERTEX_RESERVE)
        wanted = math.remainder(ahead - middle, 2.0 * math.pi)
        return middle + min(room, max(-room, wanted)) - n
    if site.kind == 'face':
        aside, wanted = (y * math.cos(n) - x * math.sin(n) for x, y in (site.point, center))
        low, high = site.edges
        middle, room = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - EDGE_RESERVE)
        if math.isfinite(room):
            wanted = middle + min(room, max(-room, wanted - middle))
        return (aside - wanted) / site.robot_radius
    return rolled + _round_turn(site, center, allowed, site.normal + (1.0 - site.share) * rolled)


def _round_turn(site, center, allowed, normal):
    distance = math.hypot(*center)
    from_center = math.remainder(math.atan2(center[1], center[0]) - normal, 2.0 * math.pi)
    share = site.object_radius * math.sin(allowed) / max(distance, 1e-9)
    if share >= 1.0:
        return 0.0
    ahead, behind = allowed + math.asin(share), allowed + math.pi - math.asin(share)
    apart = abs(from_center)
    if apart <= ahead or apart >= behind:
        return 0.0
    kept = ahead if apart - ahead <= behind - apart else behind
    return math.copysign(apart - kept, from_center * (apart - kept)) / (1.0 - site.share)


ZETA_SHARE = 0.3


class ContactSteering:
    """One robot at one contact."""

    def __init__(self, obj, robot, settings, site, supports):
        """
        Look at the contact.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param site: the contact ``ContactSite``.
        :param supports: the ``LimitSurfaceTable``.
        :raises ValueError: where this robot cannot steer at this contact.
        """
        self._differential = robot.drive == 'differential'
        if self._differential and site.kind != 'vertex':
            raise ValueError(f'target: got a contact of kind {site.kind!r} for a differential '
                             'drive, which cannot steer there, expected a vertex')
        self._robot, self._settings, self.site = robot, settings, site
        self._supports = supports
        self._cone = math.atan(settings.friction_fraction * obj.contact_friction_coefficient)

    def limits(self, flat, normal, margin):
        """
        Curvatures that the contact survives.

        :param flat: the ``Vehicle`` as estimated.
        :param normal: angle of the contact normal in the object frame [rad].
        :param margin: share of the friction cone that may be used.
        :return: ``CurvatureLimits``.
        """
        cone = margin * self._cone
        if self._differential:
            steady = jackknife_limits(flat, self._robot.radius, self.site.heading_offset, cone)
            return steady.within(vertex_limits(flat, self._robot.radius, self.site.heading_offset,
                                               self._room(flat, normal)))
        return friction_cone_limits(self._supports, flat, normal, cone)

    def stance(self, flat, normal, belief):
        """
        Where the normal is, where it rests on a straight way, and where it may be.

        :param flat: the ``Vehicle`` as estimated.
        :param normal: angle of the contact normal in the object frame [rad].
        :param belief: ``PushState`` now.
        :return: dict of the fields of ``SteeringInput`` of these names.
        """
        zeta = math.remainder(normal - flat.angle, 2.0 * math.pi)
        rest = self.site.heading_offset if self._differential else self._centred(belief)[1]
        return {'zeta': zeta, 'zeta_rest': rest,
                'zeta_limits': self._room(flat, normal),
                'cone_angle': self._settings.feedback_cone_fraction * self._cone}

    def _centred(self, belief):
        """Turn of the robot that centres the contact, and zeta there."""
        center, rolled = belief.center, belief.phi - belief.theta - self.site.heading
        turn = centering_rotation(self.site, center, ZETA_SHARE * self._cone, rolled)
        c_x, c_y, normal = self.site.at(self.site.heading + turn)
        return turn, math.remainder(normal - math.atan2(center[1] - c_y, center[0] - c_x),
                                    2.0 * math.pi)

    def _room(self, flat, normal):
        """Zeta between which the normal stays at this feature."""
        zeta = math.remainder(normal - flat.angle, 2.0 * math.pi)
        return tuple(min(math.pi, max(-math.pi, zeta + limit - normal))
                     for limit in self.site.normal_limits)

    def approach(self, belief):
        """
        Compute the command that closes a gap slowly, along the contact normal.

        :param belief: ``PushState`` one drive lag ahead.
        :return: ``Twist``.
        """
        heading_offset = belief.theta + self.site.at(belief.phi - belief.theta)[2] - belief.phi
        ahead = 0.0 if self._differential else heading_offset
        return limit_command(holonomic_command(self._settings.start_speed, 0.0, ahead, 0.0, 0.0),
                             self._robot)

    def command(self, flat, belief, curvature, speed):
        """
        Compute the robot's command.

        :param flat: the ``Vehicle`` as estimated.
        :param belief: ``PushState`` one drive lag ahead.
        :param curvature: of z [1/m].
        :param speed: of the contact [m/s].
        :return: ``Twist``; and why there is none as ``EventReport``, or None.
        """
        site, robot = self.site, self._robot
        normal = site.at(belief.phi - belief.theta)[2]
        alpha = self._supports.push_angle(flat, curvature)
        angle = flat.angle + alpha - normal
        heading_offset = belief.theta + normal - belief.phi
        trouble = jackknifed(site, normal, angle)
        if self._differential:
            return limit_command(differential_command(speed, angle, heading_offset, robot.radius), robot), trouble
        forward = speed * math.cos(alpha)
        rolled = belief.phi - belief.theta - site.heading
        wanted = self._centred(belief)[0]
        omega = forward * curvature + self._settings.rolling_gain * speed * (wanted - rolled)
        return limit_command(holonomic_command(speed, angle, heading_offset, robot.radius, omega), robot), trouble
