"""
Benchmark of stated chances: how often tasks and pushes end as their plans have stated.

Cases are those of ``benchmarks.tasks`` and ``benchmarks.controller`` with seeds of their own.
Coefficients are fitted in the package's own plant alone; ``--fit`` writes them to
``push_planner/outlook.json``. Each run is judged by coefficients fitted on runs with other seeds.
Takes some minutes on two cores, with ``--scale 8`` an hour. Records are stored in ``--records`` as
runs finish, and the same command resumes after Ctrl-C.
"""

import argparse
import functools
import itertools
import json
from pathlib import Path
import sys
from typing import Any, Callable

from benchmarks.chances.coverage import chance_table, quantile_table, Statement
from benchmarks.chances.fit import fit_model
from benchmarks.chances.jobs import push_jobs, task_jobs
from benchmarks.chances.runs import run_push, run_task, run_wide_task
from benchmarks.chances.samples import push_samples, PUSH_TOLERANCES, Sample, task_samples
from benchmarks.controller.tables import Job, Pair
from benchmarks.report_template import fill_template
from benchmarks.tasks.cases import IN_MAPS, OPEN, SLIPPERY, SPATIAL, STRICT
from push_model.outlook import LEVELS
from push_planner.outlook import COEFFICIENTS, MAP, OPEN_FLOOR, OutlookModel, STEERED_PUSH
from push_scenario.parallel import ERROR, JobFunction, progress_bar, run_many

TEXT = Path(__file__).with_name('chances.md.in')
WIDE = 'wide'
STEERED = 'steered pushes'
SPATIAL_STEERED = 'steered pushes, MuJoCo'
# Names of the groups in the report.
TITLES = {OPEN: 'tasks on open floor', STRICT: 'narrow tolerances',
          WIDE: 'wide tolerances', SLIPPERY: 'slippery contacts',
          SPATIAL: 'MuJoCo', IN_MAPS: 'maps', STEERED: STEERED,
          SPATIAL_STEERED: SPATIAL_STEERED}
COUNTS = {OPEN: 63, STRICT: 35, WIDE: 21, SLIPPERY: 21, SPATIAL: 22, IN_MAPS: 18, STEERED: 105,
          SPATIAL_STEERED: 24}
# What the coefficients are fitted on: models and their groups.
FITTED = {OPEN_FLOOR: (OPEN, STRICT, WIDE), MAP: (IN_MAPS,), STEERED_PUSH: (STEERED,)}
# Parts of the seeds, each of which is judged by what was fitted on the others; chosen.
FOLDS = 5
# Further tolerances at which chances of steered pushes are checked, over their own.
SCALES = 0.5, 0.25
# Exit status after Ctrl-C: 128 + SIGINT, the convention of shells.
INTERRUPTED = 130

Samples = dict[str, list[Sample]]
Condition = Callable[[Sample], bool]


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description='Benchmark of stated chances.')
    parser.add_argument('--scale', type=float, default=1.0, help='factor of all numbers of cases')
    parser.add_argument('--fit', action='store_true',
                        help='fit the coefficients first, and write them beside the code')
    parser.add_argument('--records', type=Path, default=Path('out/chances'))
    parser.add_argument('--out', type=Path, help='directory for chances.md')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    return parser.parse_args()


def measure(chosen: argparse.Namespace) -> Samples:
    """Run all cases, or resume them; list the samples of each group."""
    samples: Samples = {}
    for group, count in COUNTS.items():
        scaled = max(1, round(chosen.scale * count))
        if group in (STEERED, SPATIAL_STEERED):
            jobs = push_jobs(scaled, is_spatial=group == SPATIAL_STEERED)
            samples[group] = push_samples(group, _run(chosen, run_push, group, jobs))
        else:
            jobs = task_jobs(OPEN if group == WIDE else group, scaled)
            function = run_wide_task if group == WIDE else run_task
            samples[group] = task_samples(group, _run(chosen, function, group, jobs))
    return samples


def _run(chosen: argparse.Namespace, function: JobFunction, title: str,
         jobs: list[Job]) -> list[Pair]:
    records = run_many(function, jobs, folder=chosen.records, workers=chosen.workers, block=1,
                       progress=progress_bar(title))
    errors = [record[ERROR] for record in records if ERROR in record]
    if errors:
        raise RuntimeError(f'{title}: got {errors}, expected no errors')
    return list(zip(jobs, records))


def fit(samples: Samples, condition: Condition = lambda _: True) -> dict[str, Any]:
    """
    Fit all models.

    :param condition: which samples count.
    :return: plain values by name, as ``push_planner/outlook.json`` has them.
    """
    members = {name: [sample for group in groups for sample in samples[group]
                      if condition(sample)] for name, groups in FITTED.items()}
    open_floor = fit_model(members[OPEN_FLOOR])
    return {OPEN_FLOOR: open_floor,
            MAP: fit_model(members[MAP], open_floor['time']['narrow_slopes']),
            STEERED_PUSH: fit_model(members[STEERED_PUSH], [0.0] * len(LEVELS))}


def _is_outside(fold: int, sample: Sample) -> bool:
    return sample.seed % FOLDS != fold


def statements(samples: Samples) -> dict[str, list[Statement]]:
    """List what is stated of every run by models fitted on runs with other seeds."""
    models = [{name: OutlookModel.from_mapping(values) for name, values in fit(
        samples, functools.partial(_is_outside, fold)).items()} for fold in range(FOLDS)]
    return {group: [Statement(sample, sample.outlook(models[sample.seed % FOLDS][sample.model]))
                    for sample in members] for group, members in samples.items()}


def report(samples: Samples) -> str:
    """Fill the template."""
    stated = statements(samples)
    goals, later = (_by_title(stated, is_first=is_first) for is_first in (True, False))
    narrow_goals = dict(goals)
    for group, scale in itertools.product((STEERED, SPATIAL_STEERED), SCALES):
        title = f'{TITLES[group]}, {1e3 * scale * PUSH_TOLERANCES.position:g} mm'
        narrow = {group: [sample.with_tolerances(scale) for sample in samples[group]]}
        narrow_goals[title] = statements({**samples, **narrow})[group]
    return fill_template(TEXT, GOALS=quantile_table(goals), CHANCES=chance_table(narrow_goals),
                         PLANS=quantile_table(later))


def _by_title(stated: dict[str, list[Statement]], *,
              is_first: bool) -> dict[str, list[Statement]]:
    rows: dict[str, list[Statement]] = {}
    for group, title in TITLES.items():
        for statement in stated[group]:
            sample = statement.sample
            size = f', {1e3 * sample.tolerances.position:g} mm' if group == STRICT else ''
            if sample.is_first == is_first:
                rows.setdefault(title + size, []).append(statement)
    return rows


def main() -> int:
    """Measure, fit, print, write."""
    chosen = options()
    try:
        samples = measure(chosen)
    except KeyboardInterrupt:
        print('\ninterrupted; the same command resumes', file=sys.stderr)
        return INTERRUPTED
    if chosen.fit:
        COEFFICIENTS.write_text(json.dumps(fit(samples), indent=1) + '\n', encoding='utf-8')
    written = report(samples)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'chances.md').write_text(written, encoding='utf-8')
    return 0
