"""
Benchmark of tasks: how many random goals are reached, how soon, with how many pushes.

Tasks on open floor, in maps, and with an object that a person displaces and pose drop-outs (see
``cases.py``); those on open floor are repeated with single pushes only. Takes about an hour on two
cores, ``--quick`` some six minutes. Records are stored in ``--records`` as tasks finish, and the
same command resumes after Ctrl-C. ``--seed`` runs one task and prints what happened.
"""

import argparse
import dataclasses
import math
from pathlib import Path
import sys

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.cases import ALONE, Case, DISTURBED, draw, IN_MAPS, jobs, KINDS, OPEN, PARTS
from benchmarks.tasks.report import picture, text
from benchmarks.tasks.run import run, run_case
from push_scenario.batch.batch import run_batch
from push_scenario.definition.loader import scenario_text
from push_scenario.definition.scenario import Scenario
from tqdm import tqdm

DESCRIPTION = 'Benchmark of tasks: how many random goals are reached, how soon.'
# Exit status after Ctrl-C: 128 + SIGINT, the convention of shells.
INTERRUPTED = 130


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--tasks', type=int, default=1000, help='on open floor')
    parser.add_argument('--mapped', type=int, default=200, help='in maps')
    parser.add_argument('--disturbed', type=int, default=200, help='disturbed')
    parser.add_argument('--alone', type=int, default=100, help='with single pushes only')
    parser.add_argument('--quick', action='store_true', help='only 100, 20, 20 and 20')
    parser.add_argument('--records', type=Path, default=Path('out/tasks'))
    parser.add_argument('--out', type=Path, help='directory for tasks.md and tasks.png')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--part', choices=PARTS, default=OPEN, help='part of the task of --seed')
    parser.add_argument('--kind', default=KINDS[OPEN][0],
                        help='object and drive of the task of --seed')
    parser.add_argument('--seed', type=int, help='run this task only')
    chosen = parser.parse_args()
    if chosen.kind not in KINDS[chosen.part]:
        parser.error(f'--kind: got {chosen.kind!r}, expected one of '
                     + '; '.join(KINDS[chosen.part]))
    if chosen.quick:
        chosen.tasks, chosen.mapped, chosen.disturbed, chosen.alone = 100, 20, 20, 20
    return chosen


def records(chosen: argparse.Namespace, part: str, count: int) -> tuple[list[Job], list[Record]]:
    """Run tasks of one part, or resume them; return jobs and records."""
    todo = jobs({part: count})
    with tqdm(total=len(todo), desc=part) as bar:
        def advance(done: int, _: int) -> None:
            bar.update(done - bar.n)

        result = run_batch(run, todo, chosen.records / f'{part.replace(" ", "_")}-{count}.jsonl',
                           workers=chosen.workers, chunk=1,
                           progress=advance)
    return todo, [record or {'success': False, 'outcome': 'error', 'reason': result.errors[index]}
                  for index, record in enumerate(result.records)]


def one(chosen: argparse.Namespace) -> None:
    """Run one task and print what happened; write it as a scenario."""
    case = draw(chosen.part, chosen.kind, chosen.seed)
    result, clock = run_case(case)
    for change in result.history:
        print(f'{change.time:7.2f} s {change.state.value:9} {change.reason}')
    for number, plan in enumerate(result.sequence_plans, 1):
        pushes = ', '.join(f'{push.contact.kind} {push.contact.index}: {push.path_length:.2f} m'
                           for push in plan.pushes)
        print(f'plan {number}: {plan.duration:.1f} s '
              f'(single push {plan.single_push_time:.1f} s): {pushes}')
    if case.intervention is not None and case.intervention.displacement is not None:
        print(f'moved in {case.intervention.state}: {case.intervention.displacement}')
    print(f'{result.outcome.value} after {result.duration:.1f} s {result.reason}: '
          f'{1e3 * result.position_error:.1f} mm, {math.degrees(result.heading_error):.2f} deg; '
          f'planning {", ".join(f"{value:.2f} s" for value in clock.planning)}')
    chosen.records.mkdir(parents=True, exist_ok=True)
    path = chosen.records / 'random.yaml'
    path.write_text(scenario_text(disturbed(case)), encoding='utf-8')
    print(f'written: {path}; replay {path} --in-process')


def disturbed(case: Case) -> Scenario:
    """Return the scenario with the displacement that the intervention made."""
    displacement = None if case.intervention is None else case.intervention.displacement
    return dataclasses.replace(case.scenario, simulation=dataclasses.replace(
        case.scenario.simulation,
        object_displacements=() if displacement is None else (displacement,)))


def main() -> int:
    """Measure, print, write; or run one task."""
    chosen = options()
    if chosen.seed is not None:
        one(chosen)
        return 0
    counts = {OPEN: chosen.tasks, IN_MAPS: chosen.mapped, DISTURBED: chosen.disturbed,
              ALONE: chosen.alone}
    try:
        found = [records(chosen, part, count) for part, count in counts.items() if count]
    except KeyboardInterrupt:
        print('\ninterrupted; the same command resumes', file=sys.stderr)
        return INTERRUPTED
    todo = [job for jobs_of_part, _ in found for job in jobs_of_part]
    done = [record for _, records_of_part in found for record in records_of_part]
    written = text(todo, done)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'tasks.md').write_text(written, encoding='utf-8')
        picture(chosen.out / 'tasks.png', todo, done)
    return 0


if __name__ == '__main__':
    sys.exit(main())
