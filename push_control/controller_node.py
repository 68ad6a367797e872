"""ROS node of the controller."""

import sys
from typing import Any, Callable, Sequence

from builtin_interfaces.msg import Time
from push_control.ros.measurements import LatestMeasurements, OdometryWatchdog
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.single_push import SinglePushMode
from push_control.ros.task import TaskMode
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.settings import DriveSettings
from push_ros.conversions.measurements import (
    from_object_pose_message, from_odometry_message, to_command_message,
)
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import ControllerOptions, Frames
from push_ros.topics import CONTROLLER
from rclpy.duration import Duration

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('drive.', DriveSettings), ('supervision.', SupervisionSettings), ('', Frames),
            ('', ControllerOptions))
# Period at which missing odometry is looked for [s]; chosen: a fifth of the default time-out.
WATCHDOG_PERIOD = 0.05
# Time within which the last command must be acknowledged [s]; chosen: enough for one resend.
FLUSH_TIMEOUT = 0.2
# A measurement older than the newest one by more is of a time that went back [s]; chosen: longer
# than any latency.
BACKWARDS = 1.0


class ControllerNode(PushNode):
    """
    Answers every measurement with one command.

    With ``task`` false it follows one plan. A plan that starts at the push under way replaces it
    without a stop; any other starts from rest, and only where the robot stands at its start. A
    plan that is refused stops the push. Where a push has left its path, it calls
    ``planner/replan``.

    With ``task`` true it brings the object to ``goal_pose``, at once or from the time of the
    goal's stamp on, and requests plans by itself. With ``lockstep`` measurements are not
    answered until the requested plan is there.

    The command is zero before the start, without a plan or goal, for a measurement that is refused
    (not finite, not in ``world_frame``) or stale, once all is done, when odometry stops for
    ``watchdog_timeout`` on the node's clock, and at the end of the node.

    Publishers
        ``cmd_vel`` (TwistStamped, or Twist), in ``base_frame``, stamped with the measurement that
        it answers; ``push_request`` (JointTrajectory, latched), in ``world_frame``;
        ``diagnostics`` (DiagnosticArray); ``markers`` (MarkerArray).

    Subscribers
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped), best effort; ``push_plan``
        (MultiDOFJointTrajectory, latched); ``goal_pose`` (PoseStamped); ``map`` (OccupancyGrid,
        latched).

    Services
        ``controller/start``, ``controller/stop``, ``controller/pause``, ``controller/resume``
        (Trigger).

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``control.*``; ``drive.*`` and ``supervision.*`` of
        a task; ``world_frame``, ``object_frame``, ``base_frame``; and those of
        ``ControllerOptions``.

    Frames
        Poses are in ``world_frame``, commands in ``base_frame``.
    """

    def __init__(self) -> None:
        super().__init__(CONTROLLER, SECTIONS)
        *sections, self._frames, self._options = self.settings
        self._mode = self._make_mode(ControllerParameters(*sections))
        self._latest = LatestMeasurements()
        self._watchdog = OdometryWatchdog(self._options.watchdog_timeout)
        # Stamps of measurements that wait for a plan.
        self._unanswered: list[Time] = []
        self._commands = self.publisher('cmd_vel', self._options.enable_stamped_cmd_vel)
        self._subscribe()
        self.create_timer(WATCHDOG_PERIOD, self._check_odometry)
        self.reporter.report(OK, f'waits for {self._mode.awaited}', self._now())

    def close(self) -> None:
        """Publish a stop command, and wait until it is acknowledged."""
        self._send(STOP, self._now())
        self._commands.wait_for_all_acked(Duration(seconds=FLUSH_TIMEOUT))

    def _make_mode(self, parameters: ControllerParameters) -> Mode:
        kind = TaskMode if self._options.task else SinglePushMode
        return kind(self, parameters, self._frames.world_frame, self._options)

    def _subscribe(self) -> None:
        self.subscribe('odom', self._on_odometry, real_time=True)
        self.subscribe('object_pose', self._on_object_pose, real_time=True)
        self.subscribe('push_plan', self._on_plan)
        self.subscribe('goal_pose', lambda message: self._handle(self._mode.on_goal, message))
        self.subscribe('map', lambda message: self._handle(self._mode.on_map, message))
        self.serve_trigger('controller/start', self._start)
        self.serve_trigger('controller/stop', self._stop)
        self.serve_trigger('controller/pause', lambda: self._change(self._mode.pause))
        self.serve_trigger('controller/resume', lambda: self._change(self._mode.resume))

    def _on_odometry(self, message: Any) -> None:
        self._watchdog.feed(self.get_clock().now().nanoseconds, nanoseconds(message.header.stamp))
        self._on_measurement(message, from_odometry_message)

    def _on_object_pose(self, message: Any) -> None:
        self._on_measurement(message, from_object_pose_message)

    def _on_measurement(self, message: Any,
                        convert: Callable[[Any, str], Odometry | ObjectPose]) -> None:
        """Answer a measurement with a command."""
        stamp = message.header.stamp
        try:
            measured = convert(message, self._frames.world_frame)
        except MessageRefused as error:
            self._send(STOP, stamp)
            self._mode.report_again()
            self.reporter.report(ERROR, f'{error}; stopped', stamp)
            return
        if measured.time < self._latest.time - BACKWARDS:
            self._reset()
        dt = self._latest.add(measured)
        observation = self._latest.observation
        command = STOP if observation is None else self._mode.step(observation, dt)
        if self._options.lockstep and self._mode.awaits_plan:
            self._unanswered.append(stamp)
        else:
            self._answer_waiting()
            self._send(command, stamp)
        self._mode.report(stamp, self._latest.time)

    def _answer_waiting(self) -> None:
        """Answer the measurements that waited for a plan, once it is there: the robot stood."""
        if not self._mode.awaits_plan:
            for stamp in self._unanswered:
                self._send(STOP, stamp)
            self._unanswered = []

    def _on_plan(self, message: Any) -> None:
        self._handle(self._mode.on_plan, message, self._mode.stops_on_refused_plan)

    def _handle(self, handler: Callable[[Any], None], message: Any,
                stops_on_refusal: bool = False) -> None:
        """Hand a message to the mode, and report where it is refused."""
        try:
            handler(message)
        except MessageRefused as error:
            text = str(error)
            if stops_on_refusal:
                self._send(STOP, self._now())
                text = f'{error}; stopped'
            self.reporter.report(ERROR, text, message.header.stamp)
        self._follow_up()

    def _follow_up(self) -> None:
        """Answer and report what a message or a service has changed."""
        self._answer_waiting()
        if self._mode.reports_events:
            self._mode.report(self._now(), self._latest.time)

    def _start(self) -> ServiceAnswer:
        received = {'odom': self._latest.odometry is not None,
                    'object_pose': self._latest.object_pose is not None,
                    self._mode.required_topic: self._mode.is_set}
        missing = [name for name, is_there in received.items() if not is_there]
        if missing:
            return ServiceAnswer(False, f'has received no {" and no ".join(missing)} yet')
        self._mode.start()
        self._follow_up()
        return ServiceAnswer(True, 'started')

    def _stop(self) -> ServiceAnswer:
        self._mode.stop()
        self._send(STOP, self._now())
        self._follow_up()
        return ServiceAnswer(True, 'stopped')

    def _change(self, action: Callable[[], ServiceAnswer]) -> ServiceAnswer:
        answer = action()
        self._follow_up()
        return answer

    def _reset(self) -> None:
        """Start over where time went back, as for a simulator that was reset."""
        self._mode.reset()
        self._latest = LatestMeasurements()
        self._watchdog.reset()
        self._unanswered = []
        self.reporter.report(WARN, f'waits for {self._mode.awaited}: time went back', self._now())

    def _check_odometry(self) -> None:
        """Stop the robot where odometry has stopped."""
        if not self._mode.is_active:
            return
        now = self.get_clock().now()
        had_expired = self._watchdog.has_expired
        age = self._watchdog.check(now.nanoseconds)
        if age is not None:
            self._send(STOP, now.to_msg())
            if not had_expired:
                self.reporter.report(ERROR, f'no odometry for {age:.2f} s; stopped', now.to_msg())
            self._mode.report_again()

    def _send(self, twist: Twist, stamp: Time) -> None:
        self._commands.publish(to_command_message(twist, stamp, self._frames.base_frame,
                                                  self._options.enable_stamped_cmd_vel))

    def _now(self) -> Time:
        return self.get_clock().now().to_msg()


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the controller.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(ControllerNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
