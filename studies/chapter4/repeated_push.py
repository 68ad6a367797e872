"""Pushes that are repeated with other random numbers, and how far from the goal they end."""

import dataclasses
from typing import Any, NamedTuple, Protocol, Sequence

import numpy as np
from push_model.geometry import FloatArray
from push_sim_node.disturbance import FrictionChange
from scipy.stats import binom
from studies.chapter4.setup import Law, PushSetup, simulated, total_variation
from studies.chapter4.support_friction import gaussian_friction
from studies.framework.parameters import Values
from studies.framework.study import Finding, Record, RunJobs, Table

# Measured: one push takes a third of a second to one second [s].
JOB_TIME = 0.5
# Chosen: longer than any of the pushes [s].
DISTURBED_TIME = 60.0
COLUMNS = ('position_error_m', 'heading_error_rad', 'duration_s', 'variation_rad')
CONFIDENCE = 0.95


class FrictionSource(Protocol):
    """Gives the changes of the friction of one push; it can be pickled."""

    def __call__(self, seed: int, /) -> tuple[FrictionChange, ...]:
        """
        Draw the changes.

        :param seed: of the push.
        :return: all changes.
        """
        ...


@dataclasses.dataclass(frozen=True)
class GaussianFriction:
    """
    Random friction of every support, again and again; a ``FrictionSource``.

    :param deviation: standard deviation over the nominal friction.
    :param period: between draws [s].
    :param supports: number of support points.
    """

    deviation: float
    period: float
    supports: int

    def __call__(self, seed: int, /) -> tuple[FrictionChange, ...]:
        """Draw the changes; see ``gaussian_friction``."""
        return gaussian_friction(seed, self.deviation, self.period, DISTURBED_TIME, self.supports)


@dataclasses.dataclass(frozen=True)
class RepeatedPush:
    """
    A push that is repeated: with other errors of the sensors, and other changes of the friction.

    A job is a dict with ``law`` and ``seed``. A record has the columns ``COLUMNS``.

    :param setup: what is pushed.
    :param goal: (x, y, theta) [m, rad].
    :param friction: gives the changes of the friction of a push.
    """

    setup: PushSetup
    goal: tuple[float, ...]
    friction: FrictionSource

    @classmethod
    def of_gaussian(cls, values: Values) -> 'RepeatedPush':
        """
        Make a push of the box on random friction.

        :param values: with ``goal``, ``deviation``, ``period`` and the parameters of the setup.
        :return: the push.
        """
        setup = PushSetup.of(values)
        return cls(setup, tuple(values.goal), GaussianFriction(
            values.deviation, values.period, len(setup.object.supports)))

    def __call__(self, job: dict[str, Any]) -> Record:
        """
        Execute one push.

        :param job: see above.
        :return: its record.
        """
        executed = simulated(self.setup, self.goal, job['law'], self.friction(job['seed']),
                             job['seed'])
        return dict(zip(COLUMNS, (executed.position_error, executed.heading_error,
                                  executed.duration, total_variation(executed.path))))


def repeat(repeated: RepeatedPush, laws: Sequence[Law], count: int, run_jobs: RunJobs) -> Table:
    """
    Repeat a push under every law, with the same random numbers for all.

    :param repeated: the push.
    :param laws: control laws.
    :param count: number of pushes under each.
    :param run_jobs: of the study.
    :return: table with the column ``seed`` and, for every law, its name before each of
        ``COLUMNS``.
    """
    jobs = [{'law': law, 'seed': seed} for seed in range(count) for law in laws]
    records = run_jobs(repeated, jobs, job_time=JOB_TIME)
    table: Table = {'seed': np.arange(count)}
    for index, law in enumerate(laws):
        table.update((f'{law}_{column}',
                      np.array([record[column] for record in records[index::len(laws)]]))
                     for column in COLUMNS)
    return table


class MedianInterval(NamedTuple):
    """
    A median, and an interval that covers that of the population.

    :param median: of the sample.
    :param low: lower end.
    :param high: upper end.
    :param confidence: probability of covering: ``CONFIDENCE`` or more, less only of fewer than
        six samples.
    """

    median: float
    low: float
    high: float
    confidence: float


def median_interval(sample: FloatArray) -> MedianInterval:
    """
    Bound the median of a population by order statistics of a sample.

    :param sample: shape (n,).
    :return: median and interval; the whole range of samples of fewer than six.
    """
    # Ranks between which a binomial variable with probability 1/2 lies.
    ranks = binom.interval(CONFIDENCE, len(sample), 0.5)
    low, high = max(0, int(ranks[0]) - 1), min(len(sample) - 1, int(ranks[1]))
    ranked = np.sort(sample)
    # So many of the samples are below the median: more than those before low, at most high.
    confidence = float(np.diff(binom.cdf([low, high], len(sample), 0.5))[0])
    return MedianInterval(float(np.median(sample)), float(ranked[low]), float(ranked[high]),
                          confidence)


def median_findings(name: str, sample: FloatArray, unit: str,
                    meaning: str) -> dict[str, Finding]:
    """
    State a median and its interval as findings.

    :param name: of the median; its ends have ``_low`` and ``_high`` behind it.
    :param sample: shape (n,).
    :param unit: of the sample.
    :param meaning: of the median.
    :return: three findings.
    """
    interval = median_interval(sample)
    return {name: Finding(interval.median, unit, meaning),
            f'{name}_low': Finding(interval.low, unit, 'lower end of its 95 % interval'),
            f'{name}_high': Finding(interval.high, unit, 'upper end')}
