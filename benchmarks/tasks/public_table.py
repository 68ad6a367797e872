"""Tables of tasks in maps of others: answered, driven, collisions, time to answer, refusals."""

from collections import Counter
from typing import Any, Sequence

from benchmarks.controller.tables import Pair, table, wilson
from benchmarks.tasks.cases import PUBLIC_MAPS
from benchmarks.tasks.groups import Group, grouped, variety
from benchmarks.tasks.refusals import Answer
import numpy as np
from push_model.geometry import FloatArray


def public_tables(pairs: Sequence[Pair]) -> str:
    """
    Write a row for robots with a lidar, and one for those by odometry alone, in two tables.

    A task is answered where the robot sets out. The first answer is a plan or a refusal.

    :param pairs: (job, record) of all tasks.
    :return: both tables, empty where there is no task.
    """
    groups = grouped(pairs, PUBLIC_MAPS, variety)[1:]
    if not groups:
        return ''
    driven = table(['', 'tasks', 'answered', 'driven', '95 % interval', 'says done and is not',
                    'object; robot collides', 's median', 'time over bound, median'],
                   [_driven(group) for group in groups])
    refused = table(['', 'first answer, s CPU, median / p95', 'longest step, s CPU', 'given up',
                     'planner that knows all: plan', 'none, ideal pushes', 'neither', 'failures'],
                    [_refused(group) for group in groups])
    return f'{driven}\n\n{refused}'


def _driven(group: Group) -> Sequence[Any]:
    count = len(group.tasks)
    low, high = wilson(group.successes, count)
    hits = [int((group.values(f'{body}_clearance', successful=False) < 0.0).sum())
            for body in ('object', 'robot')]
    answered = int((group.values('in_approach', successful=False) > 0.0).sum())
    return (group.name, count, answered, group.successes,
            f'{100.0 * low:.0f} to {100.0 * high:.0f} %', group.falsely_done,
            f'{hits[0]}; {hits[1]}', _median(group.values('duration'), '.0f'),
            _median(group.ratios('duration', 'least'), '.2f'))


def _refused(group: Group) -> Sequence[Any]:
    records = [record for _, record in group.tasks]
    firsts, steps = _first_answers(group), group.values('longest_step', successful=False)
    answers = Counter(record['answer'] for record in records if 'answer' in record)
    causes = Counter(record['codes'] or record['outcome'] for record in records
                     if not record['success'])
    return (group.name, ' / '.join(f'{value:.2f}' for value in np.percentile(firsts, (50, 95)))
            if firsts else '-', f'{steps.max():.1f}' if len(steps) else '-', answers.total(),
            *(answers[answer.value] for answer in Answer),
            '; '.join(f'{number} {cause}' for cause, number in causes.most_common()))


def _first_answers(group: Group) -> list[float]:
    """List the CPU times of first answers [s]."""
    return [float(record['planning'].split()[0]) for _, record in group.tasks
            if record.get('planning')]


def _median(values: FloatArray, form: str) -> str:
    return f'{np.median(values):{form}}' if len(values) else '-'
