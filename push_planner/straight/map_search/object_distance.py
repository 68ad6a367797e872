"""
How far the object is from its goal among obstacles: shortest paths of a disc inside it, on a grid.

Dijkstra's algorithm, from the goal outwards. Where no path is wide enough, the widest one says
where the floor is too narrow.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_navigation.floor import clearance, Floor
from push_planner.straight.map_search.priority_queue import push, remove_first

# Spacing of the grid, at least [m]; chosen: that of usual maps.
SPACING = 0.05
# Where there is no path [m]. Finite, as compilers may drop comparisons with infinity.
UNREACHED = 1e9
# Neighbours of a grid point: rows, columns, and the distance in spacings.
NEIGHBOURS = np.array([(0, 1, 1.0), (0, -1, 1.0), (1, 0, 1.0), (-1, 0, 1.0),
                       (1, 1, math.sqrt(2.0)), (1, -1, math.sqrt(2.0)),
                       (-1, 1, math.sqrt(2.0)), (-1, -1, math.sqrt(2.0))])
# Part of the spacing by which a path may be narrower than needed: it may lie between grid points.
NARROWER = 0.5


class DistanceGrid(NamedTuple):
    """
    Lengths of the shortest paths of the object's middle to its goal, on a grid.

    :param lengths: of grid points, shape (r, c) [m]; point (i, j) lies at x = (j + 1/2) spacing,
        y = (i + 1/2) spacing in the frame of the map.
    :param spacing: of the grid [m].
    """

    lengths: NDArray[np.float32]
    spacing: float


class Narrow(NamedTuple):
    """
    Narrowest passage of the widest path.

    :param x: in the frame of the map [m].
    :param y: in the frame of the map [m].
    :param width: there [m].
    """

    x: float
    y: float
    width: float


def distance_grid(floor: Floor, goal: tuple[float, float], needed: float) -> DistanceGrid:
    """
    Measure the distances of all grid points from a goal.

    :param goal: (x, y) in the frame of the map [m].
    :param needed: clearance of the object's middle along its path, at least [m].
    """
    lengths, spacing = _grid(floor, UNREACHED)
    keys, items = _queue(lengths)
    _propagate(floor, goal, needed - NARROWER * spacing, spacing, NEIGHBOURS, lengths, keys=keys,
               items=items)
    return DistanceGrid(lengths, spacing)


def narrowest_passage(floor: Floor, start: tuple[float, float],
                      goal: tuple[float, float]) -> Narrow:
    """
    Find the narrowest passage on the widest path.

    :param start: (x, y) in the frame of the map [m].
    :param goal: (x, y) likewise [m].
    """
    widths, spacing = _grid(floor, -UNREACHED)
    before = np.full(widths.shape, -1, dtype=np.int64)
    keys, items = _queue(widths)
    _propagate_widest(floor, goal, spacing, NEIGHBOURS, widths, before, keys=keys, items=items)
    rows, columns = widths.shape
    i = min(rows - 1, max(0, int(start[1] / spacing)))
    j = min(columns - 1, max(0, int(start[0] / spacing)))
    least = float(widths[i, j])
    # Up to the narrowest passage all widths are that of it, and beyond it greater.
    while before[i, j] >= 0:
        following = divmod(int(before[i, j]), columns)
        if widths[following] > least + 1e-6:
            break
        i, j = following
    return Narrow((j + 0.5) * spacing, (i + 0.5) * spacing, max(0.0, 2.0 * least))


def _grid(floor: Floor, value: float) -> tuple[NDArray[np.float32], float]:
    """Lay a grid over the map; its values, and its spacing [m]."""
    resolution = 1.0 / floor.cells_per_metre
    spacing = max(resolution, SPACING)
    rows, columns = (math.ceil((count - 2) * resolution / spacing - 1e-6)
                     for count in floor.distances.shape)
    return np.full((rows, columns), value, dtype=np.float32), spacing


def _queue(grid: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    # Every grid point is improved a few times at most: measured at 2.1 entries each.
    count = 4 * grid.size + 16
    return np.empty(count), np.empty(count, dtype=np.int64)


@compiled
def length_at(grid: Any, x: float, y: float) -> float:
    """
    Find the length of the path from a point: the least of the grid points about it.

    :param grid: ``DistanceGrid``.
    :param x: in the frame of the map [m].
    :param y: in the frame of the map [m].
    :return: length [m], ``UNREACHED`` where there is no path.
    """
    rows, columns = grid.lengths.shape
    u, v = x / grid.spacing - 0.5, y / grid.spacing - 0.5
    i0, j0 = int(math.floor(v)), int(math.floor(u))
    least = UNREACHED
    for i in range(max(0, i0), min(rows, i0 + 2)):
        for j in range(max(0, j0), min(columns, j0 + 2)):
            if grid.lengths[i, j] < UNREACHED:
                away = grid.spacing * math.sqrt((u - j) * (u - j) + (v - i) * (v - i))
                least = min(least, grid.lengths[i, j] + away)
    return least


@compiled
def _propagate(floor: Any, goal: Any, needed: float, spacing: float, neighbours: Any, lengths: Any,
               *, keys: Any, items: Any) -> None:
    """Write the lengths of shortest paths from the grid points about the goal."""
    rows, columns = lengths.shape
    count = 0
    i0, j0 = int(math.floor(goal[1] / spacing - 0.5)), int(math.floor(goal[0] / spacing - 0.5))
    for i in range(max(0, i0), min(rows, i0 + 2)):
        for j in range(max(0, j0), min(columns, j0 + 2)):
            lengths[i, j] = 0.0
            count = push(keys, items, count, 0.0, i * columns + j)
    while count > 0:
        key, index = keys[0], items[0]
        count = remove_first(keys, items, count)
        i, j = index // columns, index % columns
        if key > lengths[i, j] + 1e-5:
            continue
        for k in range(8):
            a, b = i + int(neighbours[k, 0]), j + int(neighbours[k, 1])
            if a < 0 or b < 0 or a >= rows or b >= columns or count >= keys.shape[0]:
                continue
            length = key + spacing * neighbours[k, 2]
            if length >= lengths[a, b] - 1e-5:
                continue
            if clearance(floor, (b + 0.5) * spacing, (a + 0.5) * spacing) < needed:
                continue
            lengths[a, b] = length
            count = push(keys, items, count, length, a * columns + b)


@compiled
def _propagate_widest(floor: Any, goal: Any, spacing: float, neighbours: Any, widths: Any,
                      before: Any, *, keys: Any, items: Any) -> None:
    """Write the least clearance on the widest path to each grid point, and the point before it."""
    rows, columns = widths.shape
    i = min(rows - 1, max(0, int(goal[1] / spacing)))
    j = min(columns - 1, max(0, int(goal[0] / spacing)))
    widths[i, j] = 1e6
    count = push(keys, items, 0, -1e6, i * columns + j)
    while count > 0:
        width, index = -keys[0], items[0]
        count = remove_first(keys, items, count)
        i, j = index // columns, index % columns
        if width < widths[i, j] - 1e-6:
            continue
        for k in range(8):
            a, b = i + int(neighbours[k, 0]), j + int(neighbours[k, 1])
            if a < 0 or b < 0 or a >= rows or b >= columns or count >= keys.shape[0]:
                continue
            here = min(width, clearance(floor, (b + 0.5) * spacing, (a + 0.5) * spacing))
            if here > widths[a, b] + 1e-6:
                widths[a, b] = here
                before[a, b] = index
                count = push(keys, items, count, -here, a * columns + b)
