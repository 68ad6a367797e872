"""One random task, as a record."""

import math
import time

from benchmarks.tasks.bound import contact_path_bound, gap, least_time
from benchmarks.tasks.cases import draw, OPEN
from benchmarks.tasks.maps import object_clearance, robot_clearance
import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_navigation.path import NoPathFound
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.sequence.costs import plan_approach
from push_planner.single_push.site_selection import choose_site
from push_scenario.evaluation.metrics import distance_travelled
from push_scenario.simulation.loop import REST_SPEED, REST_YAW_RATE, simulate
from push_scenario.simulation.result import Outcome

POSITION, HEADING, CLEAR = 0.01, math.radians(1.0), 0.02
TIMED_STATES = (TaskState.PLAN, TaskState.APPROACH, TaskState.ALIGN, TaskState.PUSH,
                TaskState.RETREAT)


class PlanningClock:
    """Takes the time of planning: CPU time between measurements with an answer between them."""

    def __init__(self, intervention):
        self._intervention = intervention
        self._plan_request = None
        self._since = 0.0
        self.planning = []

    def __call__(self, simulation, supervisor):
        """
        Look on, before a measurement.

        :param simulation: the ``Simulation``.
        :param supervisor: the ``Supervisor``.
        """
        now, plan_request = time.process_time(), supervisor.plan_request
        if self._plan_request is not None and plan_request is not self._plan_request:
            self.planning.append(now - self._since)
        if self._intervention is not None:
            self._intervention(simulation, supervisor)
        self._plan_request = plan_request
        self._since = time.process_time()


def run(job):
    """
    Run one task.

    :param job: dict of ``part``, ``kind`` and ``seed``.
    :return: flat dict of numbers and text, see ``run_case`` and below.
    """
    case = draw(**job)
    result, clock = run_case(case)
    record = {'variety': case.variety, 'outcome': result.outcome.value, 'reason': result.reason,
              'pushes': result.status.pushes, 'recoveries': result.status.recoveries,
              'planning': ' '.join(f'{value:.4f}' for value in clock.planning),
              'least': least_time(case.scenario), **_end(result), **_state_times(result)}
    if result.sequence_plans:
        first = result.sequence_plans[0]
        record.update(sequence=len(first.pushes), planned=first.duration,
                      single=first.single_push_time)
    if job['part'] == OPEN:
        record.update(_robot_distances(case.scenario))
    if case.floor is not None:
        record.update(_clearances(case, result.tape))
    if case.intervention is not None:
        record['moved_in'] = case.intervention.state
    return record


def run_case(case):
    """
    Run a task.

    :param case: ``tasks_cases.Case``.
    :return: (``RunResult``, ``PlanningClock``).
    """
    clock = PlanningClock(case.intervention)
    return simulate(case.scenario, intervene=clock), clock


def _end(result):
    """Where it ended, by the true poses."""
    tape = result.tape
    last = dict(zip(tape.columns, tape.rows[-1]))
    still = (math.hypot(last['object_v_x'], last['object_v_y']) < REST_SPEED
             and abs(last['object_omega']) < REST_YAW_RATE)
    there = abs(result.position_error) <= POSITION and abs(result.heading_error) <= HEADING
    return {'position_error': result.position_error, 'heading_error': abs(result.heading_error),
            'gap': float(last['gap']), 'duration': result.duration,
            'distance': float(distance_travelled(tape)[-1]),
            'success': bool(result.outcome is Outcome.DONE and there and still
                            and last['gap'] >= CLEAR)}


def _state_times(result):
    """Time in every state, and what went wrong, in order."""
    history = result.status.history
    ends = [change.time for change in history[1:]] + [result.duration]
    spent = dict.fromkeys(TIMED_STATES, 0.0)
    for change, end in zip(history, ends):
        if change.state in spent:
            spent[change.state] += end - change.time
    return {**{f'in_{state.value}': seconds for state, seconds in spent.items()},
            'recovery_reasons': '; '.join(
                change.reason for change in history[1:-1] if change.reason)}


def _robot_distances(scenario):
    """Ways of the robot: at least that of the contact, and that of the quickest single push."""
    start, goal, robot = scenario.start.object.pose, scenario.goal.pose, scenario.robot_start
    least = gap(scenario) + contact_path_bound(scenario.true_object, start, goal)
    try:
        push = choose_site(scenario.object, scenario.robot, start, goal,
                           scenario.planner).plan.trajectory
        path = plan_approach(scenario.robot, scenario.object, start, robot,
                             Pose(*push.robot_poses[0]), DriveSettings())
    except (PlanningFailed, NoPathFound):
        return {'least_distance': least, 'single_push_distance': math.inf}
    pushed = np.hypot(*np.diff(push.robot_poses[:, :2], axis=0).T).sum()
    return {'least_distance': least, 'single_push_distance': float(path.length + pushed)}


def _clearances(case, tape):
    rectangles = case.floor.rectangles
    robot, obj = case.scenario.true_robot, case.scenario.true_object
    return {'robot_clearance': robot_clearance(robot, tape.poses('robot'), rectangles),
            'object_clearance': object_clearance(obj, tape.poses('object'), rectangles)}
