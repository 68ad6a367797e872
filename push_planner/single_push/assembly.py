"""A plan from the solution of a program: refined, assembled, and accepted or not."""

import dataclasses
import math
from typing import NamedTuple, Optional

import numpy as np
from push_planner.collocation.formulation import Formulation
from push_planner.collocation.interior_point import Iterate
from push_planner.collocation.nlp_solver import SolveResult
from push_planner.initial_guess.dubins_routes import TurnPair
from push_planner.integration.refinement import refine, RefinedPush
from push_planner.integration.rollout import Rollout
from push_planner.integration.trajectory import build_report, find_switches, sample_trajectory
from push_planner.plan import Plan, PlanSource
from push_planner.problem import PushProblem
from push_planner.single_push.bounds import displacement_bound

# Steps back of a rollout that are rounding [m].
ROUNDING = 1e-9


@dataclasses.dataclass(frozen=True, eq=False)
class SolvedPush(PlanSource):
    """
    Solution of a program, and how it was refined.

    :param formulation: ``Formulation``.
    :param iterate: ``Iterate``, its solution.
    :param refined: ``RefinedPush``.
    :param turns: the tightest ``SteadyTurn`` to either side.
    """

    formulation: Formulation
    iterate: Iterate
    refined: RefinedPush
    turns: TurnPair


class Finished(NamedTuple):
    """
    Result of refining a solution.

    :param plan: the ``Plan``; None where it is not accepted.
    :param violation: why it is not accepted, or empty.
    """

    plan: Optional[Plan]
    violation: str


def finish(problem: PushProblem, formulation: Formulation, result: SolveResult, turns: TurnPair,
           former: Optional[RefinedPush] = None) -> Finished:
    """
    Refine the solution of a program, and accept the plan or not.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param result: ``SolveResult`` with a solution.
    :param turns: the tightest ``SteadyTurn`` to either side.
    :param former: ``RefinedPush`` of a solution on the same mesh that is much the same.
    """
    if result.solution is None:
        raise ValueError('result: got no solution, expected one')
    refined = refine(problem, formulation, result.solution, former)
    if refined is None or not _is_sound(refined.rollout):
        return Finished(None, 'the fine integration broke down')
    solved = None
    if result.iterate is not None and not formulation.dimensions.jumps:
        solved = SolvedPush(formulation, result.iterate, refined, turns)
    plan = assemble_plan(problem, formulation, refined, solved)
    violation = acceptance_error(plan)
    plan.report.update(segments=formulation.dimensions.step_count, iterations=result.iterations)
    return Finished(None if violation else plan, violation)


def assemble_plan(problem: PushProblem, formulation: Formulation, refined: RefinedPush,
                  solved: Optional[SolvedPush] = None) -> Plan:
    """
    Make a plan of a refined push.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param refined: the ``RefinedPush``.
    :param solved: ``SolvedPush`` to plan on from; None for none.
    """
    rollout, mesh = refined.rollout, formulation.mesh
    jumps = formulation.dimensions.jumps
    trajectory = sample_trajectory(problem, rollout)
    switches = find_switches(problem, rollout, jumps)
    begins = rollout.nodes[:-1, 1] + (rollout.changes if jumps else 0.0)
    report = build_report(problem, rollout, trajectory, switches)
    bound = displacement_bound(problem)
    report['displacement_bound'] = bound
    report['over_displacement_bound'] = trajectory.duration / bound
    return Plan(problem, trajectory,
                tuple(zip(begins.tolist(), rollout.nodes[1:, 1].tolist())),
                tuple(np.cumsum(mesh.step_lengths(refined.free_length)).tolist()),
                tuple(zip(np.sqrt(mesh.v_squared).tolist(), np.sqrt(mesh.end_v_squared).tolist())),
                switches, report, solved)


def acceptance_error(plan: Plan) -> str:
    """
    Describe what is wrong with a plan; empty where nothing is.

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


def _is_sound(rollout: Rollout) -> bool:
    """Whether all of a rollout is finite, and its path never goes back."""
    steps = np.diff(rollout.s)
    return bool(np.isfinite(rollout.samples).all() and (steps > -ROUNDING).all()
                and rollout.s[-1] > 0.0 and (rollout.v_squared >= 0.0).all())
