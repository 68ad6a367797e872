"""Table of tasks in maps of others: answered, driven, collisions, time to answer, refusals."""

from collections import Counter
from typing import Any, Sequence

from benchmarks.controller.tables import Pair, table, wilson
from benchmarks.tasks.cases import PUBLIC_MAPS
from benchmarks.tasks.groups import Group, grouped, variety
import numpy as np


def public_table(pairs: Sequence[Pair]) -> str:
    """
    Write a row for robots with a lidar, and one for those by odometry alone.

    A task is answered where there was a plan. The CPU time of the first answer is that of the
    first plan; the longest step also has the refusals.

    :param pairs: (job, record) of all tasks.
    """
    rows = [_row(group) for group in grouped(pairs, PUBLIC_MAPS, variety)[1:]]
    return table(['', 'tasks', 'answered', 'driven', '95 % interval', 'object; robot collides',
                  'first answer, s CPU, median / p95', 'longest step, s CPU', 's median',
                  'failures'], rows)


def _row(group: Group) -> Sequence[Any]:
    records = [record for _, record in group.tasks]
    count = len(records)
    low, high = wilson(group.successes, count)
    firsts = [float(record['planning'].split()[0]) for record in records if record.get('planning')]
    hits = [int((group.values(f'{body}_clearance', successful=False) < 0.0).sum())
            for body in ('object', 'robot')]
    causes = Counter(record['codes'] or record['outcome'] for record in records
                     if not record['success'])
    times, steps = group.values('duration'), group.values('longest_step', successful=False)
    return (group.name, count, f'{len(firsts)}', f'{group.successes}',
            f'{100.0 * low:.0f} to {100.0 * high:.0f} %', f'{hits[0]}; {hits[1]}',
            ' / '.join(f'{value:.2f}' for value in np.percentile(firsts, (50, 95)))
            if firsts else '-', f'{steps.max():.1f}' if len(steps) else '-',
            f'{np.median(times):.0f}' if len(times) else '-',
            '; '.join(f'{number} {cause}' for cause, number in causes.most_common()))
