"""The contact on the object: where the robot touches it, and how that place rolls and slides."""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled
from push_model.contact import (
    contact_point, curvature_radius, face_normal, find_contact, normal_range, rolling_constants,
)
from push_model.geometry import Coordinates, Pose, wrap_angle
from push_model.parameters import Contact, ContactKind, PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory

# Gap or overlap with which the start of a plan counts as contact [m]. Chosen: far above the
# planner's tolerance, far below any robot.
CONTACT_TOLERANCE = 0.01
# How near a push that is to be continued must start: of the contact on the object [m], and of the
# object [m, rad]. Chosen: what a push moves while a plan is made.
SAME_POINT_DISTANCE = 0.02
SAME_PUSH_DISTANCE = 0.5
SAME_PUSH_ROTATION = 0.5
# Count of ``RollingContact.values``.
SITE_SIZE = 11


class ContactOffset(NamedTuple):
    """
    Offset of the robot's centre from where rolling contact would have it.

    :param gap: backwards along the contact normal n [m].
    :param slip: along the tangent t, n rotated by +90 degrees [m].
    """

    gap: float
    slip: float


class EstimatedContactFrame(NamedTuple):
    """
    Contact point C and normal in the object frame.

    :param x: of C [m].
    :param y: of C [m].
    :param normal: angle of n [rad].
    """

    x: float
    y: float
    normal: float


class RollingContact(NamedTuple):
    """
    The contact in the object frame, for any heading of the robot relative to the object.

    :param normal_ratio: lam of the rolling rule (model: section 2).
    :param robot_radius: R_p [m].
    :param object_radius: R_s [m]; 0 at a vertex, infinite on a face.
    :param point: C at the start, object frame (x, y) [m].
    :param normal: angle of n at the start, object frame [rad].
    :param heading: robot heading at the start, relative to the object [rad].
    :param normal_limits: angles that n may take at this feature, object frame [rad].
    :param edges: coordinates along t between which C may lie on a face, object frame [m].
    """

    normal_ratio: float
    robot_radius: float
    object_radius: float
    point: tuple[float, float]
    normal: float
    heading: float
    normal_limits: tuple[float, float]
    edges: tuple[float, float] = (-math.inf, math.inf)

    @property
    def kind(self) -> ContactKind:
        """The feature that is touched."""
        if self.object_radius == 0.0:
            return 'vertex'
        return 'face' if math.isinf(self.object_radius) else 'round'

    @property
    def values(self) -> tuple[float, ...]:
        """Values in a row, as ``contact_site`` reads them, ``SITE_SIZE`` of them."""
        return (*self[:3], *self.point, self.normal, self.heading, *self.normal_limits,
                *self.edges)

    @property
    def heading_offset(self) -> float:
        """D, angle from the robot's heading to the contact normal at the start [rad]."""
        return math.remainder(self.normal - self.heading, 2.0 * math.pi)

    def contact_at(self, heading: float) -> EstimatedContactFrame:
        """
        Find the contact of a robot that has rolled without slip.

        :param heading: of the robot relative to the object, unwrapped [rad].
        """
        return _rolled_contact(self, heading)

    def robot_center(self, pose: Pose, phi: float) -> tuple[float, float]:
        """
        Place a robot that has rolled without slip.

        :param pose: ``Pose`` of the object in the world, its angle not wrapped.
        :param phi: heading of the robot [rad].
        :return: its centre in the world (x, y) [m].
        """
        c_x, c_y, normal = self.contact_at(phi - pose.theta)
        return pose.transform((c_x - self.robot_radius * math.cos(normal),
                               c_y - self.robot_radius * math.sin(normal)))

    def offset(self, pose: Pose, phi: float, center: Coordinates) -> ContactOffset:
        """
        Compare the robot's place with that of a robot that has rolled without slip.

        :param pose: ``Pose`` of the object in the world, its angle not wrapped.
        :param phi: heading of the robot [rad].
        :param center: of the robot in the world (x, y) [m].
        """
        expected = self.robot_center(pose, phi)
        gamma = pose.theta + self.contact_at(phi - pose.theta).normal
        along, across = Pose(0.0, 0.0, -gamma).rotate((center[0] - expected[0],
                                                       center[1] - expected[1]))
        return ContactOffset(-along, across)

    def after_slip(self, slip: float) -> 'RollingContact':
        """
        Find the contact of a robot that has slid along the object.

        :param slip: of the robot's centre along t, the normal rotated by +90 degrees [m].
        :return: ``RollingContact`` that rolls on from there.
        """
        if self.kind == 'face':
            return self._replace(point=(self.point[0] - slip * math.sin(self.normal),
                                        self.point[1] + slip * math.cos(self.normal)))
        rolled = self._replace(normal=self.normal
                               - slip / (self.robot_radius + self.object_radius))
        x, y, _ = rolled.contact_at(self.heading)
        return rolled._replace(point=(x, y))

    def is_same_push(self, other: 'RollingContact', shift: Pose) -> bool:
        """
        Tell whether a push at another site is this one, only a little later or earlier.

        :param other: the other ``RollingContact``.
        :param shift: ``Pose`` of the object there, relative to where it is now.
        :return: whether it is.
        """
        return (self.kind == other.kind
                and math.dist(self.point, other.point) <= SAME_POINT_DISTANCE
                and math.hypot(shift.x, shift.y) <= SAME_PUSH_DISTANCE
                and abs(wrap_angle(shift.theta)) <= SAME_PUSH_ROTATION)


@compiled
def rolled_contact(contact: RollingContact, heading: float) -> EstimatedContactFrame:
    """
    Find the contact of a robot that has rolled without slip.

    :param heading: of the robot relative to the object, unwrapped [rad].
    """
    rotation = heading - contact.heading
    if contact.object_radius == 0.0:
        return EstimatedContactFrame(contact.point[0], contact.point[1], contact.normal + rotation)
    if math.isinf(contact.object_radius):
        shift = contact.robot_radius * rotation
        return EstimatedContactFrame(contact.point[0] + shift * math.sin(contact.normal),
                                     contact.point[1] - shift * math.cos(contact.normal),
                                     contact.normal)
    normal = contact.normal + (1.0 - contact.normal_ratio) * rotation
    return EstimatedContactFrame(-contact.object_radius * math.cos(normal),
                                 -contact.object_radius * math.sin(normal), normal)


# The function itself: called from Python it is faster than its machine code.
_rolled_contact = getattr(rolled_contact, 'py_func', rolled_contact)


@compiled
def contact_site(values: Any) -> RollingContact:
    """
    Read a contact.

    :param values: ``RollingContact.values``, shape (n,), the first ``SITE_SIZE`` of which count.
    """
    return RollingContact(values[0], values[1], values[2], (values[3], values[4]), values[5],
                          values[6], (values[7], values[8]), (values[9], values[10]))


def initial_contact_site(obj: PushedObject, robot: RoundRobot,
                         trajectory: PushTrajectory) -> RollingContact:
    """
    Find the contact that a trajectory starts from.

    :raises ValueError: where the robot is not round, or its first pose does not touch the object.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a fence')
    pose = Pose(*trajectory.object_poses[0].tolist())
    x, y, phi = trajectory.robot_poses[0].tolist()
    contact, gamma, gap = find_contact(obj, pose, (x, y), robot.radius)
    if abs(gap) > CONTACT_TOLERANCE:
        raise ValueError(f'trajectory.robot_poses[0]: got a robot {gap:.3f} m from the object, '
                         f'expected it in contact, to {CONTACT_TOLERANCE} m')
    object_radius = curvature_radius(obj, contact)
    normal_ratio = rolling_constants(robot.radius, object_radius).normal_ratio
    normal = gamma - pose.theta
    normal_limits = -math.inf, math.inf
    full_turns = 0
    if contact.kind == 'vertex':
        normal_limits = low, high = normal_range(obj, contact)
        # Of all angles of this normal, the one nearest to the middle of the vertex.
        full_turns = round((0.5 * (low + high) - normal) / (2.0 * math.pi))
    normal += 2.0 * math.pi * full_turns
    return RollingContact(normal_ratio, robot.radius, object_radius,
                          contact_point(obj, contact), normal, phi - pose.theta, normal_limits,
                          _edges(obj, contact))


def _edges(obj: PushedObject, contact: Contact) -> tuple[float, float]:
    """Coordinates along t of the two ends of a face."""
    if contact.kind != 'face':
        return -math.inf, math.inf
    n = face_normal(obj, contact.index)
    ends = obj.outline[contact.index], obj.outline[(contact.index + 1) % len(obj.outline)]
    first, second = (y * math.cos(n) - x * math.sin(n) for x, y in ends)
    return min(first, second), max(first, second)
