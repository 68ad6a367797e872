"""Maps that several tests plan in."""

from typing import Iterable

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_navigation.occupancy_map import OccupancyMap

RESOLUTION = 0.05


def walled_floor(width: float, height: float, door: float | None = None,
                 resolution: float = RESOLUTION) -> OccupancyMap:
    """Return a floor about the origin within walls; a wall across it at x = 0 may have a door."""
    occupied = np.zeros((round(height / resolution), round(width / resolution)), dtype=bool)
    occupied[[0, -1]] = True
    occupied[:, [0, -1]] = True
    if door is not None:
        rows, columns = occupied.shape
        half = round(0.5 * door / resolution)
        occupied[:, columns // 2] = True
        occupied[rows // 2 - half:rows // 2 + half, columns // 2] = False
    return OccupancyMap(resolution, Pose(-0.5 * width, -0.5 * height, 0.0), occupied)


def walled_room(*blocks: tuple[float, float, float, float], side: float = 6.0,
                resolution: float = RESOLUTION, origin: Pose | None = None) -> OccupancyMap:
    """Return a square room about the origin with blocks (x0, x1, y0, y1) in it."""
    count = round(side / resolution)
    occupied = np.zeros((count, count), dtype=bool)
    for block in blocks:
        x0, x1, y0, y1 = (round((value + 0.5 * side) / resolution) for value in block)
        occupied[y0:y1, x0:x1] = True
    return OccupancyMap(resolution, origin or Pose(-0.5 * side, -0.5 * side, 0.0), occupied)


def room_with_door(width: float) -> OccupancyMap:
    """Return a room with a wall along y, and a door in it about y = 1."""
    return walled_room((-0.05, 0.05, -3.0, 1.0 - width / 2), (-0.05, 0.05, 1.0 + width / 2, 3.0))


def true_distances(occupancy_map: OccupancyMap,
                   points: Iterable[tuple[float, float]]) -> FloatArray:
    """Compute the distance to the nearest occupied square, cell by cell, the border included."""
    rows, columns = np.nonzero(occupancy_map.occupied)
    centers = np.stack((columns + 0.5, rows + 0.5), axis=1) * occupancy_map.resolution
    local = np.array([occupancy_map.origin.inverse().transform(point) for point in points])
    apart = np.abs(local[:, None, :] - centers) - 0.5 * occupancy_map.resolution
    inner = np.linalg.norm(np.maximum(apart, 0.0), axis=2).min(axis=1)
    size = np.array(occupancy_map.occupied.shape[::-1]) * occupancy_map.resolution
    return np.minimum(inner, np.minimum(local, size - local).min(axis=1))


def scattered_cells(seed: int, origin: Pose | None = None) -> OccupancyMap:
    """Return a map with a few occupied cells, at random."""
    occupied = np.random.default_rng(seed).random((40, 60)) < 0.01
    return OccupancyMap(RESOLUTION, origin or Pose(0.0, 0.0, 0.0), occupied)
