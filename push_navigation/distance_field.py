"""
Distances from the occupied cells of a grid, exact to the square that a cell is.

With the distance ``g`` of a cell from the nearest occupied square of its column, that from all
squares is, in cells and over the columns ``j`` of the row,

    d_i^2 = min( g_i^2, min over j of ( (|i - j| - 1/2)^2 + g_j^2 ) )

as the nearest point of a square lies half a cell nearer than its centre along either axis. The
inner minimum is the lower envelope of parabolas, between two columns (Felzenszwalb and
Huttenlocher, 2012), so that the time is proportional to the number of cells.
"""

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


def distance_field(occupied: BoolArray) -> NDArray[np.float32]:
    """
    Compute the distances of cell centres from occupied squares.

    :param occupied: whether each cell is occupied, shape (rows, columns).
    :return: distances [cells], shape (rows, columns); negative in occupied cells.
    """
    rows, columns = occupied.shape
    result = np.empty((rows, columns), dtype=np.float32)
    count = max(rows, columns)
    _fill(np.ascontiguousarray(occupied), result, np.empty(count), np.empty(count + 1),
          np.empty(count, dtype=np.int64), np.empty(count))
    return result


@compiled
def _fill(occupied: Any, result: Any, row: Any, bounds: Any, lowest: Any, squares: Any) -> None:
    """Write the distances; the last four are memory to work with."""
    rows, columns = occupied.shape
    for j in range(columns):
        _along_column(occupied, result, j)
    for i in range(rows):
        for j in range(columns):
            squares[j] = float(result[i, j]) * float(result[i, j])
            row[j] = squares[j]
        _between_columns(squares, columns, row, bounds, lowest)
        for j in range(columns):
            result[i, j] = INSIDE if occupied[i, j] else min(FAR, np.sqrt(row[j]))


@compiled
def _along_column(occupied: Any, result: Any, j: int) -> None:
    """Write distances from the squares of the same column."""
    rows = occupied.shape[0]
    last = -FAR
    for i in range(rows):
        if occupied[i, j]:
            last = i
        result[i, j] = max(0.0, min(FAR, i - last - 0.5))
    last = 2.0 * FAR
    for i in range(rows - 1, -1, -1):
        if occupied[i, j]:
            last = i
        result[i, j] = min(result[i, j], max(0.0, last - i - 0.5))


@compiled
def _between_columns(squares: Any, columns: int, row: Any, bounds: Any, lowest: Any) -> None:
    """Lower squared distances to those from squares of other columns."""
    count = 0
    for j in range(columns):
        if squares[j] >= FAR:
            continue
        begin = -FAR
        while count > 0:
            other = lowest[count - 1]
            begin = (squares[j] + j * j - squares[other] - other * other) / (2.0 * (j - other))
            if begin > bounds[count - 1]:
                break
            count -= 1
            begin = -FAR
        lowest[count] = j
        bounds[count] = begin
        count += 1
    if count == 0:
        return
    index = 0
    # At every edge between two columns, for both of them.
    for j in range(columns + 1):
        place = j - 0.5
        while index + 1 < count and bounds[index + 1] <= place:
            index += 1
        away = place - lowest[index]
        found = away * away + squares[lowest[index]]
        if j > 0:
            row[j - 1] = min(row[j - 1], found)
        if j < columns:
            row[j] = min(row[j], found)
