"""
Benchmark of the controller: how many random pushes each law brings to the goal, how accurately.

Nominal and true parameters of object, friction, sensors, drive and placement differ in every case
(see ``cases.py``); cases without a plan are counted separately. Takes half an hour on two cores,
``--quick`` less than a minute. Records are stored in ``--records`` as pushes finish, and the same
command resumes after Ctrl-C; only CPU times, some minutes at the end, are measured again.
``--seed`` runs one case and prints its record.
"""

import argparse
from pathlib import Path
import sys
from typing import Optional, Sequence

from benchmarks.controller.cases import KINDS, scenario, STRESSES
from benchmarks.controller.dds import over_dds, OverDds
from benchmarks.controller.report import picture, Results, text
from benchmarks.controller.run import LAWS, push
from benchmarks.controller.tables import Job, Record
from benchmarks.controller.timing import STEERING, Timed, timed
from push_scenario.definition.loader import scenario_text
from push_scenario.parallel import ERROR, JobFunction, progress_bar, run_many
from tqdm import tqdm

DESCRIPTION = 'Benchmark of the controller: how many random pushes each law brings to the goal.'
# Exit status after Ctrl-C: 128 + SIGINT, the convention of shells.
INTERRUPTED = 130


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--cases', type=int, default=600,
                        help='pushes under each law, over all kinds')
    parser.add_argument('--stressed', type=int, default=200, help='the same, under each stress')
    parser.add_argument('--timed', type=int, default=10, help='pushes whose steps are timed')
    parser.add_argument('--no-dds', action='store_true', help='skip the nodes over DDS')
    parser.add_argument('--quick', action='store_true', help='few of everything, no nodes')
    parser.add_argument('--records', type=Path, default=Path('out/controller'))
    parser.add_argument('--out', type=Path, help='directory for controller.md and controller.png')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--kind', choices=tuple(KINDS), default=next(iter(KINDS)),
                        help='object and drive of the case of --seed')
    parser.add_argument('--stress', choices=STRESSES, default=STRESSES[0])
    parser.add_argument('--law', choices=LAWS + ('open_loop',), default=LAWS[0])
    parser.add_argument('--seed', type=int, help='run this case only')
    chosen = parser.parse_args()
    if chosen.quick:
        chosen.cases = chosen.stressed = len(KINDS)
        chosen.timed, chosen.no_dds = 1, True
    return chosen


def run_jobs(function: JobFunction, jobs: Sequence[Job], name: str, chosen: argparse.Namespace,
             block: int) -> list[Record]:
    """Run jobs, or resume them; return their records."""
    records = run_many(function, jobs, folder=chosen.records / name, workers=chosen.workers,
                       block=block, progress=progress_bar(name))
    errors = [record[ERROR] for record in records if ERROR in record]
    if errors:
        raise RuntimeError(f'{name}: got {errors}, expected no errors')
    return records


def random_jobs(cases: int, stressed: int) -> list[Job]:
    """List the random pushes; those of one seed are neighbours, as they share a plan."""
    return [{'kind': kind, 'seed': seed, 'stress': stress, 'laws': list(LAWS)}
            for seed in range(max(cases, stressed) // len(KINDS)) for kind in KINDS
            for stress in STRESSES
            if seed < (cases if stress == STRESSES[0] else stressed) // len(KINDS)]


def timings(count: int) -> dict[str, list[Timed]]:
    """Measure the CPU time of steps under every law on the same cases, in one process."""
    runs: dict[str, list[Timed]] = {name: [] for name in STEERING}
    kinds = list(KINDS)[1:] + list(KINDS)[:1]
    seed = 0
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


def nodes(chosen: argparse.Namespace) -> Optional[list[OverDds]]:
    """Measure the nodes where ROS 2 is installed; None otherwise."""
    if chosen.no_dds:
        return None
    try:
        return over_dds(LAWS)
    except ModuleNotFoundError as error:
        print(f'nodes: no module {error.name}, not measured', file=sys.stderr)
        return None


def one(chosen: argparse.Namespace) -> None:
    """Run one case, print its record, and write it as a scenario."""
    case, _ = scenario(chosen.kind, chosen.seed, chosen.stress)
    chosen.records.mkdir(parents=True, exist_ok=True)
    path = chosen.records / 'random.yaml'
    path.write_text(scenario_text(case), encoding='utf-8')
    print(push({'kind': chosen.kind, 'seed': chosen.seed, 'stress': chosen.stress,
                'laws': [chosen.law]}))
    print(f'written: {path}; replay {path} --law {chosen.law} --in-process')


def measure(chosen: argparse.Namespace) -> Results:
    """Run all parts; return ``Results``."""
    jobs = random_jobs(chosen.cases, chosen.stressed)
    records = run_jobs(push, jobs, 'pushes', chosen, len(STRESSES))
    return Results(jobs, records, timings(chosen.timed), nodes(chosen))


def main() -> int:
    """Measure, print, write; or run one case."""
    chosen = options()
    if chosen.seed is not None:
        one(chosen)
        return 0
    try:
        results = measure(chosen)
    except KeyboardInterrupt:
        print('\ninterrupted; the same command resumes', file=sys.stderr)
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
