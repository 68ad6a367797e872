"""
Controllers measured: how many random pushes each law brings to the goal, how near, how fast.

Objects, friction, sensors, drives and placement are wrong in every case (see
``controller_cases.py``); cases that no plan solves are counted apart. Takes half an hour on two
cores, ``--quick`` less than a minute. Pushes are kept in ``--records`` as they come, and the same
command goes on after Ctrl-C; only the times, some minutes at the end, are taken anew. ``--seed``
runs one case and tells about it.
"""

import argparse
from pathlib import Path
import sys

from benchmarks.controller import grid as controller_grid
from benchmarks.controller.cases import KINDS, scenario, STRESSES
from benchmarks.controller.dds import over_dds
from benchmarks.controller.report import picture, Results, text
from benchmarks.controller.run import LAWS, push
from benchmarks.controller.timing import STEERING, timed
from push_scenario.batch.batch import run_batch
from push_scenario.definition.loader import scenario_text
from tqdm import tqdm

INTERRUPTED = 130


def options():
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--cases', type=int, default=600, help='of each law, over all kinds')
    parser.add_argument('--stressed', type=int, default=200, help='the same, of each stress')
    parser.add_argument('--every', type=int, default=1,
                        help='of so many combinations of the grid one is pushed')
    parser.add_argument('--no-grid', action='store_true', help='leave straight pushes out')
    parser.add_argument('--timed', type=int, default=10, help='pushes whose steps are timed')
    parser.add_argument('--no-dds', action='store_true', help='leave the nodes over DDS out')
    parser.add_argument('--quick', action='store_true', help='few of everything, no nodes')
    parser.add_argument('--records', type=Path, default=Path('out/controller'))
    parser.add_argument('--out', type=Path, help='directory for controller.md and controller.png')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--kind', choices=tuple(KINDS), default=next(iter(KINDS)),
                        help='of the one case')
    parser.add_argument('--stress', choices=STRESSES, default=STRESSES[0])
    parser.add_argument('--law', choices=LAWS + ('open_loop',), default=LAWS[0])
    parser.add_argument('--seed', type=int, help='run this case only')
    chosen = parser.parse_args()
    if chosen.quick:
        chosen.cases = chosen.stressed = len(KINDS)
        chosen.every, chosen.timed, chosen.no_dds = 80, 1, True
    return chosen


def batch(function, jobs, name, chosen, chunk):
    """Run jobs, or go on with them; return their records."""
    with tqdm(total=len(jobs), desc=name) as bar:
        result = run_batch(function, jobs, chosen.records / f'{name}-{len(jobs)}.jsonl',
                           workers=chosen.workers, chunk=chunk,
                           progress=lambda done, total: bar.update(done - bar.n))
    if result.errors:
        raise RuntimeError(f'{name}: got {result.errors}, expected no errors')
    return result.records


def random_jobs(cases, stressed):
    """List the random pushes; those of one seed follow each other, as they share a plan."""
    return [{'kind': kind, 'seed': seed, 'stress': stress, 'laws': list(LAWS)}
            for seed in range(max(cases, stressed) // len(KINDS)) for kind in KINDS
            for stress in STRESSES
            if seed < (cases if stress == STRESSES[0] else stressed) // len(KINDS)]


def timings(count):
    """Time the steps of every law on the same cases, one process."""
    runs, kinds, seed = {name: [] for name in STEERING}, list(KINDS)[1:] + list(KINDS)[:1], 0
    with tqdm(total=count, desc='times') as bar:
        while bar.n < count:
            for name in STEERING:
                run = timed(kinds[seed % len(kinds)], seed, name)
                if run is None:
                    break
                runs[name].append(run)
            else:
                bar.update()
            seed += 1
    return runs


def nodes(chosen):
    """Measure the nodes where ROS 2 is at hand; None otherwise."""
    if chosen.no_dds:
        return None
    try:
        return over_dds(LAWS)
    except ModuleNotFoundError as error:
        print(f'nodes: no module {error.name}, not measured', file=sys.stderr)
        return None


def one(chosen):
    """Run one case; write it as a scenario."""
    case, _ = scenario(chosen.kind, chosen.seed, chosen.stress)
    chosen.records.mkdir(parents=True, exist_ok=True)
    path = chosen.records / 'random.yaml'
    path.write_text(scenario_text(case), encoding='utf-8')
    print(push({'kind': chosen.kind, 'seed': chosen.seed, 'stress': chosen.stress,
                'laws': [chosen.law]}))
    print(f'written: {path}; replay {path} --law {chosen.law} --in-process')


def measure(chosen):
    """Run all parts; return ``Results``."""
    jobs = random_jobs(chosen.cases, chosen.stressed)
    records = batch(push, jobs, 'pushes', chosen, len(STRESSES))
    grid = [] if chosen.no_grid else controller_grid.cases(chosen.every)
    return Results(jobs, records, grid, batch(controller_grid.push, grid, 'grid', chosen, 2),
                   timings(chosen.timed), nodes(chosen))


def main():
    """Measure, print, write; or run one case."""
    chosen = options()
    if chosen.seed is not None:
        one(chosen)
        return 0
    try:
        results = measure(chosen)
    except KeyboardInterrupt:
        print('\ninterrupted; the same command goes on', file=sys.stderr)
        return INTERRUPTED
    written = text(results)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'controller.md').write_text(written, encoding='utf-8')
        picture(chosen.out / 'controller.png', results)
    return 0


if __name__ == '__main__':
    sys.exit(main())
