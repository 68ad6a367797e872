"""What all live sessions have in common: commands, and time that runs, stands or goes by rows."""

from abc import ABC, abstractmethod
from collections.abc import Callable
import math
from typing import Any

from push_model.geometry import Pose
from push_view.server.commands import Command, CommandRefused, Run, Step
from push_view.server.message_log import MessageLog

# Time for which nothing must have moved while the robot waits [s]; chosen: long enough to see it.
REST_TIME = 1.0

Handlers = dict[type[Any], Callable[[Any], None]]


class PacedSession(ABC):
    """
    A simulation whose time passes only in ``advance``.

    ``log``: where the messages go. ``paused``: whether time stands. ``speed``: simulated over real
    time.

    :param log: where the messages go.
    """

    def __init__(self, log: MessageLog) -> None:
        self.log = log
        self.paused = False
        self.speed = 1.0
        self._moved_time = 0.0
        self._last_poses: tuple[Pose, ...] = ()

    @property
    @abstractmethod
    def time(self) -> float:
        """Simulated time [s]."""

    @property
    @abstractmethod
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""

    @property
    @abstractmethod
    def is_standing(self) -> bool:
        """Tell whether the robot waits for a goal."""

    @property
    @abstractmethod
    def poses(self) -> tuple[Pose, ...]:
        """True ``Pose`` of all that moves."""

    @property
    @abstractmethod
    def scenario_text(self) -> str:
        """What is simulated as a scenario file; empty where there is none."""

    @property
    @abstractmethod
    def handlers(self) -> Handlers:
        """What is done at each type of command, beside those that let time run or stand."""

    @abstractmethod
    def rehearse(self) -> None:
        """Compile what the robot needs."""

    @abstractmethod
    def advance_once(self) -> None:
        """Let time pass to the next measurement."""

    @abstractmethod
    def show(self) -> None:
        """Send the page what happened."""

    @property
    def is_at_rest(self) -> bool:
        """Tell whether nothing will happen until its user does something."""
        return self.is_standing and self.time - self._moved_time > REST_TIME

    def advance(self, duration: float, is_late: Callable[[], bool] = lambda: False) -> None:
        """
        Let simulated time pass.

        :param duration: how much [s]; to the next measurement at least.
        :param is_late: asked after every measurement whether to stop before.
        """
        end = self.time + duration
        self.advance_once()
        while self.time < end and not is_late():
            self.advance_once()
        self.show()
        if self.poses != self._last_poses or not self.is_standing:
            self._note_motion()

    def handle(self, command: Command) -> None:
        """
        Do what the user asks for.

        :raises CommandRefused: where it cannot be done, with the reason; then nothing changes.
        """
        handlers: Handlers = {**self.handlers, Run: self._set_speed, Step: self._step}
        if type(command) not in handlers:
            raise CommandRefused('type: got a command that this page does not have')
        try:
            handlers[type(command)](command)
        except CommandRefused:
            raise
        except ValueError as error:
            raise CommandRefused(str(error)) from error
        # Something may come of it.
        self._moved_time = self.time

    def show_speed(self, achieved: float = math.nan) -> None:
        """
        Show whether time runs, and how fast.

        :param achieved: simulated over real time, as measured; nan where it is not known.
        """
        self.log.replace({'type': 'run', 'paused': self.paused, 'speed': self.speed,
                          'achieved': None if math.isnan(achieved) else round(achieved, 1),
                          'at_rest': self.is_at_rest})

    def advance_by_a_row(self) -> None:
        """Let time pass until the page is shown another row."""
        shown = self.shown_time
        while self.shown_time == shown:
            self.advance(0.0)

    def _note_motion(self) -> None:
        """Take note that something has moved by now."""
        self._moved_time, self._last_poses = self.time, self.poses

    def _set_speed(self, command: Run) -> None:
        self.paused = self.paused if command.paused is None else command.paused
        self.speed = command.speed or self.speed
        self.show_speed()

    def _step(self, _: Step) -> None:
        self.paused = True
        self.show_speed()
        self.advance_by_a_row()
