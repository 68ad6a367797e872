"""
Benchmark of tasks: how many random goals are reached, how soon, with how many pushes.

Tasks on open floor, in maps, disturbed, and variations of those on open floor (see ``cases.py``).
Tasks with a bad base run three times (see ``bases.py``). Takes hours on two cores, ``--quick``
some minutes. Records are stored in ``--records`` as tasks finish, and the same command resumes
after Ctrl-C. ``--seed`` runs one task and prints what happened.
"""

import argparse
import math
from pathlib import Path
import sys

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.bases import BAD_BASES, compared_jobs, LEARNED, TREATMENTS
from benchmarks.tasks.cases import (
    ANY_HEADING, BASE_PARTS, BASES, BY_ODOMETRY, draw, EYES_PARTS, FAR_ROBOTS, FLATS, free_jobs,
    IN_MAPS, jobs, KINDS, LIDAR_PARTS, odometry_jobs, OPEN, OWN_EYES, PARTS, PUBLIC_MAPS, SLOPES,
    SPATIAL_BASES, SPATIAL_EYES, STRICT, WALLS,
)
from benchmarks.tasks.eyes import ALWAYS_SEEN, EYES, seen_jobs
from benchmarks.tasks.picture import picture
from benchmarks.tasks.reference import refer
from benchmarks.tasks.report import text
from benchmarks.tasks.run import disturbed, run, run_case
from push_scenario.definition.loader import scenario_text
from push_scenario.parallel import ERROR, JobFunction, progress_bar, run_many

DESCRIPTION = 'Benchmark of tasks: how many random goals are reached, how soon.'
# Number of tasks of each part; those that are not here have 200. Strict: as many for each of two
# tolerances. Bad bases: twenty with each. Eyes: 35 with each.
COUNTS = {OPEN: 1000, STRICT: 400, FLATS: 100, FAR_ROBOTS: 50, PUBLIC_MAPS: 40, WALLS: 105,
          BASES: 20 * len(BAD_BASES),
          SPATIAL_BASES: 20 * len(BAD_BASES), SLOPES: 16, OWN_EYES: 35 * len(EYES),
          SPATIAL_EYES: 35 * len(EYES)}
OTHER_COUNT = 200
# With ``--quick``: on open floor one of each kind; of bad bases one each; few in maps, where
# planning takes long.
QUICK_COUNTS = {OPEN: 7, IN_MAPS: 2, FLATS: 2, BASES: len(BAD_BASES),
                SPATIAL_BASES: len(BAD_BASES), OWN_EYES: len(EYES), SPATIAL_EYES: len(EYES)}
OTHER_QUICK_COUNT = 4
# Exit status after Ctrl-C: 128 + SIGINT, the convention of shells.
INTERRUPTED = 130


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--part', type=part_and_count, action='append', dest='parts',
                        metavar='PART[=COUNT]', help='only this part, with as many tasks; may be '
                        'given several times: ' + ', '.join(PARTS))
    parser.add_argument('--kind', help='only this object and drive, such as "box_04, holonomic"')
    parser.add_argument('--count', type=int, help='number of tasks of every part')
    parser.add_argument('--quick', action='store_true', help='a few tasks of every part')
    parser.add_argument('--records', type=Path, default=Path('out/tasks'))
    parser.add_argument('--out', type=Path, help='directory for tasks.md and tasks.png')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--maps', help='folder with maps of map_server for the part '
                        f'{PUBLIC_MAPS}, which is skipped without it')
    parser.add_argument('--seed', type=int,
                        help='run this task of the part only, and print what happens')
    parser.add_argument('--base', choices=(*TREATMENTS, ALWAYS_SEEN, BY_ODOMETRY, ANY_HEADING),
                        default=LEARNED,
                        help='how such a task treats a bad base, or that its object is always '
                        'seen, or that its robot has no lidar, or that its bin may have any '
                        'heading at a wall; default: %(default)s')
    chosen = parser.parse_args()
    chosen.counts = {part: count for part, count in chosen.parts or [] if count is not None}
    if chosen.parts is not None:
        chosen.parts = [part for part, _ in chosen.parts]
    else:
        chosen.parts = [OPEN] if chosen.seed is not None else [
            part for part in PARTS if chosen.kind in (None, *KINDS[part])]
    for part in chosen.parts or [OPEN]:
        if chosen.kind not in (None, *KINDS[part]):
            parser.error(f'--kind: got {chosen.kind!r}, expected one of ' + '; '.join(KINDS[part]))
    if chosen.seed is not None and PUBLIC_MAPS in chosen.parts and not chosen.maps:
        parser.error(f'--maps: got none, expected a folder of maps for the part {PUBLIC_MAPS}')
    if chosen.count is not None and chosen.count < 1:
        parser.error(f'--count: got {chosen.count}, expected at least 1')
    return chosen


def part_and_count(text: str) -> tuple[str, int | None]:
    """
    Parse ``PART`` or ``PART=COUNT``.

    :param text: of the command line.
    :raises argparse.ArgumentTypeError: naming what is wrong.
    """
    part, _, count = text.partition('=')
    if part not in PARTS:
        raise argparse.ArgumentTypeError(f'got {part!r}, expected one of ' + ', '.join(PARTS))
    if count and not (count.isdigit() and int(count)):
        raise argparse.ArgumentTypeError(f'got a count of {count!r}, expected at least 1')
    return part, int(count) if count else None


def count_of(chosen: argparse.Namespace, part: str) -> int:
    """
    Return the number of tasks of a part.

    :param chosen: command line.
    :param part: one of ``PARTS``.
    """
    if part in chosen.counts:
        return chosen.counts[part]
    if chosen.count is not None:
        return chosen.count
    if chosen.quick:
        return QUICK_COUNTS.get(part, OTHER_QUICK_COUNT)
    return COUNTS.get(part, OTHER_COUNT)


def run_jobs(chosen: argparse.Namespace, function: JobFunction, title: str,
             todo: list[Job]) -> list[Record]:
    """Run jobs, or resume them; return their records."""
    records = run_many(function, todo, folder=chosen.records, workers=chosen.workers, block=1,
                       progress=progress_bar(title))
    return [{'success': False, 'outcome': 'error', 'reason': record[ERROR],
             'codes': record[ERROR].partition(':')[0]}
            if ERROR in record else record for record in records]


def measure(chosen: argparse.Namespace) -> tuple[list[Job], list[Record]]:
    """Run all tasks; return jobs and records."""
    all_jobs: list[Job] = []
    all_records: list[Record] = []
    for part in chosen.parts:
        if part == PUBLIC_MAPS and not chosen.maps:
            print(f'{part}: skipped, as --maps names no folder', file=sys.stderr)
            continue
        tasks = jobs(part, count_of(chosen, part), [chosen.kind] if chosen.kind else [])
        if part == PUBLIC_MAPS:
            tasks = [{**job, 'maps': chosen.maps} for job in tasks]
        if part in BASE_PARTS:
            tasks += compared_jobs(tasks)
        if part in EYES_PARTS:
            tasks += seen_jobs(tasks)
        if part in LIDAR_PARTS:
            tasks += odometry_jobs(tasks)
        if part == WALLS:
            tasks += free_jobs(tasks)
        references: list[Record] = [{} for _ in tasks]
        if part == OPEN:
            references = run_jobs(chosen, refer, f'{part}, reference', tasks)
        done = run_jobs(chosen, run, part, tasks)
        all_jobs += tasks
        all_records += [{**reference, **record} for reference, record in zip(references, done)]
    return all_jobs, all_records


def one(chosen: argparse.Namespace) -> None:
    """Run one task and print what happened; write it as a scenario."""
    part = chosen.parts[0]
    job: Job = {'part': part, 'kind': chosen.kind or KINDS[part][0], 'seed': chosen.seed,
                'base': chosen.base}
    if part == PUBLIC_MAPS:
        job['maps'] = chosen.maps
    case = draw(**job)
    result, clock = run_case(case)
    print(', '.join(f'{name} {value}' for name, value in job.items()))
    for change in result.history:
        print(f'{change.time:7.2f} s {change.state.value:9} {change.reason}')
    for number, plan in enumerate(result.task_plans, 1):
        print(f'plan {number}: {plan.expected_time:.1f} s: {plan.contact.kind} '
              f'{plan.contact.index}: {plan.length:.3f} m')
    if case.intervention is not None and case.intervention.displacement is not None:
        print(f'moved in {case.intervention.state}: {case.intervention.displacement}')
    print(f'{result.outcome.value} after {result.duration:.1f} s {result.reason}: '
          f'{1e3 * result.position_error:.1f} mm, '
          f'{math.degrees(result.heading_error):.2f} deg (tolerance {case.tolerance}); '
          f'planning {", ".join(f"{value:.2f} s" for value in clock.planning)}')
    chosen.records.mkdir(parents=True, exist_ok=True)
    path = chosen.records / 'random.yaml'
    path.write_text(scenario_text(disturbed(case)), encoding='utf-8')
    print(f'written: {path}; replay {path} --in-process')


def main() -> int:
    """Measure, print, write; or run one task."""
    chosen = options()
    if chosen.seed is not None:
        one(chosen)
        return 0
    try:
        all_jobs, all_records = measure(chosen)
    except KeyboardInterrupt:
        print('\ninterrupted; the same command resumes', file=sys.stderr)
        return INTERRUPTED
    page = chosen.out / 'tasks.md' if chosen.out else None
    before = page.read_text(encoding='utf-8') if page is not None and page.exists() else ''
    written = text(all_jobs, all_records, before)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'tasks.md').write_text(written, encoding='utf-8')
        if OPEN in chosen.parts:
            picture(chosen.out / 'tasks.png', all_jobs, all_records)
    return 0


if __name__ == '__main__':
    sys.exit(main())
