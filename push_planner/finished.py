"""From an integrated push to a plan, and what is wrong with it."""

import math

import numpy as np
from push_planner.bounds import displacement_bound
from push_planner.plan import Plan
from push_planner.sampling import report_of, switches_of, trajectory_of


def finished(problem, formulation, rollout, way):
    """
    Make a plan.

    :param problem: the ``PushProblem``.
    :param formulation: its ``Formulation``.
    :param rollout: the ``Rollout``.
    :param way: S [m].
    :return: ``Plan``.
    """
    trajectory = trajectory_of(problem, rollout)
    switches = switches_of(problem, rollout, formulation.shape.jumps)
    begins = rollout.nodes[:-1, 1] + (rollout.changes if formulation.shape.jumps else 0.0)
    grid = formulation.grid
    report = report_of(problem, rollout, trajectory, switches)
    report['displacement_bound'] = displacement_bound(problem)
    report['over_displacement_bound'] = trajectory.duration / report['displacement_bound']
    return Plan(problem, trajectory,
                tuple(zip(begins.tolist(), rollout.nodes[1:, 1].tolist())),
                tuple(np.cumsum(grid.steps(way)).tolist()),
                tuple(zip(np.sqrt(grid.squares).tolist(), np.sqrt(grid.ends).tolist())),
                switches, report)


def fault_of(plan):
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
