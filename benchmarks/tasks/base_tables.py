"""Tables of tasks with bases that do not do what they are told, in Markdown."""

from typing import Any, Sequence

from benchmarks.controller.tables import ALL, Pair, spread, table, wilson
from benchmarks.tasks.bases import BAD_BASES, GOOD, LEARNED, NOT_LEARNED, treatment
from benchmarks.tasks.groups import Group, grouped, variety
from benchmarks.tasks.varieties import task_key
import numpy as np

# Least part of the objects that are too heavy which is called so [%], and time from the first
# touch until then [s]. Set for tasks.
CALLED_AIM = 95.0
CALLED_WITHIN = 10.0


def base_table(pairs: Sequence[Pair], part: str) -> str:
    """
    Write successes and times of every base: nothing learned, and learned; below its aim is bold.

    Tasks whose object is too heavy are left out.

    :param pairs: (job, record) of all tasks, those that are compared too.
    :param part: of the bases.
    """
    of_treatment = {name: {group.name: group for group in grouped(
        _with_good_times(pairs, name), part, variety)} for name in (NOT_LEARNED, LEARNED)}
    rows: list[Sequence[Any]] = []
    for name, group in of_treatment[LEARNED].items():
        without = of_treatment[NOT_LEARNED].get(name, Group(part, name, []))
        base = BAD_BASES.get(name)
        rows.append((
            name, len(group.tasks), _success(without), _success(group, base and base.success_aim),
            f'{base.success_aim:g} %' if base else '-',
            _ratio(without), _ratio(group, base and base.time_aim),
            f'{base.time_aim:g}' if base else '-',
            spread(group.values('duration'), '.0f'), group.falsely_done))
    return table(['base', 'tasks', 'done, nothing learned', 'done, learned', 'aim',
                  'time over a good base, nothing learned', 'learned', 'aim',
                  's median, p95, learned', 'says done and is not'], rows)


def weight_table(pairs: Sequence[Pair], part: str) -> str:
    """
    Write how many objects are called too heavy, of those that are and of those that are not.

    Those that the robot has brought to their goals all the same need not be called so.

    :param pairs: (job, record) of all tasks, those that are compared too.
    :param part: of the bases.
    """
    learned = [pair for pair in pairs if treatment(pair[0]) == LEARNED]
    rows: list[Sequence[Any]] = []
    for group in grouped(learned, part, variety):
        heavy = [record for _, record in group.tasks if record.get('is_too_heavy')]
        fit = [record for _, record in group.tasks if not record.get('is_too_heavy')]
        false = sum(bool(record.get('called_too_heavy')) for record in fit)
        if group.name != ALL and not (heavy or false):
            continue
        called = [record for record in heavy if record.get('called_too_heavy')]
        times = np.array([record['called_after'] for record in called
                          if 'called_after' in record])
        soon = int((times <= CALLED_WITHIN).sum())
        done = sum(record['success'] for record in heavy)
        due = len(heavy) - done
        rows.append((
            group.name, len(heavy),
            _bold(_rate(soon, due), 100.0 * soon < CALLED_AIM * due),
            len(called), spread(times, '.0f'), done, len(fit), _bold(str(false), false > 0)))
    return table(['base', 'too heavy', f'called so within {CALLED_WITHIN:g} s', 'called so ever',
                  's after the touch, median, p95', 'done all the same', 'not too heavy',
                  'called too heavy'], rows)


def _with_good_times(pairs: Sequence[Pair], name: str) -> list[Pair]:
    """Select tasks of one treatment; give them the time with a good base as ``good`` [s]."""
    good = {task_key(job): record['duration'] for job, record in pairs
            if treatment(job) == GOOD and record['success']}
    return [(job, {**record, 'good': good.get(task_key(job), 0.0)}) for job, record in pairs
            if treatment(job) == name and not record.get('is_too_heavy')]


def _success(group: Group, aim: float | None = None) -> str:
    count = len(group.tasks)
    falls_short = aim is not None and 100.0 * group.successes < aim * count
    return _bold(_rate(group.successes, count), falls_short)


def _rate(hits: int, count: int) -> str:
    if not count:
        return '-'
    low, high = wilson(hits, count)
    return f'{hits} of {count} ({100.0 * low:.0f} to {100.0 * high:.0f} %)'


def _ratio(group: Group, aim: float | None = None) -> str:
    ratios = group.ratios('duration', 'good')
    if not len(ratios):
        return '-'
    median = float(np.median(ratios))
    return _bold(f'{median:.2f}', aim is not None and median > aim)


def _bold(text: str, is_bold: bool) -> str:
    return f'**{text}**' if is_bold else text
