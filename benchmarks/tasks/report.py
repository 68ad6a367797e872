"""Report of the benchmark of tasks: text and a figure."""

from pathlib import Path
from typing import Iterator, NamedTuple, Sequence, Union

from benchmarks.controller.tables import ALL, Job, Pair, Record, table
from benchmarks.tasks.cases import ALONE, DISTURBED, IN_MAPS, OPEN, PARTS
from benchmarks.tasks.groups import Group, grouped, kind, variety
from benchmarks.tasks.tables import (
    collision_table, effort_table, failure_table, recovery_table, state_table, success_table,
)
import numpy as np
from push_model.geometry import FloatArray

TEXT = Path(__file__).with_name('tasks.md.in')
# Aims that were set for tasks: successes [%]; time and distance over those of the best single
# push; (percentile, CPU time of a plan [s]).
SUCCESS_AIM = 99.5
RATIO_AIM = 0.5
PLANNING_AIMS = (50, 0.3), (95, 1.0)
NOT_MEASURED = 'Not measured in this run.'
# Ratio at the left edge of the figure; tasks that no single push solves have a ratio of 0.
LEAST_SHOWN = 0.1
COLOURS: dict[str, str] = dict(zip(PARTS, ('C0', 'C1', 'C2', 'C3')))


class Aim(NamedTuple):
    """One line of the table of aims: its title, aim and measured value as text, whether met."""

    title: str
    aim: str
    measured: str
    is_met: bool


def aim_table(pairs: Sequence[Pair]) -> str:
    """
    Write every aim beside what was measured.

    :param pairs: (job, record) of all tasks.
    """
    rows = [row for part in PARTS if part != ALONE
            for group in grouped(pairs, part) for row in _rows(group)] + _against_alone(pairs)
    return table(['', 'aim', 'measured', 'met'],
                 [(*row[:3], 'yes' if row.is_met else '**no**') for row in rows])


def _rows(group: Group) -> Iterator[Aim]:
    rate = 100.0 * group.successes / len(group.tasks)
    yield Aim(
        f'{group.part}: success, %', f'{SUCCESS_AIM:g}',
        f'{rate:.1f} ({group.successes} of {len(group.tasks)})', rate >= SUCCESS_AIM)
    if group.part == IN_MAPS:
        hits = sum(int((group.values(f'{body}_clearance', successful=False) < 0.0).sum())
                   for body in ('robot', 'object'))
        yield Aim(f'{group.part}: collisions', '0', str(hits), hits == 0)
    if group.part != OPEN:
        return
    for name, unit in (('duration', 'time'), ('distance', 'distance')):
        single = 'single' if name == 'duration' else 'single_push_distance'
        value = _median(group.ratios(name, single))
        yield Aim(f'{group.part}: {unit} over that of the best single push, median',
                  f'{RATIO_AIM:g}', f'{value:.2f}', value <= RATIO_AIM)
    for percent, aim in PLANNING_AIMS:
        value = float(np.percentile(group.planning, percent)) if len(group.planning) else np.nan
        title = 'median' if percent == 50 else f'p{percent}'
        yield Aim(f'{group.part}: planning, CPU s, {title}', f'{aim:g}', f'{value:.2f}',
                  value <= aim)
    below = int((group.ratios('duration', 'least') < 1.0).sum())
    yield Aim(f'{group.part}: tasks quicker than the bound', '0', str(below), below == 0)


def _against_alone(pairs: Sequence[Pair]) -> list[Aim]:
    """Compare with the same tasks under single pushes only, where both succeed."""
    alone = {(job['kind'], job['seed']): record for job, record in pairs if job['part'] == ALONE}
    both = [(record, alone[job['kind'], job['seed']]) for job, record in pairs
            if job['part'] == OPEN and (job['kind'], job['seed']) in alone]
    done = [(record, other) for record, other in both
            if record['success'] and other['success']]
    if not done:
        return []
    rows: list[Aim] = []
    for name, unit in (('duration', 'time'), ('distance', 'distance')):
        value = _median([record[name] / other[name] for record, other in done])
        rows.append(Aim(f'{OPEN}: {unit} over that with single pushes only, as driven, median of '
                        f'{len(done)}', f'{RATIO_AIM:g}', f'{value:.2f}', value <= RATIO_AIM))
    return rows


def _median(values: Union[Sequence[float], FloatArray]) -> float:
    return float(np.median(values)) if len(values) else np.nan


def text(jobs: Sequence[Job], records: Sequence[Record]) -> str:
    """
    Fill the template.

    :param jobs: dicts of ``part``, ``kind`` and ``seed``.
    :param records: what ``benchmarks.tasks.run.run`` returned for them.
    """
    pairs, filled = list(zip(jobs, records)), TEXT.read_text(encoding='utf-8')
    kinds = grouped(pairs, OPEN, kind)
    mapped, moved = (grouped(pairs, part, variety) for part in (IN_MAPS, DISTURBED))
    moved += grouped(pairs, DISTURBED, _state_when_moved)[1:]
    alone = grouped(pairs, ALONE)
    everything = [group for part in PARTS for group in grouped(pairs, part)]
    for name, value in (
            ('COUNTS', ', '.join(f'{len(group.tasks)} {group.part}' for group in everything)),
            ('AIMS', aim_table(pairs)),
            ('OPEN', success_table(kinds) if kinds else NOT_MEASURED),
            ('EFFORT', effort_table(kinds) if kinds else NOT_MEASURED),
            ('LEGS', state_table(everything)),
            ('MAPS', success_table(mapped) if mapped else NOT_MEASURED),
            ('ROOM', collision_table(mapped) if mapped else NOT_MEASURED),
            ('DISTURBED', success_table(moved) if moved else NOT_MEASURED),
            ('ALONE', success_table(alone) if alone else NOT_MEASURED),
            ('FAILURES', failure_table(pairs)), ('TROUBLES', recovery_table(pairs))):
        filled = filled.replace(f'@{name}@', value)
    return filled


def _state_when_moved(_: Job, record: Record) -> str:
    state = record.get('moved_in', '')
    return f'while it was in: {state}' if state else 'after the end'


def picture(path: Path, jobs: Sequence[Job], records: Sequence[Record]) -> None:
    """
    Draw times over those of a single push and over the bound, and the numbers of pushes.

    :param path: of the figure.
    :param jobs: as for ``text``.
    :param records: as for ``text``.
    """
    from matplotlib.figure import Figure
    pairs = list(zip(jobs, records))
    figure = Figure(figsize=(11, 4.5), layout='constrained')
    times, pushes = figure.subplots(1, 2)
    for group in grouped(pairs, OPEN):
        for other, label in (('single', 'best single push, as planned; at the edge: none'),
                             ('least', 'lower bound')):
            ratios = np.maximum(np.sort(group.ratios('duration', other)), LEAST_SHOWN)
            times.step(ratios, np.arange(1, len(ratios) + 1) / len(group.tasks), where='post',
                       label=f'over {label}')
    times.plot(RATIO_AIM, 0.5, 'k+', ms=10, label='aim as stated')
    times.set(xlabel='time of the task as driven, over ...', ylabel='fraction of the tasks',
              xscale='log', xlim=(LEAST_SHOWN, 100.0), ylim=(0.0, 1.01))
    times.xaxis.set_major_formatter('{x:g}')
    for group in [group for part in PARTS for group in grouped(pairs, part)
                  if group.name == ALL and group.successes]:
        counts = np.bincount(group.values('pushes').astype(int))
        pushes.plot(np.cumsum(counts) / len(group.tasks), 'o-', color=COLOURS[group.part],
                    label=group.part)
    pushes.set(xlabel='pushes', ylabel='fraction of the tasks done with so many', ylim=(0.0, 1.01))
    for axis in (times, pushes):
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8, loc='lower right')
    figure.savefig(path, dpi=110)
