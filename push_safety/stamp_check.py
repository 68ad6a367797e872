"""
First check: stamps against the present time. Those that are off are refused.

Odometry sets the time: object poses are compared with it. Odometry that is off is refused as well,
and the robot is stopped: a clock that has jumped may come back. Only where its messages go on at
another time for a while has time itself changed: back, as with a simulator that was started again,
or ahead, as where a clock was set. One that starts again where it has started, or the clock of a
simulator at zero, counts at once.
"""

import enum

from push_safety.tolerances import AGREEING_MESSAGES, MAX_STAMP_OFFSET, NEW_CLOCK_TIME

# How much quicker than a steady clock, and than odometry has come before, time may pass between
# two messages; chosen: real time passes as quickly, and simulated time in small steps.
TIME_RATIO = 2.0
# Start of odometry from which on its clock is that of a computer, which counts from 1970 [s];
# chosen: three years, which no simulator counts from zero. Stamps near zero are then those of
# somebody who has no clock, for a while or for good.
COMPUTER_TIME = 1e8


class StampVerdict(enum.Enum):
    """Verdict on the stamp of a message."""

    ACCEPTED = 'accepted'
    REFUSED = 'refused'
    # Accepted, as time has changed; everything before it is of another time where it went back.
    TIME_WENT_BACK = 'time went back'
    TIME_WENT_AHEAD = 'time went ahead'


class StampCheck:
    """
    Compares stamps with the time of odometry, and that with a steady clock.

    ``ahead``: by how much time last went ahead, beside what has passed on the steady clock [s].
    """

    def __init__(self) -> None:
        """Start before the first message."""
        self.ahead = 0.0
        # Stamp of the newest odometry, and when it came on the steady clock [s]; stamp of the
        # first one, and time between the last two [s].
        self._time: float | None = None
        self._received = 0.0
        self._first = 0.0
        self._period = 0.0
        # Odometry that was refused since: how many, and those of them that agree [s].
        self._refused = 0
        self._agreeing = 0
        self._candidate = self._first_candidate = 0.0

    def check_odometry(self, stamp: float, now: float) -> StampVerdict:
        """
        Check a stamp of odometry.

        :param stamp: of the message [s].
        :param now: on a steady clock [s].
        """
        before = self._time
        if before is None or self._is_near(stamp, now) and not self._is_of_other_time(stamp):
            return self._accept(stamp, now)
        self._refused += 1
        self._add_candidate(stamp)
        if not self._has_time_changed():
            return StampVerdict.REFUSED
        went_back = self._first_candidate < before
        self.ahead = max(0.0, stamp - before - (now - self._received))
        self._time = None
        self._accept(stamp, now)
        return StampVerdict.TIME_WENT_BACK if went_back else StampVerdict.TIME_WENT_AHEAD

    def _is_of_other_time(self, stamp: float) -> bool:
        """Tell whether a stamp goes on from refused ones, which have caught up meanwhile."""
        return (self._agreeing >= AGREEING_MESSAGES
                and 0.0 <= stamp - self._candidate <= MAX_STAMP_OFFSET)

    def _add_candidate(self, stamp: float) -> None:
        """Count messages in a row that agree on another time, in which time passes."""
        if self._agreeing > 0 and stamp == self._candidate:
            return
        if self._agreeing > 0 and 0.0 < stamp - self._candidate <= MAX_STAMP_OFFSET:
            self._agreeing += 1
        else:
            self._agreeing, self._first_candidate = 1, stamp
        self._candidate = stamp

    def _has_time_changed(self) -> bool:
        starts = (self._first, 0.0) if self._first < COMPUTER_TIME else (self._first,)
        has_restarted = any(
            abs(self._first_candidate - start) < MAX_STAMP_OFFSET for start in starts)
        return self._agreeing >= AGREEING_MESSAGES and (
            has_restarted or self._candidate - self._first_candidate >= NEW_CLOCK_TIME)

    def check_pose(self, stamp: float, now: float) -> StampVerdict:
        """
        Check a stamp of an object pose.

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
        elapsed = max(0.0, now - self._received, self._refused * self._period)
        difference = self.difference(stamp)
        return -MAX_STAMP_OFFSET <= difference <= MAX_STAMP_OFFSET + TIME_RATIO * elapsed

    def _accept(self, stamp: float, now: float) -> StampVerdict:
        if self._time is None:
            self._first = stamp
        elif stamp > self._time and not self._refused:
            self._period = min(stamp - self._time, MAX_STAMP_OFFSET)
        if self._time is None or stamp > self._time:
            self._time, self._received = stamp, now
        self._refused = self._agreeing = 0
        return StampVerdict.ACCEPTED
