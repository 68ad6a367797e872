"""Tables of the benchmark of the planner, in Markdown."""

import collections
import math
from typing import Any, Iterable, Mapping, Protocol, Sequence

from benchmarks.planner.measure import Answer
from benchmarks.planner.nlp_solvers import Quality, SolverRun
from benchmarks.planner.shooting import Shot
import numpy as np

# Duration above the best of random starts that counts as small [%]; chosen.
SMALL_GAP = 0.5


class SiteTimes(Protocol):
    """CPU time [s] of a choice of a site, and whether there is one."""

    @property
    def cpu(self) -> float: ...  # noqa: D102

    @property
    def found(self) -> bool: ...  # noqa: D102


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


def spread(values: Sequence[float], form: str = '{:.1f}', scale: float = 1e3) -> list[str]:
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
    return [name, f'{len(good)}/{len(answers)}', *spread([answer.cpu for answer in answers]),
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
    found: collections.Counter[tuple[str, str]] = collections.Counter()
    for name, answers in kinds.items():
        found.update((name, answer.fault) for answer in answers if answer.fault)
    lines = [f'* {name}: {count} x {fault}' for (name, fault), count in found.most_common(12)]
    more = len(found) - len(lines)
    if more > 0:
        lines.append(f'* and {more} other reasons')
    return '\n'.join(lines) or 'Nothing.'


def shot_table(results: Sequence[tuple[int, list[tuple[Answer, Shot]]]]) -> str:
    """Write single shooting against the planner on the same goals."""
    rows: list[list[Any]] = []
    for segments, pairs in results:
        if not pairs:
            continue
        good = [(answer, shot) for answer, shot in pairs if shot.solved]
        ours = [answer.cpu for answer, _ in good]
        theirs = [shot.cpu for _, shot in good]
        longer = [shot.path_length / answer.replay.path_length - 1.0 for answer, shot in good
                  if answer.replay is not None]
        rows.append([segments, f'{len(good)}/{len(pairs)}', *spread(theirs, '{:.0f}'),
                     *spread(ours)[:1], *([f'{np.median(theirs) / np.median(ours):.0f}',
                                           f'{100 * np.median(longer):.2f}',
                                           f'{100 * max(longer):.1f}'] if good else [''] * 3)])
    return table(['segments', 'solved', 'CPU ms median', 'p95', 'max', 'planner, median',
                  'ratio of medians', 'longer than the plan by %, median', 'max'], rows)


def warm_start_table(kinds: Mapping[str, Sequence[TwoPlans]]) -> str:
    """Write planning from nothing against planning on, by what has changed."""
    rows: list[list[Any]] = []
    for name, pairs in kinds.items():
        if not pairs:
            continue
        rows.append([name, *spread([pair.first for pair in pairs])[:2],
                     *spread([pair.on for pair in pairs]),
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
    for name, found in groups.items():
        gaps = [100.0 * item.gap for item in found]
        rows.append([name, len(found), *spread(gaps, '{:.2f}', 1.0),
                     sum(gap <= SMALL_GAP for gap in gaps),
                     f'{np.mean([item.converged for item in found]):.0f}' if found else '',
                     sum(item.below_bound for item in found)])
    return table(['', 'pushes', 'above the best start by %, median', 'p95', 'max',
                  f'within {SMALL_GAP} %', 'starts that converged, mean', 'below the bound'], rows)


def bound_table(groups: dict[str, list[tuple[float, float]]]) -> str:
    """Write plans on the ellipsoidal limit surface against the bounds of the vehicle."""
    rows: list[list[Any]] = []
    for name, found in groups.items():
        good = np.array([pair for pair in found if math.isfinite(pair[0])])
        if len(good):
            least, greatest = good.T
            rows.append([name, f'{len(good)}/{len(found)}', f'{least.min():.4f}',
                         f'{np.median(least):.3f}', sum(least < 1.0), f'{np.median(greatest):.4f}',
                         f'{greatest.max():.4f}'])
    return table(['', 'solved', 'time over the Dubins path of z, least', 'median', 'below 1',
                  'time over following that path, median', 'greatest'], rows)


def solver_table(rows: Sequence[SolverRun]) -> str:
    """Write the solvers on the same NLPs."""
    if not rows:
        return 'Not measured.'
    return table(['solver', 'solved', 'CPU ms median', 'p95', 'max', 'iterations, median',
                  'cost above that of the plan by %, max'],
                 [[run.name, f'{run.solved}/{run.tried}', *spread(run.cpu),
                   f'{np.median(run.iterations):.0f}' if run.iterations else '',
                   greatest(run.gaps, '{:.3f}', 100.0)] for run in rows])


def site_table(kinds: Mapping[str, Sequence[SiteTimes]]) -> str:
    """Write the choice of the contact site, by the kind of drive and the answer."""
    rows: list[list[Any]] = []
    for kind, found in kinds.items():
        for name, done in (('a site', True), ('none', False)):
            times = [choice.cpu for choice in found if choice.found == done]
            if times:
                rows.append([kind, name, len(times), *spread(times)])
    return table(['drive', 'answer', 'goals', 'CPU ms, median', 'p95', 'max'], rows)


def growth_table(found: Sequence[tuple[str, int, Sequence[float]]]) -> str:
    """Write CPU times over a number, each beside that of the first of its kind."""
    rows: list[list[Any]] = []
    first: dict[str, float] = {}
    for name, count, times in found:
        median = float(np.median(times))
        first.setdefault(name, median)
        rows.append([name, count, f'{1e3 * median:.1f}', f'{median / first[name]:.2f}'])
    return table(['', 'number', 'CPU ms, median', 'over the first'], rows)
