"""Where the jobs of a batch run: in this process, in others, or where an executor has them run."""

import abc
from collections.abc import Generator
from concurrent import futures
import contextlib
import multiprocessing
from multiprocessing.synchronize import Event
import os
import signal
import sys
import threading
from typing import Any

from push_scenario.batch.chunks import Chunk, ChunkResult, JobFunction, run_chunk, Stop

ChunkFuture = futures.Future[ChunkResult]
# Chunks under way for each worker, so that none has to wait for its next one.
DEPTH = 3


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, 'sched_getaffinity'):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextlib.contextmanager
def open_workers(count: int, executor: futures.Executor | None,
                 jobs: int) -> Generator['Workers', None, None]:
    """
    Open what the jobs run on, and close it again.

    :param count: number of processes, 1 for this one; with an executor: how many workers it has.
    :param executor: what the caller has opened, and closes; None for processes.
    :param jobs: number of jobs to come.
    :return: context manager that yields the ``Workers``.
    """
    if executor is not None:
        yield GivenExecutor(executor, count)
    elif min(count, jobs) <= 1:
        yield InProcess()
    else:
        with Processes(min(count, jobs)) as pool:
            yield pool


class Workers(abc.ABC):
    """
    Any number of workers.

    Chunks are few enough to cost little, and enough that progress shows, a kill loses little and
    all workers end at about the same time.

    :param count: number of workers.
    """

    # One in 64 is 1.5 % of the time at whose end a worker may idle; 64 jobs are few to lose.
    chunks_per_worker = 64
    max_chunk_size = 64

    def __init__(self, count: int) -> None:
        self.count = count
        self.depth = DEPTH * count

    def chunk_size(self, jobs: int) -> int:
        """
        Estimate how many jobs to hand out at a time.

        :param jobs: number of jobs.
        """
        return max(1, min(self.max_chunk_size, jobs // (self.chunks_per_worker * self.count)))

    @abc.abstractmethod
    def submit(self, function: JobFunction, chunk: Chunk, stop: Stop) -> ChunkFuture:
        """
        Run a chunk, or have it run.

        :param function: of one job.
        :param chunk: list of (number of the job, job).
        :param stop: asked before every job that runs in this process.
        :return: future of the result of ``run_chunk``.
        """

    @abc.abstractmethod
    def stop(self) -> None:
        """Let running chunks end early."""


class InProcess(Workers):
    """This process, one chunk at a time."""

    def __init__(self) -> None:
        super().__init__(1)
        self.depth = 1

    def submit(self, function: JobFunction, chunk: Chunk, stop: Stop) -> ChunkFuture:
        """Run a chunk at once."""
        future: ChunkFuture = futures.Future()
        future.set_result(run_chunk(function, chunk, stop))
        return future

    def stop(self) -> None:
        """Do nothing: ``run_chunk`` asks by itself."""


def start_method() -> str:
    """
    Choose how processes start.

    A copy of this process (``fork``) has all modules and machine code at once; a new one takes a
    second of imports. Locks that other threads hold would stay locked in a copy.

    :return: ``fork`` where this process runs one thread of Python and no ROS, else ``spawn``.
    """
    has_fork = 'fork' in multiprocessing.get_all_start_methods() and sys.platform == 'linux'
    is_alone = threading.active_count() == 1 and 'rclpy' not in sys.modules
    return 'fork' if has_fork and is_alone else 'spawn'


class Processes(Workers):
    """Processes on this machine."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        context = multiprocessing.get_context(start_method())
        self._stop = context.Event()
        # Processes end at once when this end of the pipe is closed, be it by a kill.
        reader, self._alive = context.Pipe(duplex=False)
        self._pool = futures.ProcessPoolExecutor(
            count, context, initializer=_prepare_worker,
            initargs=(self._stop, reader, self._alive))

    def __enter__(self) -> 'Processes':
        """Do nothing yet: processes start with the first chunks."""
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """End all processes."""
        if kind is not None:
            self._alive.close()
        self._pool.shutdown(cancel_futures=True)
        self._alive.close()

    def submit(self, function: JobFunction, chunk: Chunk, stop: Stop) -> ChunkFuture:
        """Hand a chunk to the next process that is free."""
        return self._pool.submit(_run_in_worker, function, chunk)

    def stop(self) -> None:
        """Let the processes end after the job that they are at."""
        self._stop.set()


class GivenExecutor(Workers):
    """
    An executor of the caller, for example of a cluster; a chunk that runs there is given up.

    :param executor: has the interface of ``concurrent.futures``.
    :param count: number of its workers.
    """

    # A scheduler of a cluster takes some 10 ms per chunk: fewer and larger ones.
    chunks_per_worker = 16
    max_chunk_size = 256

    def __init__(self, executor: futures.Executor, count: int) -> None:
        super().__init__(count)
        self._executor = executor

    def submit(self, function: JobFunction, chunk: Chunk, stop: Stop) -> ChunkFuture:
        """Hand a chunk to the executor."""
        return self._executor.submit(run_chunk, function, chunk)

    def stop(self) -> None:
        """Do nothing: chunks that wait are cancelled one by one."""


# In a worker process: set once the parent wants it to stop.
_stop_event: Event | None = None


def _prepare_worker(stop: Event, parent: Any, alive: Any) -> None:
    """Leave Ctrl-C to the parent; it closes the other end of a pipe, ``alive``, when it ends."""
    global _stop_event
    _stop_event = stop
    alive.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=(parent,), daemon=True).start()


def _end_with_parent(parent: Any) -> None:
    parent.poll(None)
    os._exit(1)


def _run_in_worker(function: JobFunction, chunk: Chunk) -> ChunkResult:
    return run_chunk(function, chunk, _stop_event)
