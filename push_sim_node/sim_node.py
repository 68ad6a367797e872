"""ROS node of the simulator."""

import json
from pathlib import Path
import sys
import time
from typing import Any, NamedTuple

from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, from_twist_message, MessageRefused, nanoseconds,
)
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import Frames, SimOptions
from push_ros.topics import SIM
from push_sim_node.ros.lockstep import MeasurementExchange
from push_sim_node.ros.outputs import SimOutputs
from push_sim_node.ros.run_control import QUIET_TIME, RunAction, RunControl, RunState
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
# Where ROS 2 Humble has both.
from rclpy.clock import Clock, ClockType  # pyright: ignore[reportPrivateImportUsage]

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('sensors.', SensorSettings),
            ('simulation.', SimulationSettings), ('', Frames), ('', SimOptions))
# Periods of the tick on the wall [s], chosen: in lockstep it only finds what is lost, against the
# wall clock it paces measurements of 50 Hz.
LOCKSTEP_TICK = 0.05
WALL_CLOCK_TICK = 0.002
# Wall time that a command has after its measurement before the next is computed [s], chosen: the
# controller answers in a few milliseconds.
COMMAND_GRACE = 0.005


class _InFlight(NamedTuple):
    """
    The measurement that was published last.

    :param message: of it.
    :param is_object_pose: whether it is an object pose, else odometry.
    :param sent: wall time [s].
    """

    message: Any
    is_object_pose: bool
    sent: float


class SimNode(PushNode):
    """
    The true object, the true robot and their sensors.

    Publishes ``odom``, ``object_pose``, ``contact_wrench``, ``markers``, ``diagnostics``, where it
    owns time ``clock``, and ``tf`` where tf2_msgs is installed; subscribes ``cmd_vel``,
    ``initialpose``; serves ``sim/start``, ``sim/reset``. Until it is started (``autostart`` or
    ``sim/start``) it holds time and offers the first measurements. With ``lockstep`` it then goes
    from one measurement to the next when the command with its stamp has come; else it keeps to
    the wall clock. Parameters: ``object.*`` and ``robot.*`` as they truly are, ``sensors.*``,
    ``simulation.*``, frames and how time passes; at its end it writes the tape to ``tape_path``,
    and times on the wall beside it.
    """

    def __init__(self) -> None:
        super().__init__(SIM, SECTIONS)
        obj, robot, sensors, settings, self._frames, self._options = self.settings
        self._simulation = Simulation(obj, robot, Pose(*self._options.object_start),
                                      Pose(*self._options.robot_start), settings, sensors,
                                      interpret=True)
        self._outputs = SimOutputs(self, obj, robot, self._frames, self._options)
        self._latencies: list[float] = []
        self._hold()
        self.subscribe('cmd_vel', self._on_command, real_time=True,
                       stamped=self._options.enable_stamped_cmd_vel)
        self.subscribe('initialpose', self._on_initial_pose)
        self.serve_trigger('sim/start', self._start)
        self.serve_trigger('sim/reset', self._reset)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        if self._options.lockstep:
            self.create_timer(LOCKSTEP_TICK, self._tick, clock=wall)
        else:
            self.create_timer(WALL_CLOCK_TICK, self._tick, clock=wall,
                              callback_group=self.real_time)

    def close(self) -> None:
        """Write the tape, and times on the wall."""
        if not self._options.tape_path or not self._simulation.rows:
            return
        path = Path(self._options.tape_path)
        self._simulation.tape.save(path)
        path.with_suffix('.json').write_text(json.dumps({
            'simulated_time': self._simulation.time,
            'wall_time': self._control.duration(time.monotonic()),
            'latencies': self._latencies}), encoding='utf-8')

    def _hold(self, object_pose: Pose | None = None) -> None:
        self._simulation.reset(object_pose)
        self._first_measurements = [self._simulation.next_measurement(),
                                    self._simulation.next_measurement()]
        self._simulation.reset(object_pose)
        self._computed: Odometry | ObjectPose | None = None
        self._in_flight: _InFlight | None = None
        self._exchange = MeasurementExchange(self._options.answer_timeout,
                                             self._options.enable_stamped_cmd_vel)
        self._control = RunControl(time.monotonic(), self._options.autostart,
                                   QUIET_TIME if self._options.lockstep else 0.0)
        self._report(OK, 'holds time')

    def _start(self) -> ServiceAnswer:
        success = self._control.request_start(time.monotonic())
        return ServiceAnswer(success, f'is {self._control.state.value}')

    def _reset(self) -> ServiceAnswer:
        self._hold()
        return ServiceAnswer(True, 'put back to the start')

    def _tick(self) -> None:
        now = time.monotonic()
        action = self._control.tick(now)
        if action is RunAction.OFFER_FIRST_MEASUREMENTS:
            self._outputs.restart_time()
            self._outputs.publish_clock(0.0)
            for measurement in self._first_measurements:
                self._outputs.publish_measurement(measurement)
        elif action is RunAction.START:
            self._outputs.restart_time()
            self._report(OK, 'runs')
            self._publish_next(now)
        elif action is RunAction.CONTINUE and self._options.lockstep:
            self._wait_for_answer(now)
        elif action is RunAction.CONTINUE:
            self._keep_time(now)

    def _wait_for_answer(self, now: float) -> None:
        if self._exchange.is_abandoned(now):
            self._end(ERROR, f'no command for {self._options.answer_timeout:g} s: the controller '
                      'is gone; stopped')
        elif self._in_flight is not None and self._exchange.is_resend_due(now):
            self._exchange.resent(now)
            self._outputs.republish(self._in_flight.message)

    def _keep_time(self, now: float) -> None:
        sent = self._in_flight.sent if self._in_flight is not None else now
        if self._computed is None and now - sent > COMMAND_GRACE:
            self._computed = self._simulation.next_measurement()
        due = self._control.started_at + self._simulation.time / self._options.time_scale
        if self._computed is not None and now >= due:
            self._publish(self._computed, now)

    def _publish_next(self, now: float) -> None:
        limit = self._options.time_limit
        if limit and self._simulation.time >= limit:
            self._end(OK, f'has reached the time limit of {limit:g} s')
            return
        self._publish(self._simulation.next_measurement(), now)

    def _publish(self, measurement: Odometry | ObjectPose, now: float) -> None:
        self._computed = None
        sent = time.monotonic()
        message = self._outputs.publish_measurement(measurement)
        self._in_flight = _InFlight(message, isinstance(measurement, ObjectPose), sent)
        self._exchange.sent(nanoseconds(message.header.stamp), now)
        # While the controller computes its command.
        self._outputs.publish_scene(self._simulation)

    def _on_command(self, message: Any) -> None:
        now = time.monotonic()
        stamped = self._options.enable_stamped_cmd_vel
        stamp = nanoseconds(message.header.stamp) if stamped else None
        if stamp in (None, 0):
            # What is offered has the stamp 0.
            self._control.on_answer(now)
        if self._control.state is not RunState.RUNNING or self._in_flight is None:
            return
        is_answer = self._exchange.is_answer(stamp)
        if is_answer and self._in_flight.is_object_pose:
            self._latencies.append(now - self._in_flight.sent)
        if is_answer or not self._options.lockstep:
            self._command(message.twist if stamped else message)
        if is_answer and self._options.lockstep:
            self._publish_next(now)

    def _command(self, message: Any) -> None:
        try:
            self._simulation.command(from_twist_message(message))
        except ValueError as error:
            self._simulation.command(STOP)
            self._report(WARN, f'{error}; stopped')

    def _on_initial_pose(self, message: Any) -> None:
        try:
            check_frame(message.header.frame_id, self._frames.world_frame, 'initialpose')
            self._hold(from_pose_message(message.pose.pose, 'initialpose'))
        except (MessageRefused, ValueError) as error:
            self._report(ERROR, str(error))

    def _end(self, level: bytes, text: str) -> None:
        self._control.end(time.monotonic())
        self._simulation.command(STOP)
        self._outputs.publish_clock(self._simulation.time)
        self._report(level, text)

    def _report(self, level: bytes, text: str) -> None:
        values = {'state': self._control.state.value, 'time': self._simulation.time}
        self.reporter.report(level, text, self._outputs.stamp(self._simulation.time), values)


def main(arguments: list[str] | None = None) -> int:
    """
    Run the simulator.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(SimNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
