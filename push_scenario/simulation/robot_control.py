"""
What runs on the robot: planning and control behind one interface.

A single push is planned before time starts to run; a task lets the supervisor ask for a plan of
every push. The simulation loop treats both alike.
"""

import abc
import dataclasses
from typing import Any, NamedTuple

from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_control.task.supervisor import Supervisor
from push_model.events import Codes, codes, sentence
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectPose, Odometry, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.planned_pushes import planned_pushes, PlannedPush
from push_planner.problem import check_solver, PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request, PushPlanner
from push_safety.status import SafetyReport
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task
from push_scenario.simulation.history import single_push_history, StateHistory
from push_scenario.simulation.result import Outcome, TimedRefusal

ENDINGS = {TaskState.DONE: Outcome.DONE, TaskState.FAILED: Outcome.FAILED}


class Ending(NamedTuple):
    """
    End of a run by the robot itself.

    :param reason: one sentence.
    :param codes: of the reason, as of ``Report``.
    """

    outcome: Outcome
    reason: str
    codes: Codes = ()


class RobotRecord(NamedTuple):
    """Record of the robot in a run; the fields are those of ``RunResult``."""

    history: tuple[StateChange, ...]
    recoveries: int = 0
    status: SupervisorStatus | None = None
    plan: PushTrajectory | None = None
    task_plans: tuple[TaskPlan, ...] = ()
    refusals: tuple[TimedRefusal, ...] = ()


class RobotControl(abc.ABC):
    """
    Answers measurements with commands, and plans in between.

    ``supervisor``: the ``Supervisor``. ``goal``: present goal ``Pose`` of the object.
    """

    def __init__(self, scenario: Scenario, supervisor: Supervisor) -> None:
        """Take the nominal parameters of a scenario."""
        self._scenario = scenario
        self.supervisor = supervisor
        self.goal: Pose = scenario.goal.pose

    @property
    def stage(self) -> str:
        """Stage of the robot, one word."""
        return self.supervisor.state.value

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stands until somebody lets it go on."""
        return self.supervisor.awaits_resume

    @property
    def backs_off(self) -> bool:
        """Tell whether what it pushes has stopped the robot just now, and it backs off."""
        return self.supervisor.backs_off

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        self.supervisor.on_safety_report(fault, stop)

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement.

        :param dt: time since the last step [s].
        :return: velocity command in the robot's axes.
        """
        return self.supervisor.step(observation, dt)

    @abc.abstractmethod
    def update_plan(self, observation: Observation) -> Ending | None:
        """
        Do between two measurements what is due: replan, or set the next goal.

        :param observation: the ``Observation`` of the last step.
        :return: the ``Ending`` where the run is over, else None.
        """

    def _ending_as(self, outcome: Outcome) -> Ending:
        """End the run for the reason that the supervisor has."""
        cause = self.supervisor.cause
        return Ending(outcome, sentence(cause), codes(cause))

    @abc.abstractmethod
    def record(self, ending: Ending, time: float) -> RobotRecord:
        """
        Sum up the run.

        :param ending: how it ended.
        :param time: when [s].
        """


def _ending_at_goal(failure: PlanningFailed) -> Ending | None:
    """Tell how a run ends that has no plan as none is needed; None where one is."""
    if failure.code is not PlanFailure.AT_GOAL:
        return None
    return Ending(Outcome.DONE, failure.reason, (failure.code,))


class SinglePushControl(RobotControl):
    """A plan from the first measurements, which is followed."""

    def __init__(self, scenario: Scenario, observation: Observation) -> None:
        """
        Plan the push.

        :param observation: the first measurements.
        :raises PlanningFailed: with the reason, unless the object is at the goal already.
        """
        super().__init__(scenario, Supervisor(
            scenario.object, scenario.robot, scenario.control, DriveSettings(),
            SupervisionSettings(), factory=SinglePushBehaviors))
        if observation.object_pose is None:
            raise ValueError('observation.object_pose: got None, expected a measured pose')
        # Set where no push, or no further one, is needed.
        self._ending: Ending | None = None
        self._plan: PushTrajectory | None = None
        try:
            self._plan = self._plan_from(observation.object_pose, observation.odometry,
                                         scenario.planner)
        except PlanningFailed as failure:
            self._ending = _ending_at_goal(failure)
            if self._ending is None:
                raise
        if self._plan is not None:
            self.supervisor.drive(self._plan)
        self._replan_settings = dataclasses.replace(scenario.planner, site='current')

    @property
    def stage(self) -> str:
        """Stage of the robot."""
        return 'pushing'

    def update_plan(self, observation: Observation) -> Ending | None:
        """Replan where the supervisor asks for it; see ``RobotControl``."""
        supervisor = self.supervisor
        if supervisor.plan_request is not None:
            try:
                supervisor.set_plan(self._replan(observation))
            except PlanningFailed as failure:
                self._ending = _ending_at_goal(failure) or self._ending_as(Outcome.FAILED)
        elif supervisor.state in ENDINGS:
            self._ending = self._ending_as(ENDINGS[supervisor.state])
        return self._ending

    def record(self, ending: Ending, time: float) -> RobotRecord:
        """Sum up the run as a task of one push; see ``RobotControl``."""
        history = () if self._plan is None else single_push_history(
            ending.outcome, ending.reason, time, ending.codes)
        return RobotRecord(history, plan=self._plan)

    def _replan(self, observation: Observation) -> PushTrajectory:
        """Plan from where robot and object are estimated to be."""
        status, odometry = self.supervisor.status.push, observation.odometry
        measured = ObjectPose(odometry.time, status.object_pose)
        return self._plan_from(measured, odometry._replace(pose=status.robot_pose),
                               self._replan_settings)

    def _plan_from(self, measured: ObjectPose, odometry: Odometry,
                   settings: PlannerSettings) -> PushTrajectory:
        check_solver()
        # Imported here: straight pushes need no casadi.
        from push_planner.steered.replanning import plan_from_measurements, stated_trajectory
        scenario, tolerances = self._scenario, self._scenario.control.tolerances
        choice = plan_from_measurements(scenario.object, scenario.robot, measured, odometry,
                                        self.goal, settings, tolerances=tolerances)
        return stated_trajectory(choice.plan, tolerances)


class TaskControl(RobotControl):
    """A supervisor whose plan requests are answered after a fixed planning time."""

    def __init__(self, scenario: Scenario, task: Task, planning_time: float,
                 plan_push: PushPlanner = plan_for_request, *,
                 knowledge: ObjectKnowledge | None = None) -> None:
        """
        Set map and goal of the task.

        :param task: its ``Task``.
        :param planning_time: simulated time from a plan request to its answer [s].
        :param plan_push: answers plan requests.
        :param knowledge: what was learned of the object before; None for nothing.
        """
        super().__init__(scenario, Supervisor(
            scenario.object, scenario.robot, scenario.control, task.drive, task.supervision,
            knowledge=knowledge))
        self._task = task
        self._plan_push = plan_push
        self._planning_time = planning_time
        self._occupancy_map = task.occupancy_map
        self.supervisor.set_map(task.occupancy_map)
        self.supervisor.set_goal(self.goal)
        self._later_goals = list(task.goals)
        self._request: PlanRequest | None = None
        self._answer_due = 0.0
        self._plans: list[TaskPlan] = []
        self._refusals: list[TimedRefusal] = []
        # Why the last request was refused; empty where it was not, or asked for something else.
        self._refused_for = ''
        self._history = StateHistory()

    @property
    def history(self) -> tuple[StateChange, ...]:
        """Every ``StateChange`` so far, over all goals."""
        return self._history.changes

    @property
    def plans(self) -> tuple[TaskPlan, ...]:
        """``TaskPlan`` of every push so far."""
        return tuple(self._plans)

    @property
    def refusals(self) -> tuple[TimedRefusal, ...]:
        """``TimedRefusal`` of each request that was refused otherwise than the one before."""
        return tuple(self._refusals)

    def pushes_of(self, plan: TaskPlan) -> tuple[PlannedPush, ...]:
        """List the ``PlannedPush`` of a plan, for pictures, in the present map."""
        scenario = self._scenario
        return planned_pushes(plan, scenario.object, scenario.robot, self._task.drive,
                              self._occupancy_map)

    def set_goal(self, pose: Pose) -> None:
        """
        Replace the goal, and start over towards it.

        :param pose: goal ``Pose`` of the object.
        """
        self.goal = pose
        self._refused_for = ''
        self.supervisor.set_goal(pose)
        self._update_history()

    def set_map(self, occupancy_map: OccupancyMap | None) -> None:
        """
        Replace the map, from the next plan on.

        :param occupancy_map: the ``OccupancyMap``; None for open floor.
        """
        self._occupancy_map = occupancy_map
        self.supervisor.set_map(occupancy_map)

    def update_plan(self, observation: Observation) -> Ending | None:
        """Answer a plan request and set the goal that is due; see ``RobotControl``."""
        self._answer_request(observation.time)
        self._update_history()
        state = self.supervisor.state
        if state in ENDINGS and not self._later_goals:
            return self._ending_as(ENDINGS[state])
        if self._later_goals and observation.time >= self._later_goals[0].time:
            self.set_goal(self._later_goals.pop(0).goal.pose)
        return None

    def record(self, ending: Ending, time: float) -> RobotRecord:
        """Sum up the run; see ``RobotControl``."""
        self._update_history()
        return RobotRecord(
            self._history.changes, self._history.recoveries, self.supervisor.status,
            task_plans=tuple(self._plans), refusals=tuple(self._refusals))

    def _update_history(self) -> None:
        self._history.update(self.supervisor.history, self.supervisor.recoveries)

    def _note_refusal(self, refusal: TimedRefusal) -> None:
        """Keep a refusal that differs from the last one; while it waits a task asks again."""
        reason = refusal.failure.reason
        if reason != self._refused_for:
            self._refusals.append(refusal)
        self._refused_for = reason

    def _answer_request(self, time: float) -> None:
        request = self.supervisor.plan_request
        if request is not self._request:
            self._request = request
            self._answer_due = time + self._planning_time
        if request is None or time < self._answer_due:
            return
        try:
            plan: Any = self._plan_push(
                request, self._scenario.robot, self._scenario.planner, self._task.drive,
                self._occupancy_map, remaining=self._plans[-1].remaining if self._plans else None)
        except PlanningFailed as failure:
            self._note_refusal(TimedRefusal(time, failure))
            self.supervisor.on_planning_failed(failure.code, failure.reason)
            return
        if not isinstance(plan, TaskPlan):
            raise ValueError(f'plan_push: got {plan!r}, expected a TaskPlan, or PlanningFailed to '
                             'be raised')
        self._refused_for = ''
        self._plans.append(plan)
        self.supervisor.set_plan(plan.trajectory)


def make_robot_control(scenario: Scenario, observation: Observation, planning_time: float,
                       plan_push: PushPlanner = plan_for_request) -> RobotControl:
    """
    Make what runs on the robot of a scenario.

    :param observation: the first measurements.
    :param planning_time: simulated time from a supervisor's plan request to its answer [s].
    :param plan_push: answers the plan requests of a task.
    :raises PlanningFailed: where there is no plan of a single push.
    """
    if scenario.task is None:
        return SinglePushControl(scenario, observation)
    return TaskControl(scenario, scenario.task, planning_time, plan_push)
