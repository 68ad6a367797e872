"""
Planner of pushes: single steered pushes to a goal pose, and the next push of a task.

A push is planned in a few lines; the modules behind these names are imported at first use::

    problem = problem_from_placement(obj, robot, object_pose, robot_pose, goal)
    plan = plan_push(problem)
    print(plan.trajectory.duration, verify(plan))
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_model.events import ObjectFailure
    from push_model.plan_request import PlanFailure, PlanRequest
    from push_planner.problem import (
        InitialMotion, PlanningFailed, problem_from_placement, PushProblem)
    from push_planner.rearrangement.order import plan_order
    from push_planner.rearrangement.problem import (
        NamedObject, OrderPlan, Rearrangement)
    from push_planner.settings import PlannerSettings
    from push_planner.steered.plan import Plan
    from push_planner.steered.planner import plan_push
    from push_planner.steered.replanning import plan_from_measurements
    from push_planner.steered.site_selection import choose_site, SiteChoice
    from push_planner.steered.task_push import plan_steered_push
    from push_planner.steered.verification.verification import Verification, verify
    from push_planner.straight.candidates import straight_pushes, StraightPushes
    from push_planner.task_plan import TaskPlan
    from push_planner.task_planner import plan_for_request, PushPlanner

__all__ = [
    'choose_site', 'InitialMotion', 'NamedObject', 'ObjectFailure', 'OrderPlan', 'Plan',
    'plan_for_request', 'plan_from_measurements', 'plan_order', 'plan_push', 'plan_steered_push',
    'PlanFailure', 'PlannerSettings', 'PlanningFailed', 'PlanRequest', 'problem_from_placement',
    'PushPlanner', 'PushProblem', 'Rearrangement', 'SiteChoice', 'straight_pushes',
    'StraightPushes', 'TaskPlan', 'Verification', 'verify',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_model.events': ('ObjectFailure',),
    'push_model.plan_request': ('PlanFailure', 'PlanRequest'),
    'push_planner.steered.plan': ('Plan',),
    'push_planner.problem': ('InitialMotion', 'PlanningFailed', 'problem_from_placement',
                             'PushProblem'),
    'push_planner.settings': ('PlannerSettings',),
    'push_planner.steered.planner': ('plan_push',),
    'push_planner.steered.replanning': ('plan_from_measurements',),
    'push_planner.steered.site_selection': ('choose_site', 'SiteChoice'),
    'push_planner.steered.verification.verification': ('Verification', 'verify'),
    'push_planner.steered.task_push': ('plan_steered_push',),
    'push_planner.rearrangement.order': ('plan_order',),
    'push_planner.rearrangement.problem': ('NamedObject', 'OrderPlan', 'Rearrangement'),
    'push_planner.task_plan': ('TaskPlan',),
    'push_planner.straight.candidates': ('straight_pushes', 'StraightPushes'),
    'push_planner.task_planner': ('plan_for_request', 'PushPlanner'),
})
