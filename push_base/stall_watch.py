"""
A base that stands at an object although it is commanded: that is too heavy, or held up.

Fast commands that have no effect are noticed by the safety layer. Slow ones are within what it
tolerates of any base; over some time they show as well.
"""

from collections import deque
import math

from push_model.signals import Twist

# Time over which both are compared [s], and the ratio of what is driven to what is commanded below
# which the base stands; chosen: longer than dead times and pulses of bases, and less than what any
# base that moves keeps of its commands.
COMPARED_TIME = 0.8
MAX_STALL_RATIO = 0.1


class StallWatch:
    """Compares the speed of a base with its commands."""

    def __init__(self) -> None:
        """Start without a past."""
        # (time, distance commanded since the start, distance driven) [s], [m].
        self._rows: deque[tuple[float, float, float]] = deque()

    def add(self, time: float, command: Twist, measured: Twist) -> None:
        """
        Note a step; what the base moves across its command does not count.

        :param time: now [s].
        :param command: that was sent until now.
        :param measured: by odometry.
        """
        commanded = math.hypot(command.v_x, command.v_y)
        along = command.v_x * measured.v_x + command.v_y * measured.v_y
        speed = along / commanded if commanded > 0.0 else 0.0
        rows = self._rows
        if not rows:
            rows.append((time, 0.0, 0.0))
            return
        last_time, target, driven = rows[-1]
        dt = time - last_time
        rows.append((time, target + commanded * dt, driven + speed * dt))
        # The first that is older gives the distances at the start of the compared time.
        while rows[1][0] <= time - COMPARED_TIME:
            rows.popleft()

    @property
    def is_stalled(self) -> bool:
        """Tell whether it has hardly moved for as long as both are compared."""
        if len(self._rows) < 2 or self._rows[-1][0] - self._rows[0][0] < COMPARED_TIME:
            return False
        commanded, driven = (self._rows[-1][i] - self._rows[0][i] for i in (1, 2))
        return commanded > 0.0 and driven < MAX_STALL_RATIO * commanded
