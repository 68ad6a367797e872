"""Tables of the benchmark of the planner, in Markdown."""

import collections
import math
from typing import Any, Iterable, Mapping, Protocol, Sequence

from benchmarks.planner.measure import Answer
from benchmarks.planner.random_starts import Quality
import numpy as np

# Duration above the best of random starts that counts as small [%]; chosen.
SMALL_GAP = 0.5


class SiteTimes(Protocol):
    """CPU time [s] of a choice of a site, and whether there is one."""

    @property
    def cpu(self) -> float: ...  # noqa: D102

    @property
    def is_found(self) -> bool: ...  # noqa: D102


class TwoPlans(Protocol):
    """CPU times from nothing and on from a plan [s], and ratio of the times of the pushes."""

    @property
    def first(self) -> float: ...  # noqa: D102

    @property
    def on(self) -> float: ...  # noqa: D102

    @property
    def duration(self) -> float: ...  # noqa: D102

    @property
    def went_on(self) -> bool: ...  # noqa: D102


def table(head: Sequence[Any], rows: Iterable[Sequence[Any]]) -> str:
    """Write a Markdown table."""
    return '\n'.join('| ' + ' | '.join(map(str, line)) + ' |'
                     for line in (head, ['---'] * len(head), *rows))


def quantiles(values: Sequence[float], form: str = '{:.1f}', scale: float = 1e3) -> list[str]:
    """Write median, 95th percentile and greatest of some values; empty without any."""
    if not len(values):
        return ['', '', '']
    return [form.format(scale * value) for value in (*np.percentile(values, (50, 95)),
                                                     np.max(values))]


def greatest(values: Sequence[float], form: str, scale: float = 1.0) -> str:
    """Write the greatest of some values; empty without any."""
    return form.format(scale * max(values)) if values else ''


def row(name: str, answers: Sequence[Answer]) -> list[str]:
    """Write one kind of push."""
    good = [answer for answer in answers if not answer.fault]
    driven = [answer.replay for answer in answers if answer.replay]
    over = [answer.duration / answer.bound for answer in good if answer.bound > 0.0]
    return [name, f'{len(good)}/{len(answers)}', *quantiles([answer.cpu for answer in answers]),
            greatest([run.position_error for run in driven], '{:.3f}', 1e3),
            greatest([math.degrees(run.heading_error) for run in driven], '{:.4f}'),
            greatest([run.steepest / answer.problem.planning_cone_angle for answer in answers
                      if (run := answer.replay)], '{:.2f}'),
            f'{np.median(over):.2f} / {min(over):.2f}' if over else '']


HEAD = ['', 'solved', 'CPU ms median', 'p95', 'max', 'position error mm, max',
        'heading error deg, max', 'force over planning cone, max',
        'time over displacement bound, median / least']


def kind_table(kinds: dict[str, list[Answer]]) -> str:
    """Write all kinds of pushes."""
    return table(HEAD, [row(name, answers) for name, answers in kinds.items()])


def speed_table(answers: Sequence[Answer]) -> str:
    """Write the pushes of one kind by their speeds."""
    groups: dict[float, list[Answer]] = collections.defaultdict(list)
    for answer in answers:
        groups[answer.problem.settings.pushing_speed].append(answer)
    return table(HEAD, [row(f'{speed:g} m/s', groups[speed]) for speed in sorted(groups)])


def faults(kinds: dict[str, list[Answer]]) -> str:
    """Write the unsolved pushes, one line for each kind and reason."""
    counts: collections.Counter[tuple[str, str]] = collections.Counter()
    for name, answers in kinds.items():
        counts.update((name, answer.fault) for answer in answers if answer.fault)
    lines = [f'* {name}: {count} x {fault}' for (name, fault), count in counts.most_common(12)]
    more = len(counts) - len(lines)
    if more > 0:
        lines.append(f'* and {more} other reasons')
    return '\n'.join(lines) or 'Nothing.'


def warm_start_table(kinds: Mapping[str, Sequence[TwoPlans]]) -> str:
    """Write planning from nothing against planning on, by what has changed."""
    rows: list[list[Any]] = []
    for name, pairs in kinds.items():
        if not pairs:
            continue
        rows.append([name, *quantiles([pair.first for pair in pairs])[:2],
                     *quantiles([pair.on for pair in pairs]),
                     f'{sum(pair.went_on for pair in pairs)}/{len(pairs)}',
                     f'{np.median([pair.duration for pair in pairs]):.4f}',
                     f'{max(pair.duration for pair in pairs):.4f}'])
    if not rows:
        return 'Not measured.'
    return table(['', 'from nothing: CPU ms median', 'p95', 'from the plan before: CPU ms median',
                  'p95', 'max', 'went on', 'time of the push over that from nothing, median',
                  'greatest'], rows)


def quality_table(groups: dict[str, list[Quality]]) -> str:
    """Write plans against the best of random starts."""
    rows: list[list[Any]] = []
    for name, qualities in groups.items():
        gaps = [100.0 * item.gap for item in qualities]
        rows.append([name, len(qualities), *quantiles(gaps, '{:.2f}', 1.0),
                     sum(gap <= SMALL_GAP for gap in gaps),
                     f'{np.mean([item.converged for item in qualities]):.0f}' if qualities else '',
                     sum(item.below_bound for item in qualities)])
    return table(['', 'pushes', 'above the best start by %, median', 'p95', 'max',
                  f'within {SMALL_GAP} %', 'starts that converged, mean', 'below the bound'], rows)


def site_table(kinds: Mapping[str, Sequence[SiteTimes]]) -> str:
    """Write the choice of the contact site, by the kind of drive and the answer."""
    rows: list[list[Any]] = []
    for kind, choices in kinds.items():
        for name, done in (('a site', True), ('none', False)):
            times = [choice.cpu for choice in choices if choice.is_found == done]
            if times:
                rows.append([kind, name, len(times), *quantiles(times)])
    return table(['drive', 'answer', 'goals', 'CPU ms, median', 'p95', 'max'], rows)


def growth_table(growths: Sequence[tuple[str, int, Sequence[float]]]) -> str:
    """Write CPU times over a number, each beside that of the first of its kind."""
    rows: list[list[Any]] = []
    first: dict[str, float] = {}
    for name, count, times in growths:
        median = float(np.median(times))
        first.setdefault(name, median)
        rows.append([name, count, f'{1e3 * median:.1f}', f'{median / first[name]:.2f}'])
    return table(['', 'number', 'CPU ms, median', 'over the first'], rows)
