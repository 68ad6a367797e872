"""What random pushes came to, as tables."""

from collections import Counter
import math
import re

import numpy as np

DEVIATE = 1.96


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


def success_table(rows):
    """
    Write successes and errors.

    :param rows: list of (kind, stress, law, records that have a plan).
    """
    lines = ['| object and drive | truth | law | n | success | 95 % | mm median, p95 '
             '| deg median, p95 | time over plan |', '|---' * 9 + '|']
    for kind, stress, law, records in rows:
        good = [record for record in records if record[f'{law}.success']]
        low, high = wilson(len(good), len(records))
        errors = [_pair(good, f'{law}.{name}', scale) for name, scale in (
            ('position_error', 1e3), ('heading_error', math.degrees(1.0)))]
        ratio = np.median([record[f'{law}.time_ratio'] for record in good]) if good else math.nan
        lines.append(f'| {kind} | {stress} | {law} | {len(records)} '
                     f'| {100.0 * len(good) / len(records):.1f} % '
                     f'| {100.0 * low:.1f} to {100.0 * high:.1f} | {errors[0]} | {errors[1]} '
                     f'| {ratio:.2f} |')
    return '\n'.join(lines)


def _pair(records, name, scale):
    if not records:
        return '-'
    values = [scale * record[name] for record in records]
    return f'{np.median(values):.1f}, {np.percentile(values, 95):.1f}'


def failure_table(rows):
    """
    List the classes of failures, each with the first seed that shows it.

    :param rows: list of (kind, stress, law, seeds, records that have a plan).
    """
    lines = ['| object and drive | truth | law | class | n | for example |', '|---' * 6 + '|']
    for kind, stress, law, seeds, records in rows:
        found, first = Counter(), {}
        for seed, record in zip(seeds, records):
            if not record[f'{law}.success']:
                name = fault(record, law)
                found[name] += 1
                first.setdefault(name, seed)
        lines += [f'| {kind} | {stress} | {law} | {name} | {count} | `--kind "{kind}" --stress '
                  f'"{stress}" --law {law} --seed {first[name]}` |'
                  for name, count in found.most_common()]
    return '\n'.join(lines)


def fault(record, law):
    """Name the class of a failure: the controller's reason without its numbers."""
    if record[f'{law}.outcome'] == 'done':
        return 'says that it is done, and is not within 20 mm and 3 degrees'
    return re.sub(r'-?\d+(\.\d+)?', '#', record[f'{law}.reason']) or record[f'{law}.outcome']


def table(titles, rows):
    """Write a Markdown table."""
    lines = [titles, ['---'] * len(titles), *rows]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)
