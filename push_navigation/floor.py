"""Floor of a map as compiled code reads it, and distances from obstacles and polygons."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_navigation.occupancy_map import OccupancyMap


class Floor(NamedTuple):
    """
    Obstacles; positions are in the frame of the map.

    :param distances: clearances of cell centres, with a border of one cell, shape (r, c) [m].
    :param cells_per_metre: of the map [1/m].
    """

    distances: NDArray[np.float32]
    cells_per_metre: float


def make_floor(occupancy_map: OccupancyMap) -> Floor:
    """Prepare a map for compiled code."""
    return Floor(occupancy_map.distances, 1.0 / occupancy_map.resolution)


@compiled
def clearance(floor: Any, x: float, y: float) -> float:
    """
    Interpolate the distance of a point from obstacles.

    :param floor: ``Floor``.
    :param x: along columns, from the outer corner of the first cell [m].
    :param y: along rows [m].
    :return: distance [m], negative in obstacles and outside the map.
    """
    column = x * floor.cells_per_metre + 0.5
    row = y * floor.cells_per_metre + 0.5
    rows, columns = floor.distances.shape
    if column < 0.0 or row < 0.0 or column >= columns - 1 or row >= rows - 1:
        return -1.0
    j, i = int(column), int(row)
    u, v = column - j, row - i
    return ((floor.distances[i, j] * (1.0 - u) + floor.distances[i, j + 1] * u) * (1.0 - v)
            + (floor.distances[i + 1, j] * (1.0 - u) + floor.distances[i + 1, j + 1] * u) * v)


@compiled
def polygon_distance(vertices: Any, x: float, y: float) -> float:
    """
    Measure the distance of a point from a convex polygon.

    :param vertices: counter-clockwise, shape (n, 2) [m]; one of a point.
    :param x: of the point, in the frame of the vertices [m].
    :param y: of the point [m].
    :return: distance [m], negative inside.
    """
    count = vertices.shape[0]
    nearest = 1e18
    inside = count > 1
    for k in range(count):
        following = k + 1 if k + 1 < count else 0
        x0, y0 = vertices[k, 0], vertices[k, 1]
        e_x, e_y = vertices[following, 0] - x0, vertices[following, 1] - y0
        d_x, d_y = x - x0, y - y0
        if e_x * d_y - e_y * d_x < 0.0:
            inside = False
        square = e_x * e_x + e_y * e_y
        t = min(1.0, max(0.0, (d_x * e_x + d_y * e_y) / square)) if square > 0.0 else 0.0
        d_x, d_y = d_x - t * e_x, d_y - t * e_y
        nearest = min(nearest, d_x * d_x + d_y * d_y)
    return -math.sqrt(nearest) if inside else math.sqrt(nearest)
