"""Random tasks, sorted by what they have in common."""

import re
from typing import NamedTuple

from benchmarks.controller.tables import ALL
import numpy as np

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


def faults_of(_, record):
    """
    Name the classes of a failure: the supervisor's reason without its numbers, and collisions.

    :param record: of the task.
    :return: list of texts, empty where all went well.
    """
    found = [f'{body} collides' for body in ('robot', 'object')
             if record.get(f'{body}_clearance', 0.0) < 0.0]
    if record['success']:
        return found
    if record['outcome'] == 'done':
        return [*found, 'says that it is done, and is not']
    return [*found, without_numbers(record['reason'])]


def without_numbers(reason):
    """
    Name the class of a reason.

    :param reason: one sentence.
    """
    return re.sub(NUMBER, '#', reason)
