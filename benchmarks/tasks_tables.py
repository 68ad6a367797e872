"""What random tasks came to, as tables."""

from collections import Counter
import re
from typing import NamedTuple

from controller_tables import ALL, spread, table, TO_DEGREES, wilson
import numpy as np
from tasks_run import LEGS

NUMBER = r'-?\d+(\.\d+)?'


class Group(NamedTuple):
    """
    Tasks of one part that have something in common.

    :param part: one of ``tasks_cases.PARTS``.
    :param name: what they have in common, or ``ALL``.
    :param tasks: (job, record) of each.
    """

    part: str
    name: str
    tasks: list

    @property
    def successes(self):
        """Number of those that succeeded."""
        return sum(record['success'] for _, record in self.tasks)

    def values(self, name, successful=True):
        """
        Gather a figure.

        :param name: of the figure; tasks that have none are left out.
        :param successful: whether only those that succeeded count.
        :return: array, shape (n,).
        """
        return np.array([record[name] for _, record in self.tasks
                         if name in record and (record['success'] or not successful)])

    def ratios(self, name, other):
        """
        Gather one figure over another, of the tasks that succeeded.

        :param name: of the figure.
        :param other: of the one that it is divided by; 0 where that is infinite.
        :return: array, shape (n,).
        """
        return np.array([record[name] / record[other] for _, record in self.tasks
                         if record['success'] and record.get(other, 0.0) > 0.0])

    @property
    def planning(self):
        """CPU time of every answer of the planner, in all tasks [s]."""
        return np.array([float(value) for value in
                         ' '.join(self.values('planning', successful=False)).split()])


def grouped(pairs, part, key=None):
    """
    Sort tasks of one part; all together come first.

    :param pairs: (job, record) of all tasks.
    :param part: one of ``tasks_cases.PARTS``.
    :param key: of (job, record), what they have in common; None for all together alone.
    :return: list of ``Group``, none of them empty.
    """
    chosen = [(job, record) for job, record in pairs if job['part'] == part]
    found = {ALL: chosen} if chosen else {}
    for job, record in chosen if key else ():
        found.setdefault(key(job, record), []).append((job, record))
    return [Group(part, name, tasks) for name, tasks in found.items()]


def kind(job, _):
    """Key of ``grouped``: object and drive."""
    return job['kind']


def variety(_, record):
    """Key of ``grouped``: the sort of map, or of disturbance."""
    return record.get('variety', '')


def success_table(groups):
    """
    Write successes, errors, pushes.

    :param groups: list of ``Group``.
    """
    rows = []
    for group in groups:
        count, pushes = len(group.tasks), group.values('pushes')
        low, high = wilson(group.successes, count)
        rows.append((group.name, count, f'{100.0 * group.successes / count:.1f} %',
                     f'{100.0 * low:.1f} to {100.0 * high:.1f}',
                     spread(1e3 * group.values('position_error')),
                     spread(TO_DEGREES * group.values('heading_error'), '.2f'),
                     f'{np.mean(pushes):.1f}; {spread(pushes, ".0f")}' if len(pushes) else '-',
                     spread(group.values('recoveries'), '.0f'),
                     spread(group.values('duration'), '.0f')))
    return table(['', 'tasks', 'success', '95 % interval', 'mm median, p95', 'deg median, p95',
                  'pushes mean; median, p95', 'recoveries median, p95', 's median, p95'], rows)


def effort_table(groups):
    """
    Write time and way over those of one push and over the bound, and the time of planning.

    :param groups: list of ``Group``.
    """
    rows = []
    for group in groups:
        rows.append((group.name, spread(group.values('chain'), '.0f'),
                     int(np.isinf(group.values('single')).sum()),
                     spread(_finite(group.ratios('planned', 'single')), '.2f'),
                     spread(_finite(group.ratios('duration', 'single')), '.2f'),
                     spread(_finite(group.ratios('way', 'single_way')), '.2f'),
                     spread(group.ratios('duration', 'least'), '.2f'),
                     spread(group.ratios('way', 'least_way'), '.2f'),
                     spread(group.planning, '.2f')))
    return table(['', 'pushes planned at first', 'no single push', 'planned time over single',
                  'time over single', 'way over single', 'time over bound', 'way over straight',
                  'planning, s CPU'], rows)


def _finite(ratios):
    """Leave out tasks that no single push does."""
    return ratios[ratios > 0.0]


def legs_table(groups):
    """
    Write where the time goes.

    :param groups: list of ``Group``.
    """
    rows = []
    for group in groups:
        spent = [group.values(f'in_{leg}').sum() for leg in LEGS]
        if sum(spent):
            rows.append((group.part, *(f'{100.0 * part / sum(spent):.0f} %' for part in spent)))
    return table(['', *LEGS], rows)


def room_table(groups):
    """
    Write collisions with what stands in the maps, by the true poses.

    :param groups: list of ``Group``.
    """
    rows = []
    for group in groups:
        room = [group.values(f'{body}_room', successful=False) for body in ('robot', 'object')]
        rows.append((group.name, len(group.tasks),
                     *(int((values < 0.0).sum()) for values in room),
                     *(f'{1e3 * min(values):.0f}' if len(values) else '-' for values in room)))
    return table(['', 'tasks', 'robot collides', 'object collides', 'least room of the robot, mm',
                  'of the object, mm'], rows)


def failure_table(pairs):
    """
    List the classes of failures, each with the first task that shows it.

    :param pairs: (job, record) of all tasks.
    """
    faults, first = Counter(), {}
    for job, record in pairs:
        for name in faults_of(job, record):
            key = job['part'], job['kind'], name
            faults[key] += 1
            first.setdefault(key, job['seed'])
    rows = [(part, kind_, name, count,
             f'`--part "{part}" --kind "{kind_}" --seed {first[part, kind_, name]}`')
            for (part, kind_, name), count in faults.most_common()]
    return table(['part', 'object and drive', 'class', 'n', 'for example'],
                 rows) if rows else 'None.'


def faults_of(_, record):
    """
    Name the classes of a failure: the supervisor's reason without its numbers, and collisions.

    :param record: of the task.
    :return: list of texts, empty where all went well.
    """
    found = [f'{body} collides' for body in ('robot', 'object')
             if record.get(f'{body}_room', 0.0) < 0.0]
    if record['success']:
        return found
    if record['outcome'] == 'done':
        return [*found, 'says that it is done, and is not']
    return [*found, re.sub(NUMBER, '#', record['reason'])]


def trouble_table(pairs):
    """
    List what went wrong on the way, successful or not.

    :param pairs: (job, record) of all tasks.
    """
    found = Counter()
    for _, record in pairs:
        found.update(re.sub(NUMBER, '#', trouble)
                     for trouble in record.get('troubles', '').split('; ') if trouble)
    return table(['what', 'n'], found.most_common()) if found else 'Nothing.'
