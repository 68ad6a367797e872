"""ROS node of the simulator."""

import json
from pathlib import Path
import sys
import time

from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Odometry, STOP
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, from_twist_message, MessageRefused, nanoseconds,
)
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import Frames, SimOptions
from push_ros.topics import SIM
from push_sim_node.ros.lockstep import MeasurementExchange
from push_sim_node.ros.outputs import SimOutputs
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
from rclpy.clock import Clock, ClockType

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('sensors.', SensorSettings),
            ('simulation.', SimulationSettings), ('', Frames), ('', SimOptions))
TICK, REAL_TIME_TICK = 0.05, 0.002
OFFER_PERIOD, QUIET_TIME = 0.1, 0.4
GRACE = 0.005


class SimNode(PushNode):
    """
    The true object, the true robot and their sensors.

    Publishes ``odom``, ``object_pose``, ``contact_wrench``, ``markers``, ``diagnostics``, where it
    owns time ``clock``, and ``tf`` where tf2_msgs is installed; subscribes ``cmd_vel``,
    ``initialpose``; serves ``sim/start``, ``sim/reset``. Until it is started (``autostart`` or
    ``sim/start``) it holds time and offers the first measurements. With ``lockstep`` it then goes
    from one measurement to the next when the command with its stamp has come; else it keeps to
    the wall clock. Parameters: ``object.*`` and ``robot.*`` as they truly are, ``sensors.*``,
    ``simulation.*``, frames and how time goes; at its end it writes the tape to ``tape_path``,
    and times on the wall beside it.
    """

    def __init__(self):
        super().__init__(SIM, SECTIONS)
        obj, robot, sensors, settings, self._frames, self._options = self.settings
        self._simulation = Simulation(obj, robot, Pose(*self._options.object_start),
                                      Pose(*self._options.robot_start), settings, sensors)
        self._outputs = SimOutputs(self, obj, robot, self._frames, self._options)
        self._exchange = MeasurementExchange(self._options.answer_timeout,
                                             self._options.stamped_cmd_vel)
        self._latencies = []
        self._hold(self._options.autostart)
        self.subscribe('cmd_vel', self._on_command, real_time=True,
                       stamped=self._options.stamped_cmd_vel)
        self.subscribe('initialpose', self._on_initial_pose)
        self.serve_trigger('sim/start', self._start)
        self.serve_trigger('sim/reset', self._reset)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        if self._options.lockstep:
            self.create_timer(TICK, self._tick, clock=wall)
        else:
            self.create_timer(REAL_TIME_TICK, self._tick, clock=wall, callback_group=self.real_time)

    def close(self):
        """Write the tape, and times on the wall."""
        if not self._options.tape_path or not self._simulation.rows:
            return
        path = Path(self._options.tape_path)
        self._simulation.tape.save(path)
        wall = (self._ended or time.monotonic()) - self._began
        path.with_suffix('.json').write_text(json.dumps({
            'simulated_time': self._simulation.time, 'wall_time': wall,
            'latencies': self._latencies}), encoding='utf-8')

    def _hold(self, go_on, object_pose=None):
        self._simulation.reset(object_pose)
        self._first = [self._simulation.next_measurement(), self._simulation.next_measurement()]
        self._simulation.reset(object_pose)
        self._pending = self._message = self._ended = None
        self._began = self._heard = time.monotonic()
        self._offered = 0.0
        self._state = 'starting' if go_on else 'holding'
        self._report(OK, 'holds time')

    def _start(self):
        if self._state == 'holding':
            self._state, self._heard = 'starting', time.monotonic()
        return self._state != 'ended', f'is {self._state}'

    def _reset(self):
        self._hold(self._options.autostart)
        return True, 'put back to the start'

    def _tick(self):
        now = time.monotonic()
        if self._state == 'holding' and now - self._offered > OFFER_PERIOD:
            self._offered = now
            self._outputs.epoch = self._outputs.now_epoch()
            self._outputs.clock(0.0)
            for measurement in self._first:
                self._outputs.measurement(measurement)
        elif self._state == 'starting' and now - self._heard > QUIET_TIME:
            # Answers to what was offered must not be taken for those to come.
            self._state, self._began = 'running', now
            self._outputs.epoch = self._outputs.now_epoch()
            self._report(OK, 'runs')
            self._go_on(now)
        elif self._state == 'running':
            (self._wait_for_answer if self._options.lockstep else self._keep_time)(now)

    def _wait_for_answer(self, now):
        if self._exchange.is_abandoned(now):
            self._end(ERROR, f'no command for {self._options.answer_timeout:g} s: the controller '
                      'is gone; stopped')
        elif self._exchange.is_resend_due(now):
            self._exchange.resent(now)
            self._outputs.again(self._message)

    def _keep_time(self, now):
        if self._pending is None and now - self._sent > GRACE:
            self._pending = self._simulation.next_measurement()
        due = self._began + self._simulation.time / self._options.time_scale
        if self._pending is not None and now >= due:
            self._publish(self._pending, now)

    def _go_on(self, now):
        limit = self._options.time_limit
        if limit and self._simulation.time >= limit:
            self._end(OK, f'has reached the time limit of {limit:g} s')
            return
        self._publish(self._simulation.next_measurement(), now)

    def _publish(self, measurement, now):
        self._pending = None
        self._is_pose = not isinstance(measurement, Odometry)
        self._sent = time.monotonic()
        self._message = self._outputs.measurement(measurement)
        self._exchange.sent(nanoseconds(self._message.header.stamp), now)
        # While the controller thinks.
        self._outputs.scene(self._simulation)

    def _on_command(self, message):
        now = time.monotonic()
        self._heard = time.monotonic()
        if self._state != 'running':
            return
        stamped = self._options.stamped_cmd_vel
        stamp = nanoseconds(message.header.stamp) if stamped else None
        answers = self._exchange.is_answer(stamp)
        if answers and self._is_pose:
            self._latencies.append(now - self._sent)
        if answers or not self._options.lockstep:
            self._command(message.twist if stamped else message)
        if answers and self._options.lockstep:
            self._go_on(self._heard)

    def _command(self, message):
        try:
            self._simulation.command(from_twist_message(message))
        except ValueError as error:
            self._simulation.command(STOP)
            self._report(WARN, f'{error}; stopped')

    def _on_initial_pose(self, message):
        try:
            check_frame(message.header.frame_id, self._frames.world_frame, 'initialpose')
            self._hold(self._options.autostart,
                       from_pose_message(message.pose.pose, 'initialpose'))
        except (MessageRefused, ValueError) as error:
            self._report(ERROR, str(error))

    def _end(self, level, text):
        self._state, self._ended = 'ended', time.monotonic()
        self._simulation.command(STOP)
        self._outputs.clock(self._simulation.time)
        self._report(level, text)

    def _report(self, level, text):
        values = {'state': self._state, 'time': self._simulation.time}
        self.reporter.report(level, text, self._outputs.stamp(self._simulation.time), values)


def main(arguments=None):
    """
    Run the simulator.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(SimNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
