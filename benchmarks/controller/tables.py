"""Tables of the benchmark of the controller, in Markdown."""

from collections import Counter
import math
import re
from typing import Any, Iterable, NamedTuple, Sequence, Union

from benchmarks.controller.cases import KINDS, STRESSES
from benchmarks.controller.run import LAWS
import numpy as np
from push_model.geometry import FloatArray

# A job names a case, a record holds its figures; both are flat dicts that JSON can store.
Job = dict[str, Any]
Record = dict[str, Any]
Pair = tuple[Job, Record]
# Two-sided 95 % quantile of the normal distribution.
DEVIATE = 1.96
ALL = 'all'
TO_DEGREES = math.degrees(1.0)


class Group(NamedTuple):
    """
    Pushes of one kind under one law.

    :param kind: one of ``KINDS``, or ``ALL``.
    :param stress: one of ``STRESSES``.
    :param law: one of ``LAWS``.
    :param unplanned: number of cases without a plan.
    :param refused: number of cases refused at the start, where the robot is a little misplaced.
    :param pushes: (job, record) of every other case.
    """

    kind: str
    stress: str
    law: str
    unplanned: int
    refused: int
    pushes: list[Pair]

    @property
    def successes(self) -> int:
        """Number of pushes that came to rest within the tolerances."""
        return sum(record[f'{self.law}.success'] for _, record in self.pushes)

    def values(self, name: str) -> FloatArray:
        """Gather a figure of the pushes that the controller reported as done."""
        return np.array([record[f'{self.law}.{name}'] for _, record in self.pushes
                         if record[f'{self.law}.outcome'] == 'done'])


def groups(jobs: Sequence[Job], records: Sequence[Record]) -> list[Group]:
    """
    Group pushes by stress, law and kind; all kinds together come first.

    :param jobs: dicts of ``kind``, ``stress`` and ``seed``.
    :param records: what ``benchmarks.controller.run.push`` returned for them.
    """
    pairs = list(zip(jobs, records))
    candidates = [_group(kind, stress, law, pairs) for stress in STRESSES for law in LAWS
                  for kind in (ALL, *KINDS)]
    return [group for group in candidates if group.pushes]


def _group(kind: str, stress: str, law: str, pairs: Sequence[Pair]) -> Group:
    chosen = [(job, record) for job, record in pairs
              if job['stress'] == stress and kind in (ALL, job['kind'])]
    planned = [(job, record) for job, record in chosen if not record['plan']]
    pushes = [(job, record) for job, record in planned if record[f'{law}.outcome'] != 'refused']
    return Group(kind, stress, law, len(chosen) - len(planned), len(planned) - len(pushes),
                 pushes)


def wilson(hits: int, count: int) -> tuple[float, float]:
    """
    Compute the 95 % confidence interval of a success rate, after E. B. Wilson (1927).

    :param hits: number of successes.
    :param count: number of trials.
    :return: (low, high).
    """
    rate = hits / count
    term = DEVIATE ** 2 / count
    middle = (rate + 0.5 * term) / (1.0 + term)
    half_width = DEVIATE * math.sqrt((rate * (1.0 - rate) + 0.25 * term) / count) / (1.0 + term)
    return max(0.0, middle - half_width), min(1.0, middle + half_width)


def success_table(all_groups: Sequence[Group]) -> str:
    """
    Write successes and errors.

    :param all_groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in all_groups:
        count = len(group.pushes)
        low, high = wilson(group.successes, count)
        ratios = group.values('time_ratio')
        rows.append((group.stress, group.law, group.kind, count, group.unplanned, group.refused,
                     f'{100.0 * group.successes / count:.1f} %',
                     f'{100.0 * low:.1f} to {100.0 * high:.1f}',
                     spread(1e3 * group.values('position_error')),
                     spread(TO_DEGREES * group.values('heading_error')),
                     f'{np.median(ratios):.2f}' if len(ratios) else '-'))
    return table(['true parameters', 'law', 'object and drive', 'pushed', 'no plan', 'refused',
                  'success', '95 % interval', 'mm median, p95', 'deg median, p95',
                  'time over plan'], rows)


def spread(values: Union[Sequence[float], FloatArray], form: str = '.1f', high: int = 95) -> str:
    """Write the median and a high percentile of some values."""
    if not len(values):
        return '-'
    return f'{np.median(values):{form}}, {np.percentile(values, high):{form}}'


def failure_table(all_groups: Sequence[Group]) -> str:
    """
    List the classes of failures, each with the first case that shows it.

    :param all_groups: list of ``Group``.
    """
    rows: list[Sequence[Any]] = []
    for group in all_groups:
        if group.kind == ALL:
            continue
        faults: Counter[str] = Counter()
        first: dict[str, int] = {}
        for job, record in group.pushes:
            if not record[f'{group.law}.success']:
                name = fault(record, group.law)
                faults[name] += 1
                first.setdefault(name, job['seed'])
        rows += [(group.stress, group.law, group.kind, name, count,
                  f'`--kind "{group.kind}" --stress "{group.stress}" --law {group.law} '
                  f'--seed {first[name]}`') for name, count in faults.most_common()]
    return table(['true parameters', 'law', 'object and drive', 'class', 'n', 'for example'],
                 rows) if rows else 'None.'


def fault(record: Record, law: str) -> str:
    """Name the class of a failure: the controller's reason without its numbers."""
    if record[f'{law}.outcome'] == 'done':
        return 'says that it is done, and is not within 20 mm and 3 degrees'
    return re.sub(r'-?\d+(\.\d+)?', '#', record[f'{law}.reason']) or record[f'{law}.outcome']


def refusals(jobs: Sequence[Job], records: Sequence[Record]) -> str:
    """List why goals had no plan, or were refused at the start."""
    reasons: Counter[tuple[str, str]] = Counter()
    for job, record in zip(jobs, records):
        if job['stress'] == STRESSES[0]:
            reason = record['plan']
            if not reason and record[f'{LAWS[0]}.outcome'] == 'refused':
                reason = record[f'{LAWS[0]}.reason']
            if reason:
                reasons[job['kind'], re.sub(r'-?\d+(\.\d+)?', '#', reason)] += 1
    return '\n'.join(f'* {kind}: {count} x {reason}'
                     for (kind, reason), count in reasons.most_common()) or 'None.'


def table(titles: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Write a Markdown table."""
    lines = [titles, ['---'] * len(titles), *rows]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)
