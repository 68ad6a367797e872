"""
Throughput of batches: cases of one push in this process, on all cores, on a Dask cluster.

Prints a Markdown table, and whether all of them gave the same rows to the bit.
"""

import argparse
from pathlib import Path
import tempfile
import time
from typing import Any, Iterator, NamedTuple
import zlib

import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, RoundRobot, Support
from push_scenario.batch.push_batch import run_pushes
from push_scenario.batch.push_cases import simulate_cases
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

    :param rows: checksum of its rows.
    :param seconds: wall time [s].
    :param rate: cases per second after the first block.
    """

    rows: int
    seconds: float
    rate: float


def draw(rng: np.random.Generator, count: int) -> dict[str, FloatArray]:
    """Draw mass, friction, start and command of some cases."""
    start = np.tile(np.array(PUSH.robot_pose), (count, 1))
    start[:, 1:] = rng.uniform((-0.1, -0.2), (0.1, 0.2), (count, 2))
    segments = np.zeros((count, 1, 4))
    segments[:, 0, 0] = STEPS * STEP
    segments[:, 0, 1] = rng.uniform(0.05, 0.3, count)
    segments[:, 0, 3] = rng.uniform(-0.2, 0.2, count)
    return {'object.mass': rng.uniform(1.0, 5.0, count),
            'object.contact_friction_coefficient': rng.uniform(0.2, 0.8, count),
            'friction_factors': rng.uniform(0.6, 1.4, (count, len(CORNERS))),
            'robot_pose': start, 'segments': segments}


def timed(cases: int, out: Path, mode: dict[str, Any]) -> BatchRun:
    """Run a batch with options of ``run_pushes``."""
    marks: list[tuple[float, int]] = []
    began = time.perf_counter()
    result = run_pushes(PUSH, draw, cases, out, progress=lambda done, _: marks.append(
        (time.perf_counter(), done)), **mode)
    seconds = time.perf_counter() - began
    first = next(mark for mark in marks if mark[1])
    rate = (marks[-1][1] - first[1]) / (marks[-1][0] - first[0])
    return BatchRun(zlib.crc32(result.rows.tobytes()), seconds, rate)


def execution_modes(cores: int, with_cluster: bool) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield (name, options of ``run_pushes``)."""
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
    parser.add_argument('--cases', type=int, default=20000, help='at least 2000')
    parser.add_argument('--repeat', type=int, default=3, help='runs of each, the fastest counts')
    parser.add_argument('--no-cluster', action='store_true', help='skip Dask')
    arguments = parser.parse_args()
    simulate_cases(PUSH, draw(np.random.default_rng(0), 1))
    checksums: set[int] = set()
    base = None
    print(f'{arguments.cases} cases of {STEPS} steps of {1e3 * STEP:g} ms\n')
    print('| | total [s] | cases/s | million steps/s | scaling | after startup |')
    print('|---|---|---|---|---|---|')
    for name, mode in execution_modes(available_cores(), not arguments.no_cluster):
        with tempfile.TemporaryDirectory() as directory:
            runs = [timed(arguments.cases, Path(directory) / f'{i}.npy', mode)
                    for i in range(arguments.repeat)]
        checksums.update(run.rows for run in runs)
        seconds = min(run.seconds for run in runs)
        rate = max(run.rate for run in runs)
        base = base or (seconds, rate)
        print(f'| {name} | {seconds:.2f} | {arguments.cases / seconds:.0f} '
              f'| {arguments.cases * STEPS / seconds / 1e6:.2f} | {base[0] / seconds:.2f} '
              f'| {rate * STEPS / 1e6:.2f} million steps/s, {rate / base[1]:.2f} |', flush=True)
    print('\nAll rows are the same to the bit.' if len(checksums) == 1
          else f'\n{len(checksums)} different results!')


if __name__ == '__main__':
    main()
