"""
What runs on the robot: planning and control behind one interface.

A single push plans once and lets the controller follow the plan; a task lets the supervisor ask
for a plan of every push. The simulation loop treats both alike.
"""

import abc
import dataclasses
import math
from typing import NamedTuple

from push_control.observation import Observation
from push_control.push.controller import Controller
from push_control.push.status import Phase
from push_control.safety.status import SafetyReport
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_model.signals import ObjectPose, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_planner.problem import PlanningFailed
from push_planner.sequence.planner import plan_for_request, TaskPlan
from push_planner.single_push.replanning import plan_from_measurements
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task
from push_scenario.simulation.history import single_push_history, StateHistory
from push_scenario.simulation.result import Outcome

ENDINGS: dict[Phase | TaskState, Outcome] = {
    Phase.DONE: Outcome.DONE, Phase.FAILED: Outcome.FAILED,
    TaskState.DONE: Outcome.DONE, TaskState.FAILED: Outcome.FAILED}


class Ending(NamedTuple):
    """
    How the robot ended a run by itself.

    :param outcome: the ``Outcome``.
    :param reason: one sentence.
    """

    outcome: Outcome
    reason: str


class RobotRecord(NamedTuple):
    """What the robot did in a run; the fields are those of ``RunResult``."""

    history: tuple[StateChange, ...]
    recoveries: int = 0
    status: SupervisorStatus | None = None
    plan: PushTrajectory | None = None
    sequence_plans: tuple[TaskPlan, ...] = ()
    single_push_time: float = math.nan


class RobotControl(abc.ABC):
    """Answers measurements with commands, and plans in between."""

    def __init__(self, scenario: Scenario) -> None:
        """
        Take the nominal parameters of a scenario.

        :param scenario: the ``Scenario``.
        """
        self._scenario = scenario
        self.goal: Pose = scenario.goal.pose

    @property
    @abc.abstractmethod
    def controller(self) -> Controller | Supervisor:
        """The ``Controller`` of a single push, or the ``Supervisor`` of a task."""

    @property
    @abc.abstractmethod
    def stage(self) -> str:
        """What the robot is doing, one word."""

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        self.controller.on_safety_report(fault, stop)

    @abc.abstractmethod
    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement.

        :param observation: ``Observation``.
        :param dt: time since the last step [s].
        :return: velocity command in the robot's axes.
        """

    @abc.abstractmethod
    def update_plan(self, observation: Observation) -> Ending | None:
        """
        Do between two measurements what is due: replan, or set the next goal.

        :param observation: the ``Observation`` of the last step.
        :return: the ``Ending`` where the run is over, else None.
        """

    @abc.abstractmethod
    def record(self, ending: Ending, time: float) -> RobotRecord:
        """
        Sum up the run.

        :param ending: how it ended.
        :param time: when [s].
        """


class SinglePushControl(RobotControl):
    """A plan from the first measurements, followed by the controller."""

    def __init__(self, scenario: Scenario, observation: Observation) -> None:
        """
        Plan the push.

        :param scenario: the ``Scenario``.
        :param observation: the first measurements.
        :raises PlanningFailed: with the reason.
        """
        super().__init__(scenario)
        if observation.object_pose is None:
            raise ValueError('observation.object_pose: got None, expected a measured pose')
        found = plan_from_measurements(scenario.object, scenario.robot, observation.object_pose,
                                       observation.odometry, self.goal, scenario.planner)
        self._plan = found.plan.trajectory
        self._target = self._plan
        self._controller = Controller(scenario.object, scenario.robot, scenario.control)
        self._replan_settings = dataclasses.replace(scenario.planner, site='current')

    @property
    def controller(self) -> Controller:
        """The ``Controller``."""
        return self._controller

    @property
    def stage(self) -> str:
        """What the robot is doing."""
        return 'pushing'

    def step(self, observation: Observation, dt: float) -> Twist:
        """Answer a measurement; see ``RobotControl``."""
        return self._controller.step(self._target, observation, dt)

    def update_plan(self, observation: Observation) -> Ending | None:
        """Replan where the controller asks for it; see ``RobotControl``."""
        controller = self._controller
        replanned = self._replan(observation) if controller.replan_requested else None
        if replanned is not None:
            self._target = replanned
        elif controller.phase in ENDINGS:
            return Ending(ENDINGS[controller.phase], controller.reason)
        return None

    def record(self, ending: Ending, time: float) -> RobotRecord:
        """Sum up the run as a task of one push; see ``RobotControl``."""
        return RobotRecord(single_push_history(*ending, time), plan=self._plan)

    def _replan(self, observation: Observation) -> PushTrajectory | None:
        """Plan from where the controller estimates robot and object to be."""
        status, odometry = self._controller.status, observation.odometry
        measured = ObjectPose(odometry.time, status.object_pose)
        try:
            found = plan_from_measurements(
                self._scenario.object, self._scenario.robot, measured,
                odometry._replace(pose=status.robot_pose), self.goal, self._replan_settings)
        except PlanningFailed:
            return None
        return found.plan.trajectory


class TaskControl(RobotControl):
    """A supervisor whose plan requests are answered after a fixed planning time."""

    def __init__(self, scenario: Scenario, task: Task, planning_time: float) -> None:
        """
        Set map and goal of the task.

        :param scenario: the ``Scenario``.
        :param task: its ``Task``.
        :param planning_time: simulated time from a plan request to its answer [s].
        """
        super().__init__(scenario)
        self._task = task
        self._planning_time = planning_time
        self._supervisor = Supervisor(scenario.object, scenario.robot, scenario.control,
                                      task.drive, task.supervision)
        self._occupancy_map = task.occupancy_map
        self._supervisor.set_map(task.occupancy_map)
        self._supervisor.set_goal(self.goal)
        self._later_goals = list(task.goals)
        self._request: PlanRequest | None = None
        self._answer_due = 0.0
        self._plans: list[TaskPlan] = []
        self._history = StateHistory()

    @property
    def controller(self) -> Supervisor:
        """The ``Supervisor``."""
        return self._supervisor

    @property
    def stage(self) -> str:
        """State of the supervisor."""
        return self._supervisor.state.value

    @property
    def history(self) -> tuple[StateChange, ...]:
        """Every ``StateChange`` so far, over all goals."""
        return self._history.changes

    @property
    def plans(self) -> tuple[TaskPlan, ...]:
        """``TaskPlan`` of every push so far."""
        return tuple(self._plans)

    def set_goal(self, pose: Pose) -> None:
        """
        Replace the goal, and start over towards it.

        :param pose: goal ``Pose`` of the object.
        """
        self.goal = pose
        self._supervisor.set_goal(pose)
        self._update_history()

    def set_map(self, occupancy_map: OccupancyMap | None) -> None:
        """
        Replace the map, from the next plan on.

        :param occupancy_map: the ``OccupancyMap``; None for open floor.
        """
        self._occupancy_map = occupancy_map
        self._supervisor.set_map(occupancy_map)

    def step(self, observation: Observation, dt: float) -> Twist:
        """Answer a measurement; see ``RobotControl``."""
        return self._supervisor.step(observation, dt)

    def update_plan(self, observation: Observation) -> Ending | None:
        """Answer a plan request and set the goal that is due; see ``RobotControl``."""
        self._answer_request(observation.time)
        self._update_history()
        state = self._supervisor.state
        if state in ENDINGS and not self._later_goals:
            return Ending(ENDINGS[state], self._supervisor.status.reason)
        if self._later_goals and observation.time >= self._later_goals[0].time:
            self.set_goal(self._later_goals.pop(0).goal.pose)
        return None

    def record(self, ending: Ending, time: float) -> RobotRecord:
        """Sum up the run; see ``RobotControl``."""
        self._update_history()
        return RobotRecord(
            self._history.changes, self._history.recoveries, self._supervisor.status,
            sequence_plans=tuple(self._plans),
            single_push_time=(self._plans[0].single_push_time if self._plans
                              else math.nan))

    def _update_history(self) -> None:
        self._history.update(self._supervisor.history, self._supervisor.recoveries)

    def _answer_request(self, time: float) -> None:
        request = self._supervisor.plan_request
        if request is not self._request:
            self._request = request
            self._answer_due = time + self._planning_time
        if request is None or time < self._answer_due:
            return
        try:
            found = plan_for_request(
                request, self._scenario.robot, self._scenario.planner, self._task.drive,
                self._task.planning, self._occupancy_map,
                kept=self._plans[-1].kept if self._plans else None)
        except PlanningFailed as failure:
            self._supervisor.on_planning_failed(failure.code, failure.reason)
            return
        self._plans.append(found)
        self._supervisor.set_plan(found.trajectory)


def make_robot_control(scenario: Scenario, observation: Observation,
                       planning_time: float) -> RobotControl:
    """
    Make what runs on the robot of a scenario.

    :param scenario: the ``Scenario``.
    :param observation: the first measurements.
    :param planning_time: simulated time from a supervisor's plan request to its answer [s].
    :raises PlanningFailed: where there is no plan of a single push.
    """
    if scenario.task is None:
        return SinglePushControl(scenario, observation)
    return TaskControl(scenario, scenario.task, planning_time)
