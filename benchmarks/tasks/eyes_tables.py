"""Table of tasks whose object is not always seen, in Markdown."""

from typing import Any, Sequence

from benchmarks.controller.tables import Pair, spread, table, wilson
from benchmarks.tasks.eyes import ALWAYS_SEEN, EYES
from benchmarks.tasks.groups import Group, grouped, variety
from benchmarks.tasks.varieties import task_key
import numpy as np


def eyes_table(pairs: Sequence[Pair], part: str) -> str:
    """
    Write successes, errors and times of all eyes; below its aim is bold.

    :param pairs: (job, record) of all tasks, those that are compared too.
    :param part: of the eyes.
    """
    seen = {task_key(job): record['duration'] for job, record in pairs
            if job['part'] == part and job.get('base') == ALWAYS_SEEN and record['success']}
    compared = [(job, {**record, 'seen': seen.get(task_key(job), 0.0)}) for job, record in pairs
                if job['part'] == part and job.get('base') != ALWAYS_SEEN]
    rows: list[Sequence[Any]] = []
    for group in grouped(compared, part, variety)[1:]:
        eyes, count = EYES[group.name], len(group.tasks)
        claims = sum(record['outcome'] == 'done' for _, record in group.tasks)
        success = _rate(group.successes, count)
        hits = group.as_stated if eyes.is_stated else group.successes
        falls_short = 100.0 * hits < eyes.success_aim * count
        rows.append((
            group.name, count, f'**{success}**' if falls_short else success,
            f'{eyes.success_aim:g} %', claims, group.as_stated, group.falsely_done,
            _errors(group), _stated(group),
            _ratio(group, eyes.time_aim), '-' if eyes.time_aim is None else f'{eyes.time_aim:g}',
            spread(group.values('duration'), '.0f'), spread(group.values('pushes'), '.0f')))
    return table(['poses', 'tasks', 'done within the tolerances', 'aim', 'says done',
                  'within what it states', 'says done and is neither',
                  'mm; deg, median, of those that say done', 'stated, median',
                  'time over always seen, median',
                  'aim', 's median, p95', 'pushes median, p95'], rows)


def _rate(hits: int, count: int) -> str:
    low, high = wilson(hits, count)
    return f'{hits} of {count} ({100.0 * low:.0f} to {100.0 * high:.0f} %)'


def _errors(group: Group) -> str:
    """Write the medians of true errors of all tasks that are said to be done."""
    errors = np.array([(1e3 * abs(record['position_error']), np.degrees(record['heading_error']))
                       for _, record in group.tasks if record['outcome'] == 'done'])
    if not len(errors):
        return '-'
    position, heading = np.median(errors, axis=0)
    return f'{position:.0f}; {heading:.1f}'


def _stated(group: Group) -> str:
    """Write the medians of the standard deviations that are stated."""
    position = group.values('stated_position', successful=False)
    if not len(position):
        return '-'
    heading = group.values('stated_heading', successful=False)
    return f'{1e3 * np.median(position):.0f}; {np.degrees(np.median(heading)):.1f}'


def _ratio(group: Group, aim: float | None) -> str:
    ratios = group.ratios('duration', 'seen')
    if not len(ratios):
        return '-'
    median = float(np.median(ratios))
    return f'**{median:.2f}**' if aim is not None and median > aim else f'{median:.2f}'
