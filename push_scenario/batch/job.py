"""Chunks of jobs go out, entries come in, and Ctrl-C ends it in order."""

from concurrent import futures

import numpy as np
from push_scenario.batch.interrupts import Interrupts

PLAIN = {bool, int, float, str, type(None)}


def run_chunk(function, chunk, stop=None):
    """
    Run a function on some jobs, until told to stop.

    :param function: of one job, giving a flat dict.
    :param chunk: list of (number of the job, job).
    :param stop: has ``is_set``, asked after every job; None never stops.
    :return: (list of entries, whether the rest was left by an interrupt).
    """
    entries = []
    try:
        for index, job in chunk:
            if stop is not None and stop.is_set():
                return entries, True
            entries.append({'job': index, **_outcome(function, job)})
    except KeyboardInterrupt:
        return entries, True
    return entries, False


def _outcome(function, job):
    """Return the record or, so that one job does not lose the others, its error."""
    try:
        return {'record': _flat(function(job))}
    except Exception as error:  # noqa: B902
        return {'error': f'{type(error).__name__}: {error}'}


def _flat(record):
    if not isinstance(record, dict):
        raise ValueError(f'record: got {record!r}, expected a dict of numbers and text')
    return {str(key): _plain(key, value) for key, value in record.items()}


def _plain(key, value):
    if isinstance(value, np.generic):
        value = value.item()
    if type(value) in PLAIN:
        return value
    raise ValueError(f'record[{key!r}]: got {value!r}, expected a number or text')


POLL = 0.1


class StopRequest(Interrupts):
    """Notes Ctrl-C while it is entered; only the second one raises ``KeyboardInterrupt``."""

    def is_set(self):
        """Tell whether Ctrl-C has come."""
        return self._seen

    def _note(self, number, frame):
        if self._seen:
            raise KeyboardInterrupt
        self._seen = True


def collect(pool, function, chunks, keep, stop):
    """
    Run all chunks and keep what comes back; once stopped, keep what is under way and end.

    :param pool: what ``open_workers`` gave.
    :param function: of one job.
    :param chunks: list of lists of (number of the job, job).
    :param keep: called with a list of entries.
    :param stop: has ``is_set``.
    :raises KeyboardInterrupt: where stopped.
    :raises RuntimeError: where a worker died.
    """
    running = {}
    try:
        _pump(pool, function, iter(chunks), running, keep, stop)
    except futures.BrokenExecutor as error:
        _keep_done([future for future in running if future.done() and not future.exception()],
                   running, keep)
        jobs = sorted(index for chunk in running.values() for index, _ in chunk)
        raise RuntimeError(f'a worker died; it was at one of the jobs {jobs}: the same call goes '
                           'on, with workers=1 until it meets that job') from error


def _pump(pool, function, waiting, running, keep, stop):
    stopped = False
    while True:
        while not stopped and len(running) < pool.depth:
            chunk = next(waiting, None)
            if chunk is None:
                break
            running[pool.submit(function, chunk, stop)] = chunk
            stopped = stop.is_set()
        if not running:
            break
        done, _ = futures.wait(running, POLL, futures.FIRST_COMPLETED)
        stopped = _keep_done(done, running, keep) or stopped or stop.is_set()
        if stopped:
            pool.stop()
            for future in [future for future in running if future.cancel()]:
                del running[future]
    if stopped:
        raise KeyboardInterrupt


def _keep_done(done, running, keep):
    stopped = False
    for future in done:
        entries, interrupted = future.result()
        del running[future]
        stopped = stopped or interrupted
        if entries:
            keep(entries)
    return stopped
