"""What the controller's benchmark found, as text and a picture."""

from pathlib import Path
from typing import NamedTuple

from benchmarks.controller.cases import STRESSES
from benchmarks.controller.dds import dds_table
from benchmarks.controller.grid import grid_table
from benchmarks.controller.tables import (
    ALL, failure_table, groups, refusals, success_table, table, TO_DEGREES,
)
from benchmarks.controller.timing import CONVERGED, pooled, step_table
import numpy as np

TEXT = Path(__file__).with_name('controller.md.in')
SUCCESS_AIM, STRESSED_AIM = 99.7, 98.0
ERROR_AIMS = (('position_error', 1e3, 'mm', (3.0, 8.0)),
              ('heading_error', TO_DEGREES, 'deg', (0.2, 0.7)))
STEP_AIMS = {'feedback': ((50, 0.1),), 'mpc': ((50, 0.5), (99, 1.5))}
RATIO_AIM, COST_AIM, LATENCY_AIM = 10.0, 1.02, 5.0
COLOURS = {'feedback': 'C0', 'mpc': 'C1'}
STYLES = dict(zip(STRESSES, ('-', '--', ':')))


class Results(NamedTuple):
    """
    All that was measured.

    :param jobs: random pushes.
    :param records: what came of them.
    :param grid_jobs: straight pushes; empty where they were left out.
    :param grid_records: what came of them.
    :param runs: name of the law -> ``controller_timing.Timed`` of the same cases.
    :param nodes: list of ``controller_dds.OverDds``, or None.
    """

    jobs: list
    records: list
    grid_jobs: list
    grid_records: list
    runs: dict
    nodes: list


def aim_table(results):
    """Write every aim beside what was measured."""
    rows = [*_push_aims(groups(results.jobs, results.records)), *_step_aims(results.runs)]
    rows += [(f'{run.law}: pose to command over DDS, ms, p99', f'{LATENCY_AIM:g}',
              f'{1e3 * run.high:.1f}', 1e3 * run.high <= LATENCY_AIM)
             for run in results.nodes or ()]
    return table(['', 'aim', 'measured', 'met'],
                 [(*row[:3], 'yes' if row[3] else '**no**') for row in rows])


def _push_aims(found):
    for group in found:
        if group.kind != ALL:
            continue
        name, usual = f'{group.law}, {group.stress}', group.stress == STRESSES[0]
        aim = SUCCESS_AIM if usual else STRESSED_AIM
        share = 100.0 * group.successes / len(group.pushes)
        yield (f'{name}: success, %', f'{aim:g}',
               f'{share:.1f} ({group.successes} of {len(group.pushes)})', share >= aim)
        for field, scale, unit, aims in ERROR_AIMS if usual else ():
            values = scale * group.values(field)
            for percent, aim, title in zip((50, 95), aims, ('median', 'p95')):
                value = np.percentile(values, percent) if len(values) else np.nan
                yield f'{name}: {unit}, {title}', f'{aim:g}', f'{value:.2f}', value <= aim


def _step_aims(runs):
    for law, aims in STEP_AIMS.items():
        for percent, aim in aims:
            value = np.percentile(pooled(runs[law], 'steps'), percent)
            yield (f'{law}: CPU ms per step, ' + ('median' if percent == 50 else f'p{percent}'),
                   f'{aim:g}', f'{value:.3f}', value <= aim)
    ratio = np.median(pooled(runs[CONVERGED], 'laws')) / np.median(pooled(runs['mpc'], 'laws'))
    yield 'mpc: times faster than converged', f'{RATIO_AIM:g}', f'{ratio:.0f}', ratio >= RATIO_AIM
    cost = sum(run.cost for run in runs['mpc']) / sum(run.cost for run in runs[CONVERGED])
    yield ('mpc: closed-loop cost over that of converged', f'{COST_AIM:g}', f'{cost:.3f}',
           cost <= COST_AIM)


def text(results):
    """Fill the template."""
    found = groups(results.jobs, results.records)
    filled = TEXT.read_text(encoding='utf-8')
    for name, value in (
            ('COUNTS', _counts(results.jobs)), ('AIMS', aim_table(results)),
            ('SUCCESS', success_table([group for group in found if group.kind == ALL])),
            ('KINDS', success_table([group for group in found if group.kind != ALL])),
            ('FAILURES', failure_table(found)),
            ('REFUSALS', refusals(results.jobs, results.records)),
            ('GRID', grid_table(results.grid_jobs, results.grid_records)
             if results.grid_jobs else 'Not measured in this run.'),
            ('STEPS', step_table(results.runs)), ('NODES', dds_table(results.nodes))):
        filled = filled.replace(f'@{name}@', value)
    return filled


def _counts(jobs):
    return ', '.join(f"{sum(job['stress'] == stress for job in jobs)} {stress}"
                     for stress in STRESSES)


def picture(path, results):
    """Draw the share of pushes that end within an error, failures counted."""
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
    axes[0].set_ylabel('share of the pushes')
    axes[0].legend(fontsize=8, loc='upper left')
    figure.savefig(path, dpi=110)
