"""
Planner of pushes: single pushes to a goal pose, and sequences of pushes.

A push is planned in a few lines; the modules behind these names are imported at first use::

    problem = problem_from_placement(obj, robot, object_pose, robot_pose, goal)
    plan = plan_push(problem)
    print(plan.trajectory.duration, verify(plan))
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_model.plan_request import PlanFailure, PlanRequest
    from push_planner.plan import Plan
    from push_planner.problem import (
        InitialMotion, PlanningFailed, problem_from_placement, PushProblem,
    )
    from push_planner.sequence.planner import plan_for_request, plan_task, TaskPlan
    from push_planner.settings import PlannerSettings, TaskSettings
    from push_planner.single_push.planner import plan_push
    from push_planner.single_push.replanning import plan_from_measurements
    from push_planner.single_push.site_selection import choose_site, SiteChoice
    from push_planner.verification.verification import Verification, verify

__all__ = [
    'choose_site', 'InitialMotion', 'Plan', 'plan_for_request', 'plan_from_measurements',
    'plan_push', 'plan_task', 'PlanFailure', 'PlannerSettings', 'PlanningFailed', 'PlanRequest',
    'problem_from_placement', 'PushProblem', 'SiteChoice', 'TaskPlan', 'TaskSettings',
    'Verification', 'verify',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_model.plan_request': ('PlanFailure', 'PlanRequest'),
    'push_planner.plan': ('Plan',),
    'push_planner.problem': ('InitialMotion', 'PlanningFailed', 'problem_from_placement',
                             'PushProblem'),
    'push_planner.sequence.planner': ('plan_for_request', 'plan_task', 'TaskPlan'),
    'push_planner.settings': ('PlannerSettings', 'TaskSettings'),
    'push_planner.single_push.planner': ('plan_push',),
    'push_planner.single_push.replanning': ('plan_from_measurements',),
    'push_planner.single_push.site_selection': ('choose_site', 'SiteChoice'),
    'push_planner.verification.verification': ('Verification', 'verify'),
})
