"""A task in one process, without ROS: planner, supervisor and plant until the object is there."""

import dataclasses

from push_control.observation import Observation
from push_control.supervision import SupervisionSettings
from push_control.supervisor import Supervisor
from push_control.task_status import SupervisorStatus
from push_drive.settings import DriveSettings
from push_model.geometry import distance, wrap_angle
from push_model.signals import Odometry
from push_planner.problem import PlanningFailed
from push_planner.wanted_push import plan_wanted
from push_scenario.closed_loop import make_simulation
from push_scenario.scenario import Scenario
from push_scenario.tape import Tape

PLANNING_TIME = 0.3


@dataclasses.dataclass(frozen=True, eq=False)
class TaskResult:
    """
    One task.

    :param scenario: the ``Scenario``.
    :param outcome: ``done``, ``failed`` or ``time_limit``.
    :param reason: one sentence on why it ended so.
    :param status: the last ``SupervisorStatus``.
    :param plans: ``TaskPlan`` that each push was the first of, in order.
    :param tape: the ``Tape``.
    :param position_error: true distance of the object from its goal at the end [m].
    :param heading_error: its true heading less that of the goal [rad].
    """

    scenario: Scenario
    outcome: str
    reason: str
    status: SupervisorStatus
    plans: tuple
    tape: Tape
    position_error: float
    heading_error: float

    @property
    def duration(self):
        """Simulated time that it took [s]."""
        return float(self.tape.rows[-1][0])


def run_task(scenario, drive=None, supervision=None, workspace=None, planning_time=PLANNING_TIME,
             change=None):
    """
    Bring the object of a scenario to its goal, with as many pushes as that takes.

    :param scenario: the ``Scenario``; its robot may start anywhere.
    :param drive: ``DriveSettings``, or None for the defaults.
    :param supervision: ``SupervisionSettings``, or None for the defaults.
    :param workspace: the ``Workspace``, or None for free floor.
    :param planning_time: simulated time from asking for a plan to its arrival [s].
    :param change: called with ``Simulation`` and ``Supervisor`` before every measurement, to
        disturb the one or give the other another goal; None for nobody.
    :return: ``TaskResult``.
    """
    return _Task(scenario, drive or DriveSettings(), supervision or SupervisionSettings(),
                 workspace, planning_time).run(change or _nothing)


class _Task:
    """Plant, supervisor and planner."""

    def __init__(self, scenario, drive, supervision, workspace, planning_time):
        self._scenario, self._planning_time = scenario, planning_time
        self._drive, self._workspace = drive, workspace
        self._simulation = make_simulation(scenario)
        self._supervisor = Supervisor(scenario.object, scenario.robot, scenario.control, drive,
                                      supervision)
        self._supervisor.set_workspace(workspace)
        self._supervisor.set_goal(scenario.goal.pose)
        self._asked, self._answer_at, self._plans = None, 0.0, []

    def run(self, change):
        simulation, supervisor = self._simulation, self._supervisor
        pose, odometry = simulation.next(), simulation.next()
        observation = Observation(simulation.time, odometry, pose)
        simulation.command(supervisor.step(observation, 0.0))
        while simulation.time < self._scenario.time_limit:
            if supervisor.status.state in ('done', 'failed'):
                return self._result(supervisor.status.state, supervisor.status.reason)
            change(simulation, supervisor)
            measurement, before = simulation.next(), observation
            if isinstance(measurement, Odometry):
                observation = Observation(simulation.time, measurement, before.object_pose)
            else:
                observation = Observation(simulation.time, before.odometry, measurement)
            simulation.command(supervisor.step(observation, observation.time - before.time))
            self._plan()
        return self._result('time_limit', f'not done after {self._scenario.time_limit:g} s')

    def _plan(self):
        wanted, now = self._supervisor.wants, self._simulation.time
        if wanted is not self._asked:
            self._asked, self._answer_at = wanted, now + self._planning_time
        if wanted is None or now < self._answer_at:
            return
        try:
            found = plan_wanted(wanted, self._scenario.robot, self._scenario.planner, self._drive,
                                workspace=self._workspace)
        except PlanningFailed as failure:
            self._supervisor.refused(failure.reason)
            return
        self._plans.append(found)
        self._supervisor.take(found.plan.trajectory)

    def _result(self, outcome, reason):
        pose, goal = self._simulation.truth.object_pose, self._scenario.goal.pose
        return TaskResult(self._scenario, outcome, reason, self._supervisor.status,
                          tuple(self._plans), Tape(self._simulation.columns,
                                                   self._simulation.tape),
                          distance(pose, goal), wrap_angle(pose.theta - goal.theta))


def _nothing(*_):
    pass
