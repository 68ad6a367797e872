"""First plan of a task, or why there is none, without a run."""

from typing import Any, NamedTuple, NoReturn

from push_model.outlook import Outlook
from push_model.plan_request import PlanRequest
from push_planner.planned_pushes import planned_pushes, PlannedPush
from push_planner.problem import PlanningFailed
from push_planner.task_planner import plan_for_request
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate


class FirstPlan(NamedTuple):
    """
    Answer to the first request of a task.

    :param request: the ``PlanRequest``, as the robot makes it at its start.
    :param pushes: ``PlannedPush`` of each push; none where there is no plan.
    :param outlook: ``Outlook`` of the task; None where there is no plan.
    :param refusal: ``PlanningFailed``, why there is no plan; else None.
    """

    request: PlanRequest
    pushes: tuple[PlannedPush, ...] = ()
    outlook: Outlook | None = None
    refusal: PlanningFailed | None = None

    def __str__(self) -> str:
        """Say what is planned, or why nothing is."""
        if self.refusal is not None:
            return f'no plan ({self.refusal.code.name}): {self.refusal.reason}'
        noun = 'push' if len(self.pushes) == 1 else 'pushes'
        return f'{len(self.pushes)} {noun} planned: {self.outlook}'


class _Requested(Exception):
    """Ends a run at its first request."""

    def __init__(self, request: PlanRequest) -> None:
        super().__init__()
        self.request = request


def find_first_plan(scenario: Scenario) -> FirstPlan:
    """
    Plan the pushes of a task from its start.

    :raises ValueError: where it is no task, or needs no push.
    """
    task = scenario.task
    if task is None:
        raise ValueError(f'{scenario.name}: got a single push, expected a scenario with a task')
    request = _first_request(scenario)
    try:
        plan = plan_for_request(request, scenario.robot, scenario.planner, task.drive,
                                task.occupancy_map)
    except PlanningFailed as failure:
        return FirstPlan(request, refusal=failure)
    pushes = planned_pushes(plan, request.obj, scenario.robot, task.drive, task.occupancy_map)
    return FirstPlan(request, pushes, plan.trajectory.outlook)


def _first_request(scenario: Scenario) -> PlanRequest:
    """Run until the robot has measured the object at rest, and requests a plan."""
    def stop(request: PlanRequest, *_: Any, **__: Any) -> NoReturn:
        raise _Requested(request)
    try:
        result = simulate(scenario, planning_time=0.0, plan_push=stop)
    except _Requested as requested:
        return requested.request
    raise ValueError(f'{scenario.name}: got a run that ends without a plan ({result.reason}), '
                     'expected a task that needs a push')
