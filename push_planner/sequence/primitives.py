"""
Push primitives: what sequences of pushes are made of.

A primitive pushes at one contact location, with rotations of the object to one side: along a
straight line or along a circle of one radius.
"""

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.contact import normal_range
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_planner.collocation.formulation import rotation_range
from push_planner.initial_guess.dubins_routes import tightest_turns
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.push_parameters import VERTEX_MARGIN
from push_planner.settings import PlannerSettings, TaskSettings
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_feasibility

HOME = Pose(0.0, 0.0, 0.0)
# Fraction of a vertex or a face that steady turns may use, chosen; the rest is for transients.
STEADY_FRACTION = 0.9
# Curvature below which a primitive cannot rotate the object in a useful distance [1/m], chosen:
# circles of 20 m.
MIN_CURVATURE = 0.05
# Steering angle of the contact [rad], chosen: steeper pushes rotate an object about one of its
# supports, which is hard to predict.
MAX_STEERING_ANGLE = 0.8


class PushPrimitive(NamedTuple):
    """
    Pushing at a contact location, with rotations to one side.

    :param problem: ``PushProblem`` of the location, with the object at the origin.
    :param side: 1 for rotations to the left, -1 to the right.
    :param radius: of the circles of the flat output point [m].
    :param length_ratio: path length of the contact over that of the flat output point, on
        circles.
    :param max_rotation: of the object in one push [rad].
    """

    problem: PushProblem
    side: float
    radius: float
    length_ratio: float
    max_rotation: float

    @property
    def robot_pose(self) -> Pose:
        """``Pose`` of the robot in the object frame, at the start and after a straight end."""
        return robot_start(self.problem)

    def problem_at(self, object_pose: Pose, goal: Pose, settings: PlannerSettings) -> PushProblem:
        """
        Make the problem of a push from this location.

        :param object_pose: ``Pose`` of the object in the world.
        :param goal: ``Pose`` of the object in the world, after the push.
        :param settings: ``PlannerSettings``.
        :return: ``PushProblem``.
        """
        problem = self.problem
        theta = object_pose.theta
        return PushProblem(problem.obj, problem.robot, problem.contact, object_pose,
                           problem.normal + theta, problem.heading + theta, goal, settings)


class PrimitiveTable(NamedTuple):
    """
    Primitives as arrays of shape (k,), numbered from 0.

    A push may continue from one primitive to another at the same contact location.

    :param primitives: the ``PushPrimitive`` themselves.
    :param sides: 1 or -1.
    :param radii: see ``PushPrimitive`` [m].
    :param length_ratios: see ``PushPrimitive``.
    :param max_rotations: see ``PushPrimitive`` [rad].
    :param flat_angles: direction from contact to flat output point in the object frame [rad].
    :param flat_outputs: flat output points in the object frame, shape (k, 2) [m].
    :param on_face: whether the location is on a face.
    :param locations: number of the contact location.
    :param robot_poses: ``Pose`` of the robot in the object frame at each contact location, at
        the start of a push and after a straight end.
    """

    primitives: tuple[PushPrimitive, ...]
    sides: FloatArray
    radii: FloatArray
    length_ratios: FloatArray
    max_rotations: FloatArray
    flat_angles: FloatArray
    flat_outputs: FloatArray
    on_face: NDArray[np.bool_]
    locations: NDArray[np.int_]
    robot_poses: tuple[Pose, ...]

    @classmethod
    def of(cls, primitives: tuple[PushPrimitive, ...]) -> 'PrimitiveTable':
        """
        Tabulate primitives.

        :param primitives: ``PushPrimitive`` tuple.
        """
        robot_poses = tuple(dict.fromkeys(primitive.robot_pose for primitive in primitives))
        vehicles = [primitive.problem.vehicle for primitive in primitives]
        return cls(
            primitives=primitives,
            sides=np.array([primitive.side for primitive in primitives]),
            radii=np.array([primitive.radius for primitive in primitives]),
            length_ratios=np.array([primitive.length_ratio for primitive in primitives]),
            max_rotations=np.array([primitive.max_rotation for primitive in primitives]),
            flat_angles=np.array([vehicle.angle for vehicle in vehicles]),
            flat_outputs=np.array([vehicle.flat_output for vehicle in vehicles]),
            on_face=np.array([primitive.problem.contact.kind == 'face'
                              for primitive in primitives]),
            locations=np.array([robot_poses.index(primitive.robot_pose)
                                for primitive in primitives]),
            robot_poses=robot_poses)


@functools.lru_cache(maxsize=16)
def primitive_table(obj: PushedObject, robot: RoundRobot, settings: PlannerSettings,
                    task: TaskSettings, bearing: float) -> PrimitiveTable:
    """
    List the primitives of an object and a robot.

    Of the robot's headings at a contact, that with the tightest circles to the side counts.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param task: ``TaskSettings``.
    :param bearing: direction of the goal in the object frame, for a location opposite to it
        [rad]; without effect for a polygon.
    :return: ``PrimitiveTable``.
    :raises PlanningFailed: where there is no feasible site; with the reason of the last one.
    """
    goal = Pose(math.cos(bearing), math.sin(bearing), 0.0)
    best: dict[tuple[Contact, float], PushPrimitive] = {}
    reason = 'none'
    for problem in site_problems(obj, robot, HOME, goal, settings):
        try:
            check_feasibility(problem)
        except PlanningFailed as failure:
            reason = failure.reason
            continue
        for primitive in _primitives_of(problem, task):
            key = (problem.contact, primitive.side)
            if key not in best or primitive.radius < best[key].radius:
                best[key] = primitive
    if not best:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no feasible contact site for a push sequence: {reason}')
    return PrimitiveTable.of(tuple(best.values()))


def _primitives_of(problem: PushProblem, task: TaskSettings) -> list[PushPrimitive]:
    turns = tightest_turns(problem)
    if turns is None:
        return []
    low, high = rotation_range(problem)
    limits = (high, -low)
    found: list[PushPrimitive] = []
    for side, turn, limit, vertex_curvature in zip((1.0, -1.0), turns, limits,
                                                   _vertex_curvatures(problem)):
        steering_angle = min(abs(turn.steering_angle), MAX_STEERING_ANGLE)
        tightest = (abs(turn.curvature) * math.tan(steering_angle)
                    / math.tan(abs(turn.steering_angle)))
        curvature = min(tightest / task.radius_factor, vertex_curvature)
        if curvature > MIN_CURVATURE:
            found.append(PushPrimitive(problem, side, 1.0 / curvature,
                                       1.0 / math.cos(steering_angle),
                                       min(task.max_rotation, STEADY_FRACTION * limit)))
    return found


def _vertex_curvatures(problem: PushProblem) -> tuple[float, float]:
    """Curvatures (left, right) that a vertex allows to a differential drive [1/m]."""
    if problem.kind != 'differential':
        return math.inf, math.inf
    # In steady turns the normal is at D - (L + R_p) kappa off the line from contact to F.
    low, high = normal_range(problem.obj, problem.contact)
    settled = problem.vehicle.angle + problem.heading_offset
    usable = high - low - 2.0 * VERTEX_MARGIN
    right = wrap_angle(0.5 * (low + high) - settled) + 0.5 * usable
    if not 0.0 <= right <= usable:
        return 0.0, 0.0
    lever = problem.vehicle.wheelbase + problem.robot.radius
    return STEADY_FRACTION * (usable - right) / lever, STEADY_FRACTION * right / lever


def goal_bearing(obj: PushedObject, start: Pose, goal: Pose) -> float:
    """
    Direction of the goal in the object frame, where the contact sites depend on it [rad].

    :param obj: the ``PushedObject``.
    :param start: ``Pose`` of the object.
    :param goal: goal ``Pose`` of the object.
    """
    local = start.inverse() @ goal
    return 0.0 if obj.outline else wrap_angle(math.atan2(local.y, local.x))
