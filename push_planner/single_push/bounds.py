"""Lower bounds on the time of a push between two poses."""

import math

from push_model.dubins import dubins_paths
from push_model.friction import ellipsoid_c_squared
from push_model.geometry import Pose, wrap_angle
from push_planner.push_parameters import place


def displacement_bound(problem):
    """
    Time that the followed point needs for its displacement at the pushing speed [s].

    It always holds. The followed point is the contact where it stays in place on the object, else
    the robot's centre. Where the heading is free, only the distance beyond that of the point from
    the object's origin counts, at both ends.

    :param problem: the ``PushProblem``.
    """
    goal, speed = problem.relative_goal, problem.settings.pushing_speed
    x, y = _followed(problem, 0.0)
    if problem.settings.heading_free:
        reach = 2.0 * math.hypot(*_followed(problem, 0.0))
        return max(math.hypot(goal.x, goal.y) - reach, 1e-9) / speed
    end = goal.transform(_followed(problem, wrap_angle(goal.theta)))
    return max(math.hypot(end[0] - x, end[1] - y), 1e-9) / speed


def vehicle_bound(problem):
    """
    Time of the Dubins way of the flat point on the ellipsoidal limit surface [s].

    It holds for slow pushes on that surface, at a contact that is held and stays in the planning
    cone; for real supports and for inertia it is not exact.

    :param problem: the ``PushProblem``.
    :raises ValueError: where the contact is not held in the cone.
    """
    if problem.kind != 'held' or problem.settings.angle_limit != 'cone' or (
            problem.settings.heading_free):
        raise ValueError(f'problem: got a contact of kind {problem.kind!r}, limit '
                         f'{problem.settings.angle_limit!r}, heading_free '
                         f'{problem.settings.heading_free}, expected a held contact in the cone '
                         'and a heading')
    shortest = flat_paths(problem, ellipsoid_c_squared(problem.obj))[0]
    return shortest.length / problem.settings.pushing_speed


def flat_paths(problem, square):
    """
    Ways of the flat point to the goal in the tightest turns that the planning cone allows.

    :param problem: the ``PushProblem``.
    :param square: c^2 of a limit surface on which an object is a vehicle exactly [m^2].
    :return: list of ``DubinsPath`` in the object's start frame, shortest first.
    """
    flat, (x, y) = problem.vehicle, problem.friction_center
    ahead = square / flat.arm
    local = Pose(x + ahead * math.cos(flat.angle), y + ahead * math.sin(flat.angle), flat.angle)
    left, right = (ahead / math.tan(problem.planning_cone_angle + side * problem.normal_offset)
                   for side in (-1.0, 1.0))
    return dubins_paths(local, problem.relative_goal @ local, left, right)


def _followed(problem, turn):
    """Place of the followed point in the object frame, after a turn."""
    phi = 0.0 if problem.kind == 'rolling' else turn
    delta, c_x, c_y = (float(value) for value in place(problem.push_parameters, turn, phi))
    out = problem.robot.radius if problem.kind == 'rolling' else 0.0
    return c_x - out * math.cos(delta), c_y - out * math.sin(delta)
