"""
Local refinement of a mesh: finer segments where the rate of the pushing angle changes.

The fastest pushes steer to the one side and to the other, with few switches in between. A switch
that falls within a segment takes all of it, however short it could be. So the segments next to the
greatest changes of the rate are halved, and the solution is carried over: a few more steps of
Newton's method lead to the new optimum. That is repeated while pushes become shorter.
"""

from typing import NamedTuple, Optional

import numpy as np
from push_model.geometry import IntArray, Pose
from push_planner.problem import PushProblem
from push_planner.steered.collocation.formulation import formulate_on, Formulation
from push_planner.steered.collocation.interior_point import Iterate
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.collocation.resampling import Meshed, resample
from push_planner.steered.collocation.solution import Solution, SolveResult
from push_planner.steered.initial_guess.dubins_routes import is_fast

# Change of the pushing angle within a segment from which on a mesh is refined [rad]; in a shorter
# segment it counts by the length over the longest. Measured: of 350 slow pushes 11 become more
# than 0.5 % shorter with twice the segments. By this 5 of them are refined, and a tenth to a third
# of all; with 0.25 9 of them, and up to two thirds of all. Fast pushes steer more gently, and are
# refined in any case.
SHARP_CHANGE = 0.35
# Number of segments that are halved at a time, and how often at most. Chosen: some kinks with
# their neighbours, a multiple of the step of segment counts; the last ones a 64th as long.
HALVED_SEGMENTS = 16
MAX_REFINEMENTS = 6
# Ratio by which a push must become shorter for another refinement. Measured: with 0.002 one of 200
# pushes remains 2.3 % above the best of random starts; so it is 0.6 %.
MIN_GAIN = 1e-3


class MeshSolution(NamedTuple):
    """
    A program on some mesh, and its solution.

    :param formulation: ``Formulation``.
    :param result: ``SolveResult`` with a solution.
    """

    formulation: Formulation
    result: SolveResult


def refine_mesh(problem: PushProblem, solved: MeshSolution) -> MeshSolution:
    """
    Halve the segments where the pushing angle changes sharply, and solve the program on them.

    :return: ``MeshSolution``; the same where no segment needs it.
    """
    solution = solved.result.solution
    if solution is None or not _is_coarse(problem, solved.formulation, solution):
        return solved
    for _ in range(MAX_REFINEMENTS):
        before = solution.free_length
        finer = _halved(problem, solved)
        if finer is None or finer.result.solution is None:
            break
        solved, solution = finer, finer.result.solution
        if solution.free_length > (1.0 - MIN_GAIN) * before:
            break
    return solved


def _is_coarse(problem: PushProblem, formulation: Formulation, solution: Solution) -> bool:
    """Tell whether finer segments may shorten a push noticeably."""
    if formulation.dimensions.jumps:
        return False
    lengths = formulation.mesh.step_lengths(solution.free_length)
    sharpest = (np.abs(solution.changes) * formulation.mesh.may_steer * lengths).max()
    return is_fast(problem) or bool(sharpest > SHARP_CHANGE * lengths.max())


def _halved(problem: PushProblem, solved: MeshSolution) -> Optional[MeshSolution]:
    """Halve some segments; None where there is no solution then, or none to go on from."""
    formulation, result = solved.formulation, solved.result
    solution, iterate = result.solution, result.iterate
    if solution is None or iterate is None:
        return None
    mesh = formulation.mesh
    parts = np.ones(len(mesh.lengths), dtype=int)
    parts[_kinked_segments(formulation, solution)[:HALVED_SEGMENTS]] = 2
    finer = formulate_on(problem, mesh.divided(parts), formulation.dimensions.straight_end,
                         formulation.boundary.theta)
    again = push_solver(finer.dimensions).resume(
        finer, _carried_over(iterate, formulation, finer, solution.free_length), has_slacks=False)
    if again.solution is None:
        return None
    return MeshSolution(finer, again._replace(iterations=result.iterations + again.iterations))


def _kinked_segments(formulation: Formulation, solution: Solution) -> IntArray:
    """
    Rank the segments by the changes of the rate of the pushing angle at their ends.

    Times the length of the segment they estimate the error of a linear angle [rad].
    """
    lengths = formulation.mesh.step_lengths(solution.free_length)
    kinks = np.zeros(len(lengths) + 1)
    kinks[1:-1] = np.abs(np.diff(solution.changes / lengths))
    errors = (kinks[1:] + kinks[:-1]) * lengths * formulation.mesh.may_steer
    return np.argsort(-errors, kind='stable')


def _carried_over(iterate: Iterate, coarse: Formulation, fine: Formulation,
                  free_length: float) -> Iterate:
    """Carry a solution over to a finer mesh of the same push, without slacks."""
    return resample(iterate, Meshed(coarse.dimensions, coarse.mesh, free_length),
                    Meshed(fine.dimensions, fine.mesh, free_length), 0.0, Pose(0.0, 0.0, 0.0))
