"""Ctrl-C that is not lost: compiled libraries may swallow or hide the exception that it raises."""

from collections.abc import Callable
import signal
import threading
from types import FrameType, TracebackType
from typing import Any, TypeVar

Self = TypeVar('Self', bound='Interrupts')


class Interrupts:
    """
    Remembers Ctrl-C while it is entered; ``check`` raises it again.

    Outside the main thread, where Python delivers no signals, it does nothing. Within it, Ctrl-C
    counts also where the process was started with the signal ignored, as a shell does for what
    runs in its background.
    """

    def __init__(self) -> None:
        """Start with nothing remembered."""
        self._has_come = False
        self._before: Callable[[int, FrameType | None], Any] | int | None = None

    def __enter__(self: Self) -> Self:
        """Take over the signal."""
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._handle)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """
        Give the signal back.

        :param kind: of the error that ends it, None for none.
        :param error: the error.
        :param trace: where it was raised.
        :raises KeyboardInterrupt: where a compiled library has made a SystemError of Ctrl-C.
        """
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        if self._has_come and isinstance(error, SystemError):
            raise KeyboardInterrupt from error

    def check(self) -> None:
        """
        Raise what was swallowed.

        :raises KeyboardInterrupt: where Ctrl-C has come since the start.
        """
        if self._has_come:
            raise KeyboardInterrupt

    def _handle(self, signum: int, frame: FrameType | None) -> None:
        self._has_come = True
        raise KeyboardInterrupt
