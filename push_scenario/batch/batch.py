"""
Batches: many variations of anything, on all cores or on any executor, resumable.

A job is plain values (numbers, text, lists and dicts of them). A function of one job gives a flat
record. It must be pure, seeded by the job alone: then every record is the same to the bit wherever
and in whatever order the jobs run.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent import futures
import dataclasses
import math
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_scenario.batch.chunks import collect, Entry, Job, JobFunction, Record, StopRequest
from push_scenario.batch.identity import header
from push_scenario.batch.store import Store, write_table
from push_scenario.batch.workers import available_cores, open_workers, Workers

BatchProgress = Callable[[int, int], None]
# Stands for a value that a record does not have; None is one that it may have.
_MISSING = object()


@dataclasses.dataclass(frozen=True)
class BatchResult:
    """
    Records of all jobs, in the order of the jobs.

    :param jobs: the jobs.
    :param records: flat dict of each job, None where it failed; those of a file are read from it
        when they are asked for.
    :param errors: what went wrong, by number of the job.
    """

    jobs: tuple[Job, ...]
    records: Sequence[Record | None]
    errors: dict[int, str]

    def column(self, name: str) -> NDArray[Any]:
        """
        Gather one value of all records.

        :param name: key in the records.
        :return: array, shape (number of jobs,); where a job failed or its record has no such key,
            nan, or '' in a column of text.
        :raises ValueError: where no record has the key.
        """
        found = [(record or {}).get(name, _MISSING) for record in self.records]
        first = next((value for value in found if value is not _MISSING), _MISSING)
        if first is _MISSING:
            known = sorted({key for record in self.records for key in record or ()})
            raise ValueError(f'column: got {name!r}, expected one of ' + ', '.join(known))
        missing = '' if isinstance(first, str) else math.nan
        return np.array([missing if value is _MISSING else value for value in found])


def run_batch(function: JobFunction, jobs: Iterable[Job], out: str | PathLike[str] | None = None,
              *, workers: int | None = None, executor: futures.Executor | None = None,
              progress: BatchProgress | None = None, chunk: int | None = None,
              any_software: bool = False, table: bool = True,
              is_valid: Callable[[Job, Record], bool] | None = None) -> BatchResult:
    """
    Run a function on every job; continue where an earlier call was interrupted.

    Results are appended to ``out`` as they arrive, and survive Ctrl-C and kill. Ctrl-C ends the
    running jobs and then raises ``KeyboardInterrupt``; a second one does not wait. The same call
    again does the rest, and gives what an uninterrupted call would have given. Memory does not
    hold them: the result reads from ``out``. At the end a table of jobs and records is written
    beside it, with the suffix ``.csv``.

    A job whose function raises an exception is kept with its error, and the others continue.

    Processes start as copies of this one where it has no other threads and no ROS; else they are
    spawned, so that a script that calls this needs ``if __name__ == '__main__':``.

    :param function: of one job, giving a dict of numbers and text; defined in a module, or a
        partial of such a function, or an instance of a frozen dataclass that can be called.
    :param jobs: plain values.
    :param out: file of JSON lines to write, as a path; None keeps results in memory only.
    :param workers: number of processes; None for one per core, 1 for no others than this one.
        With an executor: how many workers that has, None for as many as this machine has cores.
    :param executor: runs the jobs in place of processes; it has the interface of
        ``concurrent.futures``, as have the pools of the standard library and what
        ``get_executor(pure=False)`` of a Dask client returns. It stays open.
    :param progress: called with (finished jobs, all jobs).
    :param chunk: jobs that a worker is given at a time, which is what a kill may lose; None for
        an estimate that suits short jobs.
    :param any_software: continue also with records that other software has made.
    :param table: whether to write the table.
    :param is_valid: called with job and record of those that are found in ``out``; where it
        returns False the job is run again.
    :return: the ``BatchResult``.
    :raises ValueError: where ``out`` holds another batch, or a job is not plain.
    """
    for name, value in (('workers', workers), ('chunk', chunk)):
        if value is not None and value < 1:
            raise ValueError(f'{name}: got {value!r}, expected at least 1, or None')
    jobs = tuple(jobs)
    with Store(out, header(function, jobs), any_software) as store:
        if is_valid is not None:
            store.keep_valid(lambda number, record: is_valid(jobs[number], record))

        def report() -> None:
            if progress is not None:
                progress(store.done_count, len(jobs))

        def keep(entries: list[Entry]) -> None:
            store.append(entries)
            report()

        report()
        missing = store.missing()
        if missing:
            with StopRequest() as stop, open_workers(workers or available_cores(), executor,
                                                     len(missing)) as pool:
                collect(pool, function, _chunks(jobs, missing, chunk, pool), keep, stop)
        result = BatchResult(jobs, store.records(), dict(sorted(store.errors.items())))
    if out is not None and table:
        write_table(out, result.jobs, result.records, result.errors)
    return result


def seeds(seed: int, count: int) -> list[int]:
    """
    Draw seeds for jobs; the first ones do not depend on how many there are.

    :param seed: seed of the whole batch.
    :param count: how many to draw.
    :return: list of whole numbers from 0 to 2^63 - 1.
    """
    return [int(np.random.SeedSequence(seed, spawn_key=(index,)).generate_state(1, np.uint64)[0])
            >> 1 for index in range(count)]


def _chunks(jobs: tuple[Job, ...], missing: list[int], size: int | None,
            pool: Workers) -> Iterator[list[tuple[int, Job]]]:
    """Generate lists of (number of the job, job)."""
    size = size or pool.chunk_size(len(missing))
    for first in range(0, len(missing), size):
        yield [(index, jobs[index]) for index in missing[first:first + size]]
