"""Jobs and records of a batch as one table."""

import csv
import os
from pathlib import Path


def write_table(out, result):
    """
    Write a CSV file beside the file of results: a row per job, in their order.

    Columns are ``job`` (its number), ``error``, the values of the job under ``job.`` and their
    path, such as ``job.object_pose.0``, and those of the record. Floats keep every bit.

    :param out: path of the file of results; the table gets the ending ``.csv``.
    :param result: the ``BatchResult``.
    """
    rows = [{'job': index, 'error': result.errors.get(index, ''), **dict(_flat('job', job)),
             **(record or {})}
            for index, (job, record) in enumerate(zip(result.jobs, result.records))]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    path = Path(out).with_suffix('.csv')
    unfinished = path.with_suffix('.csv.part')
    with open(unfinished, 'w', encoding='utf-8', newline='') as stream:
        writer = csv.DictWriter(stream, columns, restval='', lineterminator='\n')
        writer.writeheader()
        writer.writerows(rows)
    os.replace(unfinished, path)


def _flat(name, value):
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, (list, tuple)):
        items = enumerate(value)
    else:
        yield (f'{name}.value' if name == 'job' else name), value
        return
    for key, inner in items:
        yield from _flat(f'{name}.{key}', inner)
