"""
Faults, in the words of PX4's failure injection: off, stuck, garbage, wrong, slow, and so on.

Each is done to one input, from a moment on and for some time: to odometry, to the object poses, or
to the commands on their way to the base.
"""

from collections import deque
import enum
import math
from typing import Any, NamedTuple

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_sim_node.simulation import Simulation


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


# Inputs that the simulation and the robot have in one process, too.
SIMULATED = Input.ODOMETRY, Input.POSE, Input.COMMAND


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
    def is_temporary(self) -> bool:
        """Whether the input is ok again before the end of the run."""
        return math.isfinite(self.end)

    def __str__(self) -> str:
        """Name the fault."""
        until = f'until {self.end:g} s' if self.is_temporary else 'for good'
        return f'{self.input.value} {self.word.value} from {self.start:g} s {until}'


OFFSET = Pose(0.3, 0.0, 0.5)
DELAY = 0.5
SLOW_COUNT = 10
PERIOD, GAP = 1.0, 0.4


class SentCommand(NamedTuple):
    """A command as the robot sends it, at a simulated time [s]."""

    time: float
    twist: Twist


class Injection:
    """
    Does a fault to a simulation; an ``Intervention`` of ``simulate``.

    ``sent``: each ``SentCommand``, before the fault is done to it.
    """

    def __init__(self, fault: Fault, seed: int = 0) -> None:
        """
        Wait for the simulation.

        :param fault: the ``Fault``.
        :param seed: of the random numbers of garbage.
        """
        self._fault = fault
        self._rng = np.random.default_rng(seed)
        self.sent: list[SentCommand] = []
        self._last: Any = None
        self._count = 0
        self._late: deque[tuple[float, Any]] = deque()
        self._is_installed = False

    def __call__(self, simulation: Simulation, _: object) -> None:
        """
        Put the fault between simulation and controller.

        :param simulation: the ``Simulation``.
        """
        if self._is_installed:
            return
        self._is_installed = True
        if self._fault.input is Input.COMMAND:
            self._spoil_commands(simulation)
        else:
            self._spoil_measurements(simulation)
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
                send(self._spoilt_command(twist, time))
        setattr(simulation, 'command', command)

    def _spoilt_command(self, twist: Twist, time: float) -> Twist:
        word = self._fault.word
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
        if word is Word.DELAYED:
            return next((late for at, late in reversed(self._late) if at <= time - DELAY), STOP)
        return twist

    def _spoil_measurements(self, simulation: Simulation) -> None:
        take = simulation.next_measurement
        kind = Odometry if self._fault.input is Input.ODOMETRY else ObjectPose

        def next_measurement() -> Odometry | ObjectPose:
            while True:
                measured = take()
                if type(measured) is not kind:
                    return measured
                if not self._is_active(simulation.time):
                    self._last = measured
                    return measured
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
        if word is Word.GARBAGE:
            return measured._replace(pose=Pose(*self._rng.uniform(-3.0, 3.0, 3).tolist()))
        if word is Word.WRONG:
            pose = measured.pose
            return measured._replace(pose=Pose(pose.x + OFFSET.x, pose.y,
                                               wrap_angle(pose.theta + OFFSET.theta)))
        if word is Word.DELAYED:
            self._late.append((time, measured))
            return self._late.popleft()[1] if self._late[0][0] <= time - DELAY else None
        return measured
