"""
Outlook of plans, by what ``python -m benchmarks.chances`` has measured.

Quantiles q of times are lines of the time t that a plan expects, and of the narrowness n of the
tolerances of a task, fitted by quantile regression (Koenker and Bassett 1978):

    time_q = max(0, a_q + b_q t + c_q n).

Quantiles of the errors of a task are in proportion to what the noise of poses leaves of its
tolerances, and at most these. Those of a steered push are constant. The coefficients stand in
``outlook.json``, which the benchmark writes.
"""

import functools
import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from push_model.outlook import LEVELS, Outlook, Quantiles, QUANTITIES
from push_model.plan_request import GoalTolerances, HEADING_TOLERANCE, POSITION_TOLERANCE

# Names of the models.
OPEN_FLOOR, MAP, STEERED_PUSH = 'open_floor', 'map', 'steered_push'
# Part of the usual tolerances that the interval of an average takes up; chosen, by the errors of
# tasks within 3 to 20 mm.
NOISE_PART = 0.25
COEFFICIENTS = Path(__file__).with_name('outlook.json')


class TimeQuantiles(NamedTuple):
    """
    Quantiles of times, each a line of expected time and narrowness.

    :param offsets: a_q of each level of ``LEVELS`` [s].
    :param slopes: b_q of each.
    :param narrow_slopes: c_q of each [s]; 0 in a steered push.
    """

    offsets: tuple[float, ...]
    slopes: tuple[float, ...]
    narrow_slopes: tuple[float, ...]

    def at(self, expected_time: float, narrowness: float = 0.0) -> Quantiles:
        """
        Evaluate the lines; a higher level is never below a lower one.

        :param expected_time: t [s].
        :param narrowness: n.
        """
        lines = (np.array(self.offsets) + np.array(self.slopes) * expected_time
                 + np.array(self.narrow_slopes) * narrowness)
        return Quantiles(*np.maximum.accumulate(np.maximum(lines, 0.0)).tolist())


class OutlookModel(NamedTuple):
    """
    Model of the end of one sort of plans.

    :param chance: to be done within the tolerances; in a steered push to be done at all.
    :param retry_chance: the same after attempts that brought the object no nearer to its goal.
    :param time: ``TimeQuantiles``.
    :param position_error: ``Quantiles`` of the distance from the goal: in a task over the
        ``usable_tolerances``, in a steered push as it is [m].
    :param heading_error: likewise of the size of the heading error [rad].
    """

    chance: float
    retry_chance: float
    time: TimeQuantiles
    position_error: Quantiles
    heading_error: Quantiles

    def of_task(self, expected_time: float, tolerances: GoalTolerances, *,
                is_retry: bool) -> Outlook:
        """State how a task ends; parameters are those of ``task_outlook``."""
        usable = usable_tolerances(tolerances)
        return Outlook(
            self.retry_chance if is_retry else self.chance,
            self.time.at(expected_time, narrowness(tolerances)),
            _scaled(self.position_error, usable.position, tolerances.position),
            _scaled(self.heading_error, usable.heading, min(math.pi, tolerances.heading)))

    def of_push(self, duration: float, tolerances: GoalTolerances) -> Outlook:
        """
        State how a steered push ends; parameters are those of ``push_outlook``.

        Errors of position and heading go together, so that the less likely tolerance decides.
        """
        within = min(_share_within(tolerances.position, self.position_error),
                     _share_within(tolerances.heading, self.heading_error))
        return Outlook(self.chance * within, self.time.at(duration), self.position_error,
                       self.heading_error)

    @classmethod
    def from_mapping(cls, values: dict[str, Any]) -> 'OutlookModel':
        """
        Make a model of plain values, as ``outlook.json`` has them.

        :param values: by field.
        """
        time, position, heading = (values[name] for name in QUANTITIES)
        return cls(values['chance'], values['retry_chance'],
                   TimeQuantiles(*(tuple(time[name]) for name in TimeQuantiles._fields)),
                   Quantiles(*position), Quantiles(*heading))


def narrowness(tolerances: GoalTolerances) -> float:
    """
    Tell how narrow tolerances are, by which the time of pushes that correct others grows.

    Errors of pushes scatter over distance^2 heading. The cube root of this volume is the size of
    tolerances.

    :param tolerances: ``GoalTolerances`` that pushes aim at.
    :return: square of the size of the usual tolerances over theirs; the exponent was chosen by
        tasks of 3 to 20 mm.
    """
    volume = ((tolerances.position / POSITION_TOLERANCE) ** 2
              * min(math.pi, tolerances.heading) / HEADING_TOLERANCE)
    return float(volume ** (-2.0 / 3.0))


def usable_tolerances(tolerances: GoalTolerances) -> GoalTolerances:
    """
    Tell what the noise of poses leaves of the tolerances of a task.

    A task is done once the interval of an average of poses is within them, and poses are averaged
    until that takes up half of them at most. No heading errs by more than pi.

    :param tolerances: ``GoalTolerances`` that pushes aim at.
    """
    limited = tolerances.position, min(math.pi, tolerances.heading)
    return GoalTolerances(*(max(value / 2.0, value - NOISE_PART * usual)
                            for value, usual in zip(limited, GoalTolerances())))


@functools.lru_cache(maxsize=1)
def outlook_models() -> dict[str, OutlookModel]:
    """Read the models by their names."""
    values = json.loads(COEFFICIENTS.read_text(encoding='utf-8'))
    return {name: OutlookModel.from_mapping(model) for name, model in values.items()}


def task_outlook(expected_time: float, tolerances: GoalTolerances, *, is_in_map: bool,
                 is_retry: bool) -> Outlook:
    """
    State how a task ends, from one of its plans on.

    :param expected_time: of everything until the object is at its goal, as planned [s].
    :param tolerances: ``GoalTolerances`` that pushes aim at.
    :param is_in_map: whether the task keeps to a map.
    :param is_retry: whether attempts before have brought the object no nearer to its goal.
    """
    model = outlook_models()[MAP if is_in_map else OPEN_FLOOR]
    return model.of_task(expected_time, tolerances, is_retry=is_retry)


def push_outlook(duration: float, tolerances: GoalTolerances) -> Outlook:
    """
    State how a single steered push ends.

    :param duration: of the push as planned [s].
    :param tolerances: ``GoalTolerances`` that count as there.
    """
    return outlook_models()[STEERED_PUSH].of_push(duration, tolerances)


def _scaled(parts: Quantiles, usable: float, limit: float) -> Quantiles:
    return Quantiles(*(min(limit, part * usable) for part in parts))


def _share_within(limit: float, quantiles: Quantiles) -> float:
    """Interpolate the share of cases below a limit; at twice the last quantile it is 1."""
    return float(np.interp(limit, (0.0, *quantiles, 2.0 * quantiles.p99), (0.0, *LEVELS, 1.0)))
