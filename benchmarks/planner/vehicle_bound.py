"""
Plans held against the vehicle bound, in the model where it is exact.

Slow pushes on the ellipsoidal limit surface turn like ones on viscous friction: velocities and
directions of forces are the same, with c^2 the mean square of the supports' distances from F. The
planner's programme with friction that is viscous at all speeds is therefore that model.
"""

import dataclasses
import math

from benchmarks.planner.nlp_solvers import solve
from push_model.friction import c_squared
from push_planner.collocation.nlp_solver import NlpSolver
from push_planner.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.single_push.bounds import flat_paths

VISCOUS = 30.0
EXACT = {'fatrop': {'print_level': 0, 'tol': 1e-7, 'mu_init': 1e-3, 'max_iter': 200}}
TRIED = 12


def bounds(problem):
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


class Bounded:
    """The planner's programme on the ellipsoidal limit surface, built once for each shape."""

    def __init__(self):
        """Begin with no programme."""
        self._built = {}

    def __call__(self, problem):
        """
        Plan, and hold the plan against its bounds.

        :param problem: the ``PushProblem``.
        :return: (time over the lower bound, time over the upper one), infinite without a plan.
        """
        problem = dataclasses.replace(problem, settings=dataclasses.replace(
            problem.settings, motion_model='quasi_static'))
        least, greatest = bounds(problem)
        paths = routes(problem, tightest_turns(problem))[:TRIED]
        quickest = min(solve(problem, route, self._nlp_solver)[0] for route in paths)
        return quickest / least, quickest / greatest

    def _nlp_solver(self, shape):
        if shape not in self._built:
            self._built[shape] = NlpSolver(shape, options=EXACT, smoothing=VISCOUS)
        return self._built[shape]
