"""
Walls by place: a grid lists for each cell the walls that a body in it may touch.

Maps of real rooms have thousands of short walls, of which a body is near a few. Those of a cell
come in the order of all, so that results are the same to the last digit as if all were looked at.
"""

import math
from typing import Any, NamedTuple, Sequence

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray, IntArray
from push_model.parameters import PushedObject

# Number of columns of a wall, see ``walls.wall_rows``.
WALL_SIZE = 5
# Distance from a body up to which its walls are listed [m]; chosen: above all that a fast body
# covers in a long step.
MARGIN = 0.25
# Side of a cell, at least [m], and number of cells along the longer side of the grid, at most;
# chosen: smaller cells list hardly fewer walls.
MIN_SIDE, MAX_CELLS = 0.25, 400


class WallGrid(NamedTuple):
    """
    Rows of walls, and which of them are near each cell.

    :param rows: of ``walls.wall_rows``, shape (n, ``WALL_SIZE``).
    :param first: place in ``near`` of the first wall of each cell, row by row, and behind the last
        one, shape (cells + 1,).
    :param near: indices of the rows near each cell in turn, increasing, shape (k,).
    :param x: of the corner of the first cell [m].
    :param y: the same.
    :param side: of a cell [m].
    :param row_count: number of rows of cells.
    :param column_count: number of columns of cells.
    """

    rows: Any
    first: Any
    near: Any
    x: float
    y: float
    side: float
    row_count: int
    column_count: int

    def pairs(self, points: FloatArray) -> tuple[IntArray, IntArray]:
        """
        List which walls are near which points, both by index.

        :param points: (x, y) in the grid, shape (n, 2) [m].
        """
        columns, rows = np.floor((points - (self.x, self.y)) / self.side).astype(int).T
        cells = rows * self.column_count + columns
        counts = self.first[cells + 1] - self.first[cells]
        index, place = _numbered(counts)
        return index, self.near[self.first[cells][index] + place]

    def as_lists(self) -> 'WallGrid':
        """Return the same with lists, which plain Python reads faster."""
        return self._replace(rows=self.rows.tolist(), first=self.first.tolist(),
                             near=self.near.tolist())


def wall_grid(rows: Sequence[tuple[float, ...]], reach: float) -> WallGrid:
    """
    Sort walls into the cells of a grid.

    :param rows: of ``walls.wall_rows``.
    :param reach: distance from the middle of a body up to which walls count [m].
    """
    walls = np.reshape(np.array(rows, dtype=float), (-1, WALL_SIZE))
    if not len(walls):
        return NO_WALLS
    ends = walls[:, :2] + walls[:, 4:] * walls[:, 2:4]
    low, high = np.minimum(walls[:, :2], ends) - reach, np.maximum(walls[:, :2], ends) + reach
    corner = low.min(axis=0)
    side = max(MIN_SIDE, float((high.max(axis=0) - corner).max()) / MAX_CELLS)
    first_cells, last_cells = (np.floor((points - corner) / side).astype(int)
                               for points in (low, high))
    columns, rows_of_cells = (last_cells.max(axis=0) + 1).tolist()
    index, cells = _cells_of_boxes(first_cells, last_cells, columns)
    # Stable: walls of a cell keep their order.
    order = np.argsort(cells, kind='stable')
    first = np.searchsorted(cells[order], np.arange(rows_of_cells * columns + 1))
    x, y = corner.tolist()
    return WallGrid(walls, first.astype(np.int64), index[order], x, y, side, rows_of_cells,
                    columns)


def _cells_of_boxes(first: IntArray, last: IntArray, columns: int) -> tuple[IntArray, IntArray]:
    """
    List the cells of boxes: index of the box, and number of the cell.

    :param first: column and row of the first cell of each box, shape (n, 2).
    :param last: likewise of the last one.
    :param columns: of the grid.
    """
    widths, heights = (last - first + 1).T
    index, place = _numbered(widths * heights)
    row, column = np.divmod(place, widths[index])
    return index, (first[index, 1] + row) * columns + first[index, 0] + column


def _numbered(counts: IntArray) -> tuple[IntArray, IntArray]:
    """List the members of groups of given sizes: index of the group, and place in it."""
    index = np.repeat(np.arange(len(counts)), counts)
    return index, np.arange(len(index)) - (np.cumsum(counts) - counts)[index]


def touch_reach(obj: PushedObject, robot_radius: float) -> float:
    """
    Compute up to which distance from the middle of object or robot walls are listed [m].

    :param robot_radius: infinite for a robot that walls do not stop [m].
    """
    com_x, com_y = obj.center_of_mass
    extent = max((math.hypot(x - com_x, y - com_y) for x, y in obj.outline),
                 default=obj.radius + math.hypot(com_x, com_y))
    return max(extent, robot_radius if math.isfinite(robot_radius) else 0.0) + MARGIN


@compiled
def walls_near(walls: Any, x: float, y: float) -> tuple[int, int]:
    """
    Find the walls near the middle of a body: from the first to behind the last place in ``near``.

    :param walls: ``WallGrid``.
    :param x: of the middle [m].
    :param y: the same.
    """
    column, row = int(math.floor((x - walls.x) / walls.side)), int(
        math.floor((y - walls.y) / walls.side))
    if column < 0 or row < 0 or column >= walls.column_count or row >= walls.row_count:
        return 0, 0
    cell = row * walls.column_count + column
    return walls.first[cell], walls.first[cell + 1]


def _no_walls() -> WallGrid:
    nothing: FloatArray = np.zeros((0, WALL_SIZE))
    return WallGrid(nothing, np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64), 0.0, 0.0,
                    1.0, 0, 0)


# Of open floor.
NO_WALLS = _no_walls()
