"""Ctrl-C that is not lost: compiled libraries may swallow or hide the exception that it raises."""

import signal
import threading


class Interrupts:
    """
    Remembers Ctrl-C while it is entered; ``check`` raises it again.

    Outside the main thread, where Python delivers no signals, it does nothing.
    """

    def __init__(self):
        """Nothing is remembered at first."""
        self._seen = False
        self._before = None

    def __enter__(self):
        """Take over the signal."""
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, kind, error, trace):
        """
        Give the signal back.

        :param kind: of the error that ends it, None for none.
        :param error: the error.
        :param trace: where it was raised.
        :raises KeyboardInterrupt: where a compiled library has made a SystemError of Ctrl-C.
        """
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        if self._seen and isinstance(error, SystemError):
            raise KeyboardInterrupt from error

    def check(self):
        """
        Raise what was swallowed.

        :raises KeyboardInterrupt: where Ctrl-C has come since the beginning.
        """
        if self._seen:
            raise KeyboardInterrupt

    def _note(self, number, frame):
        self._seen = True
        raise KeyboardInterrupt
