"""Disturbances of a push: friction that changes with time, and an object that is displaced."""

import dataclasses
from typing import Sequence

from push_model.geometry import Pose
from push_model.quantity import check, MAX_ANGLE, quantity

# In place of the number of a support.
ALL_SUPPORTS = -1
# Times of a simulation are whole nanoseconds: so many in a second.
NANOSECONDS = 1_000_000_000


@dataclasses.dataclass(frozen=True)
class FrictionChange:
    """While it lasts, the friction under one support, or under all, is multiplied."""

    start: float = quantity('time at which the friction changes', 's', 0.0)
    end: float = quantity('time at which the friction is as before again', 's', 0.0)
    factor: float = quantity('factor by which the friction is multiplied', '', 0.0, 100.0)
    support: int = quantity('number of the support, -1 for all', '', ALL_SUPPORTS,
                            default=ALL_SUPPORTS)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.end <= self.start:
            raise ValueError(f'FrictionChange.end: got {self.end:g} s, expected a time after the '
                             f'start, {self.start:g} s')


@dataclasses.dataclass(frozen=True)
class ObjectDisplacement:
    """A person moves the object, at once; it is at rest afterwards."""

    time: float = quantity('time of the displacement', 's', 0.0)
    x: float = quantity('displacement along the x axis that the object has before', 'm',
                        default=0.0)
    y: float = quantity('displacement along the y axis that the object has before', 'm',
                        default=0.0)
    theta: float = quantity('angle by which the object is rotated', 'rad', -MAX_ANGLE, MAX_ANGLE,
                            default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def relative_pose(self) -> Pose:
        """``Pose`` of the object afterwards, relative to the one before."""
        return Pose(self.x, self.y, self.theta)


def friction_factors(changes: Sequence[FrictionChange], time: float,
                     count: int) -> tuple[float, ...]:
    """
    Compute the factor on the friction of every support; changes that overlap multiply.

    :param changes: ``FrictionChange`` sequence.
    :param time: now [s]; a change includes its start but not its end, both in whole nanoseconds,
        as the times of a simulation.
    :param count: number of supports.
    :return: tuple of ``count`` factors.
    :raises ValueError: where a change names a support that does not exist.
    """
    factors = [1.0] * count
    now = round(NANOSECONDS * time)
    for change in changes:
        if change.support >= count:
            raise ValueError(f'FrictionChange.support: got {change.support}, expected -1 to '
                             f'{count - 1}')
        if round(NANOSECONDS * change.start) <= now < round(NANOSECONDS * change.end):
            for i in range(count):
                if change.support in (ALL_SUPPORTS, i):
                    factors[i] *= change.factor
    return tuple(factors)


def change_times(changes: Sequence[FrictionChange]) -> list[float]:
    """
    List the times at which friction changes, sorted [s].

    :param changes: ``FrictionChange`` sequence.
    """
    return sorted({time for change in changes for time in (change.start, change.end)})
