"""What the supervisor has done since the beginning, whatever goals came on the way."""

from push_control.task_status import Change


class TaskHistory:
    """Keeps every change of state, and counts recoveries, over all goals."""

    def __init__(self):
        """Begin with nothing seen."""
        self._changes, self._before, self._recoveries = [], 0, 0

    @property
    def changes(self):
        """Tuple of ``Change``."""
        return tuple(self._changes)

    @property
    def recoveries(self):
        """Number of times that something went wrong."""
        return self._before + self._recoveries

    def note(self, changes, recoveries):
        """
        Take in what the supervisor tells, again and again.

        :param changes: ``Change`` sequence, oldest first; those that are known are passed over.
        :param recoveries: number of recoveries since the present goal was set.
        """
        new = []
        for change in reversed(changes):
            if self._changes and Change(*change) == self._changes[-1]:
                break
            new.append(Change(*change))
        self._changes += reversed(new)
        if recoveries < self._recoveries:
            self._before += self._recoveries
        self._recoveries = recoveries
