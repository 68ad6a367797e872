"""
Distances from the occupied cells of a grid, exact to the square that a cell is.

With the distance ``g`` of a cell from the nearest occupied square of its column, that from all
squares is, in cells and over the columns ``j`` of the row,

    d_i^2 = min( g_i^2, min over j of ( (|i - j| - 1/2)^2 + g_j^2 ) )

as the nearest point of a square lies half a cell nearer than its centre along either axis. The
inner minimum is the lower envelope of parabolas, between two columns (Felzenszwalb and
Huttenlocher, 2012), so that the time is proportional to the number of cells.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_model.geometry import BoolArray

# Distance of occupied cells [cells]; chosen: of lower values the free distances about a corner of
# an obstacle suffer, of higher ones the interpolated distance there is longer.
INSIDE = -1.5
# Distances interpolated between cell centres are at most this much too long [cells]; measured
# with ``INSIDE``, beside a corner of an obstacle.
INTERPOLATION_ERROR = 0.14
# More than any distance that is measured [cells].
FAR = 1e9
# Cells that are filled without a pause; chosen: that takes a few ms, during which no other thread
# of the process runs, as one that answers measurements does.
CELLS_AT_A_TIME = 50_000


def distance_field(occupied: BoolArray) -> NDArray[np.float32]:
    """
    Compute the distances of cell centres from occupied squares.

    :param occupied: whether each cell is occupied, shape (rows, columns).
    :return: distances [cells], shape (rows, columns); negative in occupied cells.
    """
    rows, columns = occupied.shape
    result = np.empty((rows, columns), dtype=np.float32)
    occupied = np.ascontiguousarray(occupied)
    for first, last in _portions(columns, rows):
        _along_columns(occupied, result, first, last)
    memory = (np.empty(columns), np.empty(columns + 1), np.empty(columns, dtype=np.int64),
              np.empty(columns))
    for first, last in _portions(rows, columns):
        _along_rows(occupied, result, first, last, memory)
    return result


def _portions(count: int, length: int) -> Iterator[tuple[int, int]]:
    """Divide rows, or columns, of a length: first of each portion, and first of the next."""
    size = max(1, CELLS_AT_A_TIME // length)
    for first in range(0, count, size):
        yield first, min(first + size, count)


@compiled
def _along_columns(occupied: Any, result: Any, first: int, last: int) -> None:
    """Write distances from the squares of the same column, of some columns."""
    rows = occupied.shape[0]
    for i in range(rows):
        for j in range(first, last):
            if occupied[i, j]:
                result[i, j] = 0.0
            elif i == 0:
                result[i, j] = FAR
            else:
                # Half a cell from the centre of a square to its edge.
                result[i, j] = result[i - 1, j] + (0.5 if occupied[i - 1, j] else 1.0)
    for i in range(rows - 2, -1, -1):
        for j in range(first, last):
            if not occupied[i, j]:
                result[i, j] = min(result[i, j], result[i + 1, j]
                                   + (0.5 if occupied[i + 1, j] else 1.0))


@compiled
def _along_rows(occupied: Any, result: Any, first: int, last: int, memory: Any) -> None:
    """Write the distances of some rows."""
    row, bounds, lowest, squares = memory
    columns = occupied.shape[1]
    for i in range(first, last):
        for j in range(columns):
            squares[j] = float(result[i, j]) * float(result[i, j])
            row[j] = squares[j]
        _between_columns(squares, columns, row, bounds, lowest)
        for j in range(columns):
            result[i, j] = INSIDE if occupied[i, j] else min(FAR, np.sqrt(row[j]))


@compiled
def _between_columns(squares: Any, columns: int, row: Any, bounds: Any, lowest: Any) -> None:
    """Lower squared distances to those from squares of other columns."""
    count = 0
    for j in range(columns):
        if squares[j] >= FAR:
            continue
        start = -FAR
        while count > 0:
            other = lowest[count - 1]
            start = (squares[j] + j * j - squares[other] - other * other) / (2.0 * (j - other))
            if start > bounds[count - 1]:
                break
            count -= 1
            start = -FAR
        lowest[count] = j
        bounds[count] = start
        count += 1
    if count == 0:
        return
    index = 0
    # At every edge between two columns, for both of them.
    for j in range(columns + 1):
        edge = j - 0.5
        while index + 1 < count and bounds[index + 1] <= edge:
            index += 1
        away = edge - lowest[index]
        square = away * away + squares[lowest[index]]
        if j > 0:
            row[j - 1] = min(row[j - 1], square)
        if j < columns:
            row[j] = min(row[j], square)
