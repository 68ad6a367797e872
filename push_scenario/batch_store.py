"""
File of what a batch has done so far: JSON lines, only ever appended to.

The first line is the header, each further one ``{"job": 3, "record": {...}}`` or ``{"job": 3,
"error": "..."}``, in the order in which they came. A last line without its end, as a kill may
leave it, does not count. Numbers keep every bit.
"""

import fcntl
import json
import os
from pathlib import Path

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
