"""What random pushes came to, as tables."""

from collections import Counter
import math
import re
from typing import NamedTuple

from benchmarks.controller.cases import KINDS, STRESSES
from benchmarks.controller.run import LAWS
import numpy as np

DEVIATE = 1.96
ALL = 'all'
TO_DEGREES = math.degrees(1.0)


class Group(NamedTuple):
    """
    Pushes of one kind under one law.

    :param kind: one of ``KINDS``, or ``ALL``.
    :param stress: one of ``STRESSES``.
    :param law: one of ``LAWS``.
    :param unplanned: number of cases without a contact that leads to the goal.
    :param refused: number of those refused from where the robot stood, a little misplaced.
    :param pushes: (job, record) of those that were pushed.
    """

    kind: str
    stress: str
    law: str
    unplanned: int
    refused: int
    pushes: list

    @property
    def successes(self):
        """Number of pushes that came to rest within the tolerances."""
        return sum(record[f'{self.law}.success'] for _, record in self.pushes)

    def values(self, name):
        """Gather a figure of the pushes that the controller called done."""
        return np.array([record[f'{self.law}.{name}'] for _, record in self.pushes
                         if record[f'{self.law}.outcome'] == 'done'])


def groups(jobs, records):
    """
    Sort pushes by truth, law and kind; all kinds together come first.

    :param jobs: dicts of ``kind``, ``stress`` and ``seed``.
    :param records: what ``controller_run.push`` gave for them.
    """
    pairs = list(zip(jobs, records))
    found = [_group(kind, stress, law, pairs) for stress in STRESSES for law in LAWS
             for kind in (ALL, *KINDS)]
    return [group for group in found if group.pushes]


def _group(kind, stress, law, pairs):
    chosen = [(job, record) for job, record in pairs
              if job['stress'] == stress and kind in (ALL, job['kind'])]
    planned = [(job, record) for job, record in chosen if not record['plan']]
    pushes = [(job, record) for job, record in planned if record[f'{law}.outcome'] != 'refused']
    return Group(kind, stress, law, len(chosen) - len(planned), len(planned) - len(pushes),
                 pushes)


def wilson(hits, count):
    """
    95 % interval of a share, after E. B. Wilson (1927).

    :param hits: number of successes.
    :param count: number of trials.
    :return: (low, high).
    """
    share, square = hits / count, DEVIATE ** 2 / count
    middle = (share + 0.5 * square) / (1.0 + square)
    half = DEVIATE * math.sqrt((share * (1.0 - share) + 0.25 * square) / count) / (1.0 + square)
    return max(0.0, middle - half), min(1.0, middle + half)


def success_table(found):
    """
    Write successes and errors.

    :param found: list of ``Group``.
    """
    rows = []
    for group in found:
        count = len(group.pushes)
        low, high = wilson(group.successes, count)
        ratios = group.values('time_ratio')
        rows.append((group.stress, group.law, group.kind, count, group.unplanned, group.refused,
                     f'{100.0 * group.successes / count:.1f} %',
                     f'{100.0 * low:.1f} to {100.0 * high:.1f}',
                     spread(1e3 * group.values('position_error')),
                     spread(TO_DEGREES * group.values('heading_error')),
                     f'{np.median(ratios):.2f}' if len(ratios) else '-'))
    return table(['truth', 'law', 'object and drive', 'pushed', 'no plan', 'refused', 'success',
                  '95 % interval', 'mm median, p95', 'deg median, p95', 'time over plan'], rows)


def spread(values, form='.1f', high=95):
    """Write the median and a high percentile of some values."""
    if not len(values):
        return '-'
    return f'{np.median(values):{form}}, {np.percentile(values, high):{form}}'


def failure_table(found):
    """
    List the classes of failures, each with the first case that shows it.

    :param found: list of ``Group``.
    """
    rows = []
    for group in found:
        if group.kind == ALL:
            continue
        faults, first = Counter(), {}
        for job, record in group.pushes:
            if not record[f'{group.law}.success']:
                name = fault(record, group.law)
                faults[name] += 1
                first.setdefault(name, job['seed'])
        rows += [(group.stress, group.law, group.kind, name, count,
                  f'`--kind "{group.kind}" --stress "{group.stress}" --law {group.law} '
                  f'--seed {first[name]}`') for name, count in faults.most_common()]
    return table(['truth', 'law', 'object and drive', 'class', 'n', 'for example'],
                 rows) if rows else 'None.'


def fault(record, law):
    """Name the class of a failure: the controller's reason without its numbers."""
    if record[f'{law}.outcome'] == 'done':
        return 'says that it is done, and is not within 20 mm and 3 degrees'
    return re.sub(r'-?\d+(\.\d+)?', '#', record[f'{law}.reason']) or record[f'{law}.outcome']


def refusals(jobs, records):
    """List why goals had no plan, or were refused from where the robot stood."""
    found = Counter()
    for job, record in zip(jobs, records):
        if job['stress'] == STRESSES[0]:
            reason = record['plan'] or (record[f'{LAWS[0]}.outcome'] == 'refused'
                                        and record[f'{LAWS[0]}.reason'])
            if reason:
                found[job['kind'], re.sub(r'-?\d+(\.\d+)?', '#', reason)] += 1
    return '\n'.join(f'* {kind}: {count} x {reason}'
                     for (kind, reason), count in found.most_common()) or 'None.'


def table(titles, rows):
    """Write a Markdown table."""
    lines = [titles, ['---'] * len(titles), *rows]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)
