"""State history of a run: every change of state, over all goals of a task."""

from collections.abc import Iterable

from push_control.task.status import StateChange, TaskState
from push_model.events import Codes
from push_scenario.simulation.result import Outcome


class StateHistory:
    """Collects state changes and recoveries from a supervisor that restarts at every goal."""

    def __init__(self) -> None:
        """Start with an empty history."""
        self._changes: list[StateChange] = []
        self._last: object = None
        self._earlier_recoveries = 0
        self._recoveries = 0

    @property
    def changes(self) -> tuple[StateChange, ...]:
        """All changes of state, oldest first."""
        return tuple(self._changes)

    @property
    def recoveries(self) -> int:
        """Number of recoveries over all goals."""
        return self._earlier_recoveries + self._recoveries

    def update(self, changes: Iterable[StateChange], recoveries: int) -> None:
        """
        Add what is new in a status; the same status may come any number of times.

        :param changes: changes since the present goal was set, oldest first; those that are
            known already are skipped.
        :param recoveries: number of recoveries since the present goal was set.
        """
        if changes is self._last and recoveries == self._recoveries:
            return
        self._last = changes
        new: list[StateChange] = []
        for change in reversed([StateChange(*change) for change in changes]):
            if self._changes and change == self._changes[-1]:
                break
            new.append(change)
        self._changes += reversed(new)
        # The supervisor counts from zero again once it has a new goal.
        if recoveries < self._recoveries:
            self._earlier_recoveries += self._recoveries
        self._recoveries = recoveries


def single_push_history(outcome: Outcome, reason: str, time: float,
                        codes: Codes = ()) -> tuple[StateChange, ...]:
    """
    Write the history of a single push as that of a task with one push.

    :param outcome: how it ended.
    :param reason: why, one sentence.
    :param time: when [s].
    :param codes: of the reason, as of ``Report``.
    """
    start = StateChange(0.0, TaskState.PUSH, '')
    if outcome is Outcome.TIME_LIMIT:
        return (start,)
    return start, StateChange(time, TaskState(outcome.value), reason, codes=codes)
