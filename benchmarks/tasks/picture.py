"""Picture of the benchmark of tasks: times, errors and success."""

from pathlib import Path
from typing import Any, Sequence

from benchmarks.controller.tables import Job, Pair, Record, TO_DEGREES, wilson
from benchmarks.tasks.bases import LEARNED, treatment
from benchmarks.tasks.cases import OPEN, PARTS, Tolerance
from benchmarks.tasks.groups import drive, Group, grouped, grouped_parts
import numpy as np

COLOUR = 'C0'
LINES = {'differential': '-', 'holonomic': '--'}


def picture(path: Path, jobs: Sequence[Job], records: Sequence[Record]) -> None:
    """
    Draw times and errors on open floor, and success and times of all parts.

    :param path: of the figure.
    :param jobs: as for ``benchmarks.tasks.report.text``.
    :param records: likewise.
    """
    from matplotlib.figure import Figure
    pairs = [(job, record) for job, record in zip(jobs, records)
             if treatment(job) == LEARNED and not record.get('is_too_heavy')]
    figure = Figure(figsize=(12, 8.5), layout='constrained')
    (times, errors), (success, spans) = figure.subplots(2, 2)
    _draw_open_floor(times, errors, pairs)
    _draw_parts(success, spans, pairs)
    for axis in (times, errors, success, spans):
        axis.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def _draw_open_floor(times: Any, errors: Any, pairs: Sequence[Pair]) -> None:
    """Draw the distribution of times, and the errors at the end."""
    for group in grouped(pairs, OPEN, drive)[1:]:
        durations = np.sort(group.values('duration'))
        fractions = np.arange(1, len(durations) + 1) / len(group.tasks)
        times.step(durations, fractions, where='post', color=COLOUR, ls=LINES[group.name],
                   label=group.name)
    for group in grouped(pairs, OPEN):
        errors.plot(1e3 * group.values('position_error', successful=False),
                    TO_DEGREES * group.values('heading_error', successful=False), '.', ms=4,
                    alpha=0.5, color=COLOUR)
    _finish_open_floor(times, errors)


def _draw_parts(success: Any, spans: Any, pairs: Sequence[Pair]) -> None:
    """Draw success and times, a row for each part that was measured."""
    groups = grouped_parts(pairs, PARTS)
    for row, group in enumerate(groups):
        _draw_success(success, group, row)
        _draw_times(spans, group, row)
    success.set(xlabel='success and its 95 % interval, %')
    spans.set(xlabel='time of the tasks that succeed, s: median, 5 and 95 %', xscale='log')
    spans.xaxis.set_major_formatter('{x:g}')
    spans.xaxis.set_minor_formatter('{x:g}')
    spans.tick_params(axis='x', which='minor', labelsize=7)
    for axis in (success, spans):
        axis.set_yticks(range(len(groups)), [group.part for group in groups])
        axis.set_ylim(len(groups) - 0.5, -0.5)


def _draw_success(axis: Any, group: Group, y: float) -> None:
    low, high = wilson(group.successes, len(group.tasks))
    axis.plot((100.0 * low, 100.0 * high), (y, y), color=COLOUR, lw=4, alpha=0.4)
    axis.plot(100.0 * group.successes / len(group.tasks), y, 'o', color=COLOUR)


def _draw_times(axis: Any, group: Group, y: float) -> None:
    durations = group.values('duration')
    if len(durations):
        low, median, high = np.percentile(durations, (5, 50, 95))
        axis.plot((low, high), (y, y), color=COLOUR, lw=4, alpha=0.4)
        axis.plot(median, y, 'o', color=COLOUR)


def _finish_open_floor(times: Any, errors: Any) -> None:
    times.set(xlabel='time, s', ylabel='fraction of the tasks on open floor that are done',
              ylim=(0.0, 1.01))
    times.set_xlim(left=0.0)
    tolerance = Tolerance()
    x, y = 1e3 * tolerance.position, TO_DEGREES * tolerance.heading
    errors.plot((0.0, x, x), (y, y, 0.0), 'k-', lw=1, label='tolerance')
    errors.set(xlabel='distance from the goal at the end, mm', ylabel='error of the heading, deg',
               xlim=(0.0, 2.0 * x), ylim=(0.0, 2.0 * y))
    for axis in (times, errors):
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=8, loc='lower right' if axis is times else 'upper right')
