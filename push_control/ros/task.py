"""Task: the controller's node pushes repeatedly until the object is at its goal."""

import dataclasses
from pathlib import Path
import time
from typing import Any

from push_control.goal import GoalOutcome, GoalProgress, PushGoal, PushState
from push_control.observation import Observation
from push_control.ros.measurements import CovarianceCheck
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.objects.knowledge import KnowledgeFile, KnowledgeMemory
from push_control.ros.plan_requests import PlanRequester
from push_control.ros.scene import ScenePublisher
from push_control.ros.task_report import TaskReporter
from push_control.safety.status import SafetyReport
from push_control.task.perception import has_moved
from push_control.task.settings import SupervisionSettings
from push_control.task.status import TaskFailure, TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import Twist
from push_navigation.footprint_clearing import FootprintClearing
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import MessageRefused
from push_ros.map_reader import MapChange, MapReader, ReadMap
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import ControllerOptions

OUTCOMES = {TaskState.DONE: GoalOutcome.REACHED, TaskState.FAILED: GoalOutcome.FAILED,
            TaskState.IDLE: GoalOutcome.CANCELLED}
STATES = {TaskState.IDLE: PushState.IDLE, TaskState.PLAN: PushState.PLANNING,
          TaskState.APPROACH: PushState.APPROACHING, TaskState.ALIGN: PushState.ALIGNING,
          TaskState.PUSH: PushState.PUSHING, TaskState.RETREAT: PushState.RETREATING,
          TaskState.DONE: PushState.REACHED, TaskState.FAILED: PushState.FAILED,
          TaskState.PAUSED: PushState.PAUSED}


class TaskMode(Mode):
    """Lets a ``Supervisor`` bring the object to its goal, with as many pushes as it takes."""

    required_topic = 'goal_pose'
    stops_on_refused_plan = False
    reports_events = True

    def __init__(self, node: PushNode, parameters: ControllerParameters, frame: str,
                 options: ControllerOptions, scene: ScenePublisher,
                 *, map_settings: MapSettings) -> None:
        """
        Wait for a goal.

        :param node: the ``PushNode``.
        :param parameters: ``ControllerParameters``.
        :param frame: id of the world frame.
        :param options: ``ControllerOptions``.
        :param scene: the ``ScenePublisher``.
        :param map_settings: ``MapSettings``.
        :raises ValueError: where ``knowledge_file`` cannot be read.
        """
        self._parameters = parameters
        self._frame = frame
        self._logger = node.get_logger()
        self._is_started = not options.wait_for_start
        file = KnowledgeFile(Path(options.knowledge_file)) if options.knowledge_file else None
        self._memory = KnowledgeMemory(parameters.object, parameters.supervision, file, time.time)
        self._covariance_check = CovarianceCheck(parameters.supervision)
        self._map: ReadMap | None = None
        self._map_reader = MapReader(frame, map_settings)
        self._clearing = FootprintClearing(map_settings, parameters.object, parameters.robot)
        # The request for which footprints were last cleared.
        self._cleared_for: PlanRequest | None = None
        self._goal: PushGoal | None = None
        self._requester = PlanRequester(node, frame, is_lockstep=options.lockstep)
        self._reporter = TaskReporter(node, scene)
        self.reset()

    @property
    def is_set(self) -> bool:
        """Whether there is a goal."""
        return self._goal is not None

    @property
    def is_commanding(self) -> bool:
        """Whether a task is under way, or the retreat from one that was cancelled."""
        return not self._supervisor.state.is_standing

    @property
    def awaits_plan(self) -> bool:
        """Whether a plan was requested and has not come yet."""
        return self._supervisor.plan_request is not None

    @property
    def progress(self) -> GoalProgress:
        """How far the task has come; errors are those of the last measured pose."""
        supervisor = self._supervisor
        outcome = OUTCOMES.get(supervisor.state) if self._is_started else None
        if self._is_started and supervisor.failure is TaskFailure.NO_PLAN:
            outcome = GoalOutcome.NO_PLAN
        progress = GoalProgress(STATES[supervisor.state], supervisor.reason, outcome,
                                supervisor.pushes)
        measured = None if self._observation is None else self._observation.object_pose
        if measured is None or self._goal is None:
            return progress
        goal = self._goal.pose
        return progress._replace(
            position_error=distance(measured.pose, goal),
            heading_error=wrap_angle(measured.pose.theta - goal.theta))

    def reset(self) -> None:
        """Forget all but goal and map, which are kept for ``start``, and what was learned."""
        self._supervisor = Supervisor(*self._parameters, knowledge=self._memory.recall())
        self._supervisor.set_map(self._cleared_map)
        self._supervisor.hold(self._map_reader.fault)
        self._observation: Observation | None = None
        self._requester.reset()
        self.report_again()

    def interrupt(self, reason: str) -> None:
        """
        Say, after ``reset``, why the robot stands.

        :param reason: one sentence.
        """
        self._supervisor.interrupt(reason)

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        self._supervisor.on_safety_report(fault, stop)

    def set_parameters(self, parameters: ControllerParameters) -> None:
        """
        Set parameters; movements use them from the next one on.

        :param parameters: ``ControllerParameters``, with the object and robot of before.
        """
        self._parameters = parameters
        self._apply_settings()

    def set_object(self, parameters: ControllerParameters) -> None:
        """
        Push another object from now on, with what was learned of it; the robot is where it was.

        :param parameters: ``ControllerParameters``, as of ``Mode``.
        """
        self._parameters = parameters
        try:
            self._memory.select(parameters.object)
        except ValueError as error:
            self._logger.warning(f'knowledge_file: {error}; nothing is known of this object')
        former = self._supervisor
        self._clearing.set_object(parameters.object)
        self._goal = None
        self.reset()
        self._supervisor.take_over_robot(former)

    def set_goal(self, goal: PushGoal) -> None:
        """
        Pursue a goal, in place of the present one; before the start, keep it until then.

        :param goal: the ``PushGoal``.
        """
        self._goal = goal
        self._apply_settings()
        self._reporter.show_goal(goal.pose)
        if self._is_started:
            self._supervisor.set_goal(goal.pose)

    def cancel(self, reason: str) -> None:
        """
        Abandon the task; a robot that may touch the object backs off first.

        :param reason: one sentence.
        """
        self._goal = None
        self._reporter.show_goal(None)
        self._supervisor.cancel(reason)

    def halt(self, reason: str) -> None:
        """
        Abandon the task, and stand at once.

        :param reason: one sentence.
        """
        self._goal = None
        self._reporter.show_goal(None)
        self._supervisor.stop(reason)

    def on_map(self, message: Any) -> None:
        """
        Read the map for the next path; the robot stands until it is there.

        :param message: ``nav_msgs/OccupancyGrid``.
        :raises MessageRefused: where it cannot be used; the robot stands until one can.
        """
        self._map_reader.start(message)
        self._take_map()

    def refuse_map(self, reason: str) -> None:
        """
        Stand until a map can be used.

        :param reason: why this one cannot, one sentence.
        """
        self._map_reader.refuse(reason)
        self._supervisor.hold(reason)

    def _take_map(self) -> None:
        """Use a map that was read."""
        try:
            found = self._map_reader.take()
        finally:
            self._supervisor.hold(self._map_reader.fault)
        if found is None:
            return
        self._map = found
        if found.change is MapChange.NEW:
            self._supervisor.set_map(self._cleared_map)
            self._reporter.report_map(found.message)
        elif found.change is MapChange.MOVED:
            self._supervisor.move_map(self._cleared_map)

    @property
    def _cleared_map(self) -> OccupancyMap | None:
        """The map without the footprints of object and robot."""
        return None if self._map is None else self._clearing.clear(self._map.occupancy_map,
                                                                   self._map.stamp)

    def move_goal(self, correction: Pose) -> None:
        """
        Move the goal; the task goes on.

        :param correction: ``Pose``, as of ``Mode``.
        """
        if self._goal is not None:
            self._goal = dataclasses.replace(self._goal, pose=correction @ self._goal.pose)
            self._supervisor.move_goal(self._goal.pose)
            self._reporter.move_goal(self._goal.pose)

    def move_map(self, correction: Pose) -> None:
        """
        Move the map for the next path.

        :param correction: ``Pose``, as of ``Mode``.
        """
        moved = self._map_reader.move(correction)
        if moved is not None:
            self._map = moved
            self._supervisor.move_map(self._cleared_map)

    def on_plan(self, message: Any) -> None:
        """
        Set the plan that was requested; one that was not is ignored.

        A plan that comes after its request has timed out is set where the object has not moved.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; another one is requested.
        """
        awaited, answered = (self._supervisor.plan_request,
                             self._requester.request_answered_by(message))
        if awaited is None or answered is None:
            return
        failure = plan_failure(message)
        if failure is not None:
            if answered is awaited:
                self._supervisor.on_planning_failed(
                    failure, f'{failure.value} (details in the diagnostics of the planner)')
            return
        if has_moved(answered.object_pose, awaited.object_pose, self._parameters.supervision):
            return
        try:
            plan = from_plan_message(message, self._frame)
        except MessageRefused as error:
            self._supervisor.on_planning_failed(PlanFailure.INVALID_PLAN, str(error))
            raise
        self._requester.forget_unanswered()
        self._supervisor.set_plan(plan)
        self._reporter.show_plan(plan, message.header.stamp)

    def renew_request(self) -> None:
        """Ask again for the plan that is awaited: the answer may have been lost."""
        self._supervisor.renew_request()

    def start(self) -> None:
        """Start the task; over again where it was started before."""
        self._is_started = True
        self._supervisor.set_goal(None if self._goal is None else self._goal.pose)
        self._supervisor.resume()

    def stop(self) -> None:
        """Abandon the task, until ``start`` starts it over."""
        self._is_started = False
        self._supervisor.stop('stopped')

    def pause(self) -> ServiceAnswer:
        """Stand until ``resume``."""
        state = self._supervisor.state
        if state.is_standing:
            return ServiceAnswer(False, f'nothing to pause: the task is {state.value}')
        self._supervisor.pause()
        return ServiceAnswer(True, 'paused')

    def resume(self) -> ServiceAnswer:
        """Go on after a pause."""
        state = self._supervisor.state
        if state is not TaskState.PAUSED:
            return ServiceAnswer(False, f'nothing to resume: the task is {state.value}')
        self._supervisor.resume()
        return ServiceAnswer(True, 'resumed')

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement, and request a plan where the supervisor needs one.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """
        self._observation = observation
        self._record_footprints(observation)
        if self._map_reader.is_busy:
            try:
                self._take_map()
            except MessageRefused as error:
                self._reporter.warn(str(error), observation)
        if self._requester.is_overdue(observation.time, self._parameters.supervision.plan_timeout):
            self._supervisor.on_plan_overdue()
        command = self._supervisor.step(observation, dt)
        self._clear_footprints()
        self._requester.update(self._supervisor.plan_request, observation.time)
        if self._memory.is_due(self._supervisor.state):
            self._reporter.warn(self._memory.keep(self._supervisor.knowledge), observation)
        self._reporter.warn(self._covariance_check.update(observation.odometry), observation)
        return command

    def _record_footprints(self, observation: Observation) -> None:
        measured = observation.object_pose
        self._clearing.record(observation.time, None if measured is None else measured.pose,
                              observation.odometry.pose)

    def _clear_footprints(self) -> None:
        """Clear those that were made since the last plan; the next one starts from here."""
        request = self._supervisor.plan_request
        if request is not self._cleared_for and self._clearing.is_enabled:
            self._supervisor.move_map(self._cleared_map)
        self._cleared_for = request

    def report(self, stamp: Any, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param stamp: ``builtin_interfaces/Time`` of the measurement.
        :param time: of the newest measurement [s].
        """
        self._reporter.report(self._supervisor, time)
        if self._observation is not None:
            self._reporter.draw(self._supervisor, time)

    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
        self._reporter.report_again()

    def _apply_settings(self) -> None:
        parameters = self._parameters
        self._supervisor.set_settings(parameters.control, parameters.drive,
                                      self._goal_supervision(parameters.supervision))

    def _goal_supervision(self, settings: SupervisionSettings) -> SupervisionSettings:
        """Replace the tolerances by those of the goal, where it has any."""
        tolerances = {} if self._goal is None else {
            'position_tolerance': self._goal.position_tolerance,
            'heading_tolerance': self._goal.heading_tolerance}
        return dataclasses.replace(settings, **{
            name: value for name, value in tolerances.items() if value is not None})
