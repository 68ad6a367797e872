"""Where the jobs of a batch run: in this process, in others, or on a Dask cluster."""

from concurrent import futures
import contextlib
import multiprocessing
import os
import signal
import threading

from push_scenario.batch.job import run_chunk

# Chunks under way for each worker, so that none has to wait for its next one.
DEPTH = 3


def available_cores():
    """Return the number of cores that this process may use."""
    if hasattr(os, 'sched_getaffinity'):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextlib.contextmanager
def open_workers(count, scheduler, jobs):
    """
    Open what the jobs run on, and close it again.

    :param count: number of processes; 1 for this one.
    :param scheduler: ``distributed.Client`` or address of a Dask cluster; None for no cluster.
    :param jobs: number of jobs to come.
    """
    if isinstance(scheduler, str):
        with _distributed().Client(scheduler, set_as_default=False) as client:
            yield Cluster(client)
    elif scheduler is not None:
        yield Cluster(scheduler)
    elif min(count, jobs) <= 1:
        yield InProcess()
    else:
        with Processes(min(count, jobs)) as pool:
            yield pool


class Workers:
    """
    Any number of workers.

    Chunks are few enough to cost little, and enough that progress shows, a kill loses little and
    all workers end at about the same time.

    :param count: number of workers.
    """

    chunks_per_worker = 64
    most_in_chunk = 64

    def __init__(self, count):
        self.count, self.depth = count, DEPTH * count

    def chunk_size(self, jobs):
        """
        Guess how many jobs to hand out at a time.

        :param jobs: number of jobs.
        """
        return max(1, min(self.most_in_chunk, jobs // (self.chunks_per_worker * self.count)))


class InProcess(Workers):
    """This process, one chunk at a time."""

    def __init__(self):
        super().__init__(1)
        self.depth = 1

    def submit(self, function, chunk, stop):
        """Run a chunk at once."""
        future = futures.Future()
        future.set_result(run_chunk(function, chunk, stop))
        return future

    def stop(self):
        """Do nothing: the jobs ask for themselves."""


class Processes(Workers):
    """Processes on this machine."""

    def __init__(self, count):
        super().__init__(count)
        context = multiprocessing.get_context('spawn')
        self._stop = context.Event()
        # Processes end at once when this end of the pipe is closed, be it by a kill.
        reader, self._alive = context.Pipe(duplex=False)
        self._pool = futures.ProcessPoolExecutor(count, context, _begin, (self._stop, reader))

    def __enter__(self):
        """Do nothing yet: processes start with the first chunks."""
        return self

    def __exit__(self, error, *_):
        """End all processes."""
        if error is not None:
            self._alive.close()
        self._pool.shutdown(cancel_futures=True)
        self._alive.close()

    def submit(self, function, chunk, stop):
        """Hand a chunk to the next process that is free."""
        return self._pool.submit(_run_in_worker, function, chunk)

    def stop(self):
        """Let the processes end after the job that they are at."""
        self._stop.set()


class Cluster(Workers):
    """A Dask cluster; a chunk that runs there cannot be stopped, and is given up."""

    # A chunk costs its scheduler some 10 ms.
    chunks_per_worker = 16
    most_in_chunk = 256

    def __init__(self, client):
        super().__init__(max(1, sum(client.nthreads().values())))
        self._executor = client.get_executor(pure=False)

    def submit(self, function, chunk, stop):
        """Hand a chunk to the cluster."""
        return self._executor.submit(run_chunk, function, chunk)

    def stop(self):
        """Do nothing: chunks that wait are cancelled one by one."""


_stop_event = None


def _begin(stop, alive):
    """Prepare a worker: Ctrl-C is the parent's matter, and without a parent it ends."""
    global _stop_event
    _stop_event = stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=(alive,), daemon=True).start()


def _end_with_parent(alive):
    alive.poll(None)
    os._exit(1)


def _run_in_worker(function, chunk):
    return run_chunk(function, chunk, _stop_event)


def _distributed():
    try:
        import distributed
    except ImportError as error:
        raise ValueError('scheduler: got an address, expected the extra "cluster" to be installed '
                         '(pip install "push_control[cluster]")') from error
    return distributed
