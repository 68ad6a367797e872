"""One measurement in flight: which command answers it, and when to send it again."""

RESEND_PERIOD = 0.2


class MeasurementExchange:
    """
    Matches commands to measurements.

    The stamp of a command is that of the measurement that it answers. An object pose and odometry
    may have the same stamp, and commands may have none; so where a measurement was sent twice,
    its second answer must not count for the next one.

    :param answer_timeout: wall time without an answer after which the controller is gone [s].
    :param stamped: whether commands have stamps.
    """

    def __init__(self, answer_timeout, stamped=True):
        self._timeout, self._stamped = answer_timeout, stamped
        self._stamp = None
        self._copies = self._stale = 0
        self._ignored = False
        self._first = self._last = 0.0

    def sent(self, stamp, now):
        """
        Note a new measurement.

        :param stamp: its stamp [ns].
        :param now: wall time [s].
        """
        leftover = self._stale + max(0, self._copies - 1)
        self._stale = leftover if stamp == self._stamp or not self._stamped else 0
        self._stamp, self._copies, self._ignored = stamp, 1, False
        self._first = self._last = now

    def resent(self, now):
        """
        Note that the measurement was sent once more.

        :param now: wall time [s].
        """
        # What was ignored was an answer to the copy before: an older one must have been lost.
        self._copies += 0 if self._ignored else 1
        self._ignored = False
        self._last = now

    def is_answer(self, stamp):
        """
        Tell whether a command answers the measurement in flight.

        :param stamp: of the command [ns]; None for a command without a stamp.
        """
        if stamp is not None and stamp != self._stamp:
            return False
        if self._stale:
            self._stale -= 1
            self._ignored = True
            return False
        return True

    def is_resend_due(self, now):
        """
        Tell whether to send the measurement again.

        :param now: wall time [s].
        """
        return now - self._last >= RESEND_PERIOD

    def is_abandoned(self, now):
        """
        Tell whether nobody answers any more.

        :param now: wall time [s].
        """
        return now - self._first >= self._timeout
