"""An identified number and its interval of confidence."""

from typing import NamedTuple


class Interval(NamedTuple):
    """
    An identified number.

    :param value: best estimate.
    :param low: lower end of its interval.
    :param high: upper end.
    """

    value: float
    low: float
    high: float

    def covers(self, truth: float) -> bool:
        """Return whether a number lies in the interval."""
        return self.low <= truth <= self.high
