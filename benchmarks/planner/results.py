"""What the planner's benchmark measures, as its report reads it."""

from typing import NamedTuple

from benchmarks.planner.measure import Answer
from benchmarks.planner.random_starts import Quality
from benchmarks.planner.sites import Choice


class WarmStart(NamedTuple):
    """
    A push planned from nothing, and from the plan before.

    :param first: CPU time from nothing [s].
    :param on: CPU time from the plan before [s].
    :param duration: time of the push over that from nothing.
    :param went_on: whether the plan before led to it.
    """

    first: float
    on: float
    duration: float
    went_on: bool


class Results(NamedTuple):
    """
    All measurements.

    :param kinds: name -> ``Answer`` of each push.
    :param first: CPU time of the first plan [s].
    :param warm_starts: what has changed -> per goal, ``WarmStart``.
    :param quality: name -> ``Quality`` of each push.
    :param starts: number of random starts.
    :param sites: name of a drive -> ``Choice`` of each goal.
    :param growth: (what, number, CPU times [s]).
    """

    kinds: dict[str, list[Answer]]
    first: float
    warm_starts: dict[str, list[WarmStart]]
    quality: dict[str, list[Quality]]
    starts: int
    sites: dict[str, list[Choice]]
    growth: list[tuple[str, int, list[float]]]
