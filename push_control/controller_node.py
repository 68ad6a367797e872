"""ROS node of the controller."""

import sys

from push_control.controller import make_controller
from push_control.observation import Observation
from push_control.settings import ControlSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.elements import MessageRefused, nanoseconds
from push_ros.interfaces import CONTROLLER
from push_ros.markers import GREY, plan_markers, scene_markers
from push_ros.messages import from_object_pose_message, from_odometry_message, to_command_message
from push_ros.node import PushNode, Rate
from push_ros.options import ControllerOptions, Frames
from push_ros.plan_messages import from_plan_message
from push_ros.run import run
from rclpy.duration import Duration

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('', Frames), ('', ControllerOptions))
LEVELS = {'waiting': WARN, 'failed': ERROR}
WATCHDOG_PERIOD = 0.05
FLUSH_TIMEOUT = 0.2
BACKWARDS = 1.0


class ControllerNode(PushNode):
    """
    Answers every measurement with one command.

    Subscribes ``odom``, ``object_pose`` (best effort), ``push_plan`` (latched); publishes
    ``cmd_vel`` (in ``base_frame``, stamped with the measurement that it answers), ``diagnostics``,
    ``markers``; serves ``controller/start``, ``controller/stop``. The command is zero before the
    start, without a plan, for a measurement that is refused (not finite, not in ``world_frame``)
    or stale, when the push has ended, when odometry stops for ``watchdog_timeout`` on the node's
    clock, and at the end of the node. A new plan that starts at the push under way is taken up
    without a stop, any other starts anew, and only where the robot stands at its start; one that
    is refused stops the push. Parameters: ``object.*`` and ``robot.*`` as believed, ``control.*``,
    frames, ``autostart``, ``stamped_cmd_vel``.
    """

    def __init__(self):
        super().__init__(CONTROLLER, SECTIONS)
        self._obj, self._robot, settings, self._frames, self._options = self.settings
        self._controller = make_controller(self._obj, self._robot, settings)
        self._running, self._target = self._options.autostart, None
        self._forget()
        self._command = self.publisher('cmd_vel', self._options.stamped_cmd_vel)
        self._markers, self._marker_rate = self.publisher('markers'), Rate(2.0)
        self.subscribe('odom', self._on_odometry, urgent=True)
        self.subscribe('object_pose', self._on_object_pose, urgent=True)
        self.subscribe('push_plan', self._on_plan)
        self.serve('controller/start', self._start)
        self.serve('controller/stop', self._stop)
        self._watchdog = self.create_timer(WATCHDOG_PERIOD, self._watch)
        self.reporter.report(OK, 'waits for a plan', self._now())

    def close(self):
        """Stop the robot, and see the command out."""
        self._send(STOP, self._now())
        self._command.wait_for_all_acked(Duration(seconds=FLUSH_TIMEOUT))

    def _forget(self):
        self._odometry = self._object_pose = self._phase = self._heard = None
        self._time, self._report_rate = 0.0, Rate(1.0)
        self._silent = False

    def _on_odometry(self, message):
        self._heard = self.get_clock().now().nanoseconds, nanoseconds(message.header.stamp)
        self._answer(message, '_odometry', from_odometry_message)

    def _on_object_pose(self, message):
        self._answer(message, '_object_pose', from_object_pose_message)

    def _answer(self, message, name, convert):
        stamp = message.header.stamp
        try:
            measured = convert(message, self._frames.world_frame)
        except MessageRefused as error:
            self._send(STOP, stamp)
            self._phase = None
            self.reporter.report(ERROR, f'{error}; stopped', stamp)
            return
        if measured.time < self._time - BACKWARDS:
            self._begin_anew()
        known = getattr(self, name)
        if known is None or measured.time >= known.time:
            setattr(self, name, measured)
        self._send(self._step(), stamp)
        self._tell(stamp)

    def _step(self):
        times = [m.time for m in (self._odometry, self._object_pose) if m is not None]
        newest = max(self._time, *times)
        dt, self._time = newest - self._time, newest
        if not self._running or self._target is None or self._odometry is None:
            return STOP
        return self._controller.step(
            self._target, Observation(self._time, self._odometry, self._object_pose), dt)

    def _tell(self, stamp):
        status = self._controller.status
        changed = (status.phase, status.reason) != self._phase
        due = self._report_rate.due(self._time)
        if changed or due:
            self._phase = status.phase, status.reason
            text = status.reason or f'is {status.phase}'
            self.reporter.report(LEVELS.get(status.phase, OK), text, stamp,
                                 {'time': self._time, **vars(status)})
        if self._marker_rate.due(self._time) and self._markers.get_subscription_count():
            self._draw(status, stamp)

    def _draw(self, status, stamp):
        if self._odometry is not None and status.phase in ('pushing', 'waiting'):
            self._markers.publish(scene_markers(
                stamp, self._frames.world_frame, 'controller', self._obj, self._robot,
                status.object_pose, self._odometry.pose, GREY))

    def _on_plan(self, message):
        self._phase = None
        try:
            self._target = from_plan_message(message, self._frames.world_frame)
        except MessageRefused as error:
            self._target = None
            self._controller.reset()
            self._send(STOP, self._now())
            self.reporter.report(ERROR, f'{error}; stopped', message.header.stamp)
            return
        self._markers.publish(plan_markers(message.header.stamp, self._frames.world_frame,
                                           self._target))
        self.reporter.report(OK, 'has a plan' + ('' if self._running else
                                                 ' and waits for controller/start'),
                             message.header.stamp)

    def _start(self):
        missing = [name for name, value in (('odom', self._odometry),
                                            ('object_pose', self._object_pose),
                                            ('push_plan', self._target)) if value is None]
        if missing:
            return False, f'has not got {" and ".join(missing)} yet'
        self._controller.reset()
        self._running, self._phase = True, None
        return True, 'started'

    def _stop(self):
        self._running, self._phase = False, None
        self._controller.reset()
        self._send(STOP, self._now())
        return True, 'stopped'

    def _begin_anew(self):
        self._controller.reset()
        self._target = None
        self._forget()
        self.reporter.report(WARN, 'waits for a plan: time went back', self._now())

    def _watch(self):
        if self._heard is None or not self._running or self._target is None:
            return
        now = self.get_clock().now()
        # Stamps may be of another clock, and messages may be ahead of simulated time.
        age = (now.nanoseconds - max(self._heard)) * 1e-9
        if age > self._options.watchdog_timeout:
            self._send(STOP, now.to_msg())
            if not self._silent:
                self.reporter.report(ERROR, f'no odometry for {age:.2f} s; stopped', now.to_msg())
            self._phase = None
        self._silent = age > self._options.watchdog_timeout

    def _send(self, twist, stamp):
        self._command.publish(to_command_message(twist, stamp, self._frames.base_frame,
                                                 self._options.stamped_cmd_vel))

    def _now(self):
        return self.get_clock().now().to_msg()


def main(arguments=None):
    """
    Run the controller.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(ControllerNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
