"""How one run with a fault ended."""

from collections.abc import Sequence
import enum
import json
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.faults.injection import Fault, Input, Word


class Ending(enum.Enum):
    """How a run ended."""

    DONE = 'done'
    FAILED = 'failed'
    # The robot stands, and says what for.
    WAITS = 'waits'


class Row(NamedTuple):
    """
    How a run with a fault ended.

    :param scenario: name of the scenario.
    :param fault: the ``Fault``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    :param codes: names of the codes of the reason.
    :param violations: names of each ``Violation``; empty where the run ended as it should.
    :param stop_time: from the beginning of the fault, of commands of its effect, until the robot
        first commands zero [s]; nan where it need not stop.
    :param driven: by the robot until then [m]; nan likewise.
    :param deviation: greatest distance of the object, after the beginning, from all that was
        planned for it [m].
    """

    scenario: str
    fault: Fault
    ending: Ending
    reason: str
    codes: tuple[str, ...]
    violations: tuple[str, ...]
    stop_time: float
    driven: float
    deviation: float

    @property
    def is_ok(self) -> bool:
        """Whether the run ended as it should."""
        return not self.violations

    def __str__(self) -> str:
        """Write one line."""
        return (f'{self.scenario}, {self.fault}: {self.ending.value}'
                + (f', {self.reason}' if self.reason else '')
                + f' (stopped after {self.stop_time:.2f} s and {self.driven:.2f} m; object '
                f'{self.deviation:.2f} m beside its plans)'
                + violation_text(self.violations))


def violation_text(violations: Sequence[str]) -> str:
    """
    Write the end of a line about a run.

    :param violations: names of each ``Violation``.
    """
    return f' VIOLATES: {", ".join(violations)}' if violations else ''


def append_row(path: Path, row: Row) -> None:
    """
    Add a run to a file.

    :param path: of the file, one run a line.
    :param row: the ``Row``.
    """
    fault = row.fault
    values = {**row._asdict(), 'ending': row.ending.value,
              'fault': [fault.input.value, fault.word.value, fault.start, fault.end]}
    append_line(path, values)


def append_line(path: Path, values: dict[str, Any]) -> None:
    """
    Add a line of JSON to a file.

    :param path: of the file.
    :param values: by name.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open('a', encoding='utf-8') as file:
        file.write(json.dumps(values) + '\n')


def read_lines(path: Path) -> list[dict[str, Any]]:
    """
    Read the lines of JSON of a file.

    :param path: of the file; where it is not there, there are none.
    """
    if not path.is_file():
        return []
    return [json.loads(line) for line in path.read_text(encoding='utf-8').splitlines()]


def read_rows(path: Path) -> list[Row]:
    """
    Read the runs of a file.

    :param path: of the file; where it is not there, there are none.
    """
    rows: list[Row] = []
    for values in read_lines(path):
        kind, word, start, end = values['fault']
        values.update(fault=Fault(Input(kind), Word(word), start, end),
                      ending=Ending(values['ending']), codes=tuple(values['codes']),
                      violations=tuple(values['violations']))
        rows.append(Row(**values))
    return rows
