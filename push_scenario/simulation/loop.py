"""A task in one process, without ROS: planner, supervisor and plant until the object is there."""

import dataclasses
import math
from typing import NamedTuple

from push_control.observation import Observation
from push_control.push.controller import Controller
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance
from push_model.signals import ObjectPose, Odometry
from push_planner.problem import PlanningFailed
from push_planner.sequence.planner import plan_for_request
from push_planner.single_push.replanning import plan_from_measurements
from push_scenario.definition.task import Task
from push_scenario.simulation.result import Result, TaskHistory, TaskResult
from push_sim_node.simulation import Simulation


class Replanner:
    """Plans anew from where the controller believes robot and object to be."""

    def __init__(self, scenario):
        """
        Take the beliefs of a scenario.

        :param scenario: the ``Scenario``.
        """
        self._parts, self._goal = (scenario.object, scenario.robot), scenario.goal.pose
        self._settings = dataclasses.replace(scenario.planner, site='current')

    def answer(self, status, odometry):
        """
        Plan anew if the controller asks for it.

        :param status: ``ControllerStatus``.
        :param odometry: newest ``Odometry``; only its time and motion count.
        :return: ``PushTrajectory``, or None where nothing is asked or there is no plan.
        """
        if not status.replan_requested:
            return None
        measured = ObjectPose(odometry.time, status.object_pose)
        try:
            found = plan_from_measurements(*self._parts, measured,
                                           odometry._replace(pose=status.robot_pose), self._goal,
                                           self._settings)
        except PlanningFailed:
            return None
        return found.plan.trajectory


REST_SPEED = 1e-4
REST_YAW_RATE = 1e-3
SETTLE_TIME = 2.0


class Progress(NamedTuple):
    """
    How far a run has come.

    :param stage: ``planning``, ``pushing``, ``settling`` or ``ended``.
    :param time: simulated time [s].
    :param distance: from the object to its goal [m].
    """

    stage: str
    time: float
    distance: float


def run(scenario, control_law=None, progress=None):
    """
    Plan and push.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``; None for what the scenario says.
    :param progress: called with a ``Progress`` at every measurement; None for nobody.
    :return: the ``Result``.
    """
    settings = control_settings(scenario, control_law)
    report = progress or _ignore
    goal = scenario.goal.pose
    simulation = make_simulation(scenario)
    pose, odometry = simulation.next_measurement(), simulation.next_measurement()
    report(Progress('planning', 0.0, distance(pose.pose, goal)))
    try:
        answer = plan_from_measurements(scenario.object, scenario.robot, pose, odometry, goal,
                                        scenario.planner).plan
    except PlanningFailed as failure:
        return Result(scenario, settings.control_law, 'refused', failure.reason)
    controller = Controller(scenario.object, scenario.robot, settings)
    observation = Observation(simulation.time, odometry, pose)
    loop = _Loop(simulation, controller, answer.trajectory, observation, goal,
                 Replanner(scenario), report)
    outcome, reason, end_time = loop.push(scenario.time_limit)
    loop.settle()
    return Result(scenario, settings.control_law, outcome, reason, answer.trajectory,
                  simulation.tape, end_time)


def control_settings(scenario, control_law=None):
    """
    Look up the controller's settings, under another law if one is named.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``; None for what the scenario says.
    :raises ValueError: where there is no such law.
    """
    if control_law is None:
        return scenario.control
    return dataclasses.replace(scenario.control, control_law=control_law)


def make_simulation(scenario):
    """
    Make the plant of a scenario, at time 0.

    :param scenario: the ``Scenario``.
    :return: the ``Simulation``.
    """
    return Simulation(scenario.truth, scenario.robot_truth, scenario.start.object.pose,
                      scenario.robot_start, scenario.simulation, scenario.sensors)


def at_rest(truth):
    """
    Tell whether robot and object have come to rest.

    :param truth: ``Truth`` of the plant.
    """
    return all(math.hypot(twist.v_x, twist.v_y) < REST_SPEED and abs(twist.omega) < REST_YAW_RATE
               for twist in (truth.object_twist, truth.robot_twist))


class _Loop:
    """The controller answers every measurement with one command."""

    def __init__(self, simulation, controller, target, observation, goal, replanner, report):
        self.simulation, self.controller, self.target = simulation, controller, target
        self.observation, self.goal = observation, goal
        self.replanner, self.report = replanner, report
        self._answer(0.0)

    def push(self, time_limit):
        """Go on until the controller ends the push, or time is up."""
        while self.simulation.time < time_limit:
            status = self.controller.status
            anew = self.replanner.answer(status, self.observation.odometry)
            if anew is None and status.phase.has_ended:
                return status.phase.value, status.reason, self.simulation.time
            self.target = anew or self.target
            self._advance('pushing')
        return 'time_limit', f'not done after {time_limit:g} s', self.simulation.time

    def settle(self):
        """Go on until everything is at rest."""
        end = self.simulation.time + SETTLE_TIME
        rows = len(self.simulation.rows)
        while self.simulation.time < end:
            self._advance('settling')
            if at_rest(self.simulation.truth) and len(self.simulation.rows) > rows + 1:
                break

    def _advance(self, stage):
        measurement = self.simulation.next_measurement()
        now, before = self.simulation.time, self.observation
        if isinstance(measurement, Odometry):
            self.observation = Observation(now, measurement, before.object_pose)
        else:
            self.observation = Observation(now, before.odometry, measurement)
        self._answer(now - before.time)
        self.report(Progress(stage, now, distance(self.simulation.truth.object_pose, self.goal)))

    def _answer(self, dt):
        self.simulation.command(self.controller.step(self.target, self.observation, dt))


def _ignore(_):
    pass


PLANNING_TIME = 0.3


def run_task(scenario, control_law=None, progress=None, change=None, planning_time=PLANNING_TIME):
    """
    Bring the object of a scenario to its goal, with as many pushes as that takes.

    :param scenario: the ``Scenario``; its robot may start anywhere. Where it has no ``task``, the
        defaults of ``Task`` hold.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``; None for what the scenario says.
    :param progress: called with a ``Progress`` at every measurement; None for nobody.
    :param change: called with ``Simulation`` and ``Supervisor`` before every measurement, to
        disturb the one or give the other another goal; None for nobody.
    :param planning_time: simulated time from asking for a plan to its arrival [s].
    :return: ``TaskResult``.
    """
    control = control_settings(scenario, control_law)
    return _Run(dataclasses.replace(scenario, control=control), planning_time,
                progress or _nothing, change or _nothing).run()


class _Run:
    """Plant, supervisor and planner."""

    def __init__(self, scenario, planning_time, progress, change):
        self._scenario, self._planning_time = scenario, planning_time
        self._progress, self._change = progress, change
        self._task = task = scenario.task or Task()
        self._simulation = make_simulation(scenario)
        self._supervisor = Supervisor(scenario.object, scenario.robot, scenario.control,
                                      task.drive, task.supervision)
        self._supervisor.set_map(task.occupancy_map)
        self._supervisor.set_goal(scenario.goal.pose)
        self._goal, self._later = scenario.goal.pose, list(task.goals)
        self._asked, self._answer_at, self._plans = None, 0.0, []
        self._history = TaskHistory()
        pose, odometry = self._simulation.next_measurement(), self._simulation.next_measurement()
        self._observation = Observation(self._simulation.time, odometry, pose)
        self._simulation.command(self._supervisor.step(self._observation, 0.0))

    def run(self):
        while self._simulation.time < self._scenario.time_limit:
            status = self._supervisor.status
            if status.state.is_final and not self._later:
                return self._result(status.state.value, status.reason)
            self._set_later_goal()
            self._change(self._simulation, self._supervisor)
            self._note()
            self._advance()
            self._plan()
            self._note()
        return self._result('time_limit', f'not done after {self._scenario.time_limit:g} s')

    def _advance(self):
        measurement, before = self._simulation.next_measurement(), self._observation
        now = self._simulation.time
        if isinstance(measurement, Odometry):
            self._observation = Observation(now, measurement, before.object_pose)
        else:
            self._observation = Observation(now, before.odometry, measurement)
        self._simulation.command(self._supervisor.step(self._observation, now - before.time))
        self._progress(Progress(self._supervisor.status.state.value, now,
                                distance(self._simulation.truth.object_pose, self._goal)))

    def _settle(self):
        end, rows = self._simulation.time + SETTLE_TIME, len(self._simulation.rows)
        while self._simulation.time < end:
            self._advance()
            if at_rest(self._simulation.truth) and len(self._simulation.rows) > rows + 1:
                break

    def _set_later_goal(self):
        if self._later and self._simulation.time >= self._later[0].time:
            self._goal = self._later.pop(0).goal.pose
            self._supervisor.set_goal(self._goal)

    def _note(self):
        status = self._supervisor.status
        self._history.note(status.history, status.recoveries)

    def _plan(self):
        wanted, now = self._supervisor.plan_request, self._simulation.time
        if wanted is not self._asked:
            self._asked, self._answer_at = wanted, now + self._planning_time
        if wanted is None or now < self._answer_at:
            return
        try:
            found = plan_for_request(wanted, self._scenario.robot, self._scenario.planner,
                                     self._task.drive, self._task.planning, self._task.occupancy_map)
        except PlanningFailed as failure:
            self._supervisor.on_planning_failed(failure.reason)
            return
        self._plans.append(found)
        self._supervisor.take(found.plan.trajectory)

    def _result(self, outcome, reason):
        duration, status = self._simulation.time, self._supervisor.status
        self._settle()
        return TaskResult(
            self._scenario, self._scenario.control.control_law, outcome, reason, status,
            self._simulation.tape, duration,
            self._history.changes, self._history.recoveries, tuple(self._plans),
            self._plans[0].single if self._plans else math.nan)


def _nothing(*_):
    pass
