"""Functions of one job, for workers that import them."""

import os
from pathlib import Path
import time
from typing import Any, Sequence

import numpy as np
from push_scenario.parallel import run_many

Job = dict[str, Any]
Row = dict[str, Any]


def noisy(job: Job) -> Row:
    """Draw from the job's own seed."""
    rng = np.random.default_rng(job['seed'])
    return {'sum': float(rng.normal(size=100).sum()), 'seed': job['seed'], 'word': f'n{job["n"]}'}


def recorded(log: str | Path, job: Job) -> Row:
    """Note in a file that the job has run."""
    with open(log, 'a') as stream:
        stream.write(f'{job["n"]}\n')
    return noisy(job)


def interrupted(flag: str | Path, log: str | Path, job: Job) -> Row:
    """Stand for Ctrl-C during the eighth job, while the flag is there."""
    if job['n'] == 7 and Path(flag).exists():
        raise KeyboardInterrupt
    return recorded(log, job)


def slow(directory: str | Path, job: Job) -> Row:
    """Take some time, and leave the number of the process."""
    (Path(directory) / str(os.getpid())).touch()
    time.sleep(0.03)
    return noisy(job)


def sometimes_failing(job: Job) -> Row:
    """Fail for every third job, and return a list once."""
    if job['n'] % 3 == 0:
        raise ZeroDivisionError(f'no {job["n"]}')
    if job['n'] == 4:
        return {'list': [1, 2]}
    return noisy(job)


def extremes(job: Job) -> Row:
    """Give numbers that are lost easily."""
    return {'nan': float('nan'), 'inf': -float('inf'), 'zero': -0.0, 'tiny': 5e-324,
            'third': 1 / 3, 'big': 2 ** 63 - 1, 'flag': True, 'none': None, 'text': 'a, "b"\n',
            'numpy': np.float64(0.1), 'counted': np.int64(3), 'is_true': np.bool_(True)}


def leave(job: Job) -> Row:
    """End the process without a word at one of the jobs."""
    if job['n'] == 20:
        os._exit(3)
    return noisy(job)


def many_slow(function: Any, jobs: Sequence[Job], folder: str | Path) -> None:
    """Run many slow jobs on two processes, and print how many are done."""
    run_many(function, jobs, folder=folder, workers=2, block=4,
             progress=lambda done, total: print(done, flush=True))
