"""Simulation of one random task; its figures as a flat record."""

import math
import time
from typing import Optional, Union

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.bound import contact_path_bound, gap, least_time
from benchmarks.tasks.cases import Case, draw, OPEN
from benchmarks.tasks.intervention import Intervention
from benchmarks.tasks.maps import Floor, object_clearance, robot_clearance
import numpy as np
from push_control.push.controller import Controller
from push_control.task.status import SupervisorStatus, TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_navigation.path import NoPathFound
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.sequence.costs import plan_approach
from push_planner.single_push.site_selection import choose_site
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.metrics import distance_travelled
from push_scenario.simulation.loop import REST_SPEED, REST_YAW_RATE, simulate
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape

# Errors of the true object pose [m], [rad] that count as success: the supervisor's tolerances, in
# spite of the sensors' noise; and least gap between robot and object at the end [m].
POSITION_TOLERANCE = 0.01
HEADING_TOLERANCE = math.radians(1.0)
MIN_GAP = 0.02
TIMED_STATES = (TaskState.PLAN, TaskState.APPROACH, TaskState.ALIGN, TaskState.PUSH,
                TaskState.RETREAT)


class PlanningClock:
    """
    Measures planning: the CPU time between two measurements with a new plan between them.

    :param intervention: ``Intervention`` to pass the calls on to, or None.
    """

    def __init__(self, intervention: Optional[Intervention]) -> None:
        self._intervention = intervention
        self._plan_request: Optional[PlanRequest] = None
        self._since = 0.0
        self.planning: list[float] = []

    def __call__(self, simulation: Simulation,
                 supervisor: Union[Controller, Supervisor]) -> None:
        """
        Note the CPU time, before a measurement.

        :param simulation: the ``Simulation``.
        :param supervisor: the ``Supervisor``.
        :raises TypeError: for the ``Controller`` of a single push.
        """
        if not isinstance(supervisor, Supervisor):
            raise TypeError(f'supervisor: got a {type(supervisor).__name__}, '
                            'expected a Supervisor')
        now, plan_request = time.process_time(), supervisor.plan_request
        if self._plan_request is not None and plan_request is not self._plan_request:
            self.planning.append(now - self._since)
        if self._intervention is not None:
            self._intervention(simulation, supervisor)
        self._plan_request = plan_request
        self._since = time.process_time()


def run(job: Job) -> Record:
    """
    Run one task.

    :param job: dict of ``part``, ``kind`` and ``seed``.
    :return: flat dict of numbers and texts.
    :raises RuntimeError: where the run has no status of a supervisor.
    """
    case = draw(**job)
    result, clock = run_case(case)
    if result.status is None:
        raise RuntimeError(f'status: got none of {job}, expected that of a supervisor')
    record: Record = {
        'variety': case.variety, 'outcome': result.outcome.value, 'reason': result.reason,
        'pushes': result.status.pushes, 'recoveries': result.status.recoveries,
        'planning': ' '.join(f'{value:.4f}' for value in clock.planning),
        'least': least_time(case.scenario), **_end(result),
        **_state_times(result.status, result.duration)}
    if result.sequence_plans:
        first = result.sequence_plans[0]
        record.update(sequence=len(first.pushes), planned=first.duration,
                      single=first.single_push_time)
    if job['part'] == OPEN:
        record.update(_robot_distances(case.scenario))
    if case.floor is not None:
        record.update(_clearances(case, case.floor, _tape(result)))
    if case.intervention is not None:
        record['moved_in'] = case.intervention.state
    return record


def run_case(case: Case) -> tuple[RunResult, PlanningClock]:
    """
    Run a task.

    :param case: ``Case`` of ``benchmarks.tasks.cases``.
    :return: (``RunResult``, ``PlanningClock``).
    """
    clock = PlanningClock(case.intervention)
    return simulate(case.scenario, intervene=clock), clock


def _tape(result: RunResult) -> Tape:
    if result.tape is None:
        raise RuntimeError(f'tape: got none ({result.reason}), expected one')
    return result.tape


def _end(result: RunResult) -> Record:
    """Gather how the task ended, by the true poses."""
    tape = _tape(result)
    last = dict(zip(tape.columns, tape.rows[-1]))
    still = (math.hypot(last['object_v_x'], last['object_v_y']) < REST_SPEED
             and abs(last['object_omega']) < REST_YAW_RATE)
    there = (abs(result.position_error) <= POSITION_TOLERANCE
             and abs(result.heading_error) <= HEADING_TOLERANCE)
    return {'position_error': result.position_error, 'heading_error': abs(result.heading_error),
            'gap': float(last['gap']), 'duration': result.duration,
            'distance': float(distance_travelled(tape)[-1]),
            'success': bool(result.outcome is Outcome.DONE and there and still
                            and last['gap'] >= MIN_GAP)}


def _state_times(status: SupervisorStatus, duration: float) -> Record:
    """Gather the time in every state, and the reasons of recoveries, in order."""
    history = status.history
    ends = [change.time for change in history[1:]] + [duration]
    spent = dict.fromkeys(TIMED_STATES, 0.0)
    for change, end in zip(history, ends):
        if change.state in spent:
            spent[change.state] += end - change.time
    return {**{f'in_{state.value}': seconds for state, seconds in spent.items()},
            'recovery_reasons': '; '.join(
                change.reason for change in history[1:-1] if change.reason)}


def _robot_distances(scenario: Scenario) -> Record:
    """Bound the robot's path length from below, and compute that of the fastest single push."""
    start, goal, robot = scenario.start.object.pose, scenario.goal.pose, scenario.robot_start
    least = gap(scenario) + contact_path_bound(scenario.true_object, start, goal)
    try:
        push = choose_site(scenario.object, scenario.robot, start, goal,
                           scenario.planner).plan.trajectory
        path = plan_approach(scenario.robot, scenario.object, start, robot,
                             Pose(*push.robot_poses[0].tolist()), DriveSettings())
    except (PlanningFailed, NoPathFound):
        return {'least_distance': least, 'single_push_distance': math.inf}
    pushed = np.hypot(*np.diff(push.robot_poses[:, :2], axis=0).T).sum()
    return {'least_distance': least, 'single_push_distance': float(path.length + pushed)}


def _clearances(case: Case, floor: Floor, tape: Tape) -> Record:
    rectangles = floor.rectangles
    robot, obj = case.scenario.true_robot, case.scenario.true_object
    return {'robot_clearance': robot_clearance(robot, tape.poses('robot'), rectangles),
            'object_clearance': object_clearance(obj, tape.poses('object'), rectangles)}
