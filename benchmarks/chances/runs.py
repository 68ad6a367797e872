"""One random task or steered push; what its plans knew, and how it ended, as a flat record."""

import dataclasses
import json
import math
from typing import Any

from benchmarks.controller.cases import scenario
from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.cases import Case, draw, Tolerance, with_tolerance
from benchmarks.tasks.run import plant_type
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance, wrap_angle
from push_model.plan_request import PlanRequest
from push_planner.problem import PlanningFailed
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.plant import Plant
from push_sim_node.simulation import Simulation

# Step of MuJoCo in steered pushes [s]; chosen: four times that of its validation.
STEP = 1e-3
# Wide tolerances: twice those of most tasks; chosen.
WIDE_TOLERANCE = Tolerance(0.02, math.radians(2.0))


class PlanRecorder:
    """
    Plans as the package does, and records what each plan knew.

    ``plans``: of every plan what is known, as numbers by name.
    """

    def __init__(self) -> None:
        """Start without plans, at time 0."""
        self.plans: list[dict[str, Any]] = []
        self._time = 0.0

    def watch(self, simulation: Simulation, _: Supervisor) -> None:
        """Note the time, before a measurement."""
        self._time = simulation.time

    def plan(self, request: PlanRequest, *arguments: Any, **options: Any) -> TaskPlan:
        """Plan; arguments as of ``plan_for_request``."""
        plan = plan_for_request(request, *arguments, **options)
        self.plans.append({
            'time': self._time, 'expected_time': plan.expected_time,
            'push_length': plan.length, 'style': plan.trajectory.style.value,
            'pushes': 1 if plan.remaining is None else 1 + len(plan.remaining.pushes),
            'is_in_map': plan.remaining is not None,
            'goal_distance': distance(request.object_pose, request.goal),
            'goal_heading': abs(wrap_angle(request.object_pose.theta - request.goal.theta)),
            **{name: getattr(request, name) for name in (
                'position_tolerance', 'heading_tolerance', 'robot_deviation', 'odometry_slope',
                'odometry_drift', 'center_deviation', 'contact_friction_deviation',
                'cone_fraction')}})
        return plan


def run_task(job: Job) -> Record:
    """
    Run a task.

    :param job: keyword arguments of ``benchmarks.tasks.cases.draw``.
    :return: flat record of how it ended, with ``plans`` as JSON.
    """
    return _task_record(draw(**job))


def run_wide_task(job: Job) -> Record:
    """
    Run a task within wide tolerances.

    :param job: as of ``run_task``.
    :return: as of ``run_task``.
    """
    return _task_record(with_tolerance(draw(**job), WIDE_TOLERANCE))


def _task_record(case: Case) -> Record:
    recorder = PlanRecorder()
    result = simulate(case.scenario, intervene=recorder.watch, plan_push=recorder.plan,
                      plant_type=plant_type(case))
    return {'outcome': result.outcome.value, 'reason': result.reason,
            'duration': result.duration, 'position_error': result.position_error,
            'heading_error': abs(result.heading_error),
            'position_tolerance': case.tolerance.position,
            'heading_tolerance': case.tolerance.heading, 'plans': json.dumps(recorder.plans)}


def run_push(job: Job) -> Record:
    """
    Drive a steered push under the default law.

    :param job: ``kind`` and ``seed`` of ``benchmarks.controller.cases.scenario``, ``stress``, and
        ``is_spatial``: whether the foreign engine moves it.
    :return: flat record; its ``outcome`` is empty where there is no plan.
    """
    try:
        case, plan = scenario(job['kind'], job['seed'], job['stress'])
    except PlanningFailed as failure:
        return {'outcome': '', 'reason': failure.reason}
    result = simulate(case, plant_type=push_plant(is_spatial=job['is_spatial']))
    record: Record = {
        'outcome': result.outcome.value, 'reason': result.reason,
        'planned_time': plan.motion.duration, 'path_length': plan.motion.path_length,
        'goal_distance': math.hypot(case.goal.x, case.goal.y),
        'goal_heading': abs(case.goal.theta), 'contact': plan.problem.contact.kind,
        'figures': json.dumps({name: value for name, value in plan.report.items()
                               if isinstance(value, (int, float))})}
    if result.outcome is not Outcome.REFUSED:
        record.update(duration=result.duration, position_error=result.position_error,
                      heading_error=abs(result.heading_error))
    return record


def push_plant(*, is_spatial: bool) -> type[Plant]:
    """
    Choose what moves object and robot of a steered push.

    :param is_spatial: whether the foreign engine does.
    """
    if not is_spatial:
        return Plant
    # Imported here, as they come with an extra.
    from benchmarks.tasks.spatial_plant import SpatialPlant
    from push_mujoco.scene import TUNED

    class HoldingPlant(SpatialPlant):
        """
        MuJoCo as in its validation: its default contacts slip, and lose any steered push.

        The bumper follows the height of the object. One that keeps its own rubs upwards on the
        soft feet: the object hops, and the contact chatters.
        """

        engine = dataclasses.replace(TUNED, step=STEP)

    return HoldingPlant
