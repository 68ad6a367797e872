"""
Surroundings: files that cannot be read or written, signals, clocks and strangers.

Each case does one thing to nodes or commands, and says what it has seen. No node may write a
traceback, leave a process behind, or be silent about what is wrong.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
import time
from typing import NamedTuple

from benchmarks.faults.commands import COMMAND_CASES
from benchmarks.faults.observation import Observation
from benchmarks.faults.row import append_line, read_lines
from benchmarks.faults.strangers import STRANGER_CASES, stranger_rig

HEADER = '| what happens | what is seen | takes [s] |\n| --- | --- | --- |'


class SurroundingsRow(NamedTuple):
    """
    A case.

    :param name: of the case.
    :param seen: one sentence.
    :param faults: what is not as it should be, one text each; empty where all is.
    :param duration: time on the wall [s].
    """

    name: str
    seen: str
    faults: tuple[str, ...]
    duration: float

    @property
    def is_ok(self) -> bool:
        """Whether all is as it should be."""
        return not self.faults

    def __str__(self) -> str:
        """Write one line."""
        return f'{self.name}: {self.seen} ({self.duration:.1f} s){self.violation_text}'

    @property
    def violation_text(self) -> str:
        """What is not as it should be, as the end of a line."""
        return ''.join(f' VIOLATES: {fault}' for fault in self.faults)


def run_surroundings(path: Path, only: str = '') -> None:
    """
    Run the cases that are not in a file yet.

    :param path: of the file.
    :param only: how the names of the cases begin.
    """
    known = {row.name for row in read_surroundings(path)}

    def remaining(names: Mapping[str, object]) -> list[str]:
        return [name for name in names if name.startswith(only) and name not in known]
    for name in remaining(COMMAND_CASES):
        _run(path, name, COMMAND_CASES[name])
    names = remaining(STRANGER_CASES)
    if names:
        with stranger_rig() as rig:
            for name in names:
                case = STRANGER_CASES[name]
                _run(path, name, lambda: case(rig))


def _run(path: Path, name: str, case: Callable[[], Observation]) -> None:
    start = time.monotonic()
    observation = case()
    row = SurroundingsRow(name, observation.seen, observation.faults, time.monotonic() - start)
    append_line(path, row._asdict())
    print(row, flush=True)


def read_surroundings(path: Path) -> list[SurroundingsRow]:
    """
    Read the cases of a file.

    :param path: of the file; where it is not there, there are none.
    """
    return [SurroundingsRow(values['name'], values['seen'], tuple(values['faults']),
                            values['duration']) for values in read_lines(path)]


def surroundings_table(rows: Sequence[SurroundingsRow]) -> str:
    """
    List what was seen.

    :param rows: each ``SurroundingsRow``.
    :return: Markdown.
    """
    return '\n'.join([HEADER, *(
        f'| {row.name} | {row.seen}{row.violation_text} | {row.duration:.0f} |'
        for row in rows)])
