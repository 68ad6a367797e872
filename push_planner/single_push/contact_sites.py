"""Every site of an object at which a robot may stand to push it."""

import math

from push_model.contact import contact_point, face_length, face_normal, normal_range
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact
from push_model.plan_request import PlanFailure
from push_planner.problem import check_robot_is_round, PlanningFailed, PushProblem
from push_planner.push_parameters import VERTEX_MARGIN

HEADING_OFFSET_SHARES = (0.0, -0.3, 0.3, -0.6, 0.6)
MOST_ASIDE = 0.6
PLACES = 12
APART = 0.005


def site_problems(obj, robot, start, goal, settings):
    """
    List the pushes from all sites: vertices, faces, or places round a disc.

    At a vertex the normal runs through the friction centre, as far as the vertex has such a
    normal. A robot looks along it; a differential drive also somewhat aside, which lets it turn
    more sharply to one side.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``.
    :return: list of ``PushProblem``.
    :raises PlanningFailed: where there is no friction centre, or the robot is a fence.
    """
    check_robot_is_round(robot)
    try:
        center = friction_center(obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    places = _vertices(obj, robot, center, settings) + _faces(obj, center) if obj.outline else (
        _round_places(start, goal))
    return [PushProblem(obj, robot, contact, start, start.theta + normal,
                        start.theta + normal - lead, goal, settings)
            for contact, normal, lead in places]


def robot_start(problem):
    """
    Find where the robot stands at the start of a push.

    :param problem: the ``PushProblem``.
    :return: ``Pose`` of the robot in the world.
    """
    x, y = problem.start.transform(problem.contact_point)
    away = problem.robot.radius
    return Pose(x - away * math.cos(problem.normal), y - away * math.sin(problem.normal),
                wrap_angle(problem.heading))


def _vertices(obj, robot, center, settings):
    """Places (contact, normal in the object frame, D) at the vertices."""
    friction = settings.friction_discount * obj.contact_friction_coefficient
    cone = settings.cone_margin * math.atan(friction)
    leads = HEADING_OFFSET_SHARES if robot.drive == 'differential' else (0.0,)
    places = []
    for index, (x, y) in enumerate(obj.outline):
        contact = Contact('vertex', index)
        low, high = normal_range(obj, contact)
        ahead = low + (math.atan2(center[1] - y, center[0] - x) - low + math.pi) % (
            2.0 * math.pi) - math.pi
        normal = min(max(ahead, low + VERTEX_MARGIN), high - VERTEX_MARGIN)
        # Nearer to the edge of the cone, a robot a little misplaced would be refused.
        if abs(normal - ahead) <= MOST_ASIDE * cone:
            places += [(contact, normal, share * cone) for share in leads]
    return places


def _faces(obj, center):
    """Places in the middle of the faces, and where their normal runs through the centre."""
    places = []
    for index in range(len(obj.outline)):
        normal, reach = face_normal(obj, index), 0.5 * face_length(obj, index)
        x, y = contact_point(obj, Contact('face', index))
        # Offsets count along t, which is n turned by +90 degrees.
        aside = (center[0] - x) * -math.sin(normal) + (center[1] - y) * math.cos(normal)
        offsets = [0.0] + ([aside] if APART < abs(aside) < reach - APART else [])
        places += [(Contact('face', index, offset), normal, 0.0) for offset in offsets]
    return places


def _round_places(start, goal):
    """Places all round a disc, and the one opposite to the goal."""
    local = start.inverse() @ goal
    angles = [2.0 * math.pi * i / PLACES - math.pi for i in range(PLACES)]
    angles.append(math.atan2(-local.y, -local.x))
    return [(Contact('round', 0, angle), angle + math.pi, 0.0) for angle in angles]
