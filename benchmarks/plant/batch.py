"""
Throughput of batches: variations of one push in this process, on all cores, on a Dask cluster.

Prints a Markdown table, and whether all of them gave the same results to the bit.
"""

import argparse
from pathlib import Path
import tempfile
import time
from typing import Any, Iterator, NamedTuple

import numpy as np
from push_model.parameters import PushedObject, RoundRobot, Support
from push_scenario.batch.batch import run_batch, seeds
from push_scenario.batch.varied_push import VariedPush
from push_scenario.batch.workers import available_cores

DESCRIPTION = 'Throughput of batches: in this process, on all cores, on a Dask cluster.'
# Side of the box [m], number of steps of the plant and their length [s]; chosen: a push of 2 s.
SIDE = 0.4
STEPS = 400
STEP = 5e-3
CORNERS = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
OUTLINE = tuple((SIDE * x, SIDE * y) for x, y in CORNERS)
ROBOT = RoundRobot(0.17, 'holonomic')
PUSH = VariedPush(
    PushedObject(2.0, 0.053, tuple(Support(x, y, 0.3) for x, y in OUTLINE), OUTLINE), ROBOT,
    (0.0, 0.0, 0.0), (-0.5 * SIDE - ROBOT.radius, 0.0, 0.0), ((STEPS * STEP, 0.2, 0.0, 0.0),),
    STEP)


class BatchRun(NamedTuple):
    """
    One batch.

    :param table: bytes of its table.
    :param seconds: wall time [s].
    :param rate: jobs per second after the first result.
    """

    table: bytes
    seconds: float
    rate: float


def job(seed: int) -> dict[str, Any]:
    """Draw mass, friction, start and command of one variation."""
    rng = np.random.default_rng(seed)
    return {'object': {'mass': rng.uniform(1.0, 5.0),
                       'contact_friction_coefficient': rng.uniform(0.2, 0.8)},
            'friction_factors': rng.uniform(0.6, 1.4, len(CORNERS)).tolist(),
            'robot_pose': [PUSH.robot_pose[0], rng.uniform(-0.1, 0.1), rng.uniform(-0.2, 0.2)],
            'segments': [[STEPS * STEP, rng.uniform(0.05, 0.3), 0.0, rng.uniform(-0.2, 0.2)]]}


def timed(jobs: list[dict[str, Any]], out: Path, mode: dict[str, Any]) -> BatchRun:
    """Run a batch with options of ``run_batch``."""
    marks: list[tuple[float, int]] = []
    began = time.perf_counter()
    run_batch(PUSH, jobs, out, progress=lambda done, _: marks.append(
        (time.perf_counter(), done)), **mode)
    seconds = time.perf_counter() - began
    first = next(mark for mark in marks if mark[1])
    rate = (marks[-1][1] - first[1]) / (marks[-1][0] - first[0])
    return BatchRun(out.with_suffix('.csv').read_bytes(), seconds, rate)


def execution_modes(cores: int, with_cluster: bool) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield (name, options of ``run_batch``)."""
    yield 'one process', {'workers': 1}
    yield f'{cores} processes', {'workers': cores}
    if with_cluster:
        import distributed
        with distributed.LocalCluster(cores, threads_per_worker=1, host='127.0.0.1',
                                      dashboard_address=':0') as cluster, \
                distributed.Client(cluster, set_as_default=False) as client:
            yield (f'Dask, {cores} workers',
                   {'executor': client.get_executor(pure=False), 'workers': cores})


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--jobs', type=int, default=10000, help='number of variations')
    parser.add_argument('--repeat', type=int, default=3, help='runs of each, the fastest counts')
    parser.add_argument('--no-cluster', action='store_true', help='skip Dask')
    arguments = parser.parse_args()
    jobs = [job(seed) for seed in seeds(1, arguments.jobs)]
    PUSH(jobs[0])
    tables: set[bytes] = set()
    base = None
    print(f'{len(jobs)} variations of {STEPS} steps of {1e3 * STEP:g} ms\n')
    print('| | total [s] | variations/s | million steps/s | scaling | after startup |')
    print('|---|---|---|---|---|---|')
    for name, mode in execution_modes(available_cores(), not arguments.no_cluster):
        with tempfile.TemporaryDirectory() as directory:
            runs = [timed(jobs, Path(directory) / f'{i}.jsonl', mode)
                    for i in range(arguments.repeat)]
        tables.update(run.table for run in runs)
        seconds = min(run.seconds for run in runs)
        rate = max(run.rate for run in runs)
        base = base or (seconds, rate)
        print(f'| {name} | {seconds:.2f} | {len(jobs) / seconds:.0f} '
              f'| {len(jobs) * STEPS / seconds / 1e6:.2f} | {base[0] / seconds:.2f} '
              f'| {rate * STEPS / 1e6:.2f} million steps/s, {rate / base[1]:.2f} |', flush=True)
    print('\nAll tables are the same to the bit.' if len(tables) == 1
          else f'\n{len(tables)} different tables!')


if __name__ == '__main__':
    main()
