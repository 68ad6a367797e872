"""Single push: the controller's node follows the newest plan."""

from typing import Any

from push_control.observation import Observation
from push_control.push.controller import Controller
from push_control.push.status import ControllerStatus, Phase
from push_control.ros.mode import ControllerParameters, Mode
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory
from push_ros.conversions.markers import GREY, MarkerHeader, plan_markers, scene_markers
from push_ros.conversions.plan import from_plan_message
from push_ros.conversions.primitives import MessageRefused
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.node import PushNode, RateLimiter, ServiceAnswer
from push_ros.node_settings import ControllerOptions

LEVELS = {Phase.WAITING: WARN, Phase.FAILED: ERROR}
# Most diagnostics and markers per second of measured time without a change [Hz]; chosen: enough to
# follow a push by eye.
REPORT_RATE = 1.0
MARKER_RATE = 2.0


class SinglePushMode(Mode):
    """Follows one plan at a time; goals and maps are those of the planner."""

    required_topic = 'push_plan'
    awaited = 'a plan'
    stops_on_refused_plan = True
    reports_events = False

    def __init__(self, node: PushNode, parameters: ControllerParameters, frame: str,
                 options: ControllerOptions) -> None:
        """
        Wait for a plan.

        :param node: the ``PushNode``.
        :param parameters: ``ControllerParameters``.
        :param frame: id of the world frame.
        :param options: ``ControllerOptions``.
        """
        self._object = parameters.object
        self._robot = parameters.robot
        self._frame = frame
        self._reporter = node.reporter
        # Unused here: a node has the topics of the list in every mode.
        node.publisher('push_request')
        self._markers = node.publisher('markers')
        self._marker_rate = RateLimiter(MARKER_RATE)
        self._request_replan = node.trigger_client('planner/replan')
        self._controller = Controller(parameters.object, parameters.robot, parameters.control)
        self._is_started = not options.wait_for_start
        self._forget_plan()

    @property
    def is_set(self) -> bool:
        """Whether there is a plan."""
        return self._target is not None

    @property
    def is_active(self) -> bool:
        """Whether it follows a plan."""
        return self._is_started and self.is_set

    @property
    def awaits_plan(self) -> bool:
        """False: a plan is set when it comes."""
        return False

    def reset(self) -> None:
        """Forget the plan and everything measured."""
        self._controller.reset()
        self._forget_plan()

    def _forget_plan(self) -> None:
        self._target: PushTrajectory | None = None
        self._robot_pose: Pose | None = None
        self._reported: tuple[Phase, str] | None = None
        self._report_rate = RateLimiter(REPORT_RATE)

    def on_plan(self, message: Any) -> None:
        """
        Set the plan.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; there is none then.
        """
        self.report_again()
        try:
            self._target = from_plan_message(message, self._frame)
        except MessageRefused:
            self._target = None
            self._controller.reset()
            raise
        stamp = message.header.stamp
        self._markers.publish(plan_markers(
            MarkerHeader(stamp, self._frame, 'plan'), self._target))
        waits = '' if self._is_started else ' and waits for controller/start'
        self._reporter.report(OK, f'has a plan{waits}', stamp)

    def on_goal(self, message: Any) -> None:
        """
        Leave a goal to the planner.

        :param message: not read.
        """

    def on_map(self, message: Any) -> None:
        """
        Leave a map to the planner.

        :param message: not read.
        """

    def start(self) -> None:
        """Start to push."""
        self._controller.reset()
        self._is_started = True
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
        self._robot_pose = observation.odometry.pose
        if not self.is_active:
            return STOP
        return self._controller.step(self._target, observation, dt)

    def report(self, stamp: Any, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param stamp: ``builtin_interfaces/Time`` of the measurement.
        :param time: of the newest measurement [s].
        """
        status = self._controller.status
        has_changed = (status.phase, status.reason) != self._reported
        if self._report_rate.due(time) or has_changed:
            self._reported = status.phase, status.reason
            if has_changed and status.replan_requested:
                self._request_replan()
            text = status.reason or f'is {status.phase.value}'
            level = LEVELS.get(status.phase, OK if status.event is None else WARN)
            self._reporter.report(level, text, stamp, {'time': time, **status.values()})
        if self._marker_rate.due(time) and self._markers.get_subscription_count():
            self._draw(status, stamp)

    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
        self._reported = None

    def _draw(self, status: ControllerStatus, stamp: Any) -> None:
        if self._robot_pose is not None and status.phase in (Phase.PUSHING, Phase.WAITING):
            self._markers.publish(scene_markers(
                MarkerHeader(stamp, self._frame, 'controller'), self._object, self._robot,
                status.object_pose, self._robot_pose, color=GREY))
