"""
Plan the next push of a task: one entrance, behind which there are two kinds of pushes.

Straight pushes do a task on open floor and in maps. Where none is possible on open floor, a
steered push leads to the goal, from the contact site from which it is there first.
"""

import dataclasses
from typing import Protocol

from push_model.optional import is_casadi_installed
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.outlook import task_outlook
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search.planner import plan_push_in_map
from push_planner.straight.map_search.remaining_pushes import RemainingPushes
from push_planner.straight.planner import plan_straight_push
from push_planner.task_plan import TaskPlan


class PushPlanner(Protocol):
    """What proposes the next push of a task: ``plan_for_request``, or a planner of one's own."""

    def __call__(self, request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                 drive: DriveSettings, occupancy_map: OccupancyMap | None = None, *,
                 remaining: RemainingPushes | None = None) -> TaskPlan:
        """
        Plan the next push; the arguments are those of ``plan_for_request``.

        :raises PlanningFailed: where there is no push.
        """
        ...


def plan_for_request(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                     drive: DriveSettings, occupancy_map: OccupancyMap | None = None, *,
                     remaining: RemainingPushes | None = None) -> TaskPlan:
    """
    Plan the next push of a task, and state its outlook.

    :param request: ``PlanRequest``, with what has been learned of the object.
    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    :param remaining: ``RemainingPushes`` of the previous plan in a map.
    :raises PlanningFailed: with the reason.
    """
    plan = _plan_push(request, robot, settings, drive, occupancy_map, remaining)
    outlook = task_outlook(plan.expected_time, request.tolerances,
                           is_in_map=occupancy_map is not None,
                           is_retry=request.cone_fraction < 1.0)
    return plan._replace(trajectory=dataclasses.replace(plan.trajectory, outlook=outlook))


def _plan_push(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
               drive: DriveSettings, occupancy_map: OccupancyMap | None,
               remaining: RemainingPushes | None) -> TaskPlan:
    if occupancy_map is not None:
        plan = plan_push_in_map(request, robot, settings, drive, occupancy_map,
                                remaining=remaining)
        return TaskPlan(*plan.first, remaining=plan.remaining)
    try:
        return TaskPlan(*plan_straight_push(request, robot, settings, drive))
    except PlanningFailed as failure:
        if failure.code is not PlanFailure.NO_FEASIBLE_SITE:
            raise
        if not is_casadi_installed():
            reason = f'{failure.reason}; {PlanFailure.NO_SOLVER.value}'
            raise PlanningFailed(failure.code, reason) from None
    # Imported here: straight pushes need no casadi.
    from push_planner.steered.task_push import plan_steered_push
    return plan_steered_push(request, robot, settings, drive)
