"""
Controllers measured: how many random pushes each law brings to the goal, and how near.

Objects, friction, sensors, drives and placement are wrong in every case (see
``controller_cases.py``); cases that no plan solves are counted apart. Takes half an hour on two
cores; records are kept in ``--records`` as they come, and the same command goes on after an
interrupt. ``--seed`` runs one case and tells about it.
"""

import argparse
from pathlib import Path

from controller_cases import KINDS, STRESSES
from controller_run import push
from controller_tables import failure_table, success_table
from push_scenario.batch import run_batch
from tqdm import tqdm

LAWS = ('feedback', 'mpc')


def options():
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--cases', type=int, default=1000, help='of each law, over all kinds')
    parser.add_argument('--stressed', type=int, default=300, help='the same, of each stress')
    parser.add_argument('--records', type=Path, default=Path('out/controller'))
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    parser.add_argument('--kind', choices=tuple(KINDS), help='of the one case')
    parser.add_argument('--stress', choices=STRESSES, default=STRESSES[0])
    parser.add_argument('--law', choices=LAWS + ('open_loop',), default=LAWS[0])
    parser.add_argument('--seed', type=int, help='run this case only')
    return parser.parse_args()


def batch_of(kind, stress, count, chosen):
    """Run the cases of a kind under a stress; return (seeds, records) of those with a plan."""
    jobs = [{'kind': kind, 'seed': seed, 'stress': stress, 'laws': list(LAWS)}
            for seed in range(count)]
    name = f'{kind}, {stress}'.replace(', ', '-').replace(' ', '_').replace('%', 'percent')
    chosen.records.mkdir(parents=True, exist_ok=True)
    with tqdm(total=count, desc=f'{kind}, {stress}') as bar:
        result = run_batch(push, jobs, chosen.records / f'{name}.jsonl', workers=chosen.workers,
                           progress=lambda done, total: bar.update(done - bar.n), chunk=2)
    if result.errors:
        raise RuntimeError(f'{kind}, {stress}: got {result.errors}, expected no errors')
    planned = [(job['seed'], record) for job, record in zip(jobs, result.records)
               if not record['plan']]
    print(f'{kind}, {stress}: {count - len(planned)} of {count} without a plan')
    return [seed for seed, _ in planned], [record for _, record in planned]


def main():
    """Measure and print, or run one case."""
    chosen = options()
    if chosen.seed is not None:
        print(push({'kind': chosen.kind or next(iter(KINDS)), 'seed': chosen.seed,
                    'stress': chosen.stress, 'laws': [chosen.law]}))
        return
    rows = []
    for stress in STRESSES:
        count = chosen.cases if stress == STRESSES[0] else chosen.stressed
        for kind in KINDS:
            seeds, records = batch_of(kind, stress, count // len(KINDS), chosen)
            rows += [(kind, stress, law, seeds, records) for law in LAWS if records]
    print(success_table([(kind, stress, law, records)
                         for kind, stress, law, _, records in rows]))
    print()
    print(failure_table(rows))


if __name__ == '__main__':
    main()
