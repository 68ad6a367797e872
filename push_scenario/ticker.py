"""Calls a function again and again, while something else keeps the main thread busy."""

from collections.abc import Callable
import threading
from types import TracebackType


class Ticker:
    """
    Calls a function in a thread of its own, within a ``with`` block.

    :param function: what to call; it shares with others only what it locks.
    :param period: time between two calls [s].
    """

    def __init__(self, function: Callable[[], None], period: float) -> None:
        self._function, self._period = function, period
        self._has_ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> 'Ticker':
        """Begin; the first call comes after a period."""
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """End, after the call that may be under way."""
        self._has_ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._has_ended.wait(self._period):
            self._function()
