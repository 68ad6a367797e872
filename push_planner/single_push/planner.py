"""From problem to plan."""

import dataclasses
import math
from typing import Any, Callable, NamedTuple, Optional

import numpy as np
from push_model.plan_request import PlanFailure
from push_planner.collocation.formulation import formulate, Formulation, rotation_range
from push_planner.collocation.nlp_solver import nlp_solver, Solution, UNSETTLED
from push_planner.initial_guess.dubins_routes import Route, routes, tightest_turns
from push_planner.initial_guess.previous_plan import previous_route
from push_planner.integration.refinement import refine
from push_planner.integration.trajectory import build_report, find_switches, sample_trajectory
from push_planner.plan import Plan
from push_planner.problem import PlanningFailed
from push_planner.single_push.bounds import displacement_bound
from push_planner.single_push.feasibility import check_feasibility


def accept_any(trajectory):
    """
    Find no fault with any plan.

    :param trajectory: ``PushTrajectory``; not looked at.
    :return: an empty text.
    """
    return ''


class PlanRequirements(NamedTuple):
    """
    What is asked of a plan.

    :param route: ``Route`` that is tried before all others; None for none.
    :param violation: function of a ``PushTrajectory`` to what is wrong with it, empty if nothing is.
    :param max_solves: programmes that are solved at most.
    """

    route: Optional[Route] = None
    violation: Callable = accept_any
    max_solves: float = math.inf


NO_REQUIREMENTS = PlanRequirements()


def assemble_plan(problem, formulation, rollout, way):
    """
    Make a plan.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param rollout: the ``Rollout``.
    :param way: S [m].
    :return: ``Plan``.
    """
    trajectory = sample_trajectory(problem, rollout)
    switches = find_switches(problem, rollout, formulation.shape.jumps)
    begins = rollout.nodes[:-1, 1] + (rollout.changes if formulation.shape.jumps else 0.0)
    grid = formulation.grid
    report = build_report(problem, rollout, trajectory, switches)
    report['displacement_bound'] = displacement_bound(problem)
    report['over_displacement_bound'] = trajectory.duration / report['displacement_bound']
    return Plan(problem, trajectory,
                tuple(zip(begins.tolist(), rollout.nodes[1:, 1].tolist())),
                tuple(np.cumsum(grid.steps(way)).tolist()),
                tuple(zip(np.sqrt(grid.squares).tolist(), np.sqrt(grid.ends).tolist())),
                switches, report)


def acceptance_error(plan):
    """
    Tell what is wrong with a plan; empty where nothing is.

    :param plan: the ``Plan``.
    """
    report, settings = plan.report, plan.problem.settings
    if not report['position_error'] <= settings.position_tolerance:
        return f're-integration misses the goal by {1e3 * report["position_error"]:.2f} mm'
    if not report['heading_error'] <= settings.heading_tolerance:
        return ('re-integration misses the goal by '
                f'{math.degrees(report["heading_error"]):.2f} deg')
    if settings.angle_limit == 'cone' and not report['friction_usage'] <= 1.0:
        return ('the contact force leaves the friction cone by a factor '
                f'{report["friction_usage"]:.2f}')
    return ''


ROUTES = 12
RELAXED = 4
NEARLY_BEST = 1.1
ALIKE = 1.0
# Of a way [m].
ROUNDING = 1e-9


class Attempt(NamedTuple):
    """
    Result of following one route.

    :param route: its name.
    :param path_length: its length [m].
    :param verdict: the result in words.
    :param failure: ``PlanFailure``; None for a plan.
    :param relaxed: whether the relaxed program was solved.
    """

    route: str
    path_length: float
    verdict: str
    failure: Optional[PlanFailure]
    relaxed: bool

    def __str__(self) -> str:
        """Describe it in one line."""
        return f'{self.route} of {self.path_length:.2f} m: {self.verdict}'

    @property
    def explains(self) -> bool:
        """Whether it tells why there is no plan: a relaxed program that converged does."""
        return not (self.relaxed and self.failure is PlanFailure.NOT_CONVERGED)


@dataclasses.dataclass
class AttemptLog:
    """
    Attempts at one problem, and the budget that they have.

    :param requirements: ``PlanRequirements`` to be met.
    :param solves: number of nonlinear programs solved so far.
    :param attempts: the ``Attempt`` list, in order.
    """

    requirements: PlanRequirements
    solves: int = 0
    attempts: list[Attempt] = dataclasses.field(default_factory=list)

    @property
    def is_spent(self) -> bool:
        """Whether the budget is used up."""
        return self.solves >= self.requirements.max_solves

    def lines(self) -> list[str]:
        """Describe all attempts, a line each."""
        return [str(attempt) for attempt in self.attempts]

    def best_explanation(self, count: int) -> Attempt:
        """
        Find the attempt that explains best why there is no plan.

        :param count: number of latest attempts to look at.
        """
        latest = self.attempts[-count:]
        return next((attempt for attempt in latest if attempt.explains), latest[0])


class _Candidate(NamedTuple):
    """A route that has been solved."""

    route: Any
    formulation: Formulation
    solution: Solution
    iterations: int

    @property
    def duration(self):
        """Time of the push, about [s]."""
        return float(self.formulation.grid.times(self.solution.way).sum())

    @property
    def length(self):
        """Way of the contact, about [m]."""
        return self.solution.way + self.formulation.grid.fixed


def plan_push(problem, previous=None, requirements=NO_REQUIREMENTS):
    """
    Find the quickest push to the goal that keeps to the planning cone.

    The programme is solved from the shortest ways of the flat point, and the best is integrated
    finely and corrected until it reaches the goal.

    :param problem: the ``PushProblem``.
    :param previous: ``Plan`` for much the same push, to start from; None for none.
    :param requirements: ``PlanRequirements``, what else is asked.
    :return: ``Plan``.
    :raises PlanningFailed: with the reason, where there is none or none was found.
    """
    check_feasibility(problem)
    attempts = AttemptLog(requirements)
    if requirements.route is not None:
        candidate = _solve(problem, requirements.route, attempts, False)
        found = candidate and _finish(problem, candidate, attempts)
        if found is not None:
            return found
    left = _ways(problem)
    if previous is not None:
        again = _follow(problem, previous, left[0].path_length, attempts)
        if again is not None:
            return again
    for relaxed in (False, True):
        waiting = left[:RELAXED] if relaxed else left
        while waiting:
            if attempts.is_spent:
                break
            solved, waiting = _solve_some(problem, waiting, attempts, relaxed)
            for candidate in sorted(solved, key=lambda candidate: candidate.duration):
                found = _finish(problem, candidate, attempts) or _finish_finer(
                    problem, candidate.route, attempts)
                if found is not None:
                    return found
    # The relaxed programme comes last, and mostly says what stands in the way.
    nearest = attempts.best_explanation(len(left[:RELAXED]))
    raise PlanningFailed(nearest.failure or PlanFailure.NOT_CONVERGED,
                         'no push within the friction cone and the limits of the robot was found '
                         f'on {len(left)} ways that were tried, among them {nearest}',
                         {'attempts': attempts.lines()})


def _ways(problem):
    """Routes that are worth a try, the most promising first."""
    turns = tightest_turns(problem)
    if turns is None:
        raise PlanningFailed(PlanFailure.ONE_SIDED_STEERING,
                             'the contact cannot steer both ways: in steady turns to one side its '
                             'force leaves the planning cone; another contact may do')
    ranked, longest = routes(problem, turns), problem.settings.max_path_length
    if ranked[0].path_length > longest:
        raise PlanningFailed(
            PlanFailure.PATH_TOO_LONG,
            f'the shortest way to the goal is a push of {ranked[0].path_length:.1f} m, at most '
            f'{longest:g} m is accepted; another contact may be nearer',
            {'path_length': ranked[0].path_length})
    low, high = rotation_range(problem)
    fit = [route for route in ranked if route.path_length <= longest and low <= route.rotation <= high]
    return (fit or ranked[:1])[:ROUTES]


def _follow(problem, previous, least, attempts):
    route = previous_route(problem, previous)
    candidate = None if route is None else _solve(problem, route, attempts, False)
    if candidate is None or candidate.length > NEARLY_BEST * least:
        return None
    return _finish(problem, candidate, attempts)


def _solve_some(problem, ways, attempts, relaxed):
    """Solve until one is found, and then what may be as good; return the rest as well."""
    solved, rest = [], []
    for route in ways:
        if attempts.is_spent or solved and not _may_be_better(route, solved):
            rest.append(route)
            continue
        candidate = _solve(problem, route, attempts, relaxed)
        if candidate is not None:
            solved.append(candidate)
    return solved, rest


def _may_be_better(route, solved):
    """Whether a route turns otherwise than what is solved (alike: same optimum), at no detour."""
    return (route.final_straight >= solved[0].route.final_straight
            and route.path_length <= NEARLY_BEST * min(candidate.length for candidate in solved)
            and all(abs(route.rotation - other.route.rotation) > ALIKE for other in solved))


def _solve(problem, route, attempts, relaxed, finer=False):
    attempts.solves += 1
    formulation, guess = formulate(problem, route, finer)
    solver = nlp_solver(formulation.shape)
    verdict, failure = 'not solved', PlanFailure.NOT_CONVERGED
    if relaxed:
        solution, verdict, count = solver.diagnose(formulation.parameters(), formulation.box,
                                                   guess)
        failure = (PlanFailure.NOT_CONVERGED if verdict == UNSETTLED else
                   PlanFailure.LIMIT_EXCEEDED)
    else:
        solution, count = solver.solve(formulation.parameters(), formulation.box, guess)
    if solution is None:
        attempts.attempts.append(Attempt(route.name, route.path_length, verdict, failure, relaxed))
        return None
    return _Candidate(route, formulation, solution, count)


def _goes_on(rollout):
    """Whether all of a rollout is finite, and its way never goes back."""
    steps = np.diff(rollout.ways)
    return (np.isfinite(rollout.samples).all() and (steps > -ROUNDING).all()
            and rollout.ways[-1] > 0.0
            and (rollout.squares >= 0.0).all())


def _finish_finer(problem, route, attempts):
    """Where the fine integration was too far from the programme, take twice as many pieces."""
    if problem.settings.pushing_angles == 'constant' or attempts.is_spent:
        return None
    candidate = _solve(problem, route, attempts, False, finer=True)
    return candidate and _finish(problem, candidate, attempts)


def _finish(problem, candidate, attempts):
    route, formulation, solution, iterations = candidate
    rollout, way = refine(problem, formulation, solution)
    found, violation = None, 'the fine integration broke down'
    if rollout is not None and _goes_on(rollout):
        found = assemble_plan(problem, formulation, rollout, way)
        found.report.update(route=route.name, segments=formulation.shape.steps,
                            final_straight=route.final_straight, iterations=iterations)
        violation = acceptance_error(found) or attempts.requirements.violation(found.trajectory)
    attempts.attempts.append(Attempt(
        route.name, route.path_length, violation or 'solved',
        PlanFailure.NOT_ACCEPTED if violation else None, False))
    if violation:
        return None
    found.report['attempts'] = attempts.lines()
    return found
