"""A task in one process, without ROS: planner, supervisor and plant until the object is there."""

import dataclasses
import math

from push_control.observation import Observation
from push_control.supervisor import Supervisor
from push_model.geometry import distance
from push_model.signals import Odometry
from push_planner.problem import PlanningFailed
from push_planner.wanted_push import plan_wanted
from push_scenario.closed_loop import (at_rest, control_settings, make_simulation, Progress,
                                       SETTLE_TIME)
from push_scenario.tape import Tape
from push_scenario.task import Task
from push_scenario.task_history import TaskHistory
from push_scenario.task_result import TaskResult

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
        self._supervisor.set_workspace(task.workspace)
        self._supervisor.set_goal(scenario.goal.pose)
        self._goal, self._later = scenario.goal.pose, list(task.goals)
        self._asked, self._answer_at, self._plans = None, 0.0, []
        self._history = TaskHistory()
        pose, odometry = self._simulation.next(), self._simulation.next()
        self._observation = Observation(self._simulation.time, odometry, pose)
        self._simulation.command(self._supervisor.step(self._observation, 0.0))

    def run(self):
        while self._simulation.time < self._scenario.time_limit:
            status = self._supervisor.status
            if status.state in ('done', 'failed') and not self._later:
                return self._result(status.state, status.reason)
            self._set_later_goal()
            self._change(self._simulation, self._supervisor)
            self._note()
            self._advance()
            self._plan()
            self._note()
        return self._result('time_limit', f'not done after {self._scenario.time_limit:g} s')

    def _advance(self):
        measurement, before = self._simulation.next(), self._observation
        now = self._simulation.time
        if isinstance(measurement, Odometry):
            self._observation = Observation(now, measurement, before.object_pose)
        else:
            self._observation = Observation(now, before.odometry, measurement)
        self._simulation.command(self._supervisor.step(self._observation, now - before.time))
        self._progress(Progress(self._supervisor.status.state, now,
                                distance(self._simulation.truth.object_pose, self._goal)))

    def _settle(self):
        end, rows = self._simulation.time + SETTLE_TIME, len(self._simulation.tape)
        while self._simulation.time < end:
            self._advance()
            if at_rest(self._simulation.truth) and len(self._simulation.tape) > rows + 1:
                break

    def _set_later_goal(self):
        if self._later and self._simulation.time >= self._later[0].time:
            self._goal = self._later.pop(0).goal.pose
            self._supervisor.set_goal(self._goal)

    def _note(self):
        status = self._supervisor.status
        self._history.note(status.history, status.recoveries)

    def _plan(self):
        wanted, now = self._supervisor.wants, self._simulation.time
        if wanted is not self._asked:
            self._asked, self._answer_at = wanted, now + self._planning_time
        if wanted is None or now < self._answer_at:
            return
        try:
            found = plan_wanted(wanted, self._scenario.robot, self._scenario.planner,
                                self._task.drive, self._task.planning, self._task.workspace)
        except PlanningFailed as failure:
            self._supervisor.refused(failure.reason)
            return
        self._plans.append(found)
        self._supervisor.take(found.plan.trajectory)

    def _result(self, outcome, reason):
        duration, status = self._simulation.time, self._supervisor.status
        self._settle()
        return TaskResult(
            self._scenario, self._scenario.control.control_law, outcome, reason, status,
            Tape(self._simulation.columns, self._simulation.tape), duration,
            self._history.changes, self._history.recoveries, tuple(self._plans),
            self._plans[0].single if self._plans else math.nan)


def _nothing(*_):
    pass
