"""Report of the benchmark of the planner: text and a figure."""

from pathlib import Path
from typing import Any, Sequence

from benchmarks.planner.goals import DIFFERENTIAL
from benchmarks.planner.measure import Answer
from benchmarks.planner.results import Results
from benchmarks.planner.tables import (
    faults, growth_table, kind_table, quality_table, site_table, speed_table, table,
    warm_start_table,
)
from benchmarks.report_template import fill_template
import numpy as np

TEXT = Path(__file__).with_name('planner.md.in')
# Aims that were set for the planner, as ratios of CPU times in one run: planning on over a first
# plan; a differential drive over the first kind of push, median and 95th percentile; and choosing
# a site over one plan, median, 95th percentile, and where there is none. Of the cost above the
# best of random starts [%]: 95th percentile and greatest.
PLANNING_ON_AIM = 0.1
DIFFERENTIAL_AIMS = 3.0, 6.0
SITE_AIMS = 4.0, 15.0, 15.0
GAP_AIMS = 0.3, 1.0

AimRow = tuple[str, Any, str, bool]


def aim_table(results: Results) -> str:
    """Write every aim beside what was measured."""
    square = next(iter(results.kinds.values()))
    solved = 100.0 * np.mean([not answer.fault for answer in square])
    rows: list[AimRow] = [('goals of the square solved, %', 100, f'{solved:.1f}',
                           solved == 100.0)]
    rows += _gap_rows(results)
    plan = _median_cpu(square)
    for name, pairs in results.warm_starts.items():
        if pairs:
            first, on = (np.median([pair[i] for pair in pairs]) for i in (0, 1))
            rows.append(_at_most(f'planning on from a plan, over a first plan: {name}',
                                 PLANNING_ON_AIM, float(on / first)))
    driven = [answer.cpu for answer in results.kinds.get(DIFFERENTIAL, ())]
    for aim, share in zip(DIFFERENTIAL_AIMS, (50, 95)) if driven else ():
        rows.append(_at_most(f'differential drive at a vertex, over a plan: percentile {share}',
                             aim, float(np.percentile(driven, share)) / plan))
    times = [choice.cpu for choices in results.sites.values() for choice in choices
             if choice.is_found]
    none = [choice.cpu for choices in results.sites.values() for choice in choices
            if not choice.is_found]
    for aim, share in zip(SITE_AIMS, (50, 95)) if times else ():
        rows.append(_at_most(f'choosing a site, over a plan: percentile {share}', aim,
                             float(np.percentile(times, share)) / plan))
    if none:
        rows.append(_at_most('finding that there is no site, over a plan, median', SITE_AIMS[2],
                             float(np.median(none)) / plan))
    return table(['', 'aim', 'measured', 'met'],
                 [(*line[:3], 'yes' if line[3] else '**no**') for line in rows])


def _at_most(name: str, aim: float, value: float) -> AimRow:
    return name, aim, f'{value:.2g}', value <= aim


def _median_cpu(answers: Sequence[Answer]) -> float:
    return float(np.median([answer.cpu for answer in answers]))


def _gap_rows(results: Results) -> list[AimRow]:
    rows: list[AimRow] = []
    for name, qualities in results.quality.items():
        gaps = [100.0 * item.gap for item in qualities]
        for aim, title, share in zip(GAP_AIMS, ('p95', 'greatest'), (95, 100)) if gaps else ():
            rows.append(_at_most(f'{name}: cost above the best start, %, {title}', aim,
                                 float(np.percentile(gaps, share))))
    return rows


def text(results: Results) -> str:
    """Fill the template."""
    square = next(iter(results.kinds.values()))
    return fill_template(
        TEXT, COUNT=len(square), FIRST=f'{results.first:.1f}', AIMS=aim_table(results),
        SPEEDS=speed_table(square), KINDS=kind_table(results.kinds),
        FAULTS=faults(results.kinds), QUALITY=quality_table(results.quality),
        SITES=site_table(results.sites), GROWTH=growth_table(results.growth),
        AGAIN=warm_start_table(results.warm_starts), STARTS=results.starts)


def picture(path: Path, results: Results) -> None:
    """Draw the fractions of plans made within a CPU time, and within a gap."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure
    figure = Figure(figsize=(11, 6), layout='constrained')
    times, gaps = figure.subplots(1, 2, sharey=True, width_ratios=(3, 2))
    for i, (name, answers) in enumerate(results.kinds.items()):
        # The goals that the aims are set for stand out.
        _draw_fractions(times, [1e3 * answer.cpu for answer in answers], name,
                        color='black' if i == 0 else colormaps['tab20'](i - 1),
                        lw=1.2 if i else 2.4)
    for name, qualities in results.quality.items():
        _draw_fractions(gaps, [100.0 * max(item.gap, 0.0) for item in qualities], name)
    times.set(xlabel='CPU time of a plan [ms]', ylabel='fraction of the pushes', xscale='log')
    times.xaxis.set_major_formatter('{x:g}')
    gaps.set(xlabel='time above the best of random starts [%]')
    gaps.axvline(GAP_AIMS[1], color='black', lw=0.8, ls='--', label='aim for the greatest')
    for axis, columns in ((times, 2), (gaps, 1)):
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8, loc='upper left', bbox_to_anchor=(0.0, -0.12), ncols=columns)
    figure.savefig(path, dpi=110)


def _draw_fractions(axis: Any, values: list[float], name: str, **style: Any) -> None:
    if values:
        axis.step(sorted(values), np.arange(1, len(values) + 1) / len(values), where='post',
                  label=name, **style)
