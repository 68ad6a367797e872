"""
Faults, in the words of PX4's failure injection: off, stuck, garbage, wrong, slow, and so on.

Each is done to one input, from a moment on and for some time: to odometry, to the object poses, or
to the commands on their way to the base.
"""

from collections import deque
from collections.abc import Callable
import enum
import math
from typing import Any, NamedTuple

import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_sim_node.simulation import Measurement, Simulation


class Input(enum.Enum):
    """What the fault is done to."""

    ODOMETRY = 'odometry'
    POSE = 'pose'
    COMMAND = 'command'
    # What only a node has: messages of others, and the clock of all stamps.
    GOAL = 'goal'
    MAP = 'map'
    PLAN = 'plan'
    CLOCK = 'clock'
    # What the base makes of its commands.
    BASE = 'base'


# Inputs that the simulation and the robot have in one process, too, and all that is done in one.
SIMULATED = Input.ODOMETRY, Input.POSE, Input.COMMAND
IN_PROCESS = (*SIMULATED, Input.BASE)


class Word(enum.Enum):
    """What the fault is."""

    # Nothing comes; commands are ignored.
    OFF = 'off'
    # The last values come again, with fresh stamps.
    STUCK = 'stuck'
    # Random numbers.
    GARBAGE = 'garbage'
    # Elsewhere by 0.3 m and rotated by 0.5 rad; commands the other way round.
    WRONG = 'wrong'
    # One in ten; commands at half of the speed.
    SLOW = 'slow'
    # By 0.5 s, with their own stamps.
    DELAYED = 'delayed'
    # Nothing comes for 0.4 s of every second.
    INTERMITTENT = 'intermittent'
    # Of odometry: the wheels slip, so that the robot moves half as far as they do.
    SLIPPING = 'slipping'
    # Of odometry: the robot is lifted and put down 0.6 m away, of which its wheels know nothing.
    LIFTED = 'lifted'
    # Of odometry: its driver starts anew, and counts from zero.
    RESTARTED = 'started anew'
    # The twist of odometry, or what the base takes a command for, is in axes of the world.
    IN_WORLD_AXES = 'in world axes'
    # Somebody else commands the base, too: one command in two is to drive ahead.
    SHARED = 'shared'
    # One object pose in ten is elsewhere, by up to 1 m, and in any direction.
    OUTLIERS = 'outliers'
    # Object poses come with an age of 0.24 to 0.26 s, and so does the time-out.
    NEAR_TIMEOUT = 'near the time-out'
    # The tracker sees another object, which stands 0.6 m away.
    OF_ANOTHER_OBJECT = 'of another object'
    # The axes of the tracker are left-handed: y and the heading have the other sign.
    MIRRORED = 'mirrored'
    # The tag is on the robot.
    OF_THE_ROBOT = 'of the robot'
    # Noise of 2 cm and 0.02 rad besides, which is not stated.
    NOISY = 'noisy'
    # Slow commands move nothing.
    DEAD_BAND = 'dead band'
    # The left wheel turns at 0.6 of its speed.
    ONE_WHEEL = 'one wheel'
    # Speeds change by 0.15 m/s and 0.6 rad/s in a second at most.
    SLUGGISH = 'sluggish'
    # Commands are followed 0.3 s late.
    LATE = 'late'


# What can be done only to some inputs; all else to anything.
FURTHER_WORDS = {Word.SLIPPING: 'odometry', Word.LIFTED: 'odometry',
                 Word.RESTARTED: 'odometry', Word.IN_WORLD_AXES: 'odometry command',
                 Word.SHARED: 'command', Word.OUTLIERS: 'pose',
                 Word.NEAR_TIMEOUT: 'pose',
                 Word.OF_ANOTHER_OBJECT: 'pose', Word.MIRRORED: 'pose',
                 Word.OF_THE_ROBOT: 'pose', Word.NOISY: 'pose'}
# What is done to the base alone.
BASE_WORDS = Word.DEAD_BAND, Word.ONE_WHEEL, Word.SLUGGISH, Word.LATE
# Those that show the object, or what is taken for it, elsewhere.
POSE_WORDS = (Word.GARBAGE, Word.WRONG, Word.OUTLIERS, Word.OF_ANOTHER_OBJECT, Word.MIRRORED,
              Word.OF_THE_ROBOT, Word.NOISY)


class Fault(NamedTuple):
    """
    A fault.

    :param input: the ``Input``.
    :param word: the ``Word``.
    :param start: when it begins [s].
    :param end: when it is over [s].
    """

    input: Input
    word: Word
    start: float
    end: float

    @property
    def first_gap(self) -> float:
        """When an input that is intermittent first does not come for a whole gap [s]."""
        phase = self.start % PERIOD
        return self.start - phase + PERIOD if phase else self.start

    @property
    def is_temporary(self) -> bool:
        """Whether the input is ok again before the end of the run."""
        return math.isfinite(self.end)

    def __str__(self) -> str:
        """Name the fault."""
        until = f'until {self.end:g} s' if self.is_temporary else 'for good'
        return f'{self.input.value} {self.word.value} from {self.start:g} s {until}'


def words_of(kind: Input) -> list[Word]:
    """
    List what can be done to an input.

    :param kind: the ``Input``.
    """
    if kind is Input.BASE:
        return list(BASE_WORDS)
    return [word for word in Word
            if word not in BASE_WORDS and kind.value in FURTHER_WORDS.get(word, kind.value)]


OFFSET = Pose(0.3, 0.0, 0.5)
DELAY = 0.5
DEAD_SPEED, DEAD_YAW_RATE = 0.06, 0.3
WHEEL_RATIO, TRACK = 0.6, 0.25
SLUGGISH_RATES = 0.15, 0.15, 0.6
BASE_DELAY = 0.3
SLOW_COUNT = 10
PERIOD, GAP = 1.0, 0.4
SLIP_RATIO = 0.5
# Where the robot is put down that somebody lifts: away from the object, and to the side.
LIFT = Pose(0.5, 0.3, 1.0)
# Other directions, if a wall or the object is there [rad], and what remains free around it [m].
LIFT_TURNS = 0.0, 0.8, -0.8, 1.6, -1.6, 2.4, -2.4, 3.1
LIFT_CLEARANCE = 0.05
OUTLIER_RATIO, OUTLIER_DISTANCE = 0.1, 1.0
MIN_AGE, MAX_AGE = 0.24, 0.26
OTHER_OBJECT, OTHER_NOISE = Pose(0.6, 0.0, 0.3), 0.001
NOISE = 0.02
# What somebody else commands.
OTHER_COMMAND = Twist(0.2, 0.0, 0.3)


class SentCommand(NamedTuple):
    """A command as the robot sends it, at a simulated time [s]."""

    time: float
    twist: Twist


class Injection:
    """
    Does a fault to a simulation; an ``Intervention`` of ``simulate``.

    ``sent``: each ``SentCommand``, before the fault is done to it.
    """

    def __init__(self, fault: Fault, seed: int = 0,
                 occupancy_map: OccupancyMap | None = None) -> None:
        """
        Wait for the simulation.

        :param fault: the ``Fault``.
        :param seed: of the random numbers of garbage.
        :param occupancy_map: where a robot that is lifted can be put down; None for anywhere.
        """
        self._fault = fault
        self._map = occupancy_map
        self._rng = np.random.default_rng(seed)
        self.sent: list[SentCommand] = []
        self._last: Any = None
        self._count = 0
        self._late: deque[tuple[float, Any]] = deque()
        self._robot_pose: Callable[[], Pose] = lambda: Pose(0.0, 0.0, 0.0)
        # Object pose at the beginning, beside which another object stands.
        self._shown: Pose | None = None
        # Odometry as it is and as it comes, where wheels slip.
        self._slipping: tuple[Odometry, Odometry] | None = None
        self._is_installed = False

    @property
    def end(self) -> float:
        """When the fault is over [s]."""
        return self._fault.end

    def __call__(self, simulation: Simulation, _: object) -> None:
        """
        Put the fault between simulation and controller.

        :param simulation: the ``Simulation``.
        """
        if self._is_installed:
            return
        self._is_installed = True
        if self._fault.input in (Input.COMMAND, Input.BASE):
            self._spoil_commands(simulation)
        else:
            self._spoil_measurements(simulation)
        if self._fault.word is Word.SLIPPING:
            self._let_slip(simulation)
        self._record_commands(simulation)

    def _record_commands(self, simulation: Simulation) -> None:
        send = simulation.command

        def command(twist: Twist) -> None:
            self.sent.append(SentCommand(simulation.time, twist))
            send(twist)
        setattr(simulation, 'command', command)

    def _is_active(self, time: float) -> bool:
        return self._fault.start <= time < self._fault.end

    def _spoil_commands(self, simulation: Simulation) -> None:
        send = simulation.command

        def command(twist: Twist) -> None:
            time = simulation.time
            self._late.append((time, twist))
            if not self._is_active(time):
                self._last = twist
                send(twist)
            else:
                send(self._spoilt_command(twist, simulation))
        setattr(simulation, 'command', command)

    def _spoilt_command(self, twist: Twist, simulation: Simulation) -> Twist:
        word, time = self._fault.word, simulation.time
        self._count += 1
        if word in BASE_WORDS:
            return self._imperfect_command(twist, time)
        if word is Word.OFF or word is Word.INTERMITTENT and time % PERIOD < GAP:
            return STOP
        if word is Word.STUCK:
            return self._last or STOP
        if word is Word.GARBAGE:
            v_x, omega = self._rng.uniform(-1.0, 1.0, 2).tolist()
            return Twist(0.3 * v_x, 0.0, 1.5 * omega)
        if word is Word.WRONG:
            return Twist(-twist.v_x, -twist.v_y, twist.omega)
        if word is Word.SLOW:
            return Twist(*(0.5 * value for value in twist))
        if word is Word.IN_WORLD_AXES:
            turned = _turned(twist, -simulation.truth.robot_pose.theta)
            return turned if simulation.robot.drive == 'holonomic' else turned._replace(v_y=0.0)
        if word is Word.SHARED:
            return twist if self._count % 2 else OTHER_COMMAND
        if word is Word.DELAYED:
            return self._command_before(time - DELAY)
        return twist

    def _command_before(self, time: float) -> Twist:
        return next((late for at, late in reversed(self._late) if at <= time), STOP)

    def _imperfect_command(self, twist: Twist, time: float) -> Twist:
        """Return what a base makes of a command."""
        word = self._fault.word
        if word is Word.DEAD_BAND:
            return Twist(*(value if abs(value) >= least else 0.0 for value, least in zip(
                twist, (DEAD_SPEED, DEAD_SPEED, DEAD_YAW_RATE))))
        if word is Word.ONE_WHEEL:
            left = WHEEL_RATIO * (twist.v_x - 0.5 * TRACK * twist.omega)
            right = twist.v_x + 0.5 * TRACK * twist.omega
            return Twist(0.5 * (left + right), twist.v_y, (right - left) / TRACK)
        if word is Word.LATE:
            return self._command_before(time - BASE_DELAY)
        last, self._last = self._last or STOP, twist
        step = time - self._late[-2][0] if len(self._late) > 1 else 0.0
        self._last = Twist(*(before + max(-rate * step, min(rate * step, value - before))
                             for before, value, rate in zip(last, twist, SLUGGISH_RATES)))
        return self._last

    def _let_slip(self, simulation: Simulation) -> None:
        """Move the robot less than its wheels, by which it is measured."""
        send = simulation.command

        def command(twist: Twist) -> None:
            slips = self._is_active(simulation.time)
            send(Twist(*(SLIP_RATIO * value for value in twist)) if slips else twist)
        setattr(simulation, 'command', command)

    def _spoil_measurements(self, simulation: Simulation) -> None:
        take = simulation.next_measurement
        self._robot_pose = lambda: simulation.truth.robot_pose
        kind = Odometry if self._fault.input is Input.ODOMETRY else ObjectPose

        def next_measurement() -> Measurement:
            while True:
                if self._is_aged and self._late and self._late[0][0] <= simulation.time:
                    return self._late.popleft()[1]
                measured = take()
                if type(measured) is not kind:
                    return measured
                if not self._is_active(simulation.time):
                    self._last = measured
                    return self._after_slip(measured)
                if (self._fault.word is Word.LIFTED and self._slipping is None
                        and isinstance(measured, Odometry)):
                    return self._before_lift(measured, simulation)
                spoilt = self._spoilt_measurement(measured, simulation.time)
                if spoilt is not None:
                    return spoilt
        setattr(simulation, 'next_measurement', next_measurement)

    def _spoilt_measurement(self, measured: Any, time: float) -> Any:
        """Return the measurement as it comes, or None where it does not."""
        word = self._fault.word
        self._count += 1
        if (word is Word.OFF or word is Word.INTERMITTENT and time % PERIOD < GAP
                or word is Word.SLOW and self._count % SLOW_COUNT):
            return None
        if word is Word.STUCK:
            return measured if self._last is None else self._last._replace(time=measured.time)
        if word in POSE_WORDS:
            return measured._replace(pose=self._spoilt_pose(measured.pose))
        if self._is_aged:
            self._late.append((measured.time + self._rng.uniform(MIN_AGE, MAX_AGE),
                               measured))
            return None
        if word is Word.DELAYED:
            self._late.append((time, measured))
            return self._late.popleft()[1] if self._late[0][0] <= time - DELAY else None
        if word is Word.SLIPPING:
            return self._slipped(measured, 1.0 / SLIP_RATIO)
        if word is Word.RESTARTED and self._slipping is None:
            self._slipping = measured, measured._replace(pose=Pose(0.0, 0.0, 0.0))
        if word in (Word.LIFTED, Word.RESTARTED):
            return self._slipped(measured, 1.0)
        if word is Word.IN_WORLD_AXES:
            return measured._replace(twist=_turned(measured.twist, measured.pose.theta))
        return measured

    @property
    def _is_aged(self) -> bool:
        return self._fault.word is Word.NEAR_TIMEOUT

    def _spoilt_pose(self, pose: Pose) -> Pose:
        """Return a pose as it is measured."""
        word, rng = self._fault.word, self._rng
        if word is Word.GARBAGE:
            return Pose(*rng.uniform(-3.0, 3.0, 3).tolist())
        if word is Word.WRONG:
            return Pose(pose.x + OFFSET.x, pose.y, wrap_angle(pose.theta + OFFSET.theta))
        if word is Word.MIRRORED:
            return Pose(pose.x, -pose.y, -pose.theta)
        if word is Word.OUTLIERS:
            x, y = Pose(0.0, 0.0, rng.uniform(-math.pi, math.pi)).rotate(
                (rng.uniform(0.0, OUTLIER_DISTANCE), 0.0))
            is_outlier = rng.uniform() < OUTLIER_RATIO
            return Pose(pose.x + x, pose.y + y, rng.uniform(-math.pi, math.pi)
                        ) if is_outlier else pose
        if word is Word.OF_ANOTHER_OBJECT:
            self._shown = self._shown or pose
            pose = Pose(self._shown.x + OTHER_OBJECT.x, self._shown.y, OTHER_OBJECT.theta)
        if word is Word.OF_THE_ROBOT:
            pose = self._robot_pose()
        noise = NOISE if word is Word.NOISY else OTHER_NOISE
        return Pose(*(a + b for a, b in zip(pose, rng.normal(0.0, noise, 3).tolist())))

    def _after_slip(self, measured: Any) -> Any:
        """Go on from where slipping wheels have led odometry."""
        return measured if self._slipping is None else self._slipped(measured, 1.0)

    def _before_lift(self, measured: Odometry, simulation: Simulation) -> Odometry:
        """Put the robot down elsewhere after a measurement, at rest: its wheels do not turn."""
        plant = simulation.plant
        before, obj = plant.robot_pose, plant.object_pose
        outward = math.atan2(before.y - obj.y, before.x - obj.x)
        places = [Pose(*Pose(before.x, before.y, outward + turn).transform(LIFT[:2]),
                       before.theta + LIFT.theta) for turn in LIFT_TURNS]
        after = next((place for place in places if self._is_free(place, simulation)), places[0])
        plant.stand_at(obj, after)
        moved = measured._replace(pose=measured.pose @ (before.inverse() @ after))
        self._slipping = moved, measured
        return measured

    def _is_free(self, place: Pose, simulation: Simulation) -> bool:
        """Tell whether a lifted robot can be put down somewhere."""
        robot = simulation.robot
        gap = find_contact(simulation.obj, simulation.plant.object_pose, place[:2],
                           robot.radius).gap
        return gap >= LIFT_CLEARANCE and (
            self._map is None or self._map.robot_is_free(robot, [place], LIFT_CLEARANCE))

    def _slipped(self, measured: Odometry, ratio: float) -> Odometry:
        """Measure wheels that turn by a ratio more than the robot moves."""
        true, shown = self._slipping or (measured, measured)
        step = true.pose.inverse() @ measured.pose
        wheels = Pose(ratio * step.x, ratio * step.y, ratio * wrap_angle(step.theta))
        slipped = measured._replace(pose=shown.pose @ wheels,
                                    twist=Twist(*(ratio * value for value in measured.twist)))
        self._slipping = measured, slipped
        return slipped


def _turned(twist: Twist, angle: float) -> Twist:
    """Return a twist in axes that are rotated by the negative of an angle [rad]."""
    return Twist(*Pose(0.0, 0.0, angle).rotate(twist[:2]), twist.omega)
