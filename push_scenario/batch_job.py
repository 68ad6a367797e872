"""A few jobs, run one after another where the worker is."""

import numpy as np

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
