"""
Results of a batch in files: JSON lines that only grow, and a table of all jobs at the end.

The first line is the header, which identifies the batch; every further line is an entry, with the
number of a job and its record or its error.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
import csv
import fcntl
import json
import os
from os import PathLike
from pathlib import Path
from typing import Any

from push_scenario.batch.chunks import Entry, Job, Record

# Keys of a header, and what errors call them.
MEANINGS = {'format': 'kind of file', 'function': 'function', 'jobs': 'number of jobs',
            'digest': 'digest of the jobs', 'version': 'version of the package',
            'software': 'digest of the source'}
SOFTWARE_KEYS = ('version', 'software')
# How much of a damaged line an error quotes.
QUOTE_LENGTH = 80


class Store:
    """
    Entries of a batch, kept in a file; to be used in a ``with`` statement.

    ``entries`` maps the number of a job to its entry.

    :param path: of the file, made if need be; None for memory only.
    :param header: dict that the file's header must equal.
    :param any_software: accept a header that differs in version and source.
    :raises ValueError: where the file is of another batch or damaged, naming what differs.
    """

    def __init__(self, path: str | PathLike[str] | None, header: Mapping[str, Any],
                 any_software: bool = False) -> None:
        self.entries: dict[int, Entry] = {}
        self._path = None if path is None else Path(path)
        self._header = dict(header)
        self._ignored = SOFTWARE_KEYS if any_software else ()
        self._descriptor: int | None = None

    def __enter__(self) -> 'Store':
        """Read what is there, and open the file for more."""
        if self._path is not None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
            try:
                self._open(self._path, self._descriptor)
            except (OSError, ValueError):
                self.__exit__()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def append(self, entries: Sequence[Entry]) -> None:
        """
        Keep more entries.

        :param entries: list of dicts, see above.
        """
        self._write(entries)
        self.entries.update((entry['job'], entry) for entry in entries)

    def keep_valid(self, is_valid: Callable[[Entry], bool]) -> None:
        """
        Forget records that are not valid any more.

        :param is_valid: called with entries that have a record.
        """
        self.entries = {job: entry for job, entry in self.entries.items()
                        if 'record' not in entry or is_valid(entry)}

    def _open(self, path: Path, descriptor: int) -> None:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ValueError(f'{path}: another process is writing to it') from error
        length = self._read(path)
        # A last line without its end is what a kill or a power cut leaves.
        os.ftruncate(descriptor, length)
        if length == 0:
            self._write([self._header])

    def _write(self, entries: Sequence[Mapping[str, Any]]) -> None:
        if self._descriptor is None:
            return
        text = b''.join(_line(entry) for entry in entries)
        while text:
            text = text[os.write(self._descriptor, text):]

    def _read(self, path: Path) -> int:
        """Read all whole lines; return how many bytes they take."""
        content = path.read_bytes()
        length = content.rfind(b'\n') + 1
        if length == 0:
            if not _line(self._header).startswith(content):
                raise ValueError(f'{path}: expected a file of results, or none')
            return 0
        lines = content[:length].splitlines()
        self._compare(path, _parse(path, lines[0], 1))
        for number, line in enumerate(lines[1:], 2):
            entry = _parse(path, line, number)
            if not isinstance(entry.get('job'), int) or not {'record', 'error'} & entry.keys():
                raise ValueError(f'{path}, line {number}: got {line[:QUOTE_LENGTH]!r}, expected a '
                                 'job and its record or error')
            self.entries[entry['job']] = entry
        return length

    def _compare(self, path: Path, found: Mapping[str, Any]) -> None:
        for key, meaning in MEANINGS.items():
            if found.get(key) != self._header[key] and key not in self._ignored:
                hint = ' or any_software=True' if key in SOFTWARE_KEYS else ''
                raise ValueError(
                    f'{path}: holds results of another batch: {meaning}: got {found.get(key)!r}, '
                    f'expected {self._header[key]!r}; give another file, remove this one{hint}')


def _line(entry: Mapping[str, Any]) -> bytes:
    return json.dumps(entry).encode() + b'\n'


def _parse(path: Path, line: bytes, number: int) -> dict[str, Any]:
    try:
        entry = json.loads(line)
    except ValueError as error:
        raise ValueError(f'{path}, line {number}: got {line[:QUOTE_LENGTH]!r}, expected JSON '
                         f'({error})') from error
    if not isinstance(entry, dict):
        raise ValueError(f'{path}, line {number}: got {line[:QUOTE_LENGTH]!r}, expected a JSON '
                         'object')
    return entry


def write_table(out: str | PathLike[str], jobs: Sequence[Job], records: Sequence[Record | None],
                errors: Mapping[int, str]) -> None:
    """
    Write a CSV file beside the file of results: a row per job, in their order.

    Columns are ``job`` (its number), ``error``, the values of the job under ``job.`` and their
    path, such as ``job.object_pose.0``, and those of the record. Floats keep every bit.

    :param out: path of the file of results; the table gets the suffix ``.csv``.
    :param jobs: the jobs.
    :param records: flat dict of each job, None where it failed.
    :param errors: what went wrong, by number of the job.
    """
    def rows() -> Iterator[dict[str, Any]]:
        for index, (job, record) in enumerate(zip(jobs, records)):
            yield {'job': index, 'error': errors.get(index, ''), **dict(_columns('job', job)),
                   **(record or {})}

    # Row by row, and twice: all rows at once would take more memory than the records.
    columns: dict[str, None] = {}
    for row in rows():
        columns.update(dict.fromkeys(row))
    path = Path(out).with_suffix('.csv')
    unfinished = path.with_suffix('.csv.part')
    with open(unfinished, 'w', encoding='utf-8', newline='') as stream:
        writer = csv.writer(stream, lineterminator='\n')
        writer.writerow(columns)
        writer.writerows([row.get(column, '') for column in columns] for row in rows())
    os.replace(unfinished, path)


def _columns(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield column names and values of a job."""
    if isinstance(value, dict):
        items: Any = value.items()
    elif isinstance(value, (list, tuple)):
        items = enumerate(value)
    else:
        yield (f'{name}.value' if name == 'job' else name), value
        return
    for key, inner in items:
        yield from _columns(f'{name}.{key}', inner)
