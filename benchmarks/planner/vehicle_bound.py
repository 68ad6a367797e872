"""
Plans compared with the vehicle bound, in the model where it is exact.

Slow pushes on the ellipsoidal limit surface rotate as under viscous friction: velocities and
directions of forces are the same, with c^2 the mean square of the supports' distances from F. The
planner's NLP with friction that is viscous at all speeds is therefore that model.
"""

import dataclasses
import math
from typing import Any

from benchmarks.planner.nlp_solvers import solve, turn_pair
from push_model.dubins import dubins_paths, DubinsPath
from push_model.friction import c_squared, ellipsoid_c_squared
from push_model.geometry import Pose
from push_planner.collocation.dimensions import Dimensions
from push_planner.collocation.nlp_solver import NlpSolver
from push_planner.initial_guess.dubins_routes import routes
from push_planner.problem import PushProblem

# Smoothing of the friction, per pushing speed: all sliding speeds lie far below it; chosen.
VISCOUS = 30.0
EXACT: dict[str, Any] = {
    'fatrop': {'print_level': 0, 'tol': 1e-7, 'mu_init': 1e-3, 'max_iter': 200}}
# Number of routes that are solved; chosen.
MAX_ROUTES = 12


def bounds(problem: PushProblem) -> tuple[float, float]:
    """
    Find the bounds on the time of a push on the ellipsoidal limit surface.

    :param problem: the ``PushProblem``.
    :return: (least, greatest) time of the quickest push [s].
    """
    flat = problem.vehicle
    c_squared_sum = sum(c_squared(problem.obj, flat.angle + turn) for turn in (0.0, 0.5 * math.pi))
    paths = flat_paths(problem, c_squared_sum)
    wheelbase = flat.arm + c_squared_sum / flat.arm
    path_length = min(
        sum(length * math.hypot(1.0, wheelbase * curvature)
            for length, curvature in zip(path.lengths, path.curvatures)) for path in paths)
    speed = problem.settings.pushing_speed
    return paths[0].length / speed, path_length / speed


def vehicle_bound(problem: PushProblem) -> float:
    """
    Return the time of the shortest path of the flat output on the ellipsoidal limit surface [s].

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


def flat_paths(problem: PushProblem, c_squared_value: float) -> list[DubinsPath]:
    """
    List the paths of the flat output to the goal in the tightest turns that the cone allows.

    :param problem: the ``PushProblem``.
    :param c_squared_value: c^2 of a limit surface on which an object is a vehicle exactly [m^2].
    :return: list of ``DubinsPath`` in the object's start frame, shortest first.
    """
    flat, (x, y) = problem.vehicle, problem.friction_center
    ahead = c_squared_value / flat.arm
    local = Pose(x + ahead * math.cos(flat.angle), y + ahead * math.sin(flat.angle), flat.angle)
    left, right = (ahead / math.tan(problem.planning_cone_angle + side * problem.normal_offset)
                   for side in (-1.0, 1.0))
    return dubins_paths(local, problem.relative_goal @ local, left, right)


class BoundComparison:
    """The planner's NLP on the ellipsoidal limit surface, built once for its dimensions."""

    def __init__(self) -> None:
        """Begin with no solver."""
        self._built: dict[Dimensions, NlpSolver] = {}

    def __call__(self, problem: PushProblem) -> tuple[float, float]:
        """
        Plan, and compare the plan with its bounds.

        :param problem: the ``PushProblem``.
        :return: (time over the lower bound, time over the upper one), infinite without a plan.
        """
        problem = dataclasses.replace(problem, settings=dataclasses.replace(
            problem.settings, motion_model='quasi_static'))
        least, greatest = bounds(problem)
        paths = routes(problem, turn_pair(problem))[:MAX_ROUTES]
        quickest = min(solve(problem, route, self._nlp_solver)[0] for route in paths)
        return quickest / least, quickest / greatest

    def _nlp_solver(self, dimensions: Dimensions) -> NlpSolver:
        if dimensions not in self._built:
            self._built[dimensions] = NlpSolver(dimensions, options=EXACT, smoothing=VISCOUS)
        return self._built[dimensions]
