"""Outlook of a plan: how sure it is, how long everything takes, and how near the object ends."""

import dataclasses
import math
from typing import NamedTuple

# Shares of cases that the quantiles of an outlook cover.
LEVELS = (0.5, 0.9, 0.95, 0.99)


class Quantiles(NamedTuple):
    """
    Bounds of a quantity: each is kept by a share of the cases, as of ``LEVELS``.

    :param median: kept by one half.
    :param p90: kept by 90 %.
    :param p95: kept by 95 %.
    :param p99: kept by 99 %.
    """

    median: float
    p90: float
    p95: float
    p99: float

    def reduced(self, amount: float) -> 'Quantiles':
        """
        Subtract what has passed already; nothing falls below 0.

        :param amount: of the same unit.
        """
        return Quantiles(*(max(0.0, value - amount) for value in self))


# Quantities of an outlook, and the names of all its numbers.
QUANTITIES = 'time', 'position_error', 'heading_error'
OUTLOOK_NAMES = ('chance', *(f'{quantity}.{level}' for quantity in QUANTITIES
                             for level in Quantiles._fields))


@dataclasses.dataclass(frozen=True)
class Outlook:
    """
    What a plan states of the end; ``benchmarks/chances`` measures how true it is.

    Times and errors are those of runs that are reported as done.

    :param chance: to be done, with the object truly within its tolerances.
    :param time: from the plan to the end, ``Quantiles`` [s].
    :param position_error: distance of the object from its goal, ``Quantiles`` [m].
    :param heading_error: size of its heading error, ``Quantiles`` [rad].
    :raises ValueError: for a chance that is none, or quantiles that are negative or fall.
    """

    chance: float
    time: Quantiles
    position_error: Quantiles
    heading_error: Quantiles

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not 0.0 <= self.chance <= 1.0:
            raise ValueError(f'Outlook.chance: got {self.chance!r}, expected 0 to 1')
        for name in QUANTITIES:
            values = getattr(self, name)
            if not (values.median >= 0.0 and math.isfinite(values.p99)
                    and all(low <= high for low, high in zip(values, values[1:]))):
                raise ValueError(f'Outlook.{name}: got {tuple(values)}, expected finite numbers '
                                 'of at least 0 that do not fall')

    def __str__(self) -> str:
        """Say it in one clause: chance, and the median and 95 % of time and errors."""
        time, position, heading = self.time, self.position_error, self.heading_error
        return (f'{100.0 * self.chance:.0f} % to end within tolerance; median (95 %): '
                f'{time.median:.0f} ({time.p95:.0f}) s, '
                f'{1e3 * position.median:.1f} ({1e3 * position.p95:.1f}) mm, '
                f'{math.degrees(heading.median):.2f} ({math.degrees(heading.p95):.2f}) degrees')

    def later(self, elapsed_time: float) -> 'Outlook':
        """
        Tell what remains of it after a while.

        :param elapsed_time: since the plan [s].
        """
        return dataclasses.replace(self, time=self.time.reduced(elapsed_time))

    def values(self) -> dict[str, float]:
        """Name every number: ``chance``, ``time.median``, ..., ``heading_error.p99``."""
        return dict(zip(OUTLOOK_NAMES, (self.chance, *self.time, *self.position_error,
                                        *self.heading_error)))

    @classmethod
    def from_values(cls, values: dict[str, float]) -> 'Outlook':
        """
        Make an outlook of what ``values`` returns.

        :raises ValueError: as the class.
        """
        quantiles = {quantity: Quantiles(*(values[f'{quantity}.{level}']
                                           for level in Quantiles._fields))
                     for quantity in QUANTITIES}
        return cls(values['chance'], **quantiles)
