"""Tables of the benchmark of tasks, in Markdown."""

from collections import Counter
from typing import Any, Sequence

from benchmarks.controller.tables import Pair, spread, table, TO_DEGREES, wilson
from benchmarks.tasks.groups import faults_of, Group
from benchmarks.tasks.run import TIMED_STATES
import numpy as np
from push_model.geometry import FloatArray


def success_table(groups: Sequence[Group], with_part: bool = False) -> str:
    """
    Write successes, errors, pushes, times.

    :param groups: list of ``Group``.
    :param with_part: name a group by its part too.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        count, pushes = len(group.tasks), group.values('pushes')
        low, high = wilson(group.successes, count)
        name = f'{group.part}, {group.name}' if with_part else group.name
        rows.append((name, count, f'{100.0 * group.successes / count:.1f} %',
                     f'{100.0 * low:.1f} to {100.0 * high:.1f}', group.falsely_done,
                     spread(1e3 * group.values('position_error')),
                     spread(TO_DEGREES * group.values('heading_error'), '.2f'),
                     f'{np.mean(pushes):.1f}; {spread(pushes, ".0f")}' if len(pushes) else '-',
                     spread(group.values('recoveries'), '.0f'),
                     spread(group.values('duration'), '.0f')))
    return table(['', 'tasks', 'success', '95 % interval', 'says done and is not',
                  'mm median, p95', 'deg median, p95', 'pushes mean; median, p95',
                  'recoveries median, p95', 's median, p95'], rows)


def effort_table(groups: Sequence[Group]) -> str:
    """
    Write times and distances over those of a single push and over the bounds, and CPU times.

    :param groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        rows.append((group.name,
                     spread(_finite(group.ratios('duration', 'single')), '.2f'),
                     int(np.isinf(group.values('single')).sum()),
                     spread(group.ratios('duration', 'least'), '.2f'),
                     spread(group.ratios('duration', 'informed'), '.2f'),
                     spread(_finite(group.ratios('distance', 'single_distance')), '.2f'),
                     spread(group.ratios('distance', 'least_distance'), '.2f'),
                     spread(group.planning, '.3f'),
                     spread(group.values('cpu', successful=False), '.1f')))
    return table(['', 'time over single', 'no single push', 'time over bound',
                  'time over informed', 'distance over single', 'distance over straight',
                  'planning, s CPU', 'simulation of a task, s CPU'], rows)


def _finite(ratios: FloatArray) -> FloatArray:
    """Drop tasks that no single push solves."""
    return ratios[ratios > 0.0]


def correction_table(groups: Sequence[Group]) -> str:
    """
    Write how many correcting pushes tasks need, and the time of each.

    :param groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        counts = group.values('corrections')
        if len(counts):
            rows.append((group.name, f'{100.0 * np.mean(counts > 0):.0f} %',
                         f'{np.mean(counts):.2f}', spread(group.values('correction_time'))))
    return table(['', 'tasks with any', 'per task, mean',
                  's each, median, p95'], rows) if rows else 'None.'


def state_table(groups: Sequence[Group]) -> str:
    """
    Write the fractions of time in each state.

    :param groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        spent = [group.values(f'in_{state.value}').sum() for state in TIMED_STATES]
        if sum(spent):
            rows.append((group.part,
                         *(f'{100.0 * part / sum(spent):.0f} %' for part in spent)))
    return table(['', *(state.value for state in TIMED_STATES)], rows)


def collision_table(groups: Sequence[Group]) -> str:
    """
    Write collisions with walls and obstacles, by the true poses.

    :param groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        clearance = [group.values(f'{body}_clearance', successful=False)
                     for body in ('robot', 'object')]
        rows.append((group.name, len(group.tasks),
                     *(int((values < 0.0).sum()) for values in clearance),
                     *(f'{1e3 * min(values):.0f}' if len(values) else '-'
                       for values in clearance)))
    return table(['', 'tasks', 'robot collides', 'object collides',
                  'least clearance of the robot, mm',
                  'of the object, mm'], rows)


def wall_table(groups: Sequence[Group]) -> str:
    """
    Write how walls are touched.

    :param groups: list of ``Group``, of tasks at walls.
    """
    rows: list[Sequence[Any]] = []
    for group in groups:
        touches, presses, forces, depths = (
            group.values(name, successful=False)
            for name in ('robot_at_wall', 'pressed', 'wall_force', 'wall_depth'))
        if len(touches):
            rows.append((group.name, int((touches > 0.0).sum()), f'{max(touches):.1f}',
                         int((presses > 0.0).sum()), spread(presses), f'{max(presses):.1f}',
                         f'{max(forces):.0f}', f'{1e3 * max(depths):.1f}'))
    return table(['', 'robot touches a wall', 'longest, s', 'object is pressed',
                  's median, p95', 'longest, s', 'greatest force, N', 'depth, mm'], rows)


def failure_table(pairs: Sequence[Pair]) -> str:
    """
    List the classes of failures, each with the first task that shows it.

    :param pairs: (job, record) of all tasks.
    """
    faults: Counter[tuple[str, str]] = Counter()
    first: dict[tuple[str, str], str] = {}
    for job, record in pairs:
        for name in faults_of(job, record):
            key = job['part'], name
            faults[key] += 1
            first.setdefault(key, arguments(job))
    rows = [(part, name, count, f'`{first[part, name]}`')
            for (part, name), count in faults.most_common()]
    return table(['part', 'class', 'n', 'for example'], rows) if rows else 'None.'


def arguments(job: dict[str, Any]) -> str:
    """
    Write the command line that shows one task.

    :param job: dict of ``part``, ``kind`` and ``seed``.
    """
    return f'--part "{job["part"]}" --kind "{job["kind"]}" --seed {job["seed"]}'


def recovery_table(pairs: Sequence[Pair]) -> str:
    """
    List the codes of recoveries, in all tasks.

    :param pairs: (job, record) of all tasks.
    """
    causes = Counter(
        cause for _, record in pairs
        for cause in record.get('recovery_codes', '').split('; ') if cause)
    return table(['what', 'n'], causes.most_common()) if causes else 'Nothing.'
