"""
Do stamps belong to the present: single ones that are off are refused.

Odometry sets the time: object poses are compared with it. Odometry that is off is refused as well,
unless some messages in a row agree with each other: then time has gone back, as with a simulator
that was put back to its start, or has jumped ahead, as when a clock is set.
"""

import enum

# Difference between a stamp and the time of odometry that is off [s]; chosen: longer than any
# latency.
MAX_DIFFERENCE = 1.0
# How much quicker than a steady clock time may pass between two messages; chosen: real time passes
# as quickly, and simulated time in small steps.
TIME_RATIO = 2.0
# Odometry messages in a row that agree with each other; chosen: no two accidents do.
AGREEING_COUNT = 3


class StampVerdict(enum.Enum):
    """What is to be done with a message."""

    ACCEPTED = 'accepted'
    REFUSED = 'refused'
    # Accepted, but everything before it is of another time.
    TIME_WENT_BACK = 'time went back'


class StampCheck:
    """Compares stamps with the time of odometry, and that with a steady clock."""

    def __init__(self) -> None:
        """Begin before the first message."""
        # Stamp of the newest odometry, and when it came on the steady clock [s].
        self._time: float | None = None
        self._received = 0.0
        # Stamp of odometry that was refused last, and how many in a row agree [s].
        self._candidate = 0.0
        self._agreeing = 0

    def check_odometry(self, stamp: float, now: float) -> StampVerdict:
        """
        Judge a stamp of odometry.

        :param stamp: of the message [s].
        :param now: on a steady clock [s].
        """
        if self._time is None or self._is_near(stamp, now):
            return self._accept(stamp, now)
        agrees = self._agreeing > 0 and 0.0 <= stamp - self._candidate <= MAX_DIFFERENCE
        self._agreeing = self._agreeing + 1 if agrees else 1
        self._candidate = stamp
        if self._agreeing < AGREEING_COUNT:
            return StampVerdict.REFUSED
        went_back = stamp < self._time
        self._time = None
        self._accept(stamp, now)
        return StampVerdict.TIME_WENT_BACK if went_back else StampVerdict.ACCEPTED

    def check_pose(self, stamp: float, now: float) -> StampVerdict:
        """
        Judge a stamp of an object pose.

        :param stamp: of the message [s].
        :param now: on a steady clock [s].
        """
        is_accepted = self._time is None or self._is_near(stamp, now)
        return StampVerdict.ACCEPTED if is_accepted else StampVerdict.REFUSED

    def difference(self, stamp: float) -> float:
        """
        Compare a stamp with the time of odometry.

        :param stamp: of a message [s].
        :return: by how much it is later [s]; 0 before the first odometry.
        """
        return 0.0 if self._time is None else stamp - self._time

    def _is_near(self, stamp: float, now: float) -> bool:
        elapsed = max(0.0, now - self._received)
        difference = self.difference(stamp)
        return -MAX_DIFFERENCE <= difference <= MAX_DIFFERENCE + TIME_RATIO * elapsed

    def _accept(self, stamp: float, now: float) -> StampVerdict:
        if self._time is None or stamp > self._time:
            self._time, self._received = stamp, now
        self._agreeing = 0
        return StampVerdict.ACCEPTED
