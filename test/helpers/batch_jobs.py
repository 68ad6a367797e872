"""Functions of one job, for batches whose workers import them."""

from functools import partial
import os
from pathlib import Path
import time
from typing import Any, Sequence

import numpy as np
from push_scenario.batch.batch import run_batch

Job = dict[str, Any]
Record = dict[str, Any]


def noisy(job: Job) -> Record:
    """Draw from the job's own seed."""
    rng = np.random.default_rng(job['seed'])
    return {'sum': float(rng.normal(size=100).sum()), 'seed': job['seed'], 'word': f'n{job["n"]}'}


def recorded(log: str | Path, job: Job) -> Record:
    """Note in a file that the job has run."""
    with open(log, 'a') as stream:
        stream.write(f'{job["n"]}\n')
    return noisy(job)


def interrupted(flag: str | Path, job: Job) -> Record:
    """Stand for Ctrl-C during the eighth job, while the flag is there."""
    if job['n'] == 7 and Path(flag).exists():
        raise KeyboardInterrupt
    return noisy(job)


def slow(directory: str | Path, job: Job) -> Record:
    """Take some time, and leave the number of the process."""
    (Path(directory) / str(os.getpid())).touch()
    time.sleep(0.03)
    return noisy(job)


def sometimes_failing(job: Job) -> Record:
    """Fail for every third job, in several ways."""
    if job['n'] % 3 == 0:
        raise (ValueError, ZeroDivisionError, RuntimeError)[job['n'] // 3 % 3](f'no {job["n"]}')
    if job['n'] == 4:
        return {'list': [1, 2]}
    return noisy(job)


def extremes(job: Job) -> Record:
    """Give numbers that are lost easily."""
    return {'nan': float('nan'), 'inf': -float('inf'), 'zero': -0.0, 'tiny': 5e-324,
            'third': 1 / 3, 'big': 2 ** 63 - 1, 'flag': True, 'none': None, 'text': 'a, "b"\n',
            'numpy': np.float64(0.1), 'counted': np.int64(3)}


def long_text(job: int) -> Record:
    """Return some 100 kB, for each job others."""
    return {'text': f'{job:03d}' * 33_000}


def leave(job: Job) -> Record:
    """End the process without a word at one of the jobs."""
    if job['n'] == 20:
        os._exit(3)
    return noisy(job)


def slow_batch(directory: str | Path, jobs: Sequence[Job], out: str | Path) -> None:
    """Run many slow jobs on two processes, and print how many are done."""
    run_batch(partial(slow, directory), jobs, out, workers=2, chunk=4,
              progress=lambda done, total: print(done, flush=True))
