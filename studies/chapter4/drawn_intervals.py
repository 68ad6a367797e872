"""Disturbances of one side of the box that are drawn: side, factor, start and interval."""

import dataclasses
from typing import NamedTuple

import numpy as np
from push_sim_node.disturbance import FrictionChange
from studies.chapter4.setup import TIME_LIMIT
from studies.chapter4.support_friction import friction_interval, SIDES
from studies.framework.parameters import Parameter, Values

DRAWN = (Parameter('factors', '', 'least and greatest factor on the friction of one side'),
         Parameter('start_times', 's', 'earliest and latest start of a disturbance'),
         Parameter('intervals', 's', 'shortest and longest temporary disturbance; without effect '
                   'on sustained ones'),
         Parameter('seeds', '', 'number of drawn disturbances, each for every law'))


class Interval(NamedTuple):
    """
    A disturbance of one side.

    :param side: one of ``SIDES``.
    :param factor: on the friction of its support points.
    :param start: of the disturbance [s].
    :param duration: of a temporary one [s].
    """

    side: str
    factor: float
    start: float
    duration: float


@dataclasses.dataclass(frozen=True)
class DrawnIntervals:
    """
    Draws a disturbance for each seed; a ``FrictionSource``.

    A temporary and a sustained one with the same seed differ by their end alone.

    :param factors: range of the factor.
    :param start_times: range of the start [s].
    :param durations: range of the duration [s].
    :param is_sustained: whether disturbances last until after the push.
    """

    factors: tuple[float, float]
    start_times: tuple[float, float]
    durations: tuple[float, float]
    is_sustained: bool

    @classmethod
    def of(cls, values: Values, is_sustained: bool) -> 'DrawnIntervals':
        """
        Take the ranges of a study.

        :param values: with the parameters ``DRAWN``.
        :param is_sustained: whether disturbances last until after the push.
        :return: the disturbances.
        """
        return cls(tuple(values.factors), tuple(values.start_times), tuple(values.intervals),
                   is_sustained)

    def interval(self, seed: int) -> Interval:
        """
        Draw a disturbance, uniformly from each range.

        :param seed: of the draw.
        :return: the disturbance.
        """
        rng = np.random.default_rng(seed)
        side = tuple(SIDES)[int(rng.integers(len(SIDES)))]
        return Interval(side, *(float(rng.uniform(*ends)) for ends in (
            self.factors, self.start_times, self.durations)))

    def __call__(self, seed: int, /) -> tuple[FrictionChange, ...]:
        """Draw the changes of the friction of a push."""
        side, factor, start, duration = self.interval(seed)
        return friction_interval(side, factor, start,
                                 start + (TIME_LIMIT if self.is_sustained else duration))
