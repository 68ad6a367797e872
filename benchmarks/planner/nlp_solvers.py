"""
The planner's programme from other starts and with other solvers.

``starts`` and ``solve`` are all that knows of the planner's insides.
"""

import dataclasses
import math
import shutil
import time
from typing import NamedTuple

import casadi as ca
import numpy as np
from push_model.dubins import dubins_paths, DubinsPath
from push_model.geometry import Pose
from push_planner.collocation.formulation import formulate
from push_planner.collocation.nlp_solver import FATROP, IPOPT, nlp_solver, NlpSolver
from push_planner.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.initial_guess.first_guess import Route
from push_planner.initial_guess.steady_turns import SteadyTurn

PIECES, FINE_PIECES, ONE_SHAPE = 24, 48, 20.0
SEED = 48
REACH, GENTLEST = 2.0, 0.3
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
    One solver on all programmes.

    :param name: of the solver.
    :param solved: number of programmes that it solved.
    :param tried: number of programmes.
    :param cpu: CPU times of what it solved [s].
    :param iterations: of the same.
    :param gaps: cost over that by fatrop, less 1, of the same.
    """

    name: str
    solved: int
    tried: int
    cpu: list
    iterations: list
    gaps: list


def pieces(problem, count):
    """Return the problem with a fixed number of pieces."""
    settings = dataclasses.replace(problem.settings, segments=count, segment_length=ONE_SHAPE)
    return dataclasses.replace(problem, settings=settings)


def starts(problem, rng, count):
    """
    Draw routes: Dubins paths by way of a random pose, with turns of random tightness.

    :param problem: the ``PushProblem``; without straight end.
    :param rng: random generator.
    :param count: number of routes.
    :return: list of ``Route``.
    """
    vehicle, tightest = problem.vehicle, tightest_turns(problem)
    begin = Pose(*vehicle.flat_output, vehicle.angle)
    goal = problem.relative_goal @ begin
    size, found = REACH + math.hypot(goal.x, goal.y), []
    while len(found) < count:
        left, right = (SteadyTurn(share * turn.steering_angle, share * turn.w) for turn, share in
                       zip(tightest, rng.uniform(GENTLEST, 1.0, 2)))
        between = Pose(*rng.uniform(-size, size, 2), rng.uniform(-math.pi, math.pi))
        path, pose = (), begin
        for end in (between, goal) if rng.random() < 0.5 else (goal,):
            paths = dubins_paths(pose, end, 1.0 / left.curvature, -1.0 / right.curvature)
            path, pose = (*path, paths[rng.integers(len(paths))]), end
        lengths, curvatures = (sum((getattr(part, name) for part in path), ())
                               for name in ('lengths', 'curvatures'))
        turns = tuple((left if c > 0.0 else right) if c else SteadyTurn(0.0, 0.0)
                      for c in curvatures)
        cost = sum(length / math.cos(turn.steering_angle) for length, turn in zip(lengths, turns))
        word = ''.join(part.word for part in path)
        found.append(Route(DubinsPath(begin, word, lengths, curvatures), turns, 0.0, cost))
    return found


def solve(problem, route, solver=None):
    """
    Solve the programme from a route.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :param solver: function of a ``Dimensions`` that returns an ``NlpSolver``; that of the planner
        if None.
    :return: (duration of the push [s], CPU time [s], iterations); the first is infinite where
        there is none.
    """
    asked, guess = formulate(problem, route)
    made = (solver or nlp_solver)(asked.dimensions)
    began = time.process_time()
    found = made.solve(asked.parameters(), asked.bounds, guess)
    cpu = time.process_time() - began
    duration = math.inf
    if found.solution is not None:
        duration = asked.mesh.step_times(found.solution.free_length).sum()
    return duration, cpu, found.iterations


def rivals(compiled):
    """Return name -> (plugin, options)."""
    conics = {'qrqp': {'print_iter': False, 'print_header': False}, 'hpipm': {}, 'daqp': {},
              'osqp': {'osqp': {'verbose': False, 'eps_abs': 1e-7, 'eps_rel': 1e-7,
                                'max_iter': 20000}}}
    found = {'fatrop': ('fatrop', FATROP), 'ipopt': ('ipopt', IPOPT)}
    found.update({f'sqpmethod, {name}': ('sqpmethod', {
        **SQP, 'qpsol': name, 'qpsol_options': {**QUIET, **options}})
        for name, options in conics.items() if ca.has_conic(name)})
    if compiled and shutil.which('gcc'):
        found.update({f'{name}, compiled': (plugin, {**options, **FLAGS}) for name, (
            plugin, options) in list(found.items())[:2]})
    return found


def quality(answer, count):
    """
    Hold a plan against random starts of a programme with twice the pieces.

    :param answer: ``planner_measure.Answer`` of the plan.
    :param count: number of starts.
    :return: ``Quality``.
    """
    problem = pieces(answer.problem, FINE_PIECES)
    rng = np.random.default_rng((SEED, int(1e6 * abs(problem.goal.x))))
    times = [solve(problem, route)[0] for route in starts(problem, rng, count)]
    return Quality(answer.duration / min(times) - 1.0, sum(map(math.isfinite, times)),
                   answer.duration < answer.bound - SLACK / problem.settings.pushing_speed)


def compare_solvers(problems, collect, compiled):
    """
    Solve the programmes of the shortest routes with every solver.

    :param problems: list of ``PushProblem``.
    :param collect: function (items, title, work) that shows progress.
    :param compiled: whether to compile some as well.
    :return: list of ``SolverRun``.
    """
    tasks = [(problem, routes(problem, tightest_turns(problem))[0])
             for problem in (pieces(problem, PIECES) for problem in problems)]
    best, runs = [solve(*task)[0] for task in tasks], []
    for name, (plugin, options) in rivals(compiled).items():
        built = {}

        def made(shape, plugin=plugin, options=options, built=built):
            if shape not in built:
                built[shape] = NlpSolver(shape, plugin, options)
            return built[shape]
        if tasks:
            solve(*tasks[0], made)
        done = collect(tasks, name, lambda task, made=made: solve(*task, made))
        good = [(run, least) for run, least in zip(done, best) if math.isfinite(run[0])]
        runs.append(SolverRun(name, len(good), len(done), [run[1] for run, _ in good],
                              [run[2] for run, _ in good],
                              [run[0] / least - 1.0 for run, least in good]))
    return runs
