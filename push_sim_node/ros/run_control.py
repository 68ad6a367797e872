"""
States of a run: the simulator holds time, is about to start, runs, has ended.

``HOLDING -> STARTING -> RUNNING -> ENDED``, and from each of them back to the first by a reset.
Times are on the wall; they are arguments, so that a test needs no clock.
"""

import enum

# Period with which the first measurements are published while time is held [s], chosen: a
# controller that comes up late receives them soon.
OFFER_PERIOD = 0.1
# Time without an answer after which a run in lockstep starts [s], chosen as a few offers: answers
# to what was offered must not be taken for answers to what comes.
QUIET_TIME = 0.4
# Time after which it starts in any case [s], chosen as several times the one above: a controller
# may repeat a stop without end.
MAX_START = 2.0


class RunState(enum.Enum):
    """State of the simulator."""

    HOLDING = 'holding'
    STARTING = 'starting'
    RUNNING = 'running'
    ENDED = 'ended'


class RunAction(enum.Enum):
    """Action at a tick of the wall clock."""

    WAIT = enum.auto()
    OFFER_FIRST_MEASUREMENTS = enum.auto()
    START = enum.auto()
    CONTINUE = enum.auto()


class RunControl:
    """
    State of a run, and when it changes.

    :param now: wall time [s].
    :param autostart: whether the run starts by itself.
    :param quiet_time: how long no answer may have come before it starts [s].
    """

    def __init__(self, now: float, autostart: bool, quiet_time: float = 0.0) -> None:
        self.state = RunState.STARTING if autostart else RunState.HOLDING
        self.started_at = now
        self._quiet_time = quiet_time
        self._ended_at: float | None = None
        self._offered_at = 0.0
        self._requested_at = now
        self._last_answer_at = now

    def request_start(self, now: float) -> bool:
        """
        Start as soon as no answers come; return whether the run has not ended yet.

        :param now: wall time [s].
        """
        if self.state is RunState.HOLDING:
            self.state = RunState.STARTING
            self._requested_at = self._last_answer_at = now
        return self.state is not RunState.ENDED

    def on_answer(self, now: float) -> None:
        """
        Note that a command has come that may answer what was offered.

        :param now: wall time [s].
        """
        self._last_answer_at = now

    def tick(self, now: float) -> RunAction:
        """
        Decide what is to be done, and change the state accordingly.

        :param now: wall time [s].
        """
        if self.state is RunState.HOLDING and now - self._offered_at > OFFER_PERIOD:
            self._offered_at = now
            return RunAction.OFFER_FIRST_MEASUREMENTS
        if self.state is RunState.STARTING and self._may_start(now):
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

    def _may_start(self, now: float) -> bool:
        return (now - self._last_answer_at >= self._quiet_time
                or now - self._requested_at >= MAX_START)
