"""
The planner's NLP from random initial guesses: how far its plans are above the best of them.

Only ``starts`` and ``solve`` use the internals of the planner.
"""

import dataclasses
import math
from typing import NamedTuple

from benchmarks.planner.measure import Answer
import numpy as np
from push_model.dubins import dubins_paths, DubinsPath
from push_model.geometry import Pose
from push_planner.problem import PushProblem
from push_planner.steered.collocation.formulation import formulate
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.initial_guess.dubins_routes import tightest_turns, TurnPair
from push_planner.steered.initial_guess.first_guess import Route
from push_planner.steered.initial_guess.steady_turns import SteadyTurn

# Number of segments, and a segment length that leaves it fixed [m].
FINE_SEGMENTS = 48
SEGMENT_LENGTH = 20.0
SEED = 48
# Random starts, chosen: intermediate poses lie within the goal's distance and this [m]; least
# fraction of the tightest turns.
MARGIN = 2.0
GENTLEST = 0.3
# Path length that a plan may fall short of the displacement bound by its tolerances [m]; chosen.
SLACK = 1e-4


class Quality(NamedTuple):
    """
    A plan against random starts.

    :param gap: its time over that of the best, less 1.
    :param converged: number of starts that led to a push.
    :param below_bound: whether it is quicker than the displacement of the contact allows.
    """

    gap: float
    converged: int
    below_bound: bool


def turn_pair(problem: PushProblem) -> TurnPair:
    """
    Return the tightest turns of a problem.

    :raises ValueError: where there are none.
    """
    turns = tightest_turns(problem)
    if turns is None:
        raise ValueError('problem: got one without steady turns, expected turns both ways')
    return turns


def with_segments(problem: PushProblem, count: int) -> PushProblem:
    """Return the problem with a fixed number of segments."""
    settings = dataclasses.replace(problem.settings, segments=count, segment_length=SEGMENT_LENGTH)
    return dataclasses.replace(problem, settings=settings)


def starts(problem: PushProblem, rng: np.random.Generator, count: int) -> list[Route]:
    """
    Draw routes: Dubins paths through a random pose, with turns of random tightness.

    :param problem: the ``PushProblem``; without final straight.
    :param rng: random generator.
    :param count: number of routes.
    :return: list of ``Route``.
    """
    vehicle, tightest = problem.vehicle, turn_pair(problem)
    start = Pose(vehicle.flat_output[0], vehicle.flat_output[1], vehicle.angle)
    goal = problem.relative_goal @ start
    size = MARGIN + math.hypot(goal.x, goal.y)
    routes: list[Route] = []
    while len(routes) < count:
        left, right = (SteadyTurn(factor * turn.steering_angle, factor * turn.w)
                       for turn, factor in zip(tightest, rng.uniform(GENTLEST, 1.0, 2)))
        x, y = rng.uniform(-size, size, 2)
        between = Pose(x, y, rng.uniform(-math.pi, math.pi))
        path: tuple[DubinsPath, ...] = ()
        pose = start
        for end in (between, goal) if rng.random() < 0.5 else (goal,):
            paths = dubins_paths(pose, end, 1.0 / left.curvature, -1.0 / right.curvature)
            path, pose = (*path, paths[rng.integers(len(paths))]), end
        lengths = tuple(length for part in path for length in part.lengths)
        curvatures = tuple(curvature for part in path for curvature in part.curvatures)
        turns = tuple((left if c > 0.0 else right) if c else SteadyTurn(0.0, 0.0)
                      for c in curvatures)
        cost = sum(length / math.cos(turn.steering_angle) for length, turn in zip(lengths, turns))
        word = ''.join(part.word for part in path)
        routes.append(Route(DubinsPath(start, word, lengths, curvatures), turns, 0.0, cost))
    return routes


def solve(problem: PushProblem, route: Route) -> float:
    """
    Solve the NLP from a route.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :return: duration of the push [s]; infinite where there is none.
    """
    asked, guess = formulate(problem, route)
    solution = push_solver(asked.dimensions).solve(asked, guess).solution
    if solution is None:
        return math.inf
    return float(asked.mesh.step_times(solution.free_length).sum())


def quality(answer: Answer, count: int) -> Quality:
    """
    Compare a plan with random starts of an NLP with twice the segments.

    :param answer: ``Answer`` of the plan.
    :param count: number of starts.
    :return: ``Quality``.
    """
    problem = with_segments(answer.problem, FINE_SEGMENTS)
    rng = np.random.default_rng((SEED, int(1e6 * abs(problem.goal.x))))
    times = [solve(problem, route) for route in starts(problem, rng, count)]
    return Quality(answer.duration / min(times) - 1.0, sum(map(math.isfinite, times)),
                   answer.duration < answer.bound - SLACK / problem.settings.pushing_speed)
