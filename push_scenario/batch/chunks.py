"""Chunks of jobs: run by a worker, collected by the process that hands them out."""

from collections.abc import Callable, Iterable, Iterator
from concurrent import futures
from types import FrameType
from typing import Any, Protocol

import numpy as np
from push_scenario.batch.interrupts import Interrupts

# Plain values, as JSON has them; a function of one gives a record.
Job = Any
Record = dict[str, Any]
JobFunction = Callable[[Job], Record]
# Number of the job, and its record or its error.
Entry = dict[str, Any]
Chunk = list[tuple[int, Job]]
# Entries of a chunk, and whether an interrupt has cut it short.
ChunkResult = tuple[list[Entry], bool]

PLAIN_TYPES = {bool, int, float, str, type(None)}
# How often to look for Ctrl-C while chunks run [s].
POLL_PERIOD = 0.1


class Stop(Protocol):
    """Tells whether to stop."""

    def is_set(self) -> bool:
        """Tell whether to stop."""
        ...


class Pool(Protocol):
    """What chunks run on; see ``push_scenario.batch.workers.Workers``."""

    depth: int

    def submit(self, function: JobFunction, chunk: Chunk,
               stop: Stop) -> 'futures.Future[ChunkResult]':
        """Run a chunk, or have it run."""
        ...

    def stop(self) -> None:
        """Let running chunks end early."""
        ...


class StopRequest(Interrupts):
    """Notes Ctrl-C while it is entered; only the second one raises ``KeyboardInterrupt``."""

    def is_set(self) -> bool:
        """Tell whether Ctrl-C has come."""
        return self._has_come

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._has_come:
            raise KeyboardInterrupt
        self._has_come = True


def run_chunk(function: JobFunction, chunk: Chunk, stop: Stop | None = None) -> ChunkResult:
    """
    Run a function on some jobs, until there is a stop.

    :param function: of one job, giving a flat dict.
    :param chunk: list of (number of the job, job).
    :param stop: asked before every job; None never stops.
    :return: (list of entries, whether the rest was left because of an interrupt).
    """
    entries: list[Entry] = []
    try:
        for index, job in chunk:
            if stop is not None and stop.is_set():
                return entries, True
            entries.append({'job': index, **_run_job(function, job)})
    except KeyboardInterrupt:
        return entries, True
    return entries, False


def _run_job(function: JobFunction, job: Job) -> Entry:
    """Return the record or, so that one job does not lose the others, its error."""
    try:
        return {'record': _plain_record(function(job))}
    except Exception as error:  # noqa: B902
        return {'error': f'{type(error).__name__}: {error}'}


def _plain_record(record: Any) -> Record:
    if not isinstance(record, dict):
        raise ValueError(f'record: got {record!r}, expected a dict of numbers and text')
    return {str(key): _plain(key, value) for key, value in record.items()}


def _plain(key: object, value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if type(value) in PLAIN_TYPES:
        return value
    raise ValueError(f'record[{key!r}]: got {value!r}, expected a number or text')


def collect(pool: Pool, function: JobFunction, chunks: Iterable[Chunk],
            keep: Callable[[list[Entry]], None], stop: Stop) -> None:
    """
    Run all chunks and keep their entries; once stopped, keep what is under way and end.

    :param pool: the ``Workers``.
    :param function: of one job.
    :param chunks: lists of (number of the job, job).
    :param keep: called with a list of entries.
    :param stop: asked while chunks run.
    :raises KeyboardInterrupt: where stopped.
    :raises RuntimeError: where a worker died.
    """
    collection = _Collection(pool, function, keep, stop)
    try:
        collection.run(iter(chunks))
    except futures.BrokenExecutor as error:
        collection.keep_finished()
        raise RuntimeError(f'a worker died; it was at one of the jobs {collection.running_jobs()}:'
                           ' the same call goes on, with workers=1 until it meets that job'
                           ) from error


class _Collection:
    """Chunks under way, and their entries once they are finished."""

    def __init__(self, pool: Pool, function: JobFunction, keep: Callable[[list[Entry]], None],
                 stop: Stop) -> None:
        self._pool = pool
        self._function = function
        self._keep = keep
        self._stop = stop
        self._running: dict[futures.Future[ChunkResult], Chunk] = {}

    def run(self, waiting: Iterator[Chunk]) -> None:
        """Keep all workers busy until all chunks are finished or there is a stop."""
        stopped = False
        while True:
            if not stopped:
                stopped = self._submit(waiting)
            if not self._running:
                break
            done, _ = futures.wait(self._running, POLL_PERIOD, futures.FIRST_COMPLETED)
            stopped = self._keep_done(done) or stopped or self._stop.is_set()
            if stopped:
                self._pool.stop()
                for future in [future for future in self._running if future.cancel()]:
                    del self._running[future]
        if stopped:
            raise KeyboardInterrupt

    def keep_finished(self) -> None:
        """Keep the entries of the chunks that are finished although the workers are gone."""
        self._keep_done([future for future in self._running
                         if future.done() and not future.exception()])

    def running_jobs(self) -> list[int]:
        """Numbers of the jobs that are under way."""
        return sorted(index for chunk in self._running.values() for index, _ in chunk)

    def _submit(self, waiting: Iterator[Chunk]) -> bool:
        """Hand out chunks up to the depth of the pool; return whether there was a stop."""
        while len(self._running) < self._pool.depth:
            chunk = next(waiting, None)
            if chunk is None:
                break
            self._running[self._pool.submit(self._function, chunk, self._stop)] = chunk
            if self._stop.is_set():
                return True
        return False

    def _keep_done(self, done: Iterable['futures.Future[ChunkResult]']) -> bool:
        """Keep the entries of finished chunks; return whether one was interrupted."""
        stopped = False
        for future in done:
            entries, interrupted = future.result()
            del self._running[future]
            stopped = stopped or interrupted
            if entries:
                self._keep(entries)
        return stopped
