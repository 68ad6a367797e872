"""Report of the benchmark of the planner: text and a figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TYPE_CHECKING

from benchmarks.planner.tables import (
    bound_table, faults, GAP_AIM, kind_table, quality_table, shot_table, solver_table, speed_table,
    table, warm_start_table,
)
import numpy as np

if TYPE_CHECKING:
    from benchmarks.planner.benchmark import Results

TEXT = Path(__file__).with_name('planner.md.in')
# Aims that were set for the planner: median and 95th percentile of the CPU time [ms], CPU time of
# single shooting over it, median CPU time with a warm start [ms].
MEDIAN_AIM = 6.0
HIGH_AIM = 15.0
RATIO_AIM = 200.0
WARM_AIM = 3.0


def aim_table(results: Results) -> str:
    """Write every aim beside what was measured."""
    square = next(iter(results.kinds.values()))
    cpu = [1e3 * answer.cpu for answer in square]
    solved = 100.0 * np.mean([not answer.fault for answer in square])
    median, high = np.percentile(cpu, (50, 95))
    rows: list[tuple[Any, ...]] = [
            ('goals of the square solved, %', 100, f'{solved:.1f}', solved == 100.0),
            ('CPU ms, median', MEDIAN_AIM, f'{median:.1f}', median <= MEDIAN_AIM),
            ('CPU ms, p95', HIGH_AIM, f'{high:.1f}', high <= HIGH_AIM)]
    pairs = [pair for pair in results.shots[0][1] if pair[1].solved]
    if pairs:
        ratio = np.median([s.cpu for _, s in pairs]) / np.median([a.cpu for a, _ in pairs])
        rows.append(('times faster than single shooting', RATIO_AIM, f'{ratio:.0f}',
                     ratio >= RATIO_AIM))
    for name, found in results.quality.items():
        if found:
            worst = max(100.0 * item.gap for item in found)
            rows.append((f'{name}: cost above the best start, %, max', GAP_AIM, f'{worst:.2f}',
                         worst <= GAP_AIM))
    if results.warm_starts:
        warm = 1e3 * np.median([pair[1][0] for pair in results.warm_starts])
        rows.append(('planning on from a plan, CPU ms, median', WARM_AIM, f'{warm:.1f}',
                     warm <= WARM_AIM))
    return table(['', 'aim', 'measured', 'met'],
                 [(*line[:3], 'yes' if line[3] else '**no**') for line in rows])


def text(results: Results) -> str:
    """Fill the template."""
    square = next(iter(results.kinds.values()))
    filled = TEXT.read_text(encoding='utf-8')
    for name, value in (
            ('COUNT', len(square)), ('FIRST', f'{results.first:.1f}'),
            ('AIMS', aim_table(results)), ('SPEEDS', speed_table(square)),
            ('KINDS', kind_table(results.kinds)), ('FAULTS', faults(results.kinds)),
            ('SHOTS', shot_table(results.shots)), ('QUALITY', quality_table(results.quality)),
            ('SOLVERS', solver_table(results.solvers)),
            ('AGAIN', warm_start_table(results.warm_starts)),
            ('STARTS', results.starts), ('BOUNDS', bound_table(results.bounded))):
        filled = filled.replace(f'@{name}@', str(value))
    return filled


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
    for name, found in results.quality.items():
        _draw_fractions(gaps, [100.0 * max(item.gap, 0.0) for item in found], name)
    for aim, share in ((MEDIAN_AIM, 0.5), (HIGH_AIM, 0.95)):
        times.plot(aim, share, 'k+', ms=10, label='aims for the first' if share == 0.5 else None)
    times.set(xlabel='CPU time of a plan [ms]', ylabel='fraction of the pushes', xscale='log')
    times.xaxis.set_major_formatter('{x:g}')
    gaps.set(xlabel='time above the best of random starts [%]')
    gaps.axvline(GAP_AIM, color='black', lw=0.8, ls='--', label='aim')
    for axis, columns in ((times, 2), (gaps, 1)):
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8, loc='upper left', bbox_to_anchor=(0.0, -0.12), ncols=columns)
    figure.savefig(path, dpi=110)


def _draw_fractions(axis: Any, values: list[float], name: str, **style: Any) -> None:
    if values:
        axis.step(sorted(values), np.arange(1, len(values) + 1) / len(values), where='post',
                  label=name, **style)
