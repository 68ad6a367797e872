"""Tape: the recording of a run, as named columns over time."""

import csv
import dataclasses
import io
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_model.files.whole_file import write_whole
from push_model.optional import how_to_install


@dataclasses.dataclass(frozen=True, eq=False)
class Tape:
    """
    Named columns of numbers, one row per recorded instant; read-only.

    :param columns: names, the first is ``time`` [s], increasing.
    :param rows: shape (n, k), one column per name.
    :raises ValueError: where names and numbers do not fit together.
    """

    columns: tuple[str, ...]
    rows: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Check the shape and freeze the numbers."""
        columns = tuple(self.columns)
        rows = np.array(self.rows, dtype=float)
        if not columns or columns[0] != 'time' or len(set(columns)) != len(columns):
            raise ValueError(f'Tape.columns: got {columns}, expected distinct names, the first '
                             "'time'")
        if not len(rows) or rows.shape != (len(rows), len(columns)):
            raise ValueError(f'Tape.rows: got shape {rows.shape}, expected one row or more of '
                             f'{len(columns)} numbers')
        if not (np.diff(rows[:, 0]) > 0.0).all():
            raise ValueError('Tape.rows: got times that do not increase, expected increasing '
                             'times [s]')
        rows.setflags(write=False)
        object.__setattr__(self, 'columns', columns)
        object.__setattr__(self, 'rows', rows)

    def __repr__(self) -> str:
        """Say in one line what it holds."""
        return (f'<Tape of {len(self)} rows and {len(self.columns)} columns, '
                f'{self.rows[0, 0]:g} to {self.rows[-1, 0]:g} s>')

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """
        Look up a column.

        :param name: of the column.
        :return: its numbers, shape (n,).
        :raises KeyError: where there is none, with those there are.
        """
        if name not in self.columns:
            raise KeyError(f'{name}: expected one of {", ".join(self.columns)}')
        return self.rows[:, self.columns.index(name)]

    def poses(self, body: str) -> NDArray[np.float64]:
        """
        Look up x, y and theta of a body.

        :param body: ``object`` or ``robot``.
        :return: shape (n, 3) [m, m, rad].
        """
        return np.column_stack([self[f'{body}_{name}'] for name in ('x', 'y', 'theta')])

    def to_pandas(self) -> Any:
        """
        Return the tape as a ``pandas.DataFrame``, with the names of the columns.

        :raises RuntimeError: where pandas is not installed.
        """
        # Imported here: nothing else needs pandas.
        try:
            from pandas import DataFrame
        except ImportError as error:
            raise RuntimeError(f'to_pandas: {how_to_install("pandas")}') from error
        return DataFrame(self.rows, columns=list(self.columns))

    def to_bytes(self) -> bytes:
        """Return the tape as CSV: equal runs give equal bytes, and no digit is lost."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator='\n')
        writer.writerow(self.columns)
        writer.writerows([repr(value) for value in row] for row in self.rows.tolist())
        return text.getvalue().encode('ascii')

    def save(self, path: str | PathLike[str]) -> None:
        """
        Write the tape to a file.

        :param path: where, by convention ``*.csv``.
        :raises OSError: naming the file, where it cannot be written; then there is none.
        """
        write_whole(Path(path), self.to_bytes())


def read_tape(path: str | PathLike[str]) -> Tape:
    """
    Read a tape that ``Tape.save`` wrote.

    :param path: the file.
    :raises ValueError: naming the file and the line that is wrong.
    """
    with open(path, newline='', encoding='utf-8') as file:
        lines = list(csv.reader(file))
    if len(lines) < 2:
        raise ValueError(f'{path}: got {len(lines)} lines, expected names and numbers')
    rows: list[list[float]] = []
    for number, line in enumerate(lines[1:], 2):
        try:
            rows.append([float(value) for value in line])
        except ValueError as error:
            raise ValueError(f'{path}:{number}: {error}, expected numbers') from error
        if len(line) != len(lines[0]):
            raise ValueError(f'{path}:{number}: got {len(line)} numbers, expected '
                             f'{len(lines[0])}')
    return Tape(tuple(lines[0]), np.array(rows))
