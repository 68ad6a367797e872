"""
Outlook of plans, by what ``python -m benchmarks.chances`` has measured.

Each quantile q is a line of one number x that a plan knows:

    q(x) = max(0, a_q + b_q x),

fitted by quantile regression (Koenker and Bassett 1978). For times x is the time that the plan
expects, for errors the tolerance in a task, and the path length of the contact in a steered push.
The coefficients stand in ``outlook.json``, which the benchmark writes.
"""

import functools
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from push_model.outlook import LEVELS, Outlook, Quantiles
from push_model.plan_request import GoalTolerances

# Names of the models.
OPEN_FLOOR, MAP, STEERED_PUSH = 'open_floor', 'map', 'steered_push'
COEFFICIENTS = Path(__file__).with_name('outlook.json')


class QuantileLines(NamedTuple):
    """
    Quantiles of a quantity, each a line of one number.

    :param offsets: a_q of each level of ``LEVELS``, in the unit of the quantity.
    :param slopes: b_q of each, in its unit over that of the number.
    """

    offsets: tuple[float, ...]
    slopes: tuple[float, ...]

    def at(self, value: float) -> Quantiles:
        """
        Evaluate the lines; a higher level is never below a lower one.

        :param value: the number.
        """
        lines = np.array(self.offsets) + np.array(self.slopes) * value
        return Quantiles(*np.maximum.accumulate(np.maximum(lines, 0.0)).tolist())


class OutlookModel(NamedTuple):
    """
    Model of the end of one sort of plans.

    :param chance: to be done within the tolerances; in a steered push to be done at all.
    :param retry_chance: the same after attempts that brought the object no nearer to its goal.
    :param time: ``QuantileLines`` of the time [s].
    :param position_error: of the distance from the goal [m].
    :param heading_error: of the size of the heading error [rad].
    """

    chance: float
    retry_chance: float
    time: QuantileLines
    position_error: QuantileLines
    heading_error: QuantileLines

    def of_task(self, expected_time: float, tolerances: GoalTolerances, *,
                is_retry: bool) -> Outlook:
        """State how a task ends; parameters are those of ``task_outlook``."""
        return Outlook(self.retry_chance if is_retry else self.chance,
                       self.time.at(expected_time), self.position_error.at(tolerances.position),
                       self.heading_error.at(tolerances.heading))

    def of_push(self, duration: float, path_length: float,
                tolerances: GoalTolerances) -> Outlook:
        """
        State how a steered push ends; parameters are those of ``push_outlook``.

        Errors of position and heading go together, so that the less likely tolerance decides.
        """
        position_error = self.position_error.at(path_length)
        heading_error = self.heading_error.at(path_length)
        within = min(_share_within(tolerances.position, position_error),
                     _share_within(tolerances.heading, heading_error))
        return Outlook(self.chance * within, self.time.at(duration), position_error,
                       heading_error)

    @classmethod
    def from_mapping(cls, values: dict[str, Any]) -> 'OutlookModel':
        """
        Make a model of plain values, as ``outlook.json`` has them.

        :param values: by field.
        """
        lines = {name: QuantileLines(tuple(values[name]['offsets']),
                                     tuple(values[name]['slopes']))
                 for name in ('time', 'position_error', 'heading_error')}
        return cls(values['chance'], values['retry_chance'], **lines)


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


def push_outlook(duration: float, path_length: float, tolerances: GoalTolerances) -> Outlook:
    """
    State how a single steered push ends.

    :param duration: of the push as planned [s].
    :param path_length: of its contact [m].
    :param tolerances: ``GoalTolerances`` that count as there.
    """
    return outlook_models()[STEERED_PUSH].of_push(duration, path_length, tolerances)


def _share_within(limit: float, quantiles: Quantiles) -> float:
    """Interpolate the share of cases below a limit; at twice the last quantile it is 1."""
    return float(np.interp(limit, (0.0, *quantiles, 2.0 * quantiles.p99), (0.0, *LEVELS, 1.0)))
