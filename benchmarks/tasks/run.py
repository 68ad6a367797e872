"""Simulation of one random task; its figures as a flat record."""

import dataclasses
import math
import time
from typing import Optional

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.bound import least_time
from benchmarks.tasks.cases import Case, draw, PUBLIC_MAPS, Tolerance, WALLS
from benchmarks.tasks.intervention import Intervention
from benchmarks.tasks.maps import distinct_poses, Floor, object_clearance, robot_clearance
from benchmarks.tasks.refusals import answer
from benchmarks.tasks.wall_contact import wall_record
from benchmarks.tasks.weight import weight_record
from push_control.task.code_text import code_text
from push_control.task.status import SupervisorStatus, TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_model.plan_request import PlanRequest
from push_navigation.settings import MapSettings
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.corrections import correcting_pushes
from push_scenario.evaluation.metrics import distance_travelled
from push_scenario.simulation.loop import REST_SPEED, REST_YAW_RATE, simulate
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.plant import Plant
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape

# Least gap between robot and object at the end of a task that counts as success [m].
MIN_GAP = 0.02
# Standard deviations that a task states as it is done by which its true errors may exceed the
# tolerances; chosen: 95 % of the errors of one axis are within them.
STATED_SIGMAS = 2.0
TIMED_STATES = (TaskState.PLAN, TaskState.APPROACH, TaskState.ALIGN, TaskState.PUSH,
                TaskState.RETREAT)


class PlanningClock:
    """
    Measures planning: the CPU time between two measurements with a new plan between them.

    ``longest``: the most CPU time between any two measurements, which refusals count for, too [s].

    :param intervention: ``Intervention`` to pass the calls on to, or None.
    """

    def __init__(self, intervention: Optional[Intervention]) -> None:
        self._intervention = intervention
        self._plan_request: Optional[PlanRequest] = None
        self._since = 0.0
        self.planning: list[float] = []
        self.longest = 0.0

    def __call__(self, simulation: Simulation, supervisor: Supervisor) -> None:
        """
        Note the CPU time, before a measurement.

        :param simulation: the ``Simulation``.
        :param supervisor: the ``Supervisor``.
        """
        now, plan_request = time.process_time(), supervisor.plan_request
        if self._since:
            self.longest = max(self.longest, now - self._since)
        if self._plan_request is not None and plan_request is not self._plan_request:
            self.planning.append(now - self._since)
        if self._intervention is not None:
            self._intervention(simulation, supervisor)
        self._plan_request = plan_request
        self._since = time.process_time()


def run(job: Job) -> Record:
    """
    Run one task.

    :param job: keyword arguments of ``draw``.
    :return: flat dict of numbers and texts.
    :raises RuntimeError: where the run has no status of a supervisor.
    """
    case = draw(**job)
    begin = time.process_time()
    result, clock = run_case(case)
    cpu = time.process_time() - begin
    if result.status is None:
        raise RuntimeError(f'status: got none of {job}, expected that of a supervisor')
    record: Record = {
        'variety': case.variety, 'outcome': result.outcome.value, 'reason': result.reason,
        'codes': code_text(result.codes),
        'pushes': result.status.pushes, 'recoveries': result.status.recoveries,
        'planning': ' '.join(f'{value:.4f}' for value in clock.planning), 'cpu': cpu,
        'longest_step': clock.longest,
        **_end(result, case.tolerance), **weight_record(result),
        **_stated(result, result.status, case.tolerance),
        **state_times(result.status, result.duration)}
    corrections = correcting_pushes(result.status.history, result.duration, _tape(result),
                                    case.scenario.final_goal)
    record['corrections'] = corrections.pushes
    if corrections.pushes:
        record['correction_time'] = corrections.seconds / corrections.pushes
    if case.floor is not None:
        record.update(_clearances(case, case.floor, _tape(result)))
    elif case.scenario.task is not None and case.scenario.task.map is not None:
        record.update(_clearances_of_cells(case, case.scenario.task.map, _tape(result)))
    if job['part'] == PUBLIC_MAPS:
        record.update(_of_public_map(case, result))
    if job['part'] == WALLS:
        # Object and walls are meant to touch: how hard is what counts.
        del record['object_clearance']
        record.update(wall_record(_tape(result), case.scenario.true_object))
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
    return simulate(case.scenario, intervene=clock, plant_type=plant_type(case)), clock


def plant_type(case: Case) -> type[Plant]:
    """
    Choose what moves object and robot of a task.

    :param case: ``Case`` of ``benchmarks.tasks.cases``.
    """
    if not case.is_spatial:
        return Plant
    # Imported here, as it comes with an extra.
    from benchmarks.tasks.spatial_plant import spatial_plant
    return spatial_plant(*case.slope)


def disturbed(case: Case) -> Scenario:
    """Return the scenario with the displacement that the intervention made."""
    displacement = None if case.intervention is None else case.intervention.displacement
    return dataclasses.replace(case.scenario, simulation=dataclasses.replace(
        case.scenario.simulation,
        object_displacements=() if displacement is None else (displacement,)))


def _tape(result: RunResult) -> Tape:
    if result.tape is None:
        raise RuntimeError(f'tape: got none ({result.reason}), expected one')
    return result.tape


def _end(result: RunResult, tolerance: Tolerance) -> Record:
    """Gather how the task ended, by the true poses."""
    tape = _tape(result)
    last = dict(zip(tape.columns, tape.rows[-1]))
    still = (math.hypot(last['object_v_x'], last['object_v_y']) < REST_SPEED
             and abs(last['object_omega']) < REST_YAW_RATE)
    there = (abs(result.position_error) <= tolerance.position
             and abs(result.heading_error) <= tolerance.heading)
    return {'position_error': result.position_error, 'heading_error': abs(result.heading_error),
            'gap': float(last['gap']), 'duration': result.duration,
            'distance': float(distance_travelled(tape)[-1]),
            'success': bool(result.outcome is Outcome.DONE and there and still
                            and last['gap'] >= MIN_GAP)}


def _stated(result: RunResult, status: SupervisorStatus, tolerance: Tolerance) -> Record:
    """Gather what a task that is done states of its errors, and whether that is true."""
    stated = status.goal_deviation
    if stated is None or result.outcome is not Outcome.DONE:
        return {}
    is_true = (abs(result.position_error) <= tolerance.position + STATED_SIGMAS * stated.position
               and abs(result.heading_error) <= tolerance.heading + STATED_SIGMAS * stated.heading)
    return {'stated_position': stated.position, 'stated_heading': stated.heading,
            'is_as_stated': is_true}


def state_times(status: SupervisorStatus, duration: float) -> Record:
    """
    Gather the time in every state [s], and the codes of recoveries, in order.

    :param duration: of the task [s].
    :return: record of ``in_STATE`` for each state and of ``recovery_codes``.
    """
    history = status.history
    ends = [change.time for change in history[1:]] + [duration]
    spent = dict.fromkeys(TIMED_STATES, 0.0)
    for change, end in zip(history, ends):
        if change.state in spent:
            spent[change.state] += end - change.time
    return {**{f'in_{state.value}': seconds for state, seconds in spent.items()},
            'recovery_codes': '; '.join(
                code_text(change.codes) for change in history[1:-1] if change.codes)}


def _of_public_map(case: Case, result: RunResult) -> Record:
    """Bound the time of a task, and tell what could be done where it was given up."""
    task = case.scenario.task
    record: Record = {'least': least_time(case.scenario)}
    if result.outcome is Outcome.DONE or task is None or task.occupancy_map is None:
        return record
    tape = _tape(result)
    ends = (Pose(*tape.poses(body)[-1].tolist()) for body in ('object', 'robot'))
    return {**record, 'answer': answer(case.scenario, task.occupancy_map, *ends).value}


def _clearances(case: Case, floor: Floor, tape: Tape) -> Record:
    rectangles = floor.rectangles
    robot, obj = case.scenario.true_robot, case.scenario.true_object
    return {'robot_clearance': robot_clearance(robot, tape.poses('robot'), rectangles),
            'object_clearance': object_clearance(obj, tape.poses('object'), rectangles)}


def _clearances_of_cells(case: Case, floor_map: FloorMap, tape: Tape) -> Record:
    """Find the least clearances from occupied cells; unknown ones are no walls."""
    occupancy_map = floor_map.read(MapSettings(allow_unknown=True))
    robot, obj = case.scenario.true_robot, case.scenario.true_object
    disc = PushedObject(mass=1.0, radius=robot.radius, supports=(Support(0.0, 0.0, 1.0),))
    return {f'{name}_clearance': occupancy_map.object_clearance(
        body, distinct_poses(tape.poses(name))) for name, body in (('robot', disc),
                                                                   ('object', obj))}
