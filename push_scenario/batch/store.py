"""Jobs and records of a batch as one table."""

import csv
import dataclasses
import fcntl
import functools
import hashlib
import json
import os
from pathlib import Path
import sys
import types
from xml.etree import ElementTree

from push_scenario.definition import data

FORMAT = 'push_control batch 1'
PURE_PACKAGES = ('push_model', 'push_drive', 'push_planner', 'push_control', 'push_sim_node',
                 'push_scenario', 'push_study')


def header(function, jobs):
    """
    Tell a batch from others.

    :param function: what runs on every job.
    :param jobs: the jobs.
    :return: dict of text and numbers.
    :raises ValueError: where a job is not plain, or the function cannot be told from others.
    """
    manifest = ElementTree.parse(data.share_directory() / 'package.xml').getroot()
    return {'format': FORMAT, 'function': describe(function), 'jobs': len(jobs),
            'digest': jobs_digest(jobs), 'version': manifest.findtext('version'),
            'software': software_digest(function)}


def describe(function):
    """
    Name a function so that every process finds the same name for it.

    :param function: function of a module, partial of one, or instance of a dataclass.
    :raises ValueError: for anything else, as other processes could not import it.
    """
    if isinstance(function, functools.partial):
        keywords = sorted(function.keywords.items())
        return f'partial({describe(function.func)}, {function.args!r}, {keywords!r})'
    if isinstance(function, types.FunctionType) and '<' not in function.__qualname__:
        return f'{function.__module__}.{function.__qualname__}'
    if dataclasses.is_dataclass(function) and not isinstance(function, type):
        return f'{type(function).__module__}.{function!r}'
    raise ValueError(f'function: got {function!r}, expected a function defined in a module, a '
                     'partial of one, or an instance of a dataclass')


def jobs_digest(jobs):
    """
    Digest of all jobs.

    :param jobs: the jobs.
    :raises ValueError: naming the first job that is not made of plain values.
    """
    digest = hashlib.sha256()
    for index, job in enumerate(jobs):
        try:
            text = json.dumps(job, sort_keys=True)
        except TypeError as error:
            raise ValueError(f'jobs[{index}]: got {job!r} ({error}), expected numbers, text, '
                             'lists and dicts of them') from error
        digest.update(text.encode() + b'\n')
    return digest.hexdigest()


def software_digest(function):
    """
    Digest of the source that computes a record: the pure packages and the function's module.

    :param function: as in ``header``.
    """
    while isinstance(function, functools.partial):
        function = function.func
    root = Path(__file__).resolve().parents[2]
    sources = {path.relative_to(root).as_posix(): path for package in PURE_PACKAGES
               for path in (root / package).rglob('*.py') if not path.stem.endswith('_node')}
    own = getattr(sys.modules[function.__module__], '__file__', None)
    if own is not None and Path(own).resolve() not in sources.values():
        sources[''] = Path(own)
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(name.encode() + b'\n' + sources[name].read_bytes())
    return digest.hexdigest()


MEANINGS = {'format': 'kind of file', 'function': 'function', 'jobs': 'number of jobs',
            'digest': 'digest of the jobs', 'version': 'version of the package',
            'software': 'digest of the source'}
SOFTWARE = ('version', 'software')


class Store:
    """
    Entries of a batch, kept in a file; to be used in a ``with`` statement.

    ``entries`` maps the number of a job to its entry.

    :param path: of the file, made if need be; None for memory only.
    :param header: dict that the file's header must equal.
    :param any_software: accept a header that differs in version and source.
    :raises ValueError: where the file is of another batch or damaged, naming what differs.
    """

    def __init__(self, path, header, any_software=False):
        self.entries = {}
        self._path, self._header = path and Path(path), header
        self._ignored = SOFTWARE if any_software else ()
        self._descriptor = None

    def __enter__(self):
        """Read what is there, and open the file for more."""
        if self._path is not None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
            try:
                self._begin()
            except (OSError, ValueError):
                self.__exit__()
                raise
        return self

    def __exit__(self, *_):
        """Close the file."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def append(self, entries):
        """
        Keep more entries.

        :param entries: list of dicts, see above.
        """
        self._write(entries)
        self.entries.update((entry['job'], entry) for entry in entries)

    def _begin(self):
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ValueError(f'{self._path}: another process is writing to it') from error
        length = self._read()
        os.ftruncate(self._descriptor, length)
        if length == 0:
            self._write([self._header])

    def _write(self, entries):
        if self._descriptor is None:
            return
        text = b''.join(_line(entry) for entry in entries)
        while text:
            text = text[os.write(self._descriptor, text):]

    def _read(self):
        """Read all whole lines; return how many bytes they take."""
        content = self._path.read_bytes()
        length = content.rfind(b'\n') + 1
        if length == 0:
            if not _line(self._header).startswith(content):
                raise ValueError(f'{self._path}: expected a file of results, or none')
            return 0
        lines = content[:length].splitlines()
        self._compare(self._parse(lines[0], 1))
        for number, line in enumerate(lines[1:], 2):
            entry = self._parse(line, number)
            if not isinstance(entry.get('job'), int) or not {'record', 'error'} & entry.keys():
                raise ValueError(f'{self._path}, line {number}: got {line[:80]!r}, expected a '
                                 'job and its record or error')
            self.entries[entry['job']] = entry
        return length

    def _parse(self, line, number):
        try:
            entry = json.loads(line)
        except ValueError as error:
            raise ValueError(f'{self._path}, line {number}: got {line[:80]!r}, expected JSON '
                             f'({error})') from error
        if not isinstance(entry, dict):
            raise ValueError(f'{self._path}, line {number}: got {line[:80]!r}, expected a '
                             'JSON object')
        return entry

    def _compare(self, found):
        for key, meaning in MEANINGS.items():
            if found.get(key) != self._header[key] and key not in self._ignored:
                hint = ' or any_software=True' if key in SOFTWARE else ''
                raise ValueError(
                    f'{self._path}: holds results of another batch: {meaning}: got '
                    f'{found.get(key)!r}, expected {self._header[key]!r}; give another file, '
                    f'remove this one{hint}')


def _line(entry):
    return json.dumps(entry).encode() + b'\n'


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
