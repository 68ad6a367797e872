"""Work beside a node: on threads, one thing after the other."""

from collections.abc import Callable
import contextlib
import threading


class Background:
    """Does one thing after the other, while the node goes on."""

    def __init__(self, name: str) -> None:
        """
        Start with nothing to do.

        :param name: of its threads.
        """
        self._name = name
        self._thread = threading.Thread()

    def start(self, action: Callable[[], object]) -> None:
        """
        Do something, behind what is under way.

        :param action: that compiles or loads; where it fails, so will whoever needs it, and says
            so.
        """
        previous = self._thread

        def run() -> None:
            if previous.is_alive():
                previous.join()
            with contextlib.suppress(Exception):
                action()
        self._thread = threading.Thread(target=run, name=self._name, daemon=True)
        self._thread.start()

    @property
    def is_busy(self) -> bool:
        """Tell whether something is being done."""
        return self._thread.is_alive()

    def wait(self, duration: float) -> None:
        """
        Wait until the last thing that was started is done.

        :param duration: for how long at most [s].
        """
        self._thread.join(duration)
