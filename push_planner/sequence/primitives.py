"""What a chain is made of: at each site a turn to one side, with straight pushes around it."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.contact import normal_range
from push_model.geometry import Pose, wrap_angle
from push_model.plan_request import PlanFailure
from push_planner.collocation.formulation import rotation_range
from push_planner.initial_guess.dubins_routes import tightest_turns
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.push_parameters import VERTEX_MARGIN
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_feasibility

HOME = Pose(0.0, 0.0, 0.0)
# Share of a vertex or a face that steady turns may use; the rest is for changes of them.
AGILITY = 0.9
STRAIGHT = 0.05
# Steeper pushes turn an object about one of its feet, which is hard to foretell [rad].
STEEPEST = 0.8


class PushPrimitive(NamedTuple):
    """
    Pushing at a site, with turns to one side.

    :param problem: ``PushProblem`` of the site, with the object at the origin.
    :param side: 1 for turns to the left, -1 to the right.
    :param radius: of the turns of the flat point [m].
    :param stretch: way of the contact over that of the flat point, in turns.
    :param widest: most that the push may turn the object [rad].
    """

    problem: PushProblem
    side: float
    radius: float
    stretch: float
    widest: float

    @property
    def robot_pose(self):
        """``Pose`` of the robot in the object frame, at the start and after a straight end."""
        return robot_start(self.problem)

    def moved(self, object_pose, goal, settings):
        """
        Ask for a push from this site.

        :param object_pose: ``Pose`` of the object in the world.
        :param goal: ``Pose`` of the object in the world, after the push.
        :param settings: ``PlannerSettings``.
        :return: ``PushProblem``.
        """
        problem, turn = self.problem, object_pose.theta
        return PushProblem(problem.obj, problem.robot, problem.contact, object_pose,
                           problem.normal + turn, problem.heading + turn, goal, settings)


class PrimitiveTable(NamedTuple):
    """
    Elements as arrays of shape (n,).

    Pushing may go on from one element to another of the same place.

    :param primitives: the ``PushPrimitive`` themselves.
    :param sides: 1 or -1.
    :param radii: [m].
    :param stretches: see ``PushPrimitive``.
    :param widest: [rad].
    :param angles: direction from contact to flat point in the object frame [rad].
    :param flats: the flat points in the object frame, shape (n, 2) [m].
    :param faces: whether it is a place on a face.
    :param numbers: number of the place.
    :param places: ``Pose`` of the robot in the object frame at each place, at the start of a push
        and after a straight end.
    """

    primitives: tuple
    sides: np.ndarray
    radii: np.ndarray
    stretches: np.ndarray
    widest: np.ndarray
    angles: np.ndarray
    flats: np.ndarray
    faces: np.ndarray
    numbers: np.ndarray
    places: tuple


@functools.lru_cache(maxsize=16)
def primitive_table(obj, robot, settings, task, bearing):
    """
    List what chains can be made of.

    Of the robot's headings at a contact, that with the tightest turns to the side counts.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param task: ``TaskSettings``.
    :param bearing: direction of the goal in the object frame, for a place opposite to it [rad];
        does not matter for a polygon.
    :return: ``PrimitiveTable``.
    :raises PlanningFailed: where there is no site; with the reason of the last one refused.
    """
    goal = Pose(math.cos(bearing), math.sin(bearing), 0.0)
    best, reason = {}, 'none'
    for problem in site_problems(obj, robot, HOME, goal, settings):
        try:
            check_feasibility(problem)
        except PlanningFailed as failure:
            reason = failure.reason
            continue
        for primitive in _elements(problem, task):
            key = (problem.contact, primitive.side)
            if key not in best or primitive.radius < best[key].radius:
                best[key] = primitive
    if not best:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no site will do for a chain of pushes: {reason}')
    found = tuple(best.values())
    places = tuple(dict.fromkeys(primitive.robot_pose for primitive in found))
    views = [primitive.problem.vehicle for primitive in found]
    return PrimitiveTable(found, *(np.array(column) for column in zip(*(item[1:] for item in found))),
                          np.array([view.angle for view in views]),
                          np.array([view.flat_output for view in views]),
                          np.array([primitive.problem.contact.kind == 'face' for primitive in found]),
                          np.array([places.index(primitive.robot_pose) for primitive in found]), places)


def _elements(problem, task):
    turns = tightest_turns(problem)
    if turns is None:
        return []
    low, high = rotation_range(problem)
    found = []
    for side, turn, limit, sharpest in zip((1.0, -1.0), turns, (high, -low), _sharpest(problem)):
        steering_angle = min(abs(turn.steering_angle), STEEPEST)
        tightest = abs(turn.curvature) * math.tan(steering_angle) / math.tan(abs(turn.steering_angle))
        curvature = min(tightest / task.radius_factor, sharpest)
        if curvature > STRAIGHT:
            found.append(PushPrimitive(problem, side, 1.0 / curvature, 1.0 / math.cos(steering_angle),
                                       min(task.max_rotation, AGILITY * limit)))
    return found


def _sharpest(problem):
    """Curvatures (left, right) that a vertex allows to a differential drive [1/m]."""
    if problem.kind != 'differential':
        return math.inf, math.inf
    # In steady turns the normal is at D - (L + R_p) kappa off the line from contact to F.
    low, high = normal_range(problem.obj, problem.contact)
    settled = problem.vehicle.angle + problem.heading_offset
    room = high - low - 2.0 * VERTEX_MARGIN
    right = wrap_angle(0.5 * (low + high) - settled) + 0.5 * room
    if not 0.0 <= right <= room:
        return 0.0, 0.0
    reach = problem.vehicle.wheelbase + problem.robot.radius
    return tuple(AGILITY * share / reach for share in (room - right, right))


def goal_bearing(obj, start, goal):
    """
    Direction of the goal in the object frame, where it decides on the sites [rad].

    :param obj: the ``PushedObject``.
    :param start: ``Pose`` of the object.
    :param goal: ``Pose`` of the object.
    """
    local = start.inverse() @ goal
    return 0.0 if obj.outline else wrap_angle(math.atan2(local.y, local.x))
