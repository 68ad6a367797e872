"""
The planner's NLP from random initial guesses and with other solvers.

Only ``starts`` and ``solve`` use the internals of the planner.
"""

import dataclasses
import functools
import math
import shutil
import time
from typing import Any, Callable, NamedTuple, Optional, Sequence

from benchmarks.planner.measure import Answer, collect
import casadi as ca
import numpy as np
from push_model.dubins import dubins_paths, DubinsPath
from push_model.geometry import Pose
from push_planner.collocation.dimensions import Dimensions
from push_planner.collocation.formulation import formulate
from push_planner.collocation.nlp_solver import FATROP, IPOPT, NlpSolver
from push_planner.collocation.push_solver import push_solver
from push_planner.initial_guess.dubins_routes import routes, tightest_turns, TurnPair
from push_planner.initial_guess.first_guess import Route
from push_planner.initial_guess.steady_turns import SteadyTurn
from push_planner.problem import PushProblem

OWN = 'interior point of the planner, compiled'
# Numbers of segments, for the solvers and against random starts, and a segment length that leaves
# them fixed [m].
SEGMENTS = 24
FINE_SEGMENTS = 48
SEGMENT_LENGTH = 20.0
SEED = 48
# Random starts, chosen: intermediate poses lie within the goal's distance and this [m]; least
# fraction of the tightest turns.
REACH = 2.0
GENTLEST = 0.3
# Path length that a plan may fall short of the displacement bound by its tolerances [m]; chosen.
SLACK = 1e-4
QUIET = {'print_time': False, 'error_on_fail': False}
SQP = {'print_header': False, 'print_iteration': False, 'print_status': False, 'max_iter': 60,
       'convexify_strategy': 'regularize'}
FLAGS = {'jit': True, 'compiler': 'shell', 'jit_options': {'flags': ['-O1']}}


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


class SolverRun(NamedTuple):
    """
    One solver on the NLPs of all problems.

    :param name: of the solver.
    :param solved: number of NLPs that it solved.
    :param tried: number of NLPs.
    :param cpu: CPU times of what it solved [s].
    :param iterations: of the same.
    :param gaps: cost over that by fatrop, less 1, of the same.
    """

    name: str
    solved: int
    tried: int
    cpu: list[float]
    iterations: list[int]
    gaps: list[float]


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
    begin = Pose(vehicle.flat_output[0], vehicle.flat_output[1], vehicle.angle)
    goal = problem.relative_goal @ begin
    size = REACH + math.hypot(goal.x, goal.y)
    found: list[Route] = []
    while len(found) < count:
        left, right = (SteadyTurn(factor * turn.steering_angle, factor * turn.w)
                       for turn, factor in zip(tightest, rng.uniform(GENTLEST, 1.0, 2)))
        x, y = rng.uniform(-size, size, 2)
        between = Pose(x, y, rng.uniform(-math.pi, math.pi))
        path: tuple[DubinsPath, ...] = ()
        pose = begin
        for end in (between, goal) if rng.random() < 0.5 else (goal,):
            paths = dubins_paths(pose, end, 1.0 / left.curvature, -1.0 / right.curvature)
            path, pose = (*path, paths[rng.integers(len(paths))]), end
        lengths = tuple(length for part in path for length in part.lengths)
        curvatures = tuple(curvature for part in path for curvature in part.curvatures)
        turns = tuple((left if c > 0.0 else right) if c else SteadyTurn(0.0, 0.0)
                      for c in curvatures)
        cost = sum(length / math.cos(turn.steering_angle) for length, turn in zip(lengths, turns))
        word = ''.join(part.word for part in path)
        found.append(Route(DubinsPath(begin, word, lengths, curvatures), turns, 0.0, cost))
    return found


def solve(problem: PushProblem, route: Route,
          solver: Optional[Callable[[Dimensions], NlpSolver]] = None) -> tuple[float, float, int]:
    """
    Solve the NLP from a route.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :param solver: function of a ``Dimensions`` that returns an ``NlpSolver``; that of the planner
        if None.
    :return: (duration of the push [s], CPU time [s], iterations); the first is infinite where
        there is none.
    """
    asked, guess = formulate(problem, route)
    if solver is None:
        work = functools.partial(push_solver(asked.dimensions).solve, asked, guess)
    else:
        work = functools.partial(solver(asked.dimensions).solve, asked.parameters(),
                                 asked.bounds, guess)
    began = time.process_time()
    found = work()
    cpu = time.process_time() - began
    duration = math.inf
    if found.solution is not None:
        duration = asked.mesh.step_times(found.solution.free_length).sum()
    return duration, cpu, found.iterations


def solvers(compiled: bool) -> dict[str, tuple[str, dict[str, Any]]]:
    """Return name -> (plugin, options) of each solver."""
    conics: dict[str, dict[str, Any]] = {
        'qrqp': {'print_iter': False, 'print_header': False}, 'hpipm': {}, 'daqp': {},
        'osqp': {'osqp': {'verbose': False, 'eps_abs': 1e-7, 'eps_rel': 1e-7,
                          'max_iter': 20000}}}
    found: dict[str, tuple[str, dict[str, Any]]] = {
        'fatrop': ('fatrop', FATROP), 'ipopt': ('ipopt', IPOPT)}
    found.update({f'sqpmethod, {name}': ('sqpmethod', {
        **SQP, 'qpsol': name, 'qpsol_options': {**QUIET, **options}})
        for name, options in conics.items() if ca.has_conic(name)})
    if compiled and shutil.which('gcc'):
        found.update({f'{name}, compiled': (plugin, {**options, **FLAGS}) for name, (
            plugin, options) in list(found.items())[:2]})
    return found


def quality(answer: Answer, count: int) -> Quality:
    """
    Compare a plan with random starts of an NLP with twice the segments.

    :param answer: ``Answer`` of the plan.
    :param count: number of starts.
    :return: ``Quality``.
    """
    problem = with_segments(answer.problem, FINE_SEGMENTS)
    rng = np.random.default_rng((SEED, int(1e6 * abs(problem.goal.x))))
    times = [solve(problem, route)[0] for route in starts(problem, rng, count)]
    return Quality(answer.duration / min(times) - 1.0, sum(map(math.isfinite, times)),
                   answer.duration < answer.bound - SLACK / problem.settings.pushing_speed)


def _solve_task(build: Optional[Callable[[Dimensions], NlpSolver]],
                task: tuple[PushProblem, Route]) -> tuple[float, float, int]:
    return solve(*task, build)


def compare_solvers(problems: Sequence[PushProblem], compiled: bool) -> list[SolverRun]:
    """
    Solve the NLPs of the shortest routes with every solver.

    :param problems: list of ``PushProblem``.
    :param compiled: whether to compile some as well.
    :return: list of ``SolverRun``.
    """
    tasks = [(problem, routes(problem, turn_pair(problem))[0])
             for problem in (with_segments(problem, SEGMENTS) for problem in problems)]
    best = [solve(*task)[0] for task in tasks]
    runs: list[SolverRun] = []
    builders: dict[str, Optional[Callable[[Dimensions], NlpSolver]]] = {OWN: None}
    for name, (plugin, options) in solvers(compiled).items():
        builders[name] = functools.lru_cache(None)(
            functools.partial(NlpSolver, solver=plugin, options=options))
    for name, build in builders.items():
        if tasks:
            solve(*tasks[0], build)
        done = collect(tasks, name, functools.partial(_solve_task, build))
        good = [(run, least) for run, least in zip(done, best) if math.isfinite(run[0])]
        runs.append(SolverRun(name, len(good), len(done), [run[1] for run, _ in good],
                              [run[2] for run, _ in good],
                              [run[0] / least - 1.0 for run, least in good]))
    return runs
