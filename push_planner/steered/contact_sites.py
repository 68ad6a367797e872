"""Contact sites: the places on an object where a robot may push it."""

import math
from typing import NamedTuple

from push_model.contact import contact_point, face_length, face_normal, normal_range
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_planner.problem import (
    check_object_stands, check_robot_is_round, PlanningFailed, PushProblem)
from push_planner.settings import PlannerSettings
from push_planner.steered.push_parameters import VERTEX_MARGIN

# Heading offsets of a differential drive at a vertex, as fractions of the planning cone. Chosen:
# the further off, the tighter the turns to one side; at 1 it would steer to that side only.
HEADING_OFFSET_FRACTIONS = (0.0, -0.3, 0.3, -0.6, 0.6)
# Largest angle between the normal at a vertex and the direction to the centre of friction, as a
# fraction of the planning cone. Chosen: nearer to the edge of the cone, a robot that stands a
# little off would be refused.
MAX_NORMAL_OFFSET_FRACTION = 0.6
# Sites round a disc. Chosen: 30 degrees apart, besides the one opposite to the goal.
ROUND_SITES = 12
# Least distance between two sites on a face, and from its ends [m]. Chosen: the accuracy with
# which a robot reaches a site.
MIN_SITE_DISTANCE = 0.005


class ContactSite(NamedTuple):
    """
    A place on an object to push at.

    :param contact: the ``Contact``.
    :param normal: angle of the contact normal in the object frame [rad].
    :param heading_offset: D, angle from the robot's heading to the normal [rad].
    """

    contact: Contact
    normal: float
    heading_offset: float


def site_problems(obj: PushedObject, robot: RoundRobot, start: Pose, goal: Pose,
                  settings: PlannerSettings) -> list[PushProblem]:
    """
    List the pushes from all sites: vertices, faces, or places round a disc.

    At a vertex the normal runs through the centre of friction, as far as the vertex has such a
    normal. A robot heads along it; a differential drive also somewhat off, which lets it turn more
    tightly to one side.

    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world at the end.
    :raises PlanningFailed: where there is no centre of friction, or the robot is not round.
    """
    check_robot_is_round(robot)
    check_object_stands(obj)
    try:
        center = friction_center(obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    if obj.outline:
        sites = _vertex_sites(obj, robot, center, settings) + _face_sites(obj, center)
    else:
        sites = _round_sites(start, goal)
    return [PushProblem(obj, robot, site.contact, start, start.theta + site.normal,
                        start.theta + site.normal - site.heading_offset, goal, settings)
            for site in sites]


def robot_start(problem: PushProblem) -> Pose:
    """Find the pose of the robot in the world at the start of a push."""
    x, y = problem.start.transform(problem.contact_point)
    radius = problem.robot.radius
    return Pose(x - radius * math.cos(problem.normal), y - radius * math.sin(problem.normal),
                wrap_angle(problem.heading))


def _vertex_sites(obj: PushedObject, robot: RoundRobot, center: tuple[float, float],
                  settings: PlannerSettings) -> list[ContactSite]:
    friction = settings.friction_discount * obj.contact_friction_coefficient
    cone = settings.cone_margin * math.atan(friction)
    fractions = HEADING_OFFSET_FRACTIONS if robot.drive == 'differential' else (0.0,)
    sites: list[ContactSite] = []
    for index, (x, y) in enumerate(obj.outline):
        contact = Contact('vertex', index)
        low, high = normal_range(obj, contact)
        to_center = math.atan2(center[1] - y, center[0] - x)
        # Next to the range of normals, which may be beyond pi.
        to_center = low + (to_center - low + math.pi) % (2.0 * math.pi) - math.pi
        normal = min(max(to_center, low + VERTEX_MARGIN), high - VERTEX_MARGIN)
        if abs(normal - to_center) <= MAX_NORMAL_OFFSET_FRACTION * cone:
            sites += [ContactSite(contact, normal, fraction * cone) for fraction in fractions]
    return sites


def _face_sites(obj: PushedObject, center: tuple[float, float]) -> list[ContactSite]:
    """Sites in the middle of the faces, and where their normal runs through the centre."""
    sites: list[ContactSite] = []
    for index in range(len(obj.outline)):
        normal, half = face_normal(obj, index), 0.5 * face_length(obj, index)
        x, y = contact_point(obj, Contact('face', index))
        # Offsets count along t, which is n rotated by +90 degrees.
        offset = (center[0] - x) * -math.sin(normal) + (center[1] - y) * math.cos(normal)
        sites.append(ContactSite(Contact('face', index, 0.0), normal, 0.0))
        if MIN_SITE_DISTANCE < abs(offset) < half - MIN_SITE_DISTANCE:
            sites.append(ContactSite(Contact('face', index, offset), normal, 0.0))
    return sites


def _round_sites(start: Pose, goal: Pose) -> list[ContactSite]:
    """Sites all round a disc, and the one opposite to the goal."""
    local = start.inverse() @ goal
    angles = [2.0 * math.pi * i / ROUND_SITES - math.pi for i in range(ROUND_SITES)]
    angles.append(math.atan2(-local.y, -local.x))
    return [ContactSite(Contact('round', 0, angle), angle + math.pi, 0.0) for angle in angles]
