"""A plan from the solution of a program: refined, accepted or not, and sampled when it is read."""

import dataclasses
import functools
import math
from typing import NamedTuple, Optional

import numpy as np
from push_planner.problem import PushProblem
from push_planner.steered.bounds import displacement_bound
from push_planner.steered.collocation.formulation import Formulation
from push_planner.steered.collocation.interior_point import Iterate
from push_planner.steered.collocation.solution import SolveResult
from push_planner.steered.initial_guess.dubins_routes import TurnPair
from push_planner.steered.integration.refinement import EndError, refine, RefinedPush
from push_planner.steered.integration.trajectory import (
    build_report, find_switches, sample_trajectory)
from push_planner.steered.plan import RecordedMotion


@dataclasses.dataclass(frozen=True, eq=False)
class SolvedPush:
    """
    Solution of a program, how it was refined, and the ``PlannedMotion`` that it is.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param iterate: ``Iterate``, the solution; None where it is none of the interior point method.
    :param refined: ``RefinedPush``.
    :param turns: the tightest ``SteadyTurn`` to either side.
    """

    problem: PushProblem
    formulation: Formulation
    iterate: Optional[Iterate]
    refined: RefinedPush
    turns: TurnPair

    @property
    def duration(self) -> float:
        """Duration of the push [s]."""
        return float(self.formulation.mesh.step_times(self.refined.free_length).sum())

    @property
    def path_length(self) -> float:
        """Path length of the contact [m]."""
        return float(self.refined.rollout.s[-1])

    def recorded(self) -> RecordedMotion:
        """Sample and describe it; the same object each time."""
        return self._recorded

    @property
    def end_error(self) -> EndError:
        """Deviation of the end from the goal."""
        return self.refined.end_error

    @property
    def largest_force_angle(self) -> float:
        """Largest angle of the contact force from the normal; 90 degrees where it pulls [rad]."""
        return math.atan(self.refined.checks.force_ratio)

    @functools.cached_property
    def _recorded(self) -> RecordedMotion:
        problem, rollout, mesh = self.problem, self.refined.rollout, self.formulation.mesh
        jumps = self.formulation.dimensions.jumps
        switches = find_switches(problem, rollout, jumps)
        starts = rollout.nodes[:-1, 1] + (rollout.changes if jumps else 0.0)
        bound = displacement_bound(problem)
        return RecordedMotion(
            sample_trajectory(problem, rollout),
            tuple(zip(starts.tolist(), rollout.nodes[1:, 1].tolist())),
            tuple(np.cumsum(mesh.step_lengths(self.refined.free_length)).tolist()),
            tuple(zip(np.sqrt(mesh.v_squared).tolist(), np.sqrt(mesh.end_v_squared).tolist())),
            switches, {
                **build_report(problem, rollout, switches), **self.end_error._asdict(),
                'path_length': self.path_length, 'duration': self.duration,
                'cone_usage': self.largest_force_angle / problem.planning_cone_angle,
                'friction_usage': self.largest_force_angle / problem.friction_angle,
                'displacement_bound': bound, 'over_displacement_bound': self.duration / bound,
                'segments': self.formulation.dimensions.step_count})


class Finished(NamedTuple):
    """
    Result of refining a solution.

    :param push: the ``SolvedPush``; None where it is not accepted.
    :param violation: why it is not accepted, or empty.
    """

    push: Optional[SolvedPush]
    violation: str


def finish(problem: PushProblem, formulation: Formulation, result: SolveResult, turns: TurnPair,
           previous: Optional[RefinedPush] = None) -> Finished:
    """
    Refine the solution of a program, and accept the push or not.

    :param formulation: its ``Formulation``.
    :param result: ``SolveResult`` with a solution.
    :param turns: the tightest ``SteadyTurn`` to either side.
    :param previous: ``RefinedPush`` of a solution on the same mesh that is much the same.
    """
    if result.solution is None:
        raise ValueError('result: got no solution, expected one')
    refined = refine(problem, formulation, result.solution, previous)
    if refined is None or not refined.checks.is_sound:
        return Finished(None, 'the fine integration broke down')
    push = SolvedPush(problem, formulation, result.iterate, refined, turns)
    violation = acceptance_error(push)
    return Finished(None if violation else push, violation)


def acceptance_error(push: SolvedPush) -> str:
    """Describe what is wrong with a push; empty where nothing is."""
    error, settings = push.end_error, push.problem.settings
    if not error.position_error <= settings.position_tolerance:
        return f're-integration misses the goal by {1e3 * error.position_error:.2f} mm'
    if not error.heading_error <= settings.heading_tolerance:
        return f're-integration misses the goal by {math.degrees(error.heading_error):.2f} deg'
    if not push.path_length <= settings.max_path_length:
        return (f'the push is {push.path_length:.1f} m long, at most '
                f'{settings.max_path_length:g} m is accepted')
    friction = push.problem.obj.contact_friction_coefficient
    if settings.angle_limit == 'cone' and not push.refined.checks.force_ratio <= friction:
        usage = push.largest_force_angle / push.problem.friction_angle
        return f'the contact force leaves the friction cone by a factor {usage:.2f}'
    return ''
