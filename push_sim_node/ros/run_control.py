"""
States of a run: the simulator holds time, is about to start, runs, has ended.

``HOLDING -> STARTING -> RUNNING -> ENDED``, and from each of them back to the first by a reset.
Times are on the wall; they are arguments, so that a test needs no clock.
"""

import enum

# Period with which the first measurements are published while time is held [s], chosen: a
# controller that comes up late receives them soon.
OFFER_PERIOD = 0.1
# Time without a command after which a run starts [s], chosen as a few offers: answers to what was
# offered must not be taken for answers to what comes.
QUIET_TIME = 0.4


class RunState(enum.Enum):
    """What the simulator does."""

    HOLDING = 'holding'
    STARTING = 'starting'
    RUNNING = 'running'
    ENDED = 'ended'


class RunAction(enum.Enum):
    """What is to be done at a tick of the wall clock."""

    WAIT = enum.auto()
    OFFER_FIRST_MEASUREMENTS = enum.auto()
    START = enum.auto()
    CONTINUE = enum.auto()


class RunControl:
    """
    State of a run, and when it changes.

    :param now: wall time [s].
    :param autostart: whether the run starts by itself.
    """

    def __init__(self, now: float, autostart: bool) -> None:
        self.state = RunState.STARTING if autostart else RunState.HOLDING
        self.started_at = now
        self._ended_at: float | None = None
        self._offered_at = 0.0
        self._last_command_at = now

    def request_start(self, now: float) -> bool:
        """
        Start as soon as no commands come; return whether the run has not ended yet.

        :param now: wall time [s].
        """
        if self.state is RunState.HOLDING:
            self.state = RunState.STARTING
            self._last_command_at = now
        return self.state is not RunState.ENDED

    def on_command(self, now: float) -> None:
        """
        Note that a command has come.

        :param now: wall time [s].
        """
        self._last_command_at = now

    def tick(self, now: float) -> RunAction:
        """
        Decide what is to be done, and change the state accordingly.

        :param now: wall time [s].
        """
        if self.state is RunState.HOLDING and now - self._offered_at > OFFER_PERIOD:
            self._offered_at = now
            return RunAction.OFFER_FIRST_MEASUREMENTS
        if self.state is RunState.STARTING and now - self._last_command_at > QUIET_TIME:
            self.state = RunState.RUNNING
            self.started_at = now
            return RunAction.START
        return RunAction.CONTINUE if self.state is RunState.RUNNING else RunAction.WAIT

    def end(self, now: float) -> None:
        """
        End the run.

        :param now: wall time [s].
        """
        self.state = RunState.ENDED
        self._ended_at = now

    def duration(self, now: float) -> float:
        """
        Wall time from the start of the run to its end, or until now [s].

        :param now: wall time [s].
        """
        return (now if self._ended_at is None else self._ended_at) - self.started_at
