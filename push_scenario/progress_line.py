"""Progress of a run, in a line of a terminal or now and then in a log."""

from collections.abc import Callable
import math
from typing import TextIO, TYPE_CHECKING

from push_scenario.terminal_line import TerminalLine

if TYPE_CHECKING:
    from push_scenario.simulation.loop import Progress

# How often progress is shown: smoothly in a terminal, without flooding a log [s].
TERMINAL_PERIOD = 0.1
LOG_PERIOD = 5.0
# What a first run compiles and computes takes longer than this [s]; chosen.
HINT_DELAY = 5.0
# A ratio to wall time is shown once so much of it can be trusted [s].
MIN_TIMED = 0.2


class ProgressLine:
    """
    Shows the progress of a run: one line that is overwritten in a terminal, else a line at times.

    :param stream: where to write, such as ``sys.stderr``.
    :param clock: function that returns wall-clock seconds.
    :param title: what is running.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float], title: str) -> None:
        self._line = TerminalLine(stream)
        self._clock = clock
        self._title = title
        self._started = self._shown = clock()
        # Wall and simulated time when the latter began to run: until then, nodes start and plan.
        self._first: tuple[float, float] | None = None
        self._last_time = math.inf
        self._stage = ''

    def __call__(self, progress: 'Progress') -> None:
        """Show progress, unless something was shown a moment ago."""
        now = self._clock()
        if self._first is None and progress.time > self._last_time:
            self._first = now, progress.time
        self._last_time = progress.time
        period = TERMINAL_PERIOD if self._line.is_overwritten else LOG_PERIOD
        if progress.stage == self._stage and now - self._shown < period:
            return
        self._stage, self._shown = progress.stage, now
        self._line.write(f'{self._title}: {progress.stage}, {progress.time:.1f} s simulated'
                         f'{self._speed(progress.time, now)}, '
                         f'{progress.distance:.3f} m to the goal{self._hint(now)}')

    def end(self, text: str) -> None:
        """
        Write the last line.

        :param text: how it ended.
        """
        self._line.write(f'{self._title}: {text}, {self._clock() - self._started:.1f} s',
                         is_last=True)

    def _speed(self, time: float, now: float) -> str:
        if self._first is None or now - self._first[0] < MIN_TIMED:
            return ''
        return f' at {(time - self._first[1]) / (now - self._first[0]):.1f} x real time'

    def _hint(self, now: float) -> str:
        """Tell why nothing moves at first."""
        if self._first is not None or now - self._started < HINT_DELAY:
            return ''
        return ' (nodes start and plan; what is used for the first time is compiled: a minute)'
