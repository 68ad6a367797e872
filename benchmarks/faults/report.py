"""Report of a campaign: its runs summed up by input, word and duration."""

from collections import Counter
from collections.abc import Sequence
import math
from pathlib import Path
import re
from typing import NamedTuple

from benchmarks.faults.expectations import EXPECTATIONS, HARMLESS_NOTE
from benchmarks.faults.injection import Input, Word
from benchmarks.faults.process_rig import ProcessRow
from benchmarks.faults.row import Ending, Row, violation_text
from benchmarks.faults.soak import soak_table, SoakTask
from benchmarks.faults.surroundings import surroundings_table, SurroundingsRow
from benchmarks.faults.verdict import Violation
from benchmarks.report_template import fill_template
import numpy as np

TEMPLATE = Path(__file__).parent / 'faults.md.in'
HEADER = ('fault', 'runs', 'done', 'failed', 'waits', 'violations', 'stops after [s]: median',
          'worst', 'drives until then [m], worst', 'object beside its plans [m], worst',
          'most frequent reason')
# Numbers and quantities, by which reasons differ that are the same.
FIGURES = re.compile(r'\(.*?\)|[-\d.]+')


# Groups of faults whose stops are compared: where the input itself shows the fault, and where only
# the motion of the robot does.
SHOWN = (Input.ODOMETRY, Input.POSE), (Word.OFF, Word.STUCK, Word.GARBAGE)
MOVED = (Input.COMMAND,), (Word.OFF, Word.STUCK, Word.GARBAGE, Word.WRONG)
PROCESS_HEADER = ('process', 'state of the task', 'task', 'reason', 'stands after [s]')
BOUND_HEADER = ('fault', 'stops within [s]', 'drives until then [m]',
                'object beside its plans [m]', 'why')
STOP_HEADER = ('faults that come while the robot drives', 'runs', 'stops after [s]: median',
               '99 of 100', 'worst', 'drives until then [m]: 99 of 100', 'worst')


class Findings(NamedTuple):
    """
    What a campaign has found.

    :param rows: ``Row`` of each run.
    :param processes: ``ProcessRow`` of each fault of a process.
    :param surroundings: ``SurroundingsRow`` of each case of files, clocks and strangers.
    :param soak: each ``SoakTask``.
    """

    rows: Sequence[Row]
    processes: Sequence[ProcessRow]
    surroundings: Sequence[SurroundingsRow]
    soak: Sequence[SoakTask]


def write_report(path: Path, findings: Findings, options: str) -> None:
    """
    Write the report.

    :param path: of the file.
    :param findings: the ``Findings``.
    :param options: of the command line that has made them.
    """
    rows, processes = findings.rows, findings.processes
    temporary = [row for row in rows if row.fault.is_temporary]
    text = fill_template(
        TEMPLATE, RUNS=len(rows), OPTIONS=options, TABLE=table(rows),
        VIOLATING=sum(not row.is_ok for row in [*rows, *processes, *findings.surroundings]),
        TEMPORARY=len(temporary),
        RECOVERED=sum(row.ending is Ending.DONE for row in temporary),
        STOPS=stop_table(rows), BOUNDS=bound_table(), STRUCK=len(processes),
        CASES=len(findings.surroundings),
        PROCESSES=process_table(processes),
        SURROUNDINGS=surroundings_table(findings.surroundings),
        SOAK=soak_table(findings.soak))
    path.write_text(text, encoding='utf-8')


def stop_table(rows: Sequence[Row]) -> str:
    """
    Sum up how soon the robot stops, where it drives when a fault comes.

    :param rows: ``Row`` of each run.
    :return: Markdown.
    """
    lines = [_markdown(STOP_HEADER), _markdown(['---'] * len(STOP_HEADER))]
    for name, (inputs, words) in (
            ('odometry or poses off, stuck or garbage', SHOWN),
            ('commands that the base does not follow: off, stuck, garbage, wrong', MOVED)):
        chosen = [row for row in rows if row.fault.input in inputs and row.fault.word in words
                  and row.stop_time > 0.0]
        if chosen:
            times, distances = ([getattr(row, field) for row in chosen]
                                for field in ('stop_time', 'driven'))
            lines.append(_markdown([
                name, str(len(chosen)),
                *(f'{np.quantile(times, q):.2f}' for q in (0.5, 0.99, 1.0)),
                *(f'{np.quantile(distances, q):.2f}' for q in (0.99, 1.0))]))
    return '\n'.join(lines)


def process_table(rows: Sequence[ProcessRow]) -> str:
    """
    List what became of faults of processes.

    :param rows: each ``ProcessRow``.
    :return: Markdown.
    """
    lines = [_markdown(PROCESS_HEADER), _markdown(['---'] * len(PROCESS_HEADER))]
    for row in rows:
        ending = row.ending.value + violation_text(row.violations)
        stop_time = '' if math.isnan(row.stop_time) else f'{row.stop_time:.1f}'
        lines.append(_markdown([f'`{row.fault.node}` {row.fault.strike.value}',
                                row.fault.state.value, ending, row.reason, stop_time]))
    return '\n'.join(lines)


def table(rows: Sequence[Row]) -> str:
    """
    Sum up the runs of each fault after which not every run was done.

    :param rows: ``Row`` of each run.
    :return: Markdown.
    """
    lines = [_markdown(HEADER), _markdown(['---'] * len(HEADER))]
    for kind in Input:
        for word in Word:
            for is_temporary in (True, False):
                chosen = [row for row in rows if row.fault.input is kind and row.fault.word is word
                          and row.fault.is_temporary is is_temporary]
                if any(row.ending is not Ending.DONE or not row.is_ok for row in chosen):
                    duration = '2 s' if is_temporary else 'lasting'
                    lines.append(_line(chosen, f'{kind.value} {word.value}, {duration}'))
    return '\n'.join(lines)


def _line(rows: Sequence[Row], name: str) -> str:
    endings = Counter(row.ending for row in rows)
    reasons = [row.reason for row in rows if row.reason]
    kinds = Counter(FIGURES.sub('#', reason) for reason in reasons).most_common(1)
    frequent = next((reason for reason in reasons
                     if FIGURES.sub('#', reason) == kinds[0][0]), '')
    stops = sorted(row.stop_time for row in rows if not math.isnan(row.stop_time))
    driven = [row.driven for row in rows if not math.isnan(row.driven)]
    return _markdown([
        name, str(len(rows)), *(str(endings[ending]) for ending in Ending),
        _violations(rows),
        f'{stops[len(stops) // 2]:.2f}' if stops else '', f'{stops[-1]:.2f}' if stops else '',
        f'{max(driven):.2f}' if driven else '', f'{max(row.deviation for row in rows):.2f}',
        frequent])


def _violations(rows: Sequence[Row]) -> str:
    """Count what was not as it should be, each kind; empty for nothing."""
    counts = Counter(name for row in rows for name in row.violations)
    return ', '.join(f'{count} {Violation[name].value}' for name, count in sorted(counts.items()))


def bound_table() -> str:
    """
    List bounds that are not the common ones, and why.

    :return: Markdown.
    """
    lines = [_markdown(BOUND_HEADER), _markdown(['---'] * len(BOUND_HEADER))]
    for (kind, word), expectation in EXPECTATIONS.items():
        if expectation.note and expectation.note != HARMLESS_NOTE:
            bounds = [f'{expectation.stop_time:g}', f'{expectation.driven:g}']
            if not expectation.must_stop:
                bounds = ['need not stop', '']
            lines.append(_markdown([f'{kind.value} {word.value}', *bounds,
                                    f'{expectation.deviation:g}', expectation.note]))
    return '\n'.join(lines)


def _markdown(cells: Sequence[str]) -> str:
    return '| ' + ' | '.join(cells) + ' |'
