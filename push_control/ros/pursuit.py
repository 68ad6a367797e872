"""Pursuit of a goal: between the controller's node and the supervisor of its task."""

import dataclasses
import math
from pathlib import Path
import time
from typing import Any, TypeVar

from push_control.events import TaskEvent
from push_control.goal import GoalOutcome, GoalProgress, PushGoal, PushState
from push_control.ros.floor import LiveMap
from push_control.ros.measurements import CovarianceCheck
from push_control.ros.objects.knowledge import KnowledgeFile, KnowledgeMemory
from push_control.ros.parameters import ControllerParameters
from push_control.ros.plan_entry import PlanEntry
from push_control.ros.robot_placing import RobotPlacing
from push_control.ros.scene import ScenePublisher
from push_control.ros.start_state import StartState
from push_control.ros.task_progress import task_progress, with_errors
from push_control.ros.task_report import TaskReporter
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.events import AnyReport, Report
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.plan_request import PlanRequest
from push_model.signals import Twist
from push_ros.conversions.primitives import MessageRefused
from push_ros.map_reader import MapChange
from push_ros.node import PushNode, ServiceAnswer
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReport

Settings = TypeVar('Settings', ControlSettings, SupervisionSettings)


def settings_for_goal(settings: Settings, goal: PushGoal | None) -> Settings:
    """Put tolerances that a goal states in place of others: a heading for a disc, too."""
    stated: dict[str, Any] = {}
    if goal is not None and goal.position_tolerance is not None:
        stated['position_tolerance'] = goal.position_tolerance
    if goal is not None and goal.heading_tolerance is not None:
        stated['heading_tolerance'] = goal.heading_tolerance
        if isinstance(settings, SupervisionSettings):
            stated['disc_heading_free'] = False
    return dataclasses.replace(settings, **stated)


class GoalPursuit:
    """
    Lets a ``Supervisor`` bring the object to its goal: with one steered push, or with many pushes.

    ``start_state``: the present ``StartState``.
    """

    def __init__(self, node: PushNode, parameters: ControllerParameters,
                 scene: ScenePublisher, placing: RobotPlacing) -> None:
        """
        Wait for a goal.

        :param placing: ``RobotPlacing``, which gets the map.

        :raises ValueError: where ``knowledge_file`` cannot be read.
        """
        options = parameters.options
        self._options = options
        self._placing = placing
        self._parameters = parameters
        self._logger = node.get_logger()
        self.start_state = StartState.first(waits=options.wait_for_start)
        self._factory = None if options.task else SinglePushBehaviors
        file = KnowledgeFile(Path(options.knowledge_file)) if options.knowledge_file else None
        self._memory = KnowledgeMemory(parameters.object, parameters.supervision, file, time.time)
        self._covariance_check = CovarianceCheck(parameters.supervision)
        self._floor = LiveMap(parameters, is_needed=options.task)
        # The request for which footprints were last cleared.
        self._cleared_for: PlanRequest | None = None
        self._goal: PushGoal | None = None
        self._reporter = TaskReporter(node, scene)
        self._plans = PlanEntry(node, parameters, self._floor, self._reporter)
        self.reset()

    def rehearse(self) -> None:
        """Compile or load now what the first goal would wait for."""
        self._supervisor.rehearse()

    # What it does.

    @property
    def is_started(self) -> bool:
        """Tell whether the robot may move."""
        return self.start_state is StartState.STARTED

    @property
    def is_set(self) -> bool:
        """Tell whether there is something to do."""
        return self._goal is not None or self._supervisor.has_stored_plan

    @property
    def missing_input(self) -> str:
        """Topics of which one has to bring something to do; empty where there is something."""
        if self.is_set:
            return ''
        return 'goal_pose or push_plan' if self._plans.accepts_unrequested else 'goal_pose'

    @property
    def is_commanding(self) -> bool:
        """Tell whether it drives or holds the robot, so that measurements must come."""
        return self.is_started and not self._supervisor.state.is_standing

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stands until somebody lets it go on, by ``resume`` or a goal."""
        return self._supervisor.awaits_resume

    @property
    def awaits_plan(self) -> bool:
        """Tell whether nothing happens before the plan comes that was requested."""
        return self._supervisor.awaits_plan

    @property
    def has_open_request(self) -> bool:
        """Tell whether the planner has not answered a request yet."""
        return self._supervisor.plan_request is not None

    @property
    def awaits_map(self) -> bool:
        """Tell whether it needs a map, and none has come."""
        return self._floor.is_awaited

    @property
    def progress(self) -> GoalProgress:
        """Progress of the pursuit of the goal; errors are those of the last measured pose."""
        if self._plans.refusal is not None:
            progress = GoalProgress(PushState.FAILED, self._plans.refusal, GoalOutcome.NO_PLAN)
        else:
            progress = task_progress(self._supervisor.status, self._supervisor.cause,
                                     is_started=self.is_started)
        perception = self._supervisor.perception
        if perception.is_localized:
            progress = progress._replace(robot_pose=perception.robot_pose)
        measured = None if self._observation is None else self._observation.object_pose
        if measured is None or self._goal is None:
            return progress._replace(deviation=None)
        return with_errors(progress, measured.pose, self._goal.pose)

    # Start and stop.

    def reset(self) -> None:
        """Forget all but goal and map, which are kept for ``start``, and what was learned."""
        parameters = self._parameters
        self._supervisor = Supervisor(
            parameters.object, parameters.robot, parameters.control, parameters.drive,
            parameters.supervision, factory=self._factory, knowledge=self._memory.recall())
        self._apply_settings()
        self._supervisor.set_map(self._floor.occupancy_map)
        self._hold_without_map()
        self._stand_if_stopped()
        self._observation: Observation | None = None
        # By how much clocks were set ahead, for which the supervisor's does not count [s].
        self._skipped_time = self._reporter.skipped_time = 0.0
        self._plans.reset(self._supervisor)
        self.report_again()

    def interrupt(self, cause: AnyReport) -> None:
        """Say, after ``reset``, why the robot stands; a known goal waits for ``start``."""
        self._supervisor.interrupt(cause)
        self._stand_if_stopped()

    def start(self) -> None:
        """Start, or start over; lift a stop."""
        self.start_state = StartState.STARTED
        self._plans.forget_plan_age()
        self._supervisor.restart(None if self._goal is None else self._goal.pose,
                                 self._time_before_goal)

    def stop(self) -> None:
        """Stop, until ``start``; what has ended is not started again."""
        if not self._supervisor.can_restart:
            self._forget_goal()
            self._supervisor.stop(TaskEvent.STOPPED_BY_USER.report())
        self.start_state = StartState.STOPPED
        self._stand_if_stopped()

    def _stand_if_stopped(self) -> None:
        if self.start_state is StartState.STOPPED:
            self._supervisor.interrupt(TaskEvent.STOPPED_BY_USER.report())

    def pause(self) -> ServiceAnswer:
        """Stand until ``resume``."""
        state = self._supervisor.state
        if not self._options.task:
            return ServiceAnswer(False, 'no task to pause: the parameter task is false')
        if not self._supervisor.can_pause:
            return ServiceAnswer(False, f'nothing to pause: the task is {state.value}')
        self._supervisor.pause()
        return ServiceAnswer(True, 'paused')

    def resume(self) -> ServiceAnswer:
        """Go on after a pause, or after a stop of the base."""
        state = self._supervisor.state
        if state is not TaskState.PAUSED and not self.awaits_resume:
            return ServiceAnswer(False, f'nothing to resume: the task is {state.value}')
        self._supervisor.resume()
        return ServiceAnswer(True, 'resumed')

    @property
    def backs_off(self) -> bool:
        """Tell whether what it pushes has stopped the robot just now, and it backs off."""
        return self._supervisor.backs_off

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before the step with that odometry.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        self._supervisor.on_safety_report(fault, stop)

    def on_time_ahead(self, duration: float) -> None:
        """
        Note that clocks were set ahead: no limit of time is over for that.

        :param duration: by how much [s].
        """
        self._skipped_time += duration
        self._plans.on_time_ahead(duration)
        self._reporter.skipped_time = self._skipped_time

    # Goals and parameters.

    def set_goal(self, goal: PushGoal) -> None:
        """Pursue a goal, in place of the present one; before the start, plan it at most."""
        self._goal = goal
        self._plans.refusal = None
        self._apply_settings()
        self._reporter.show_goal(goal.pose)
        if self.is_started or self._supervisor.keeps_plan:
            self._supervisor.set_goal(goal.pose, self._time_before_goal)

    @property
    def _time_before_goal(self) -> float:
        """Time up to which object poses are from before a goal that comes now [s]."""
        # In lockstep the measurement from whose time on it holds has come before.
        if self._options.lockstep or self._observation is None:
            return -math.inf
        return self._observation.time

    def note_refused_goal(self, cause: AnyReport) -> None:
        """
        Say why a robot without a goal stands, until there is one: the one that has come is none.

        :param cause: ``Report`` of why it was refused.
        """
        if self.start_state is not StartState.STOPPED:
            self._supervisor.interrupt(cause)

    def move_goal(self, correction: Pose) -> None:
        """
        Follow the frame of the goal, which has drifted; the task goes on.

        :param correction: ``Pose`` that takes the previous goal to the new one,
            ``correction @ goal``.
        """
        if self._goal is not None:
            self._goal = dataclasses.replace(self._goal, pose=correction @ self._goal.pose)
            self._supervisor.move_goal(self._goal.pose)
            self._reporter.move_goal(self._goal.pose)

    def cancel(self, cause: AnyReport) -> None:
        """Abandon the goal; a robot that may touch the object backs off first."""
        self._forget_goal()
        self._supervisor.cancel(cause)

    def halt(self, cause: AnyReport) -> None:
        """Abandon the goal, and stand at once, as where odometry is lost."""
        self._forget_goal()
        self._supervisor.stop(cause)

    def _forget_goal(self) -> None:
        self._goal = None
        self._plans.refusal = None
        self._reporter.show_goal(None)

    def set_parameters(self, parameters: ControllerParameters) -> None:
        """
        Set parameters; movements use them from the next one on.

        :param parameters: ``ControllerParameters``, with the object and robot of before.
        """
        self._parameters = self._plans.parameters = parameters
        self._apply_settings()

    def _apply_settings(self) -> None:
        """Hand on the settings, with the tolerances of the goal where it has any."""
        parameters, goal = self._parameters, self._goal
        self._supervisor.set_settings(settings_for_goal(parameters.control, goal),
                                      parameters.drive,
                                      settings_for_goal(parameters.supervision, goal))

    def set_object(self, parameters: ControllerParameters) -> None:
        """
        Push another object from now on; the robot stands where it was, and has no goal.

        :param parameters: ``ControllerParameters``, with the robot of before.
        """
        self._parameters = self._plans.parameters = parameters
        try:
            self._memory.select(parameters.object)
        except ValueError as error:
            self._logger.warning(f'knowledge_file: {error}; nothing is known of this object')
        perception = self._supervisor.perception
        self._floor.set_object(parameters.object)
        self._goal = None
        self.reset()
        self._supervisor.perception.take_over_robot(perception)

    # Maps.

    def on_map(self, message: Any) -> None:
        """
        Read the map for the next path or plan; a task stands until it is there.

        :raises MessageRefused: where it cannot be used.
        """
        self._floor.start(message)
        self._take_map()

    def refuse_map(self, reason: str) -> None:
        """Take note of a map that cannot be brought to the world frame: a task stands."""
        self._floor.refuse(reason)
        self._hold_without_map()

    def protect(self, report: Report[ProtectiveCause] | None) -> None:
        """
        Let the robot stand while a scan shows something in the way.

        :param report: ``Report`` of that; None where the way is clear.
        """
        self._supervisor.protect(report)

    def _hold_without_map(self) -> None:
        """Let the robot stand while a map cannot be relied on."""
        fault = self._floor.fault
        self._supervisor.hold(TaskEvent.NO_USABLE_MAP.report(map_fault=fault) if fault else None)

    def _take_map(self) -> None:
        """Use a map that was read."""
        try:
            taken = self._floor.take()
        finally:
            self._hold_without_map()
        if taken is None:
            return
        if taken.change is MapChange.NEW:
            self._supervisor.set_map(self._floor.occupancy_map)
            self._placing.set_map(taken.message)
            self._reporter.report_map(taken.message)
        elif taken.change is MapChange.MOVED:
            self._move_map()

    def move_map(self, correction: Pose) -> None:
        """
        Follow the frame of the map, which has drifted.

        :param correction: ``Pose``, as of ``move_goal``.
        """
        if self._floor.move(correction):
            self._move_map()

    def _move_map(self) -> None:
        occupancy_map = self._floor.occupancy_map
        self._supervisor.move_map(occupancy_map)
        if occupancy_map is not None:
            self._placing.set_map_origin(occupancy_map.origin)

    # Plans.

    def on_plan(self, message: Any) -> None:
        """
        Take a plan; see ``PlanEntry``.

        :raises MessageRefused: where it cannot be used: the robot stands.
        """
        self._plans.on_plan(message, is_started=self.is_started)

    def renew_request(self) -> None:
        """Ask again for the plan that is awaited: the answer may have been lost."""
        self._supervisor.renew_request()

    # From a measurement to a command.

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement, and request a plan where the supervisor needs one.

        :param dt: time since the last one [s].
        """
        self._observation = observation.earlier(self._skipped_time)
        self._floor.record(observation)
        try:
            self._plans.check(observation, is_started=self.is_started)
            if self._floor.is_busy:
                self._take_map()
        except MessageRefused as error:
            self._reporter.warn(str(error), observation)
        command = self._supervisor.step(self._observation, dt)
        self._clear_footprints()
        self._plans.update(observation.time)
        knowledge = self._supervisor.perception.knowledge
        if knowledge is not None and self._memory.is_due(self._supervisor.state):
            self._reporter.warn(self._memory.keep(knowledge), observation)
        self._reporter.warn(self._covariance_check.update(observation.odometry), observation)
        self._reporter.warn(self._placing.fit_warning(), observation)
        return command

    def _clear_footprints(self) -> None:
        """Clear those that were made since the last plan; the next one starts from here."""
        request = self._supervisor.plan_request
        if request is not self._cleared_for and self._floor.clears_footprints:
            self._supervisor.move_map(self._floor.occupancy_map)
        self._cleared_for = request

    def report(self, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param time: of the newest measurement [s].
        """
        self._reporter.report(self._supervisor, time)
        if self._observation is not None:
            self._reporter.draw(self._supervisor, time)

    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
        self._reporter.report_again()
