"""Friction that changes with time: patches of wet floor, a foot that catches."""

import dataclasses

from push_model.quantity import check, quantity

ALL = -1


@dataclasses.dataclass(frozen=True)
class FrictionChange:
    """While it lasts, the friction under one support, or under all, is multiplied."""

    start: float = quantity('when it begins', 's', 0.0)
    end: float = quantity('when it ends', 's', 0.0)
    factor: float = quantity('what friction is multiplied by', '', 0.0, 100.0)
    support: int = quantity('number of the support, -1 for all', '', ALL, default=ALL)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if self.end <= self.start:
            raise ValueError(f'FrictionChange.end: got {self.end:g} s, expected a time after the '
                             f'start, {self.start:g} s')


def friction_factors(changes, time, count):
    """
    Factor on the friction of every support; changes that overlap multiply.

    :param changes: ``FrictionChange`` sequence.
    :param time: now [s]; a change includes its start but not its end.
    :param count: number of supports.
    :return: tuple of ``count`` factors.
    :raises ValueError: where a change names a support that does not exist.
    """
    factors = [1.0] * count
    for change in changes:
        if change.support >= count:
            raise ValueError(f'FrictionChange.support: got {change.support}, expected -1 to '
                             f'{count - 1}')
        if change.start <= time < change.end:
            for i in range(count):
                if change.support in (ALL, i):
                    factors[i] *= change.factor
    return tuple(factors)


def change_times(changes):
    """
    List the times at which friction changes, sorted [s].

    :param changes: ``FrictionChange`` sequence.
    """
    return sorted({time for change in changes for time in (change.start, change.end)})
