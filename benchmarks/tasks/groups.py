"""Groups of random tasks: by object and drive, map, disturbance, variation."""

from typing import Callable, NamedTuple, Optional, Sequence

from benchmarks.controller.tables import ALL, Job, Pair, Record
from benchmarks.tasks.cases import INFORMED, OPEN
import numpy as np
from push_model.geometry import FloatArray

FALSELY_DONE = 'says that it is done, and is not'


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

    @property
    def falsely_done(self) -> int:
        """Number of those that were reported as done, and were not."""
        return sum(is_falsely_done(record) for _, record in self.tasks)

    @property
    def as_stated(self) -> int:
        """Number of those that are done within what they state, or within the tolerances."""
        return sum(is_as_stated(record) for _, record in self.tasks)

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


def grouped_parts(pairs: Sequence[Pair], parts: Sequence[str],
                  key: Optional[Callable[[Job, Record], str]] = None) -> list[Group]:
    """
    Group the tasks of some parts, part by part.

    :param pairs: (job, record) of all tasks.
    :param parts: of ``PARTS`` in ``benchmarks.tasks.cases``.
    :param key: function of (job, record) that names the group; None for all together alone.
    """
    return [group for part in parts for group in grouped(pairs, part, key)]


def kind(job: Job, _: Record) -> str:
    """Name the group by object and drive."""
    return job['kind']


def drive(job: Job, _: Record) -> str:
    """Name the group by the drive."""
    return job['kind'].split(', ')[1]


def variety(_: Job, record: Record) -> str:
    """Name the group by the sort of map, disturbance or variation."""
    return record.get('variety', '')


def with_informed_times(pairs: Sequence[Pair]) -> list[Pair]:
    """
    Give tasks on open floor the time of the robot that knows everything, as ``informed`` [s].

    :param pairs: (job, record) of all tasks.
    """
    times = {(job['kind'], job['seed']): record['duration']
             for job, record in pairs if job['part'] == INFORMED and record['success']}
    return [(job, {**record, 'informed': times[key]})
            if job['part'] == OPEN and (key := (job['kind'], job['seed'])) in times
            else (job, record) for job, record in pairs]


def is_falsely_done(record: Record) -> bool:
    """
    Tell whether a task was reported as done, and was not, by what the report states either.

    :param record: of the task.
    """
    return record['outcome'] == 'done' and not is_as_stated(record)


def is_as_stated(record: Record) -> bool:
    """
    Tell whether a task is done within its tolerances, or within those and what it states.

    :param record: of the task.
    """
    return record['outcome'] == 'done' and (
        record['success'] or record.get('is_as_stated', False))


def faults_of(_: Job, record: Record) -> list[str]:
    """
    Name the classes of a failure: the codes of the supervisor's reason, and collisions.

    An object that is too heavy, and called so, is none.

    :param record: of the task.
    :return: list of texts, empty where all went well.
    """
    found = [f'{body} collides' for body in ('robot', 'object')
             if record.get(f'{body}_clearance', 0.0) < 0.0]
    is_explained = record.get('is_too_heavy') and record.get('called_too_heavy')
    if record['success'] or is_as_stated(record) or is_explained:
        return found
    if is_falsely_done(record):
        return [*found, FALSELY_DONE]
    return [*found, ': '.join(filter(None, (record['outcome'], record.get('codes'))))]
