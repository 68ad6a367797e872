"""
Tasks measured: how many random goals are reached, how soon, with how many pushes.

On open floor, in maps, and with the object shoved or turned and poses lost (see
``tasks_cases.py``), and once more with single pushes only. Takes about an hour on two cores,
``--quick`` some six minutes. Tasks are
kept in ``--records`` as they come, and the same command goes on after Ctrl-C. ``--seed`` runs one
task and tells about it.
"""

import argparse
import dataclasses
import math
from pathlib import Path
import sys

from benchmarks.tasks.cases import ALONE, DISTURBED, draw, IN_MAPS, jobs, KINDS, OPEN, PARTS
from benchmarks.tasks.report import picture, text
from benchmarks.tasks.run import run, run_case
from push_scenario.batch.batch import run_batch
from push_scenario.definition.loader import scenario_text
from tqdm import tqdm

INTERRUPTED = 130


def options():
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--tasks', type=int, default=1000, help='on open floor')
    parser.add_argument('--mapped', type=int, default=200, help='in maps')
    parser.add_argument('--disturbed', type=int, default=200, help='disturbed')
    parser.add_argument('--alone', type=int, default=100, help='with single pushes only')
    parser.add_argument('--quick', action='store_true', help='100, 20, 20 and 20')
    parser.add_argument('--records', type=Path, default=Path('out/tasks'))
    parser.add_argument('--out', type=Path, help='directory for tasks.md and tasks.png')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--part', choices=PARTS, default=OPEN, help='of the one task')
    parser.add_argument('--kind', default=KINDS[OPEN][0], help='object and drive of the one task')
    parser.add_argument('--seed', type=int, help='run this task only')
    chosen = parser.parse_args()
    if chosen.kind not in KINDS[chosen.part]:
        parser.error(f'--kind: got {chosen.kind!r}, expected one of '
                     + '; '.join(KINDS[chosen.part]))
    if chosen.quick:
        chosen.tasks, chosen.mapped, chosen.disturbed, chosen.alone = 100, 20, 20, 20
    return chosen


def records(chosen, part, count):
    """Run tasks of one part, or go on with them; return jobs and records."""
    todo = jobs({part: count})
    with tqdm(total=len(todo), desc=part) as bar:
        result = run_batch(run, todo, chosen.records / f'{part.replace(" ", "_")}-{count}.jsonl',
                           workers=chosen.workers, chunk=1,
                           progress=lambda done, total: bar.update(done - bar.n))
    return todo, [record or {'success': False, 'outcome': 'error', 'reason': result.errors[index]}
                  for index, record in enumerate(result.records)]


def one(chosen):
    """Run one task and tell about it; write it as a scenario."""
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


def disturbed(case):
    """Return the scenario with what the intervention has moved."""
    done = case.intervention and case.intervention.displacement
    return dataclasses.replace(case.scenario, simulation=dataclasses.replace(
        case.scenario.simulation, object_displacements=(done,) if done else ()))


def main():
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
        print('\ninterrupted; the same command goes on', file=sys.stderr)
        return INTERRUPTED
    todo, done = ([item for part in found for item in part[side]] for side in (0, 1))
    written = text(todo, done)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'tasks.md').write_text(written, encoding='utf-8')
        picture(chosen.out / 'tasks.png', todo, done)
    return 0


if __name__ == '__main__':
    sys.exit(main())
