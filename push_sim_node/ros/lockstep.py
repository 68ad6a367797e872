"""
The measurement in flight: which command answers it, and when to send it again.

In lockstep simulated time waits for the command that answers the last measurement. Messages may
be lost, so that a measurement is sent again after a while; then two answers may come for one.
"""

# Wall time without an answer after which a measurement is sent again [s], chosen: long against
# the milliseconds that an answer takes, short against what a person notices.
RESEND_PERIOD = 0.2


class MeasurementExchange:
    """
    Matches commands to measurements.

    The stamp of a command is that of the measurement that it answers. An object pose and odometry
    may have the same stamp, and commands may have none; therefore, where a measurement was sent
    twice, its second answer must not count for the next one.

    :param answer_timeout: wall time without an answer after which the controller is gone [s].
    :param stamped: whether commands have stamps.
    """

    def __init__(self, answer_timeout: float, stamped: bool = True) -> None:
        self._timeout = answer_timeout
        self._stamped = stamped
        self._stamp: int | None = None
        # How often the present measurement was sent, as far as an answer may still come.
        self._copies = 0
        # Answers to former measurements that may still come.
        self._stale = 0
        # Whether an answer was ignored since the measurement was last sent.
        self._ignored = False
        self._first_sent = 0.0
        self._last_sent = 0.0

    def sent(self, stamp: int, now: float) -> None:
        """
        Note that a new measurement was sent.

        :param stamp: its stamp [ns].
        :param now: wall time [s].
        """
        leftover = self._stale + max(0, self._copies - 1)
        self._stale = leftover if stamp == self._stamp or not self._stamped else 0
        self._stamp = stamp
        self._copies = 1
        self._ignored = False
        self._first_sent = now
        self._last_sent = now

    def resent(self, now: float) -> None:
        """
        Note that the measurement was sent once more.

        :param now: wall time [s].
        """
        # What was ignored was an answer to the copy before: an older one must have been lost.
        self._copies += 0 if self._ignored else 1
        self._ignored = False
        self._last_sent = now

    def is_answer(self, stamp: int | None) -> bool:
        """
        Return whether a command answers the measurement in flight.

        :param stamp: of the command [ns]; None for a command without a stamp.
        """
        if stamp is not None and stamp != self._stamp:
            return False
        if self._stale:
            self._stale -= 1
            self._ignored = True
            return False
        return True

    def is_resend_due(self, now: float) -> bool:
        """
        Return whether to send the measurement again.

        :param now: wall time [s].
        """
        return now - self._last_sent >= RESEND_PERIOD

    def is_abandoned(self, now: float) -> bool:
        """
        Return whether no answer is to be expected any more.

        :param now: wall time [s].
        """
        return now - self._first_sent >= self._timeout
