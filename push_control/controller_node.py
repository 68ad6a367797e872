"""ROS node of the controller."""

import sys

from push_control.observation import Observation
from push_control.ros.single_push import SinglePushMode
from push_control.ros.task import TaskMode
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP
from push_navigation.settings import DriveSettings
from push_ros.conversions.measurements import (
    from_object_pose_message, from_odometry_message, to_command_message,
)
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import ControllerOptions, Frames
from push_ros.topics import CONTROLLER
from rclpy.duration import Duration

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('drive.', DriveSettings), ('supervision.', SupervisionSettings), ('', Frames),
            ('', ControllerOptions))
WATCHDOG_PERIOD = 0.05
FLUSH_TIMEOUT = 0.2
BACKWARDS = 1.0


class ControllerNode(PushNode):
    """
    Answers every measurement with one command.

    Subscribes ``odom``, ``object_pose`` (best effort), ``push_plan``, ``map`` (latched),
    ``goal_pose``; publishes ``cmd_vel`` (in ``base_frame``, stamped with the measurement that it
    answers), ``push_request`` (latched), ``diagnostics``, ``markers``; serves
    ``controller/start``, ``controller/stop``, ``controller/pause``, ``controller/resume``. The
    command is zero before the start, without a plan or goal, for a measurement that is refused
    (not finite, not in ``world_frame``) or stale, when all is done, when odometry stops for
    ``watchdog_timeout`` on the node's clock, and at the end of the node.

    With ``task`` false it follows one plan. A new one that starts at the push under way is taken
    up without a stop, any other starts anew, and only where the robot stands at its start; one
    that is refused stops the push. It calls ``planner/replan`` where a push has gone astray.

    With ``task`` true it brings the object to ``goal_pose``, at once or when the time of the
    goal's stamp has come, and asks for plans itself. With ``wait_for_plans`` measurements are not
    answered until the plan is there.

    Parameters: ``object.*`` and ``robot.*`` as believed, and what the sections say.
    """

    def __init__(self):
        super().__init__(CONTROLLER, SECTIONS)
        *parts, self._frames, self._options = self.settings
        # Also where nothing is ever asked for: a node has the topics of the list.
        self.requests = self.publisher('push_request')
        self._work = (TaskMode if self._options.task else SinglePushMode)(
            self, parts, self._frames.world_frame, self._options.autostart)
        self._forget()
        self._command = self.publisher('cmd_vel', self._options.stamped_cmd_vel)
        self.subscribe('odom', self._on_odometry, real_time=True)
        self.subscribe('object_pose', self._on_object_pose, real_time=True)
        work, stops = self._work, not self._options.task
        self.subscribe('push_plan', lambda message: self._hear(work.on_plan, message, stops))
        self.subscribe('goal_pose', lambda message: self._hear(work.on_goal, message))
        self.subscribe('map', lambda message: self._hear(work.on_map, message))
        self.serve_trigger('controller/start', self._start)
        self.serve_trigger('controller/stop', self._stop)
        self.serve_trigger('controller/pause', lambda: self._obey(work.pause))
        self.serve_trigger('controller/resume', lambda: self._obey(work.resume))
        self._watchdog = self.create_timer(WATCHDOG_PERIOD, self._watch)
        self.reporter.report(OK, f'waits for {self._work.awaited}', self._now())

    def close(self):
        """Stop the robot, and see the command out."""
        self._send(STOP, self._now())
        self._command.wait_for_all_acked(Duration(seconds=FLUSH_TIMEOUT))

    def _forget(self):
        self._odometry = self._object_pose = self._heard = None
        self._time, self._silent, self._unanswered = 0.0, False, []

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
            self._work.repeat()
            self.reporter.report(ERROR, f'{error}; stopped', stamp)
            return
        if measured.time < self._time - BACKWARDS:
            self._begin_anew()
        known = getattr(self, name)
        if known is None or measured.time >= known.time:
            setattr(self, name, measured)
        command = self._step()
        if self._options.wait_for_plans and self._work.awaits_plan:
            self._unanswered.append(stamp)
        else:
            self._answer_late()
            self._send(command, stamp)
        self._work.report(stamp, self._time)

    def _step(self):
        times = [m.time for m in (self._odometry, self._object_pose) if m is not None]
        newest = max(self._time, *times)
        dt, self._time = newest - self._time, newest
        if self._odometry is None:
            return STOP
        return self._work.step(Observation(self._time, self._odometry, self._object_pose), dt)

    def _answer_late(self):
        """Answer what had to wait for a plan, once none is wanted: the robot stood meanwhile."""
        if not self._work.awaits_plan:
            while self._unanswered:
                self._send(STOP, self._unanswered.pop(0))

    def _follow_up(self):
        self._answer_late()
        if self._options.task:
            self._work.report(self._now(), self._time)

    def _hear(self, take, message, stops=False):
        try:
            take(message)
        except MessageRefused as error:
            if stops:
                self._send(STOP, self._now())
            self.reporter.report(ERROR, f'{error}; stopped' if stops else str(error),
                                 message.header.stamp)
        self._follow_up()

    def _start(self):
        there = {'odom': self._odometry is not None, 'object_pose': self._object_pose is not None,
                 self._work.needs: self._work.is_set}
        missing = [name for name, known in there.items() if not known]
        if missing:
            return False, f'has not got {" and ".join(missing)} yet'
        self._work.start()
        self._follow_up()
        return True, 'started'

    def _stop(self):
        self._work.stop()
        self._send(STOP, self._now())
        self._follow_up()
        return True, 'stopped'

    def _obey(self, action):
        answer = action()
        self._follow_up()
        return answer

    def _begin_anew(self):
        self._work.forget()
        self._forget()
        self.reporter.report(WARN, f'waits for {self._work.awaited}: time went back', self._now())

    def _watch(self):
        if self._heard is None or not self._work.is_active:
            return
        now = self.get_clock().now()
        # Stamps may be of another clock, and messages may be ahead of simulated time.
        age = (now.nanoseconds - max(self._heard)) * 1e-9
        before, self._silent = self._silent, age > self._options.watchdog_timeout
        if self._silent:
            self._send(STOP, now.to_msg())
            if not before:
                self.reporter.report(ERROR, f'no odometry for {age:.2f} s; stopped', now.to_msg())
            self._work.repeat()

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
