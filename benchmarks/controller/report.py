"""Report of the benchmark of the controller: text and a figure."""

from pathlib import Path
from typing import Iterator, NamedTuple, Optional, Sequence

from benchmarks.controller.cases import STRESSES
from benchmarks.controller.dds import dds_table, OverDds
from benchmarks.controller.tables import (
    ALL, failure_table, Group, groups, Job, Record, refusals, success_table, table, TO_DEGREES,
)
from benchmarks.controller.timing import cpu_times, step_table, Timed
from benchmarks.report_template import fill_template
import numpy as np

TEXT = Path(__file__).with_name('controller.md.in')
# Aims that were set for the controller: successes [%], as stated and under stress.
SUCCESS_AIM = 99.7
STRESSED_AIM = 98.0
# Figure, factor to its unit, unit, (median, 95th percentile).
ERROR_AIMS = (('position_error', 1e3, 'mm', (3.0, 8.0)),
              ('heading_error', TO_DEGREES, 'deg', (0.2, 0.7)))
# CPU time of a step: (percentile, [ms]) of each law.
STEP_AIMS = {'feedback': ((50, 0.1),), 'mpc': ((50, 0.5), (99, 1.5))}
# 99th percentile of the latency over DDS [ms].
LATENCY_AIM = 5.0
COLOURS = {'feedback': 'C0', 'mpc': 'C1'}
STYLES: dict[str, str] = dict(zip(STRESSES, ('-', '--', ':')))


class Aim(NamedTuple):
    """One line of the table of aims: its title, aim and measured value as text, whether met."""

    title: str
    aim: str
    measured: str
    is_met: bool


class Results(NamedTuple):
    """
    All that was measured.

    :param jobs: random pushes.
    :param records: their figures.
    :param runs: name of the law -> ``Timed`` of the same cases.
    :param nodes: ``OverDds`` of each law, or None.
    """

    jobs: list[Job]
    records: list[Record]
    runs: dict[str, list[Timed]]
    nodes: Optional[list[OverDds]]


def aim_table(results: Results) -> str:
    """Write every aim beside what was measured."""
    rows = [*_push_aims(groups(results.jobs, results.records)), *_step_aims(results.runs)]
    rows += [Aim(f'{run.law}: pose to command over DDS, ms, p99', f'{LATENCY_AIM:g}',
                 f'{1e3 * run.high:.1f}', 1e3 * run.high <= LATENCY_AIM)
             for run in results.nodes or ()]
    return table(['', 'aim', 'measured', 'met'],
                 [(*row[:3], 'yes' if row.is_met else '**no**') for row in rows])


def _push_aims(all_groups: Sequence[Group]) -> Iterator[Aim]:
    for group in all_groups:
        if group.kind != ALL:
            continue
        name = f'{group.law}, {group.stress}'
        is_stressed = group.stress != STRESSES[0]
        success_aim = STRESSED_AIM if is_stressed else SUCCESS_AIM
        rate = 100.0 * group.successes / len(group.pushes)
        yield Aim(f'{name}: success, %', f'{success_aim:g}',
                  f'{rate:.1f} ({group.successes} of {len(group.pushes)})', rate >= success_aim)
        if is_stressed:
            continue
        for field, scale, unit, aims in ERROR_AIMS:
            values = scale * group.values(field)
            for percent, aim, title in zip((50, 95), aims, ('median', 'p95')):
                value = float(np.percentile(values, percent)) if len(values) else np.nan
                yield Aim(f'{name}: {unit}, {title}', f'{aim:g}', f'{value:.2f}', value <= aim)


def _step_aims(runs: dict[str, list[Timed]]) -> Iterator[Aim]:
    for law, aims in STEP_AIMS.items():
        for percent, aim in aims:
            value = float(np.percentile(cpu_times(runs[law], 'steps'), percent))
            title = 'median' if percent == 50 else f'p{percent}'
            yield Aim(f'{law}: CPU ms per step, {title}', f'{aim:g}', f'{value:.3f}',
                      value <= aim)


def text(results: Results) -> str:
    """Fill the template."""
    all_groups = groups(results.jobs, results.records)
    return fill_template(
        TEXT, COUNTS=_counts(results.jobs), AIMS=aim_table(results),
        SUCCESS=success_table([group for group in all_groups if group.kind == ALL]),
        KINDS=success_table([group for group in all_groups
                             if group.kind != ALL and group.stress == STRESSES[0]]),
        FAILURES=failure_table(all_groups), REFUSALS=refusals(results.jobs, results.records),
        STEPS=step_table(results.runs), NODES=dds_table(results.nodes))


def _counts(jobs: Sequence[Job]) -> str:
    return ', '.join(f"{sum(job['stress'] == stress for job in jobs)} {stress}"
                     for stress in STRESSES)


def picture(path: Path, results: Results) -> None:
    """Draw the fraction of pushes that end within an error, failures counted."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(11, 5), layout='constrained')
    axes = figure.subplots(1, 2, sharey=True)
    for group in groups(results.jobs, results.records):
        if group.kind == ALL:
            for axis, (field, scale, _, _) in zip(axes, ERROR_AIMS):
                values = np.sort(scale * group.values(field))
                axis.step(values, np.arange(1, len(values) + 1) / len(group.pushes),
                          where='post', color=COLOURS[group.law], ls=STYLES[group.stress],
                          label=f'{group.law}, {group.stress}')
    for axis, (_, _, unit, aims), title, least in zip(
            axes, ERROR_AIMS, ('position error', 'heading error'), (0.1, 0.01)):
        axis.plot(aims, (0.5, 0.95), 'k+', ms=10, label='aims as stated: median, p95')
        axis.set(xlabel=f'{title} at rest [{unit}]', xscale='log', ylim=(0.0, 1.01))
        axis.set_xlim(left=least)
        axis.xaxis.set_major_formatter('{x:g}')
        axis.grid(alpha=0.3)
    axes[0].set_ylabel('fraction of the pushes')
    axes[0].legend(fontsize=8, loc='upper left')
    figure.savefig(path, dpi=110)
