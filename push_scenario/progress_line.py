"""Progress of a run, in a line of a terminal or now and then in a log."""

from collections.abc import Callable
import threading
from typing import TextIO, TYPE_CHECKING

from push_scenario.terminal_line import TerminalLine

if TYPE_CHECKING:
    from push_scenario.simulation.loop import Progress

# How often progress is shown: smoothly in a terminal, without flooding a log [s].
TERMINAL_PERIOD = 0.1
LOG_PERIOD = 5.0
# A ratio to wall time is shown once so much of it can be trusted [s].
MIN_TIMED = 0.2


class ProgressLine:
    """
    Shows the progress of a run: one line that is overwritten in a terminal, else a line at times.

    :param stream: where to write, such as ``sys.stderr``.
    :param clock: function that returns wall-clock seconds.
    :param title: what is running.
    :param preparation: returns what is made for the first time, such as ``compiling 37 of about
        125``; an empty text for nothing.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float], title: str,
                 preparation: Callable[[], str] = str) -> None:
        self._line = TerminalLine(stream)
        self._clock = clock
        self._title = title
        self._preparation = preparation
        self._lock = threading.Lock()
        self._started = self._shown = clock()
        # Wall and simulated time when the latter began to run: until then, nodes start and plan.
        self._first: tuple[float, float] | None = None
        self._progress: 'Progress | None' = None
        self._prepared = ''

    def __call__(self, progress: 'Progress') -> None:
        """Show progress, unless something was shown a moment ago."""
        with self._lock:
            now, before = self._clock(), self._progress
            if self._first is None and before is not None and progress.time > before.time:
                self._first = now, progress.time
            self._progress = progress
            self._show(now, self._prepared if self._first is None else '',
                       is_due=before is None or progress.stage != before.stage)

    def refresh(self) -> None:
        """Show what is being prepared, where that has changed: time may stand still for it."""
        with self._lock:
            prepared, self._prepared = self._prepared, self._preparation()
            if self._prepared != prepared:
                self._show(self._clock(), self._prepared, is_due=False)

    def end(self, text: str) -> None:
        """
        Write the last line.

        :param text: how it ended.
        """
        self._line.write(f'{self._title}: {text}, {self._clock() - self._started:.1f} s',
                         is_last=True)

    def _show(self, now: float, preparation: str, *, is_due: bool) -> None:
        period = TERMINAL_PERIOD if self._line.is_overwritten else LOG_PERIOD
        if self._progress is None or not is_due and now - self._shown < period:
            return
        self._shown = now
        stage, time, distance = self._progress
        text = preparation or (f'{time:.1f} s{self._speed(time, now)}, '
                               f'{distance:.3f} m to the goal')
        self._line.write(f'{self._title}: {stage}, {text}')

    def _speed(self, time: float, now: float) -> str:
        if self._first is None or now - self._first[0] < MIN_TIMED:
            return ''
        return f' at {(time - self._first[1]) / (now - self._first[0]):.1f} x real time'
