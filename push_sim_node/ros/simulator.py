"""What a node of the simulator does, whichever plant it has."""

import json
from pathlib import Path
import time
from typing import Any, Callable, NamedTuple, Sequence

from builtin_interfaces.msg import Time
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, from_twist_message, MessageRefused, nanoseconds,
)
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import Frames, SimOptions
from push_ros.object_catalogue import ObjectCatalogue
from push_ros.parameters import DYNAMIC, Section
from push_ros.topics import SIM
from push_sim_node.bumped_object import PlacedObject
from push_sim_node.plant import Plant
from push_sim_node.room_simulation import RoomSimulation
from push_sim_node.ros.lockstep import MeasurementExchange
from push_sim_node.ros.outputs import PublishedMeasurement, SimOutputs
from push_sim_node.ros.pacing import Pacer, SpeedMeter, StampLag
from push_sim_node.ros.run_control import QUIET_TIME, RunAction, RunControl, RunState
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Measurement, Simulation

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('sensors.', SensorSettings),
            ('simulation.', SimulationSettings), ('', Frames), ('', SimOptions))
SETTABLE = {'time_scale': DYNAMIC}
# Period on the wall at which the state of the run is looked at where nothing is due before [s],
# chosen: it finds in lockstep what is lost, and offers measurements while time is held.
STATE_PERIOD = 0.05
# Wall time that a command has after its measurement before the next is computed [s], chosen: the
# controller answers in a few milliseconds. It shrinks where time is to run faster than the wall.
COMMAND_GRACE = 0.005
# Speed of robot and object below which nothing moves [m/s, rad/s]; chosen: 0.02 mm within the time
# by which stamps are moved on at once.
REST_SPEED = 1e-3


class _InFlight(NamedTuple):
    """
    The measurement that was published last.

    :param published: ``PublishedMeasurement`` of it; of an object pose before that those of all
        other objects, as the controller may answer any of them.
    :param sent: wall time [s].
    :param is_timed: whether the time until its first answer is of interest still.
    """

    published: list[PublishedMeasurement]
    sent: float
    is_timed: bool


class Simulator(PushNode):
    """
    The true object, the true robot and their sensors; a node derives from it.

    Until it is started (``autostart`` or ``sim/start``) it holds time and offers the first
    measurements. With ``lockstep`` it then goes from one measurement to the next when the command
    with its stamp has come; else it keeps to the wall clock. At its end it writes the tape to
    ``tape_path``, and times on the wall beside it.

    :param sections: those of ``SECTIONS``, and then what a node has besides.
    """

    def __init__(self, sections: Sequence[Section] = SECTIONS) -> None:
        super().__init__(SIM, sections, SETTABLE)
        obj, robot, sensors, settings, self._frames, self._options = self.settings[:len(SECTIONS)]
        plant_type = self.make_plant_type()
        self._room = self._make_room(robot, settings, sensors)
        # Where time keeps to the wall there is little to compute: not worth loading machine code.
        self._simulation = self._room.simulation if self._room else Simulation(
            obj, robot, Pose(*self._options.object_start), Pose(*self._options.robot_start),
            settings, sensors, interpret=not self._options.lockstep, plant_type=plant_type)
        self._outputs = SimOutputs(self, robot, sensors, self._frames, self._options)
        self._latencies: list[float] = []
        self._hold()
        self.subscribe('cmd_vel', self._on_command, real_time=True,
                       stamped=self._options.enable_stamped_cmd_vel)
        self.subscribe('initialpose', self._on_initial_pose)
        self.serve_trigger('sim/start', self._start)
        self.serve_trigger('sim/reset', self._reset)

    @property
    def simulation(self) -> Simulation:
        """The ``Simulation`` that runs."""
        return self._simulation

    def make_plant_type(self) -> Callable[..., Plant]:
        """Return what makes the plant, as ``Simulation`` takes it."""
        return Plant

    def is_published(self, measurement: Measurement) -> bool:
        """
        Tell whether a measurement is published, and not only made.

        :param measurement: of any sensor.
        """
        return True

    def on_measured(self, measurement: Measurement) -> None:
        """
        Take note of a measurement that is about to be published: the simulation is at its time.

        :param measurement: of any sensor.
        """
        is_pressed = self._simulation.is_bumper_pressed
        if is_pressed is not None and isinstance(measurement, Odometry):
            self._outputs.publish_bumper(is_pressed)

    def _make_room(self, robot: RoundRobot, settings: SimulationSettings,
                   sensors: SensorSettings) -> RoomSimulation | None:
        """Place several objects; return None where there is but one."""
        options = self._options
        if not options.objects:
            return None
        catalogue = ObjectCatalogue(options.object_folder)
        try:
            objects = {entry.name: PlacedObject(catalogue.find(entry.name),
                                                Pose(entry.x, entry.y, entry.theta))
                       for entry in options.objects}
        except ValueError as error:
            self.refuse_to_start(f'objects.name: {error}')
        return RoomSimulation(objects, robot, Pose(*options.robot_start), settings, sensors)

    def on_settings_changed(self) -> None:
        """Let time run at another pace, from now on."""
        self._options = self.settings[len(SECTIONS) - 1]
        now = time.monotonic()
        self._pacer.set_scale(self._options.time_scale, now)
        if self._speed_meter.is_slow:
            # That was said of the former pace.
            self._report(OK, 'runs')
        self._speed_meter.restart(self._simulation.time, now)

    @property
    def wake_time(self) -> float:
        """Time on the wall at which something is due [s]."""
        return self._wake_time

    def poll(self) -> bool:
        """Handle what has come, and what is due; tell whether anything has come."""
        has_message = super().poll()
        now = time.monotonic()
        if now >= self._wake_time:
            self._wake_time = now + STATE_PERIOD
            self._tick(now)
        return has_message

    def now(self) -> Time:
        """Return the simulated time, or where it is not the node's own, the time of its clock."""
        return self._outputs.stamp(self._simulation.time)

    def close(self) -> None:
        """Write the tape, and times on the wall."""
        self._outputs.flush()
        if not self._options.tape_path or not self._simulation.rows:
            return
        path = Path(self._options.tape_path)
        self._simulation.tape.save(path)
        path.with_suffix('.json').write_text(json.dumps({
            'simulated_time': self._simulation.time,
            'wall_time': self._control.duration(time.monotonic()),
            'latencies': self._latencies}), encoding='utf-8')

    def _hold(self, object_pose: Pose | None = None) -> None:
        reached = self._simulation.time
        self._restart(object_pose)
        self._outputs.keep_clock(reached)
        self._first_measurements = self._take_first_measurements()
        self._restart(object_pose)
        self._computed: Measurement | None = None
        self._in_flight: _InFlight | None = None
        # Simulated time of the last command, where that was to move [s].
        self._moving_since: float | None = None
        self._is_abandoned = False
        self._exchange = MeasurementExchange(self._options.answer_timeout,
                                             self._options.enable_stamped_cmd_vel)
        self._control = RunControl(time.monotonic(), self._options.autostart,
                                   QUIET_TIME if self._options.lockstep else 0.0)
        self._pacer = Pacer(self._options.time_scale, time.monotonic())
        self._speed_meter = SpeedMeter(time.monotonic())
        self._stamp_lag = StampLag()
        self._wake_time = 0.0
        self._report(OK, 'holds time')

    def _restart(self, object_pose: Pose | None) -> None:
        """Restart at time 0."""
        if self._room is None:
            self._simulation.reset(object_pose)
            return
        self._room.reset()
        self._simulation = self._room.simulation

    def _take_first_measurements(self) -> list[Measurement]:
        """Let time go on to the first odometry, which comes after the first pose in the world."""
        taken: list[Measurement] = []
        while not (taken and isinstance(taken[-1], Odometry)):
            taken.append(self._next_published())
        return taken

    def _start(self) -> ServiceAnswer:
        success = self._control.request_start(time.monotonic())
        return ServiceAnswer(success, f'is {self._control.state.value}')

    def _reset(self) -> ServiceAnswer:
        self._hold()
        return ServiceAnswer(True, 'put back to the start')

    def _tick(self, now: float) -> None:
        action = self._control.tick(now)
        if action is RunAction.OFFER_FIRST_MEASUREMENTS:
            self._outputs.restart_time()
            self._outputs.publish_clock(0.0)
            for measurement in self._first_measurements:
                self._publish_measurement(measurement)
        elif action is RunAction.START:
            self._outputs.restart_time()
            self._pacer = Pacer(self._options.time_scale, now)
            self._speed_meter = SpeedMeter(now)
            self._stamp_lag = StampLag()
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
            for published in self._in_flight.published:
                self._outputs.republish(published)

    def _keep_time(self, now: float) -> None:
        """Compute the next measurement, and publish it when it is due."""
        if self._computed is None:
            if self._has_ended():
                return
            self._computed = self._next_measurement()
        due = self._pacer.due(self._simulation.time)
        if now < due:
            self._outputs.publish_clock(self._pacer.time(now))
            next_clock = self._outputs.next_clock_time(self._pacer.time(now))
            self._wake_time = min(due, self._pacer.due(next_clock))
            return
        self._keep_stamps(self._pacer.reached(self._simulation.time, now))
        self._publish(self._computed, now)
        self._watch_controller()
        self._watch_speed(now)

    def _keep_stamps(self, delay: float) -> None:
        """Let stamps of the wall clock catch up with it, where they can."""
        if not self._options.owns_time:
            # Looked at only where there is something to catch up with.
            is_at_rest = delay + self._stamp_lag.time > 0.0 and self._is_at_rest
            self._outputs.skip_time(self._stamp_lag.update(delay, is_at_rest=is_at_rest))

    @property
    def _is_at_rest(self) -> bool:
        """Whether nothing moves, and nothing is to."""
        truth = self._simulation.truth
        return self._moving_since is None and max(
            map(abs, (*truth.object_twist, *truth.robot_twist))) < REST_SPEED

    def _watch_controller(self) -> None:
        """Say that commands have ceased while the robot moved; an idle controller stops it."""
        since, timeout = self._moving_since, self._simulation.settings.command_timeout
        if since is not None and self._simulation.time > since + timeout:
            self._moving_since, self._is_abandoned = None, True
            self._report(WARN, f'no command for {timeout:g} s: the robot stands, its controller '
                         'is gone or hangs')

    def _watch_speed(self, now: float) -> None:
        was_slow = self._speed_meter.is_slow
        if not self._speed_meter.update(self._simulation.time, now, self._pacer.scale):
            return
        if self._speed_meter.is_slow and not was_slow:
            self._report(WARN, f'time runs {self._speed_meter.speed:.2g} times as fast as on the '
                         f'wall, time_scale asks for {self._pacer.scale:g}' + self._lag_text)
        elif was_slow and not self._speed_meter.is_slow:
            self._report(OK, 'runs')
        else:
            self._report(self._level, self._text)

    @property
    def _lag_text(self) -> str:
        """What a slow simulator does to stamps; empty where they are simulated time."""
        if self._options.owns_time:
            return ''
        return (f'; stamps are {self._stamp_lag.time:.2g} s behind the wall clock, and catch up '
                'while nothing moves')

    def _has_ended(self) -> bool:
        limit = self._options.time_limit
        if not limit or self._simulation.time < limit:
            return False
        self._end(OK, f'has reached the time limit of {limit:g} s')
        return True

    def _publish_next(self, now: float) -> None:
        if not self._has_ended():
            self._publish(self._next_measurement(), now)

    def _publish(self, measurement: Measurement, now: float) -> None:
        self._computed = None
        if not self._options.tape_path:
            # Nobody asks for what would grow without end.
            self._simulation.rows.clear()
            self._latencies.clear()
        sent = time.monotonic()
        published = self._publish_measurement(measurement)
        self._in_flight = _InFlight(published, sent, is_timed=isinstance(measurement, ObjectPose))
        self._exchange.sent(published[-1].stamp, now)
        # While the controller computes its command.
        self._outputs.publish_scene(self._simulation)
        if not self._options.lockstep:
            self._wake_time = now + COMMAND_GRACE / max(1.0, self._pacer.scale)

    def _publish_measurement(self, measurement: Measurement) -> list[PublishedMeasurement]:
        """Publish a measurement; with a pose of one of several objects those of all others."""
        self.on_measured(measurement)
        room = self._room
        if room is None:
            return [self._outputs.publish_measurement(measurement)]
        standing: dict[str, ObjectPose] = {}
        if isinstance(measurement, ObjectPose):
            standing = room.measure_standing(measurement.time)
        return [*(self._outputs.publish_standing(name, pose) for name, pose in standing.items()),
                self._outputs.publish_measurement(measurement, room.pushed)]

    def _next_measurement(self) -> Measurement:
        """Let time go on; of several objects the one can be pushed that the robot is nearest."""
        if self._room is not None:
            self._room.turn_to_nearest()
        return self._next_published()

    def _next_published(self) -> Measurement:
        while True:
            measurement = self._simulation.next_measurement()
            if self.is_published(measurement):
                return measurement

    def _on_command(self, message: Any) -> None:
        now = time.monotonic()
        stamped = self._options.enable_stamped_cmd_vel
        stamp = nanoseconds(message.header.stamp) if stamped else None
        if stamp in (None, 0):
            # What is offered has the stamp 0.
            self._control.on_answer(now)
        if self._control.state is not RunState.RUNNING or self._in_flight is None:
            return
        if self._options.lockstep and not self._exchange.is_answer(stamp):
            return
        if self._in_flight.is_timed:
            self._latencies.append(now - self._in_flight.sent)
            # Without lockstep more than one command may follow a measurement.
            self._in_flight = self._in_flight._replace(is_timed=False)
        self._command(message.twist if stamped else message)
        if self._options.lockstep:
            self._publish_next(now)

    def _command(self, message: Any) -> None:
        try:
            twist = from_twist_message(message)
            self._simulation.command(twist)
            self._moving_since = None if twist == STOP else self._simulation.time
            if self._is_abandoned:
                self._is_abandoned = False
                self._report(OK, 'runs')
        except ValueError as error:
            self._simulation.command(STOP)
            self._report(WARN, f'{error}; stopped')

    def _on_initial_pose(self, message: Any) -> None:
        try:
            check_frame(message.header.frame_id, self._frames.world_frame, 'initialpose')
            if self._room is not None:
                raise ValueError('initialpose: got one, expected none with several objects')
            self._hold(from_pose_message(message.pose.pose, 'initialpose'))
        except (MessageRefused, ValueError) as error:
            self._report(ERROR, str(error))

    def _end(self, level: bytes, text: str) -> None:
        self._control.end(time.monotonic())
        self._simulation.command(STOP)
        self._outputs.publish_clock(self._simulation.time)
        self._report(level, text)

    def _report(self, level: bytes, text: str) -> None:
        self._level, self._text = level, text
        values = {'state': self._control.state.value, 'time': self._simulation.time}
        if self._speed_meter.speed is not None:
            values['speed'] = round(self._speed_meter.speed, 3)
        if not self._options.owns_time:
            values['stamp_lag'] = round(self._stamp_lag.time, 3)
        self.reporter.report(level, text, values)
