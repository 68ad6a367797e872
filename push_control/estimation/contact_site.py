"""Where the robot touches the object, and how that place rolls."""

import math
from typing import NamedTuple

from push_model.contact import (
    contact_point, curvature_radius, face_normal, find_contact, normal_range, rolling_constants,
)
from push_model.geometry import Pose, wrap_angle

GAP_LIMIT = 0.01
SAME_POINT, NEAR, TURN = 0.02, 0.5, 0.5


class ContactOffset(NamedTuple):
    """
    Where the robot's centre is beside the place that rolling contact gives it.

    :param gap: backwards along the contact normal [m].
    :param slid: along t, the normal turned by +90 degrees [m].
    """

    gap: float
    slid: float


class ContactSite(NamedTuple):
    """
    The contact in the object frame, for any turn of the robot relative to the object.

    :param kind: ``'vertex'``, ``'face'`` or ``'round'``.
    :param share: lam of the rolling rule.
    :param robot_radius: R_p [m].
    :param object_radius: R_s [m].
    :param point: C at the start, object frame (x, y) [m].
    :param normal: angle of n at the start, object frame [rad].
    :param heading: robot heading at the start, relative to the object [rad].
    :param normal_limits: angles that n may take at this feature, object frame [rad].
    :param edges: coordinates along t between which C may lie on a face, object frame [m].
    """

    kind: str
    share: float
    robot_radius: float
    object_radius: float
    point: tuple
    normal: float
    heading: float
    normal_limits: tuple
    edges: tuple = (-math.inf, math.inf)

    def at(self, heading):
        """
        Find the contact for a robot that has rolled without slip.

        :param heading: robot heading relative to the object, unwrapped [rad].
        :return: (C_x, C_y) in the object frame [m], angle of n in the object frame [rad].
        """
        turn = heading - self.heading
        if self.kind == 'vertex':
            return self.point[0], self.point[1], self.normal + turn
        if self.kind == 'face':
            shift = self.robot_radius * turn
            return (self.point[0] + shift * math.sin(self.normal),
                    self.point[1] - shift * math.cos(self.normal), self.normal)
        normal = self.normal + (1.0 - self.share) * turn
        return (-self.object_radius * math.cos(normal), -self.object_radius * math.sin(normal),
                normal)

    def offset(self, pose, phi, center):
        """
        Compare the robot's place with that of a robot that has rolled.

        :param pose: ``Pose`` of the object in the world, its angle not wrapped.
        :param phi: heading of the robot [rad].
        :param center: of the robot in the world (x, y) [m].
        :return: ``ContactOffset``.
        """
        place = self.robot_center(pose, phi)
        gamma = pose.theta + self.at(phi - pose.theta)[2]
        ahead, aside = Pose(0.0, 0.0, -gamma).rotate((center[0] - place[0], center[1] - place[1]))
        return ContactOffset(-ahead, aside)

    def robot_center(self, pose, phi):
        """
        Place a robot that has rolled.

        :param pose: ``Pose`` of the object in the world, its angle not wrapped.
        :param phi: heading of the robot [rad].
        :return: its centre in the world (x, y) [m].
        """
        c_x, c_y, normal = self.at(phi - pose.theta)
        return pose.transform((c_x - self.robot_radius * math.cos(normal),
                               c_y - self.robot_radius * math.sin(normal)))

    def slid(self, travel):
        """
        Find the contact of a robot that has slid along the object.

        :param travel: of the robot's centre along t, the normal turned by +90 degrees [m].
        :return: ``ContactSite`` that rolls on from there.
        """
        if self.kind == 'face':
            return self._replace(point=(self.point[0] - travel * math.sin(self.normal),
                                        self.point[1] + travel * math.cos(self.normal)))
        normal = self.normal - travel / (self.robot_radius + self.object_radius)
        if self.kind == 'vertex':
            return self._replace(normal=normal)
        return self._replace(normal=normal, point=(-self.object_radius * math.cos(normal),
                                                   -self.object_radius * math.sin(normal)))

    def is_kept(self, other, shift):
        """
        Tell whether a push at another site is this one, only seen a little later or earlier.

        :param other: the other ``ContactSite``.
        :param shift: ``Pose`` of the object there, relative to where it is now.
        """
        return (self.kind == other.kind and math.dist(self.point, other.point) <= SAME_POINT
                and math.hypot(shift.x, shift.y) <= NEAR and abs(wrap_angle(shift.theta)) <= TURN)

    @property
    def heading_offset(self):
        """Angle from the robot's heading to the contact normal at the start [rad]."""
        return math.remainder(self.normal - self.heading, 2.0 * math.pi)


def initial_contact_site(obj, robot, trajectory):
    """
    Find the contact that a trajectory starts from.

    :param obj: the ``PushedObject`` as believed.
    :param robot: the ``RoundRobot``.
    :param trajectory: the ``PushTrajectory``.
    :return: ``ContactSite``.
    :raises ValueError: where the robot is not round, or its first pose does not touch the object.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a fence')
    pose = Pose(*trajectory.object_poses[0].tolist())
    x, y, phi = trajectory.robot_poses[0].tolist()
    contact, gamma, gap = find_contact(obj, pose, (x, y), robot.radius)
    if abs(gap) > GAP_LIMIT:
        raise ValueError(f'trajectory.robot_poses[0]: got a robot {gap:.3f} m from the object, '
                         f'expected it in contact, to {GAP_LIMIT} m')
    curved = curvature_radius(obj, contact)
    share, _ = rolling_constants(robot.radius, curved)
    low, high = normal_range(obj, contact)
    if contact.kind != 'vertex':
        low, high = -math.inf, math.inf
    normal = gamma - pose.theta
    normal += 2.0 * math.pi * round((0.5 * (low + high) - normal) / (2.0 * math.pi)
                                    if contact.kind == 'vertex' else 0.0)
    return ContactSite(contact.kind, share, robot.radius, curved, contact_point(obj, contact), normal,
                       phi - pose.theta, (low, high), _edges(obj, contact))


def _edges(obj, contact):
    if contact.kind != 'face':
        return -math.inf, math.inf
    n = face_normal(obj, contact.index)
    return tuple(sorted(y * math.cos(n) - x * math.sin(n) for x, y in (
        obj.outline[contact.index], obj.outline[(contact.index + 1) % len(obj.outline)])))
