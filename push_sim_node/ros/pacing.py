"""
Simulated time against the wall clock: when a measurement is due, and how fast time runs.

A simulator that could not go on for a while does not make up for it: its time would run faster
than the robot's controller was made for. Times on the wall are arguments, so that a test needs no
clock.
"""

# Delay that is made up for [s], chosen: what timers and a busy machine do to single measurements,
# so that the rate is right on average.
JITTER = 0.05
# Delay beyond which stamps on the wall clock are moved on [s], chosen: the process was suspended.
# After shorter ones stamps stay behind while something moves: a machine that is too slow would
# else let measurements look as if the robot stood still between them, and as if they were too old.
SUSPENSION = 0.5
# Time by which stamps that are behind are moved on at each measurement at rest [s]; chosen: at
# 50 Hz twice as fast as the wall, and no object pose gets too old by it.
CATCH_UP = 0.02
# Wall time over which the speed of time is measured [s], chosen: a person sees it change, and
# jitter does not show.
SPEED_WINDOW = 2.0
# Ratio of the speed of time to what was asked for below which it counts as too slow, and from
# which on as right again; chosen apart, so that it does not change all the time.
SLOW_RATIO = 0.9
RIGHT_RATIO = 0.95


class Pacer:
    """
    Says when a simulated time is due.

    :param scale: simulated time per wall time.
    :param now: wall time at which simulated time is 0 [s].
    """

    def __init__(self, scale: float, now: float) -> None:
        self._scale = scale
        self._anchor = (0.0, now)

    @property
    def scale(self) -> float:
        """Simulated time per wall time that is asked for."""
        return self._scale

    def set_scale(self, scale: float, now: float) -> None:
        """
        Go on at another pace.

        :param scale: simulated time per wall time.
        :param now: wall time [s].
        """
        self._anchor = (self.time(now), now)
        self._scale = scale

    def due(self, time: float) -> float:
        """
        Compute the wall time at which a simulated time is due [s].

        :param time: simulated time [s].
        """
        simulated, wall = self._anchor
        return wall + (time - simulated) / self._scale

    def time(self, now: float) -> float:
        """
        Compute the simulated time that is due [s].

        :param now: wall time [s].
        """
        simulated, wall = self._anchor
        return simulated + (now - wall) * self._scale

    def reached(self, time: float, now: float) -> float:
        """
        Note which simulated time was reached; a delay above jitter is dropped.

        :param time: simulated time [s].
        :param now: wall time [s].
        :return: the delay that was dropped, on the wall [s].
        """
        delay = now - self.due(time)
        if delay <= JITTER:
            return 0.0
        self._anchor = (time, now)
        return delay


class StampLag:
    """
    How far stamps on the wall clock are behind it, as simulated time has run too slowly.

    They catch up where that does not matter: while nothing moves.

    ``time``: how far they are behind [s].
    """

    def __init__(self) -> None:
        """Start with stamps that are right."""
        self.time = 0.0

    def update(self, delay: float, *, is_at_rest: bool) -> float:
        """
        Take note of a measurement.

        :param delay: by which it has come too late, as of ``Pacer.reached`` [s].
        :param is_at_rest: whether nothing moves.
        :return: by how much to move stamps on from now on [s].
        """
        if delay > SUSPENSION:
            return delay
        self.time += delay
        step = min(self.time, CATCH_UP) if is_at_rest else 0.0
        self.time -= step
        return step


class SpeedMeter:
    """
    Measures how fast simulated time runs, over one window after the other.

    ``speed``: simulated time per wall time over the last window, None before its end.
    ``is_slow``: whether that was below what was asked for.

    :param now: wall time at the start [s].
    """

    def __init__(self, now: float) -> None:
        self.restart(0.0, now)

    def restart(self, time: float, now: float) -> None:
        """
        Measure anew, as another speed is asked for.

        :param time: simulated time [s].
        :param now: wall time [s].
        """
        self.speed: float | None = None
        self.is_slow = False
        self._start = (time, now)

    def update(self, time: float, now: float, scale: float) -> bool:
        """
        Note the simulated time; return whether a window has ended.

        :param time: simulated time [s].
        :param now: wall time [s].
        :param scale: speed that is asked for.
        """
        simulated, wall = self._start
        if now - wall < SPEED_WINDOW:
            return False
        self.speed = (time - simulated) / (now - wall)
        self.is_slow = self.speed < scale * (RIGHT_RATIO if self.is_slow else SLOW_RATIO)
        self._start = (time, now)
        return True
