"""Report of a replay: how it ended, and a row for each metric with a column for each run."""

from collections.abc import Callable, Iterator, Sequence
import math
import textwrap
from typing import Any, NamedTuple

from push_control.law_names import law_title
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.headline import headline
from push_scenario.evaluation.metrics import (
    bounds_missed, is_as_expected, measure, Metrics, verdict,
)
from push_scenario.simulation.result import Outcome, RunResult, WallClockTiming

NOT_APPLICABLE = '-'
# Columns of a terminal that nobody has widened.
COLUMNS = 80
# What turns the text of a terminal green, red and back.
GREEN, RED, PLAIN = '\x1b[1;32m', '\x1b[1;31m', '\x1b[0m'


def _always(_: Scenario) -> bool:
    return True


def _is_single_push(scenario: Scenario) -> bool:
    return scenario.task is None


def _is_task(scenario: Scenario) -> bool:
    return scenario.task is not None


def _has_map(scenario: Scenario) -> bool:
    return scenario.task is not None and scenario.task.map is not None


def _no_bound(_: Scenario) -> str:
    return ''


def _yes_or_no(value: bool) -> str:
    return 'yes' if value else 'no'


def _seconds(value: float) -> str:
    return f'{value:.2f}' if math.isfinite(value) else NOT_APPLICABLE


def _of_one_plan(value: float | None, factor: float) -> str:
    """Write what a run has that followed one plan."""
    return NOT_APPLICABLE if value is None else f'{factor * value:.1f}'


class Row(NamedTuple):
    """
    A row of the table.

    :param title: what it shows.
    :param unit: of the numbers, empty for none.
    :param text: writes the value of a run; of ``Metrics``, or of ``WallClockTiming``.
    :param applies: whether the row makes sense for a scenario.
    :param bound: writes what the scenario allows, if anything.
    """

    title: str
    unit: str
    text: Callable[[Any], str]
    applies: Callable[[Scenario], bool] = _always
    bound: Callable[[Scenario], str] = _no_bound


ROWS: tuple[Row, ...] = (
    Row('final position error', 'mm', lambda m: f'{1e3 * m.position_error:.1f}',
        bound=lambda scenario: f'{1e3 * scenario.final_bounds.position_error:.1f}'),
    Row('final heading error', 'deg', lambda m: f'{math.degrees(m.heading_error):+.2f}',
        bound=lambda scenario: f'{math.degrees(scenario.final_bounds.heading_error):.2f}'),
    Row('pushes', '', lambda m: f'{m.pushes}', _is_task),
    Row('correcting pushes', '', lambda m: f'{m.corrections}', _is_task),
    Row('recoveries', '', lambda m: f'{m.recoveries}', _is_task),
    Row('time', 's', lambda m: _seconds(m.time)),
    Row('time of a correcting push', 's', lambda m: _seconds(m.correction_time), _is_task),
    Row('time in contact', 's', lambda m: _seconds(m.contact_time)),
    Row('path length of the robot', 'm', lambda m: f'{m.robot_path_length:.3f}'),
    Row('path length of the object', 'm', lambda m: f'{m.object_path_length:.3f}'),
    Row('path length against the plan', '%', lambda m: _of_one_plan(m.path_length_ratio, 1e2),
        _is_single_push),
    Row('largest distance from the plan', 'mm', lambda m: _of_one_plan(m.max_deviation, 1e3),
        _is_single_push),
    Row('sliding at the contact', 'mm', lambda m: f'{1e3 * m.slip:.1f}'),
    Row('robot clear of the object', 'mm', lambda m: f'{1e3 * m.gap:.0f}', _is_task,
        lambda scenario: f'{1e3 * scenario.task.drive.clearance:.0f}' if scenario.task else ''),
    Row('clear of the map', '', lambda m: _yes_or_no(m.within_map), _has_map),
    Row('within bounds', '', lambda m: _yes_or_no(m.within_bounds)),
)
TIMING_ROWS: tuple[Row, ...] = (
    Row('pose to command, median', 'ms', lambda timing: f'{1e3 * timing.latency_median:.2f}'),
    Row('pose to command, 99 of 100', 'ms', lambda timing: f'{1e3 * timing.latency_p99:.2f}'),
    Row('simulated over wall time', '', lambda timing: f'{timing.speed_up:.1f}'),
)


def format_report(results: Sequence[RunResult], *, is_colored: bool = False) -> str:
    """
    Say how runs of one scenario ended, and compare them, as aligned text.

    Runs over DDS have rows on their timing besides. Below the table stands what went wrong.

    :param results: the ``RunResult`` of each run, one or more.
    :param is_colored: show in green what ended as expected, and in red what did not.
    :return: lines without a newline at the end.
    """
    lines = report_table(results)
    lines[0][0] = results[0].scenario.name
    notes = [note for result in results for note in report_notes(result)]
    return '\n'.join([*_headlines(results, is_colored), '', *_aligned(lines), *notes])


def _headlines(results: Sequence[RunResult], is_colored: bool) -> Iterator[str]:
    for result in results:
        title = f'{law_title(result.control_law)}: ' if len(results) > 1 else ''
        text = textwrap.fill(title + headline(result), COLUMNS, subsequent_indent='  ',
                             break_long_words=False, break_on_hyphens=False)
        color = GREEN if is_as_expected(result) else RED
        yield f'{color}{text}{PLAIN}' if is_colored else text


def report_table(results: Sequence[RunResult]) -> list[list[str]]:
    """
    List the cells of the table: title, unit, a cell per run, bound; rows without a value are out.

    :param results: the ``RunResult`` of each run of one scenario, one or more.
    :return: lines, the first one the head.
    """
    scenario = results[0].scenario
    metrics = [measure(result) for result in results]
    lines = [['', ''] + [law_title(result.control_law) for result in results] + ['bound']]
    lines += _table_rows(ROWS, scenario, metrics)
    timings = [result.timing for result in results]
    if any(timings):
        lines += _table_rows(TIMING_ROWS, scenario, timings)
    lines.append(['outcome', ''] + [verdict(result) for result in results] + [''])
    return lines


def _table_rows(rows: Sequence[Row], scenario: Scenario,
                values: Sequence[Metrics | WallClockTiming | None]) -> list[list[str]]:
    lines: list[list[str]] = []
    for row in rows:
        cells = [NOT_APPLICABLE if value is None else row.text(value) for value in values]
        if row.applies(scenario) and any(cell != NOT_APPLICABLE for cell in cells):
            unit = f'[{row.unit}]' if row.unit else ''
            lines.append([row.title, unit, *cells, row.bound(scenario)])
    return lines


def report_notes(result: RunResult) -> Iterator[str]:
    """Yield changes of state for a reason, and why the run ended as it did or what it missed."""
    title = law_title(result.control_law)
    for change in result.history[1:]:
        if change.reason and change.reason != result.reason:
            yield f'{title}, {change.time:.1f} s, {change.state.value}: {change.reason}'
    if result.reason and result.outcome is not Outcome.DONE:
        yield f'{title}: {result.reason}'
    for missed in bounds_missed(result):
        yield f'{title}: missed, {missed}'


def _aligned(lines: Sequence[Sequence[str]]) -> Iterator[str]:
    """Pad cells, the first two columns to the left, the others to the right; rule off the head."""
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    for row, line in enumerate(lines):
        cells = [cell.ljust(width) if column < 2 else cell.rjust(width)
                 for column, (cell, width) in enumerate(zip(line, widths))]
        yield '  '.join(cells).rstrip()
        if row == 0:
            yield '-' * (sum(widths) + 2 * len(widths) - 2)
