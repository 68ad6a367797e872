"""Solver of the program of a push: fast where it can be solved, and with a reason elsewhere."""

import functools

from push_model.plan_request import PlanFailure
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.formulation import Formulation, MIN_FREE_LENGTH
from push_planner.steered.collocation.interior_point import (
    InteriorPointMethod, InteriorResult, Iterate,
)
from push_planner.steered.collocation.newton_step import Bounds
from push_planner.steered.collocation.relaxed_program import RelaxedProgram
from push_planner.steered.collocation.solution import Solution, SolveResult, VariableBounds
from push_planner.steered.push_parameters import UNLIMITED


class PushSolver:
    """
    Solver of all programs of the same dimensions.

    :param dimensions: ``Dimensions``.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Prepare the method."""
        self._dimensions = dimensions
        self._method = InteriorPointMethod(dimensions)

    def solve(self, formulation: Formulation, guess: Solution) -> SolveResult:
        """
        Solve the program.

        :param formulation: ``Formulation`` of these dimensions.
        :param guess: ``Solution`` to start from.
        """
        return self._result(self._method.solve(
            formulation.common, formulation.steps, method_bounds(formulation.bounds),
            guess.column(self._dimensions)))

    def resume(self, formulation: Formulation, iterate: Iterate,
               has_slacks: bool = True) -> SolveResult:
        """
        Solve the program from the solution of nearly the same one.

        :param formulation: ``Formulation`` of these dimensions.
        :param iterate: ``Iterate`` of the former solution.
        :param has_slacks: whether it has slacks; else they follow from the rows.
        """
        return self._result(self._method.resume(
            formulation.common, formulation.steps, method_bounds(formulation.bounds), iterate,
            has_slacks))

    def _result(self, result: InteriorResult) -> SolveResult:
        if result.iterate is None:
            return SolveResult(None, result.iterations, PlanFailure.NOT_CONVERGED, 'not solved')
        column = result.iterate.primal[:self._dimensions.variable_count]
        return SolveResult(Solution.of_column(column, self._dimensions), result.iterations,
                           iterate=result.iterate)

    def solve_relaxed(self, formulation: Formulation, guess: Solution) -> SolveResult:
        """
        Solve the relaxed program, more slowly and more robustly.

        :param formulation: ``Formulation`` of these dimensions.
        :param guess: ``Solution`` to start from.
        """
        return self._relaxed.solve(formulation, guess)

    @functools.cached_property
    def _relaxed(self) -> RelaxedProgram:
        return RelaxedProgram(self._dimensions)


@functools.lru_cache(maxsize=32)
def push_solver(dimensions: Dimensions) -> PushSolver:
    """Build a solver, which takes longer than solving, or return the one built before."""
    return PushSolver(dimensions)


def method_bounds(bounds: VariableBounds) -> Bounds:
    """Make all bounds numbers, as the method wants them."""
    rotation = [max(-UNLIMITED, min(UNLIMITED, angle)) for angle in bounds.rotation]
    return Bounds(MIN_FREE_LENGTH, *bounds.first_angle, -bounds.angle, bounds.angle, *rotation)
