"""How one run with a fault ended."""

import enum
from typing import NamedTuple

from benchmarks.faults.injection import Fault


class Ending(enum.Enum):
    """How a run ended."""

    DONE = 'done'
    FAILED = 'failed'
    # The robot stands, and says what for.
    WAITS = 'waits'


class Row(NamedTuple):
    """
    How a run with a fault ended.

    :param scenario: name of the scenario.
    :param fault: the ``Fault``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    :param is_explained: whether it is done in truth, or stands with a reason.
    :param stop_time: from the beginning of the fault until the robot first commands zero [s]; nan
        where it need not stop.
    :param driven: by the robot until then [m]; nan likewise.
    :param deviation: greatest distance of the object, after the beginning, from all that was
        planned for it [m].
    """

    scenario: str
    fault: Fault
    ending: Ending
    reason: str
    is_explained: bool
    stop_time: float
    driven: float
    deviation: float

    def __str__(self) -> str:
        """Write one line."""
        return (f'{self.scenario}, {self.fault}: {self.ending.value}'
                + (f', {self.reason}' if self.reason else '')
                + f' (stopped after {self.stop_time:.2f} s and {self.driven:.2f} m; object '
                f'{self.deviation:.2f} m beside its plans)'
                + ('' if self.is_explained else ' UNEXPLAINED'))
