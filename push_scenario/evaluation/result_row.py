"""A run as flat values, for tables and files."""

import dataclasses
from typing import Any

from push_control.task.code_text import code_text
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.simulation.result import RunResult

Row = dict[str, Any]


def result_row(result: RunResult) -> Row:
    """
    Describe how a run ended.

    :return: ``scenario`` (its name), ``outcome``, ``reason``, ``codes``, ``is_as_expected``, and
        the fields of ``Metrics`` where something moved.
    """
    metrics = measure(result)
    return {'scenario': result.scenario.name, 'outcome': result.outcome.value,
            'reason': result.reason, 'codes': code_text(result.codes),
            'is_as_expected': is_as_expected(result),
            **({} if metrics is None else dataclasses.asdict(metrics))}
