"""Single push: the controller's node follows the newest plan."""

import dataclasses
import math
from typing import Any, NamedTuple

from push_control.estimation.monitors import is_finite_odometry
from push_control.goal import GoalOutcome, GoalProgress, PushGoal, PushState
from push_control.observation import Observation
from push_control.push.controller import Controller
from push_control.push.status import ControllerStatus, Phase
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.plan_requests import PlanRequester
from push_control.ros.scene import Scene, ScenePublisher
from push_control.safety.status import SafetyReport
from push_control.task.behavior import BehaviorContext
from push_control.task.path_execution import PathExecution
from push_control.task.retreat import retreat_path
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectEstimate, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import MessageRefused, seconds
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.node import PushNode, RateLimiter, ServiceAnswer
from push_ros.node_settings import ControllerOptions

LEVELS = {Phase.WAITING: WARN, Phase.FAILED: ERROR}
# A robot that waits for measurements is at its push all the same.
STATES = {Phase.IDLE: PushState.IDLE, Phase.PUSHING: PushState.PUSHING,
          Phase.WAITING: PushState.PUSHING, Phase.DONE: PushState.REACHED,
          Phase.FAILED: PushState.FAILED}
OUTCOMES = {Phase.DONE: GoalOutcome.REACHED, Phase.FAILED: GoalOutcome.FAILED}
# Most diagnostics per second of measured time without a change [Hz]; chosen: enough to follow a
# push by eye.
REPORT_RATE = 1.0


class _Retreat(NamedTuple):
    """The path off the object after a push that was cancelled, and why it was."""

    execution: PathExecution
    reason: str


class SinglePushMode(Mode):
    """
    Requests a plan for each goal, and follows one plan at a time.

    A plan that starts at the push under way replaces it without a stop; any other starts from
    rest. Where there is no plan for a goal the former one stays. From a push that is cancelled the
    robot backs off.
    """

    required_topic = 'push_plan'
    stops_on_refused_plan = True
    reports_events = False

    def __init__(self, node: PushNode, parameters: ControllerParameters, frame: str,
                 options: ControllerOptions, scene: ScenePublisher) -> None:
        """
        Wait for a plan.

        :param node: the ``PushNode``.
        :param parameters: ``ControllerParameters``.
        :param frame: id of the world frame.
        :param options: ``ControllerOptions``.
        :param scene: the ``ScenePublisher``.
        """
        self._parameters = parameters
        self._frame = frame
        self._reporter = node.reporter
        self._requester = PlanRequester(node, frame, is_lockstep=options.lockstep)
        self._scene = scene
        self._is_started = not options.wait_for_start
        self._settings = parameters.control
        self._controller = Controller(parameters.object, parameters.robot, self._settings)
        self.reset()

    @property
    def is_set(self) -> bool:
        """Whether there is a plan."""
        return self._target is not None

    @property
    def is_commanding(self) -> bool:
        """Whether it follows a plan that has not ended, or backs off from a cancelled push."""
        return self._retreat is not None or self._is_pushing

    @property
    def awaits_plan(self) -> bool:
        """False: a plan is set when it comes."""
        return False

    @property
    def progress(self) -> GoalProgress:
        """How far the push has come; errors are those of the estimate."""
        status = self._controller.status
        if self._goal is not None:
            return GoalProgress(PushState.PLANNING)
        if self._retreat is not None:
            return GoalProgress(PushState.RETREATING, self._retreat.reason)
        if self._failure is not None:
            return GoalProgress(PushState.FAILED, f'no plan: {self._failure.value}',
                                GoalOutcome.NO_PLAN)
        outcome = None if status.replan_requested else OUTCOMES.get(status.phase)
        has_begun = status.phase is not Phase.IDLE
        return GoalProgress(STATES[status.phase], status.reason, outcome, int(has_begun),
                            status.position_error, status.heading_error)

    def reset(self) -> None:
        """Forget goal, plan and everything measured."""
        # A goal that waits for its plan, and the tolerances of the last one.
        self._goal: PushGoal | None = None
        self._tolerances: dict[str, float] = {}
        self._failure: PlanFailure | None = None
        self._request: PlanRequest | None = None
        self._has_requested_replan = False
        self._requester.reset()
        self._target: PushTrajectory | None = None
        # Stamp of a plan that may be older than this node, and time of the first measurement [s].
        self._plan_time = math.inf
        self._first_time: float | None = None
        self._retreat: _Retreat | None = None
        self._observation: Observation | None = None
        # Why the robot stands although nobody has stopped it.
        self._interruption = ''
        self._restart_controller()
        self._reported: tuple[Phase, str] | None = None
        self._report_rate = RateLimiter(REPORT_RATE)

    def interrupt(self, reason: str) -> None:
        """
        Say, after ``reset``, why the robot stands.

        :param reason: one sentence, which stays until there is a goal or a plan.
        """
        self._interruption = reason

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        self._controller.on_safety_report(fault, stop)

    def set_parameters(self, parameters: ControllerParameters) -> None:
        """
        Set parameters; the next push from rest uses them.

        :param parameters: ``ControllerParameters``, with the object and robot of before.
        """
        self._parameters = parameters

    def set_object(self, parameters: ControllerParameters) -> None:
        """
        Push another object from now on.

        :param parameters: ``ControllerParameters``, as of ``Mode``.
        """
        self._parameters = parameters
        self._controller = Controller(parameters.object, parameters.robot, self._settings)
        self.reset()

    def set_goal(self, goal: PushGoal) -> None:
        """
        Request a plan, as soon as there are measurements; until it comes the former one stays.

        :param goal: the ``PushGoal``.
        """
        self._goal = goal
        self._failure = None
        self._request = None
        self._retreat = None
        self._request_plan()

    def cancel(self, reason: str) -> None:
        """
        Forget goal and plan; a robot that pushes backs off before it stands.

        :param reason: one sentence.
        """
        observation, retreat = self._observation, self._plan_retreat(reason)
        self.reset()
        self._observation, self._retreat = observation, retreat

    def halt(self, reason: str) -> None:
        """
        Forget goal and plan, and stand at once.

        :param reason: not reported: a single push has no state for it.
        """
        self.reset()

    def on_plan(self, message: Any) -> None:
        """
        Set the plan, whoever asked for it; under way not one that another planner has, too.

        A planner that is started answers the last request, as that is latched.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; there is none then.
        """
        has_begun = self._is_pushing and self._controller.phase is not Phase.IDLE
        if has_begun and self._requester.is_answered_again_by(message):
            return
        self.report_again()
        answered = self._requester.request_answered_by(message)
        is_answer = answered is not None and answered is self._request
        failure = plan_failure(message)
        if failure is not None:
            if is_answer:
                self._goal, self._failure = None, failure
                self._reporter.report(ERROR, f'no plan: {failure.value} (details in the '
                                             'diagnostics of the planner)')
            return
        self._interruption = ''
        try:
            self._target = from_plan_message(message, self._frame)
        except MessageRefused:
            self._target = None
            self._controller.reset()
            raise
        if is_answer:
            self._requester.forget_unanswered()
        if is_answer and self._goal is not None:
            self._tolerances = self._goal_tolerances(self._goal)
            self._goal = None
        controller = self._controller
        if (controller.phase is Phase.IDLE
                or controller.phase.has_ended and not controller.replan_requested):
            self._restart_controller()
        self._plan_time = seconds(message.header.stamp)
        goal = Pose(*self._target.object_poses[-1].tolist())
        self._scene.show_goal(goal, message.header.stamp)
        self._scene.show_plan(self._target, message.header.stamp)
        waits = '' if self._is_started else ' and waits for controller/start'
        self._reporter.report(OK, f'has a plan{waits}')
        self._check_plan_age()

    def on_map(self, message: Any) -> None:
        """
        Leave a map to the planner.

        :param message: not read.
        """

    def refuse_map(self, reason: str) -> None:
        """
        Leave a map to the planner.

        :param reason: not read.
        """

    def move_goal(self, correction: Pose) -> None:
        """
        Move a goal that waits for its plan; a plan is followed where it was planned.

        :param correction: ``Pose``, as of ``Mode``.
        """
        if self._goal is not None:
            self._goal = dataclasses.replace(self._goal, pose=correction @ self._goal.pose)

    def move_map(self, correction: Pose) -> None:
        """
        Leave the map to the planner.

        :param correction: not read.
        """

    def start(self) -> None:
        """Start to push."""
        self._restart_controller()
        self._is_started = True
        self._plan_time = math.inf
        self._interruption = ''
        self.report_again()

    def stop(self) -> None:
        """Stop, until ``start``."""
        self._is_started = False
        self.report_again()
        self._controller.reset()

    def pause(self) -> ServiceAnswer:
        """Refuse: only a task can be paused."""
        return ServiceAnswer(False, 'no task to pause: the parameter task is false')

    def resume(self) -> ServiceAnswer:
        """Refuse: only a task can be resumed."""
        return ServiceAnswer(False, 'no task to resume: the parameter task is false')

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """
        self._observation = observation
        if self._first_time is None:
            self._first_time = observation.time
            self._check_plan_age()
        self._request_plan()
        if self._retreat is not None:
            return self._step_retreat(self._retreat, observation, dt)
        if not self._is_active:
            return STOP
        command = self._controller.step(self._target, observation, dt)
        self._request_replan()
        return command

    def report(self, stamp: Any, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param stamp: ``builtin_interfaces/Time`` of the measurement.
        :param time: of the newest measurement [s].
        """
        state = self._controller.phase, self._controller.reason
        has_changed = state != self._reported
        if self._report_rate.due(time) or has_changed:
            self._reported, status = state, self._controller.status
            text, is_fault = self._report_text(status)
            level = LEVELS.get(status.phase, WARN if is_fault else OK)
            self._reporter.report(level, text, {'time': time, **status.values()})
        self._scene.publish(time, self._make_scene)

    def _report_text(self, status: ControllerStatus) -> tuple[str, bool]:
        """Make the sentence to report, and tell whether it is about a fault."""
        if self._retreat is not None:
            return f'backs off from the object: {self._retreat.reason}', False
        interruption = self._interruption if status.phase is Phase.IDLE else ''
        text = status.reason or f'is {status.phase.value}' + (
            f', {interruption}' if interruption else '')
        return text, status.event is not None or bool(interruption)

    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
        self._reported = None

    @property
    def _is_pushing(self) -> bool:
        return self._is_active and not self._controller.phase.has_ended

    def _plan_retreat(self, reason: str) -> '_Retreat | None':
        """Plan the path off the object; None where the robot does not push, or there is none."""
        observation, status = self._observation, self._controller.status
        if observation is None or not self._is_pushing or status.phase is Phase.IDLE:
            return None
        obj, robot, control, drive, supervision = self._parameters
        path = retreat_path(BehaviorContext(obj, robot, control, drive, supervision),
                            observation.odometry.pose, status.object_pose,
                            drive.retreat_distance)
        if path is None:
            return None
        return _Retreat(PathExecution(robot, drive, path, supervision.stall_timeout), reason)

    def _step_retreat(self, retreat: '_Retreat', observation: Observation, dt: float) -> Twist:
        odometry = observation.odometry
        age = observation.time - odometry.time
        if not is_finite_odometry(odometry) or age > self._settings.odometry_timeout:
            return STOP
        command = retreat.execution.step(odometry.pose, dt)
        if retreat.execution.finished or retreat.execution.failure_reason:
            self._retreat = None
            self.report_again()
        return command

    @property
    def _is_active(self) -> bool:
        return self._is_started and self.is_set and not self._is_plan_old

    @property
    def _is_plan_old(self) -> bool:
        """Whether the plan was latched before this node had measured anything."""
        return self._first_time is not None and self._plan_time < self._first_time

    def _check_plan_age(self) -> None:
        """Say why a plan is not followed that is older than this node."""
        if self.is_set and self._is_plan_old:
            self._controller.reset()
            self._interruption = ('the plan is older than this node: request another, or call '
                                  'controller/start')
            self.report_again()

    def _restart_controller(self) -> None:
        """Let the controller stand idle, with the present settings."""
        parameters = self._parameters
        settings = dataclasses.replace(parameters.control, **self._tolerances)
        if settings == self._settings:
            self._controller.reset()
        else:
            self._settings = settings
            self._controller = Controller(parameters.object, parameters.robot, settings)

    def _goal_tolerances(self, goal: PushGoal) -> dict[str, float]:
        given = {'position_tolerance': goal.position_tolerance,
                 'heading_tolerance': goal.heading_tolerance}
        return {name: value for name, value in given.items() if value is not None}

    def _request_plan(self) -> None:
        """Request a plan for a goal that has none, from what is measured."""
        if self._goal is not None and self._request is None:
            self._publish_request(self._goal.pose)

    def _request_replan(self) -> None:
        """Request another plan to the goal of the present one, once, where the push needs it."""
        is_requested = self._controller.replan_requested
        if is_requested and not self._has_requested_replan and self._target is not None:
            self._publish_request(Pose(*self._target.object_poses[-1].tolist()))
        self._has_requested_replan = is_requested

    def _publish_request(self, goal: Pose) -> None:
        observation = self._observation
        if observation is None or observation.object_pose is None:
            return
        self._request = PlanRequest(observation.object_pose.pose, observation.odometry.pose, goal,
                                    self._parameters.object)
        self._requester.update(self._request, observation.time)

    def _make_scene(self) -> Scene | None:
        status = self._controller.status
        if self._observation is None or status.phase not in (Phase.PUSHING, Phase.WAITING):
            return None
        estimate = ObjectEstimate(self._observation.time, status.object_pose, None,
                                  status.friction_center)
        return Scene(self._observation.odometry.pose, estimate, status.phase is Phase.PUSHING)
