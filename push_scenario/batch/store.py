"""
Results of a batch in files: JSON lines that only grow, and a table of all jobs at the end.

The first line is the header, which identifies the batch; every further line is an entry, with the
number of a job and its record or its error.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
import csv
import fcntl
import json
import operator
import os
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO, cast, overload

import numpy as np
from numpy.typing import NDArray
from push_scenario.batch.chunks import Entry, Job, Record

# Keys of a header, and what errors call them.
MEANINGS = {'format': 'kind of file', 'function': 'function', 'jobs': 'number of jobs',
            'digest': 'digest of the jobs', 'version': 'version of the package',
            'software': 'digest of the source'}
SOFTWARE_KEYS = ('version', 'software')
# How much of a damaged line an error quotes.
QUOTE_LENGTH = 80


class StoredRecords(Sequence[Record | None]):
    """
    Records of a batch in its file, each read when it is asked for; equal to any equal sequence.

    :param path: of the file.
    :param begins: where the line of each job begins [bytes], shape (n,), -1 where there is none.
    """

    def __init__(self, path: Path, begins: NDArray[np.int64]) -> None:
        self._path = path
        self._begins = begins

    def __len__(self) -> int:
        """Return the number of jobs."""
        return len(self._begins)

    @overload
    def __getitem__(self, index: int) -> Record | None:
        ...

    @overload
    def __getitem__(self, index: slice) -> list[Record | None]:
        ...

    def __getitem__(self, index: int | slice) -> Record | None | list[Record | None]:
        """
        Read one or several records.

        :param index: number of the job, or a slice of such numbers.
        :raises ValueError: where the file has been changed since the batch ended.
        """
        numbers = range(len(self))[index]
        with open(self._path, 'rb') as stream:
            if isinstance(numbers, int):
                return self._read(stream, numbers)
            return [self._read(stream, number) for number in numbers]

    def __iter__(self) -> Iterator[Record | None]:
        """Read the records one by one."""
        with open(self._path, 'rb') as stream:
            for number in range(len(self)):
                yield self._read(stream, number)

    def __eq__(self, other: object) -> bool:
        """Tell whether there are the same records in the same order."""
        if not isinstance(other, Sequence):
            return NotImplemented
        others = cast(Sequence[object], other)
        return len(self) == len(others) and all(map(operator.eq, self, others))

    def _read(self, stream: BinaryIO, number: int) -> Record | None:
        if self._begins[number] < 0:
            return None
        stream.seek(int(self._begins[number]))
        line = stream.readline()
        try:
            entry = json.loads(line)
        except ValueError:
            entry = None
        if not isinstance(entry, dict) or cast(Entry, entry).get('job') != number:
            raise ValueError(f'{self._path}: got {line[:QUOTE_LENGTH]!r} in place of job {number},'
                             ' expected the file as the batch has left it')
        return cast(Entry, entry).get('record')


class Store:
    """
    Entries of a batch, kept in a file or in memory; to be used in a ``with`` statement.

    Of a file, memory holds only where the entries begin, and the errors.

    :param path: of the file, made if need be; None for memory only.
    :param header: dict that the file's header must equal.
    :param any_software: accept a header that differs in version and source.
    :raises ValueError: where the file is of another batch or damaged, naming what differs.
    """

    def __init__(self, path: str | PathLike[str] | None, header: Mapping[str, Any],
                 any_software: bool = False) -> None:
        # What went wrong, by number of the job.
        self.errors: dict[int, str] = {}
        self._path = None if path is None else Path(path).absolute()
        self._header = dict(header)
        self._ignored = SOFTWARE_KEYS if any_software else ()
        self._descriptor: int | None = None
        self._is_done = np.zeros(header['jobs'], dtype=np.bool_)
        # Of a file: its length, and where the line of each job begins [bytes].
        self._length = 0
        self._begins = np.full(header['jobs'], -1, dtype=np.int64)
        # Without a file.
        self._kept: list[Record | None] = [None] * (header['jobs'] if path is None else 0)

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

    @property
    def done_count(self) -> int:
        """Number of jobs that have an entry."""
        return int(np.count_nonzero(self._is_done))

    def missing(self) -> list[int]:
        """List the numbers of the jobs that have no entry."""
        return np.flatnonzero(~self._is_done).tolist()

    def records(self) -> Sequence[Record | None]:
        """Return the records of all jobs, None for each that has none."""
        if self._path is not None:
            return StoredRecords(self._path, self._begins)
        return tuple(self._kept)

    def append(self, entries: Sequence[Entry]) -> None:
        """
        Keep more entries.

        :param entries: list of dicts, see above.
        """
        if self._path is None:
            for entry in entries:
                self._note(entry, 0)
            return
        lines = [_line(entry) for entry in entries]
        begin = self._length
        self._write(b''.join(lines))
        for entry, line in zip(entries, lines):
            self._note(entry, begin)
            begin += len(line)

    def keep_valid(self, is_valid: Callable[[int, Record], bool]) -> None:
        """
        Forget records that are not valid any more.

        :param is_valid: called with the number of each job that has a record, and that.
        """
        for number, record in enumerate(self.records()):
            if record is not None and not is_valid(number, record):
                self._is_done[number] = False

    def _note(self, entry: Entry, begin: int) -> None:
        """Note that a job is done, and where its line begins."""
        number = entry['job']
        self._is_done[number] = True
        self.errors.pop(number, None)
        if 'error' in entry:
            self.errors[number] = entry['error']
        if self._path is None:
            self._kept[number] = entry.get('record')
        else:
            self._begins[number] = begin

    def _open(self, path: Path, descriptor: int) -> None:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ValueError(f'{path}: another process is writing to it') from error
        self._length = self._read(path)
        # A last line without its end is what a kill or a power cut leaves.
        os.ftruncate(descriptor, self._length)
        if self._length == 0:
            self._write(_line(self._header))

    def _write(self, text: bytes) -> None:
        if self._descriptor is None:
            return
        while text:
            count = os.write(self._descriptor, text)
            self._length += count
            text = text[count:]

    def _read(self, path: Path) -> int:
        """Read all whole lines; return how many bytes they take."""
        with open(path, 'rb') as stream:
            first = stream.readline()
            if not first.endswith(b'\n'):
                if not _line(self._header).startswith(first):
                    raise ValueError(f'{path}: expected a file of results, or none')
                return 0
            self._compare(path, _parse(path, first, 1))
            length = len(first)
            for number, line in enumerate(stream, 2):
                if not line.endswith(b'\n'):
                    break
                self._note(self._entry(path, line, number), length)
                length += len(line)
        return length

    def _entry(self, path: Path, line: bytes, number: int) -> Entry:
        entry = _parse(path, line, number)
        job = entry.get('job')
        if (not isinstance(job, int) or not 0 <= job < len(self._is_done)
                or not {'record', 'error'} & entry.keys()):
            raise ValueError(f'{path}, line {number}: got {line[:QUOTE_LENGTH]!r}, expected a '
                             'job and its record or error')
        return entry

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
