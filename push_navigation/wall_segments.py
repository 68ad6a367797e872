"""Walls of a map: the faces between occupied and free cells, merged into segments."""

import math

import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import BoolArray, Coordinates, FloatArray, IntArray
from push_navigation.occupancy_map import OccupancyMap


def wall_segments(occupied: BoolArray) -> FloatArray:
    """
    Find the walls round occupied cells; the rim of the grid is none.

    :param occupied: shape (rows, columns).
    :return: segments (x_0, y_0, x_1, y_1) along columns and rows from the outer corner of the
        first cell, in cells, shape (n, 4).
    """
    along_columns = _runs(occupied[1:] != occupied[:-1])
    along_rows = _runs((occupied[:, 1:] != occupied[:, :-1]).T)
    return np.concatenate([
        along_columns[:, [1, 0, 2, 0]], along_rows[:, [0, 1, 0, 2]]]).astype(float)


def map_walls(occupancy_map: OccupancyMap, center: Coordinates | None = None,
              radius: float = math.inf) -> tuple[Wall, ...]:
    """
    List the walls round what is occupied.

    :param occupancy_map: the ``OccupancyMap``; its rim is no wall.
    :param center: (x, y) in the world round which walls are listed [m]; None for all.
    :param radius: distance along columns and rows up to which they count [m].
    """
    occupied, first = occupancy_map.occupied, np.zeros(2, dtype=int)
    if center is not None:
        column, row = occupancy_map.to_map(np.array([center[:2]]))[0] / occupancy_map.resolution
        reach = radius / occupancy_map.resolution
        first = np.maximum(0, np.floor([column - reach, row - reach]).astype(int))
        last = np.maximum(0, np.ceil([column + reach, row + reach]).astype(int))
        occupied = occupied[first[1]:last[1], first[0]:last[0]]
    segments = wall_segments(occupied) + np.tile(first, 2)
    starts, ends = (occupancy_map.from_map(occupancy_map.resolution * points).tolist()
                    for points in (segments[:, :2], segments[:, 2:]))
    return tuple(Wall(*start, *end) for start, end in zip(starts, ends))


def _runs(is_face: BoolArray) -> IntArray:
    """Merge neighbouring faces of each line: rows (line, first, behind last), shape (n, 3)."""
    ends = np.diff(np.pad(is_face.astype(int), ((0, 0), (1, 1))), axis=1)
    lines, first = np.nonzero(ends == 1)
    _, last = np.nonzero(ends == -1)
    # Faces of the first line are between the first and the second row of cells.
    return np.column_stack((lines + 1, first, last))
