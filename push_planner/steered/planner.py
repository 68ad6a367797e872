"""
Planner of a single push: from a problem to a plan.

Routes of the flat output are ranked by length. From each the nonlinear program is solved, until
one leads to a push; others that may be as good are solved too, and the fastest one is refined
until it reaches the goal exactly. Where none does, the relaxed program tells what stands in the
way.
"""

from collections.abc import Iterator, Sequence
import dataclasses
import itertools
import math
from typing import NamedTuple, Optional

import numpy as np
from push_model.plan_request import PlanFailure
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.steered.assembly import finish
from push_planner.steered.collocation.formulation import (
    formulate, Formulation, InitialRoute, rotation_range)
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.collocation.solution import SolveResult
from push_planner.steered.continuation import plan_on
from push_planner.steered.feasibility import check_feasibility
from push_planner.steered.initial_guess.dubins_routes import (
    choose_various, is_fast, routes, tightest_turns, TurnPair)
from push_planner.steered.initial_guess.first_guess import Route
from push_planner.steered.mesh_refinement import MeshSolution, refine_mesh
from push_planner.steered.plan import Plan

# Routes that are tried at most, and of those the first with the relaxed program. Chosen: the six
# Dubins words with two final straights; fewer with the relaxed program, which takes 0.2 s: of 290
# random problems one needed it, on its first route.
MAX_ROUTES = 12
MAX_RELAXED_ROUTES = 2
# Ratio of an optimum to its route that is hardly fallen below: routes whose length times this is
# above the best solved push are not tried. Measured: all routes of 300 random pushes solved; a
# fast push leaves the reserve of curvature of its routes, and may leave its homotopy class. Of 91
# pushes at 1 m/s the worst is 0.2 % above the best of twelve routes, with 0.77 3 %, for a quarter
# more iterations.
ROUTE_SLACK = 0.95
FAST_ROUTE_SLACK = 0.7
# Reserves of the pushing angle below the largest of a push that is refused [rad]. The tightest
# turns are about a support, whose friction turns around where the centre of rotation passes it.
# The program smooths that, and may hold a force in between that no push can. Measured: of 26
# pushes that were refused 19 are accepted with the first, and 3 more with the second, up to 1 %
# longer (two of them 5 %), where the next routes were a tenth longer (median; up to 3.8 times).
ANGLE_RESERVES = 0.01, 0.04
# Difference of the object's rotations below which two routes lead to the same optimum [rad].
SAME_ROTATION = 1.0


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
        """Tell whether it explains why there is no plan; a relaxed program does not."""
        return not (self.relaxed and self.failure is PlanFailure.NOT_CONVERGED)


@dataclasses.dataclass
class AttemptLog:
    """
    Attempts at one problem, and their budget.

    :param max_solves: number of programs that may be solved.
    :param solves: number of programs that have been solved.
    :param attempts: the attempts in order.
    """

    max_solves: float
    solves: int = 0
    attempts: list[Attempt] = dataclasses.field(default_factory=list[Attempt])

    @property
    def is_spent(self) -> bool:
        """Tell whether the budget is used up."""
        return self.solves >= self.max_solves

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


class _Solved(NamedTuple):
    """A route whose program has been solved."""

    route: InitialRoute
    formulation: Formulation
    result: SolveResult
    free_length: float
    relaxed: bool

    @property
    def duration(self) -> float:
        """Approximate time of the push [s]."""
        return float(self.formulation.mesh.step_times(self.free_length).sum())

    @property
    def path_length(self) -> float:
        """Approximate path length of the contact [m]."""
        return self.free_length + self.formulation.mesh.fixed_length


def plan_push(problem: PushProblem, previous: Optional[Plan] = None,
              max_solves: float = math.inf) -> Plan:
    """
    Find the fastest push to the goal that keeps to the planning cone.

    :param previous: ``Plan`` for nearly the same push, to go on from where that leads to a push;
        None for none.
    :param max_solves: number of programs that are solved at most.
    :raises PlanningFailed: with the reason, where there is none or none was found.
    """
    plan = None if previous is None else plan_on(problem, previous)
    return plan or RouteSearch(problem, max_solves).plan()


def steering_limits(problem: PushProblem) -> TurnPair:
    """
    Find the tightest steady turns of a contact that steers to both sides.

    :return: ``SteadyTurn`` (to the left, to the right).
    :raises PlanningFailed: where it steers to one side only.
    """
    turns = tightest_turns(problem)
    if turns is None:
        raise PlanningFailed(PlanFailure.ONE_SIDED_STEERING,
                             'the contact cannot steer to both sides: in steady turns to one side '
                             'its force leaves the planning cone; another contact may do')
    return turns


class RouteSearch:
    """
    Search for a push over the routes of one problem.

    The program of a route is solved soon, and the push that it leads to refined later, if at all.

    :param problem: the ``PushProblem``.
    :param max_solves: number of programs that are solved at most.
    :raises PlanningFailed: where the problem is refused.
    """

    def __init__(self, problem: PushProblem, max_solves: float = math.inf) -> None:
        """Rank the routes."""
        check_feasibility(problem)
        self._problem = problem
        self._log = AttemptLog(max_solves)
        self._turns = steering_limits(problem)
        self._ranked = routes(problem, self._turns)
        self._candidates: Optional[Iterator[_Solved]] = None

    def shortest_route(self) -> float:
        """Length of the shortest route with the final straight that is tried first [m]."""
        first = self._ranked[0].final_straight
        return min(route.path_length for route in self._ranked if route.final_straight == first)

    def solve(self) -> float:
        """
        Solve programs until one leads to a push.

        :return: approximate time of the push, which is not refined yet [s].
        :raises PlanningFailed: where none does.
        """
        candidates = self._solve_all()
        first = next(candidates, None)
        if first is None:
            raise self._failure()
        self._candidates = itertools.chain([first], candidates)
        return first.duration

    def plan(self) -> Plan:
        """
        Refine pushes until one is accepted.

        :raises PlanningFailed: with the reason, where none is.
        """
        for candidate in self._candidates or self._solve_all():
            for solved in self._variants(candidate):
                finished = self._finish(solved)
                if finished is not None:
                    return finished
        raise self._failure()

    def _solve_all(self) -> Iterator[_Solved]:
        """Solve programs one by one: of all routes, and then the relaxed ones."""
        promising = self._promising()
        yield from self._solve_routes(promising, False)
        yield from self._solve_routes(promising[:MAX_RELAXED_ROUTES], True)

    def _promising(self) -> list[Route]:
        """Find the routes that are worth a try, the most promising first."""
        ranked, longest = self._ranked, self._problem.settings.max_path_length
        shortest = ranked[0].path_length
        if shortest > longest:
            raise PlanningFailed(
                PlanFailure.PATH_TOO_LONG,
                f'the shortest path to the goal is a push of {shortest:.1f} m, at most '
                f'{longest:g} m is accepted; another contact may be nearer',
                {'path_length': shortest})
        low, high = rotation_range(self._problem)
        fitting = [route for route in ranked
                   if route.path_length <= longest and low <= route.rotation <= high]
        return choose_various(fitting or ranked[:1], MAX_ROUTES)

    def _failure(self) -> PlanningFailed:
        # The relaxed program comes last, and mostly tells what stands in the way.
        promising = self._promising()
        nearest = self._log.best_explanation(min(len(promising), MAX_RELAXED_ROUTES))
        return PlanningFailed(
            nearest.failure or PlanFailure.NOT_CONVERGED,
            'found no push within the friction cone and the limits of the robot on '
            f'{len(promising)} routes, among them {nearest}', {'attempts': self._log.lines()})

    def _solve_routes(self, ranked: Sequence[Route], relaxed: bool) -> Iterator[_Solved]:
        """Solve routes in their order; of those that may be as good, the fastest push first."""
        waiting = ranked
        while waiting and not self._log.is_spent:
            solved, waiting = self._solve_some(waiting, relaxed)
            yield from sorted(solved, key=lambda one: one.duration)

    def _solve_some(self, ranked: Sequence[Route],
                    relaxed: bool) -> tuple[list[_Solved], list[Route]]:
        """Solve until one is found, and then what may be as good; return the rest as well."""
        solved: list[_Solved] = []
        remaining: list[Route] = []
        for route in ranked:
            if self._log.is_spent or solved and not self._may_be_faster(route, solved):
                remaining.append(route)
                continue
            candidate = self._solve(route, relaxed)
            if candidate is not None:
                solved.append(candidate)
        return solved, remaining

    def _may_be_faster(self, route: Route, solved: Sequence[_Solved]) -> bool:
        """Tell whether a route may lead to a shorter push, and to another optimum."""
        shortest = min(candidate.path_length for candidate in solved)
        fast = is_fast(self._problem)
        slack = FAST_ROUTE_SLACK if fast else ROUTE_SLACK
        # In slow pushes, routes of the same rotation lead to the same optimum.
        return (route.final_straight >= solved[0].route.final_straight
                and slack * route.path_length <= shortest
                and (fast or all(abs(route.rotation - other.route.rotation) > SAME_ROTATION
                                 for other in solved)))

    def _solve(self, route: InitialRoute, relaxed: bool = False,
               refined_mesh: bool = False) -> Optional[_Solved]:
        self._log.solves += 1
        formulation, guess = formulate(self._problem, route, refined_mesh)
        solver = push_solver(formulation.dimensions)
        if relaxed:
            result = solver.solve_relaxed(formulation, guess)
        else:
            result = solver.solve(formulation, guess)
        if result.solution is None:
            self._log.attempts.append(Attempt(route.name, route.path_length, result.verdict,
                                              result.failure, relaxed))
            return None
        return _Solved(route, formulation, result, result.solution.free_length, relaxed)

    def _variants(self, solved: _Solved) -> Iterator[_Solved]:
        """Solve for more of one route while they are refused: gentler ones, and on finer steps."""
        solved = self._on_refined_mesh(solved)
        yield solved
        for reserve in ANGLE_RESERVES:
            gentler = None if self._log.is_spent else self._steered_less(solved, reserve)
            if gentler is not None:
                yield gentler
        if self._problem.settings.pushing_angles != 'constant' and not self._log.is_spent:
            finer = self._solve(solved.route, refined_mesh=True)
            if finer is not None:
                yield finer

    def _on_refined_mesh(self, solved: _Solved) -> _Solved:
        """Refine the mesh where the pushing angle changes sharply."""
        formulation, result = refine_mesh(
            self._problem, MeshSolution(solved.formulation, solved.result))
        if result is solved.result or result.solution is None:
            return solved
        return solved._replace(formulation=formulation, result=result,
                               free_length=result.solution.free_length)

    def _steered_less(self, solved: _Solved, reserve: float) -> Optional[_Solved]:
        """Solve for a push whose pushing angles stay below the largest so far by a reserve."""
        previous, formulation = solved.result.solution, solved.formulation
        if previous is None:
            return None
        self._log.solves += 1
        angle = float(np.abs(previous.nodes[:, 1]).max()) - reserve
        formulation = formulation._replace(bounds=formulation.bounds._replace(angle=angle))
        result = push_solver(formulation.dimensions).solve(formulation, previous)
        if result.solution is None:
            return None
        return solved._replace(formulation=formulation, result=result,
                               free_length=result.solution.free_length)

    def _finish(self, solved: _Solved) -> Optional[Plan]:
        """Refine a solved route, and accept the plan or not."""
        push, violation = finish(self._problem, solved.formulation, solved.result, self._turns)
        self._log.attempts.append(Attempt(
            solved.route.name, solved.route.path_length, violation or 'solved',
            PlanFailure.NOT_ACCEPTED if violation else None, solved.relaxed))
        return None if push is None else Plan(self._problem, push, {
            'iterations': solved.result.iterations, 'route': solved.route.name,
            'attempts': self._log.lines(), 'final_straight': solved.route.final_straight})
