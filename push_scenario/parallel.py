"""
Many simulations, on all cores or on any executor; an interrupted run goes on where it stopped.

A job is a scenario, or plain values. A function of one job returns a row: a flat dict of numbers
and text. The function must be pure, and seeded by the job alone: then each row is the same to the
bit wherever and in whatever order the jobs run.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent import futures
import dataclasses
import enum
import functools
import hashlib
import importlib
import json
import multiprocessing
import os
from pathlib import Path
import signal
import sys
import threading
import types
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_control.law_names import is_own_law, law_reference
from push_model.files.whole_file import write_whole
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.result_row import result_row, Row
from push_scenario.interrupts import Interrupts
from push_scenario.simulation.loop import simulate

Job = Any
JobFunction = Callable[[Job], Row]
# Called with (finished jobs, all jobs).
Progress = Callable[[int, int], None]
# Jobs and rows by the digest of the job.
Jobs = dict[str, Job]
Rows = dict[str, Row]

# Column with what went wrong, of the rows of jobs that failed.
ERROR = 'error'
# Key of the digest in the lines of a file.
DIGEST = 'job'
SUFFIX = '.jsonl'
# Chosen: a worker idles at the end for a sixteenth of the time at most, and a kill loses at most
# so many short jobs of each worker.
BLOCKS_PER_WORKER = 16
MAX_BLOCK = 64


def simulate_many(scenarios: Iterable[Scenario], *, folder: str | Path | None = None,
                  executor: futures.Executor | None = None, workers: int | None = None,
                  progress: Progress | None = None) -> list[Row]:
    """
    Simulate scenarios.

    :param scenarios: any number.
    :param folder: see ``run_many``, as are the other parameters.
    :return: a row for each, as ``simulated`` makes it.
    """
    scenarios = list(scenarios)
    laws = {scenario.control.control_law for scenario in scenarios}
    modules = sorted(law_reference(law).partition(':')[0] for law in laws if is_own_law(law))
    return run_many(simulated, scenarios, folder=folder, executor=executor, workers=workers,
                    modules=modules, progress=progress)


def simulated(scenario: Scenario) -> Row:
    """
    Simulate a scenario, and measure how it ended.

    :param scenario: which.
    :return: see ``result_row``.
    """
    return result_row(simulate(scenario))


def run_many(function: JobFunction, jobs: Iterable[Job], *, folder: str | Path | None = None,
             executor: futures.Executor | None = None, workers: int | None = None,
             block: int | None = None, modules: Sequence[str] = (),
             progress: Progress | None = None) -> list[Row]:
    """
    Run a function on every job; jobs whose rows are in the folder are not run again.

    Ctrl-C lets the blocks under way end, keeps their rows and raises ``KeyboardInterrupt``. A job
    whose function raises an exception gets a row with the column ``error`` alone; it is not
    written, so that the next call runs it again.

    Processes start as copies of this one if that has one thread and no ROS; otherwise they are
    spawned, so that a script that calls this needs ``if __name__ == '__main__':``.

    :param function: defined in a module, a partial of such a function, or an instance of a
        dataclass that can be called.
    :param jobs: dataclasses and plain values (numbers, text, lists and dicts of them).
    :param folder: gets a file of JSON lines for each block; made if need be. A row there belongs
        to its function, job and source code, whatever else is in the folder.
    :param executor: runs the blocks in place of processes, and stays open: a pool of
        ``concurrent.futures``, or ``get_executor(pure=False)`` of a Dask client.
    :param workers: number of processes, or of the executor's workers; None for one per core, 1
        for no others than this one.
    :param block: jobs that a worker gets at a time; 1 suits jobs of many seconds, None short ones.
    :param modules: names of further modules whose source code the rows depend on.
    :param progress: called at the start and after each block.
    :return: the rows, in the order of the jobs.
    :raises ValueError: for a function or job that cannot be told from others, and for a file in
        the folder that holds no rows.
    """
    for name, value in (('workers', workers), ('block', block)):
        if value is not None and value < 1:
            raise ValueError(f'{name}: got {value!r}, expected at least 1, or None')
    workers = workers or available_cores()
    jobs = list(jobs)
    digests = job_digests(function, jobs, modules)
    different = dict(zip(digests, jobs))
    stored = {} if folder is None else _read_rows(Path(folder))
    rows = {digest: stored[digest] for digest in different if digest in stored}

    def collect(block_rows: Rows) -> None:
        rows.update(block_rows)
        if folder is not None:
            _write_rows(Path(folder), block_rows)
        report()

    def report() -> None:
        if progress is not None:
            progress(len(rows), len(different))

    report()
    missing = [(digest, job) for digest, job in different.items() if digest not in rows]
    size = block or max(1, min(MAX_BLOCK, len(missing) // (BLOCKS_PER_WORKER * workers)))
    blocks = [dict(missing[first:first + size]) for first in range(0, len(missing), size)]
    _run_blocks(function, blocks, executor, workers, collect)
    return [rows[digest] for digest in digests]


def stored_jobs(function: JobFunction, jobs: Iterable[Job], folder: str | Path) -> list[Job]:
    """
    List the jobs whose rows are in a folder: ``run_many`` reads them, and runs nothing.

    :param function: as ``run_many`` takes it, like the other parameters.
    :raises ValueError: as ``run_many``.
    """
    jobs, rows = list(jobs), _read_rows(Path(folder))
    return [job for job, digest in zip(jobs, job_digests(function, jobs)) if digest in rows]


def progress_bar(title: str) -> Progress:
    """
    Show a bar on the terminal; needs tqdm (extra ``plot``).

    :param title: left of the bar.
    :return: what ``run_many`` takes as ``progress``.
    """
    # Imported here: a robot has no tqdm.
    from tqdm import tqdm
    bar: Any = tqdm(desc=title)

    def show(done: int, total: int) -> None:
        bar.total = total
        bar.n = done
        bar.refresh()
        if done == total:
            bar.close()

    return show


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, 'sched_getaffinity'):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def job_digests(function: JobFunction, jobs: Sequence[Job],
                modules: Sequence[str] = ()) -> list[str]:
    """
    Compute the identity of each row: that of function, source code and job.

    :param function: as ``run_many`` takes it.
    :param jobs: likewise.
    :param modules: likewise.
    :raises ValueError: naming what cannot be told from others.
    """
    try:
        name = json.dumps(function, default=_plain, sort_keys=True)
    except TypeError as error:
        raise ValueError(f'function: got {function!r}, expected a function defined in a module, a '
                         'partial of one, or an instance of a dataclass') from error
    prefix = hashlib.sha256(f'{name}\n{source_digest(function)}\n'.encode())
    for module in modules:
        importlib.import_module(module)
        prefix.update(_sources_digest(module).encode())
    return [_job_digest(prefix.copy(), index, job) for index, job in enumerate(jobs)]


def source_digest(function: Any) -> str:
    """
    Compute the digest of the sources that a row depends on.

    :param function: as ``run_many`` takes it; the package that it belongs to counts as well.
    """
    while isinstance(function, functools.partial):
        function = function.func
    return _sources_digest(function.__module__)


def _job_digest(digest: Any, index: int, job: Job) -> str:
    try:
        digest.update(json.dumps(job, default=_plain, sort_keys=True).encode())
    except TypeError as error:
        raise ValueError(f'jobs[{index}]: got {job!r} ({error}), expected dataclasses, numbers, '
                         'text, lists and dicts of them') from error
    return digest.hexdigest()


def _plain(value: Any) -> Any:
    """Describe a value that JSON does not know, so that equal descriptions mean equal values."""
    if isinstance(value, functools.partial):
        return [value.func, value.args, value.keywords]
    if isinstance(value, types.FunctionType) and '<' not in value.__qualname__:
        return f'{value.__module__}.{value.__qualname__}'
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        return [f'{type(value).__module__}.{type(value).__qualname__}', fields]
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, (np.ndarray, np.generic)):
        array: NDArray[Any] | np.generic[Any] = value
        return array.tolist()
    raise TypeError(f'{type(value).__name__} is not plain')


# A process keeps the modules that it has read first.
@functools.lru_cache(maxsize=16)
def _sources_digest(module: str) -> str:
    """Compute the digest of the package's sources, and of those beside a module."""
    root = Path(__file__).resolve().parents[1]
    paths = {*root.glob('push_*/**/*.py'), *_own_sources(module)}
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.name.encode() + b'\n' + path.read_bytes())
    return digest.hexdigest()


def _own_sources(module: str) -> Iterable[Path]:
    """List the sources of the package that a module belongs to, or its own without one."""
    for name in (module.partition('.')[0], module):
        file = getattr(sys.modules.get(name), '__file__', None)
        if file is not None:
            path = Path(file).resolve()
            return path.parent.rglob('*.py') if path.name == '__init__.py' else [path]
    return []


def _read_rows(folder: Path) -> Rows:
    """Read the rows of all files in a folder."""
    rows: Rows = {}
    for path in sorted(folder.glob('*' + SUFFIX)):
        for number, line in enumerate(path.read_text(encoding='utf-8').splitlines(), 1):
            try:
                row = json.loads(line)
                rows[row.pop(DIGEST)] = row
            except (ValueError, TypeError, KeyError, AttributeError) as error:
                raise ValueError(f'{path}, line {number}: got {line[:80]!r}, expected a row of '
                                 f'a job') from error
    return rows


def _write_rows(folder: Path, rows: Mapping[str, Row]) -> None:
    """Write the rows of a block, but for jobs that failed."""
    lines = [json.dumps({DIGEST: digest, **row}) + '\n' for digest, row in rows.items()
             if ERROR not in row]
    if lines:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / (next(iter(rows)) + SUFFIX), ''.join(lines).encode())


def _run_blocks(function: JobFunction, blocks: Sequence[Jobs], executor: futures.Executor | None,
                workers: int, collect: Callable[[Rows], None]) -> None:
    """Run blocks where the caller wants them to run."""
    if executor is not None:
        _run_on(executor, function, blocks, collect)
    elif min(workers, len(blocks)) <= 1:
        with Interrupts() as interrupts:
            for block in blocks:
                collect(_run_block(function, block))
                interrupts.check()
    else:
        context = multiprocessing.get_context(start_method())
        with futures.ProcessPoolExecutor(min(workers, len(blocks)), context,
                                         initializer=_prepare_worker) as pool:
            _run_on(pool, function, blocks, collect)


def _run_on(executor: futures.Executor, function: JobFunction, blocks: Sequence[Jobs],
            collect: Callable[[Rows], None]) -> None:
    """Run blocks on an executor; after Ctrl-C collect what is under way, and no more."""
    running: set[futures.Future[Rows]] = set()
    try:
        for block in blocks:
            running.add(executor.submit(_run_block, function, block))
        _collect_all(running, collect)
    except KeyboardInterrupt:
        _collect_all({future for future in running if not future.cancel()}, collect)
        raise
    finally:
        for future in running:
            future.cancel()


def _collect_all(running: set['futures.Future[Rows]'], collect: Callable[[Rows], None]) -> None:
    """Collect rows as blocks end, and forget these."""
    for future in futures.as_completed(set(running)):
        collect(future.result())
        running.discard(future)


def _run_block(function: JobFunction, block: Jobs) -> Rows:
    return {digest: _run_job(function, job) for digest, job in block.items()}


def _run_job(function: JobFunction, job: Job) -> Row:
    """Return the row or, so that one job does not lose the others, its error."""
    try:
        return {key: _plain_cell(key, value) for key, value in function(job).items()}
    except Exception as error:  # noqa: B902 (a row of its own)
        return {ERROR: f'{type(error).__name__}: {error}'}


def _plain_cell(column: str, value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f'{column}: got {value!r}, expected a number or text')


def start_method() -> str:
    """
    Choose how processes start.

    A copy of this process (``fork``) has all modules and machine code at once; a new one takes a
    second of imports. Locks that other threads hold would stay locked in a copy.

    :return: ``fork`` where this process runs one thread of Python and no ROS, else ``spawn``.
    """
    is_alone = threading.active_count() == 1 and 'rclpy' not in sys.modules
    return 'fork' if sys.platform == 'linux' and is_alone else 'spawn'


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it, be it by a kill."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
