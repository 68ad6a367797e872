"""Groups of random tasks: by object and drive, by map, by disturbance."""

import re
from typing import Callable, NamedTuple, Optional, Sequence

from benchmarks.controller.tables import ALL, Job, Pair, Record
import numpy as np
from push_model.geometry import FloatArray

NUMBER = r'-?\d+(\.\d+)?'


class Group(NamedTuple):
    """
    Tasks of one part that share a property.

    :param part: one of ``PARTS`` in ``benchmarks.tasks.cases``.
    :param name: the property, or ``ALL``.
    :param tasks: (job, record) of each.
    """

    part: str
    name: str
    tasks: list[Pair]

    @property
    def successes(self) -> int:
        """Number of those that succeeded."""
        return sum(record['success'] for _, record in self.tasks)

    def values(self, name: str, successful: bool = True) -> FloatArray:
        """
        Gather a figure.

        :param name: of the figure; tasks that have none are left out.
        :param successful: whether only those that succeeded count.
        :return: array, shape (n,).
        """
        return np.array([record[name] for _, record in self.tasks
                         if name in record and (record['success'] or not successful)])

    def ratios(self, name: str, other: str) -> FloatArray:
        """
        Gather the ratios of two figures, of the tasks that succeeded.

        :param name: of the figure.
        :param other: of its divisor; the ratio is 0 where that is infinite.
        :return: array, shape (n,).
        """
        return np.array([record[name] / record[other] for _, record in self.tasks
                         if record['success'] and record.get(other, 0.0) > 0.0])

    @property
    def planning(self) -> FloatArray:
        """CPU time of every plan, in all tasks [s]."""
        return np.array([float(value) for value in
                         ' '.join(self.values('planning', successful=False)).split()])


def grouped(pairs: Sequence[Pair], part: str,
            key: Optional[Callable[[Job, Record], str]] = None) -> list[Group]:
    """
    Group the tasks of one part; all together come first.

    :param pairs: (job, record) of all tasks.
    :param part: one of ``PARTS`` in ``benchmarks.tasks.cases``.
    :param key: function of (job, record) that names the group; None for all together alone.
    :return: list of ``Group``, none of them empty.
    """
    chosen = [(job, record) for job, record in pairs if job['part'] == part]
    found = {ALL: chosen} if chosen else {}
    if key is not None:
        for job, record in chosen:
            found.setdefault(key(job, record), []).append((job, record))
    return [Group(part, name, tasks) for name, tasks in found.items()]


def kind(job: Job, _: Record) -> str:
    """Name the group by object and drive."""
    return job['kind']


def variety(_: Job, record: Record) -> str:
    """Name the group by the sort of map, or of disturbance."""
    return record.get('variety', '')


def faults_of(_: Job, record: Record) -> list[str]:
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


def without_numbers(reason: str) -> str:
    """
    Name the class of a reason: replace its numbers.

    :param reason: one sentence.
    """
    return re.sub(NUMBER, '#', reason)
