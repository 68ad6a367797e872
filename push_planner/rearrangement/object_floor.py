"""Distances from walls and from objects on one grid, in the frame of the map."""

import math
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import BoolArray, FloatArray, IntArray, Pose
from push_model.parameters import PushedObject
from push_navigation.floor import Floor
from push_navigation.occupancy_map import OccupancyMap
from push_planner.rearrangement.footprints import distances_to_object
from push_planner.straight.map_search.object_distance import (
    distance_grid, DistanceGrid, length_at, NEIGHBOURS, SPACING, UNREACHED)

# Points of the grid at most; chosen: shortest paths to all of them take some 10 ms.
MAX_POINTS = 40_000
# Cosine of the angle to a direction up to which something lies in it; chosen: 65 degrees, so that
# three faces of any object push it in all directions.
MIN_ALONG = math.cos(math.radians(65.0))
# Distance up to which points are next to a pose, in grid points; chosen: it lies between four.
NEXT_POINTS = 2.0
Field = NDArray[np.float32]


class ObjectFloor:
    """
    Grid over a map.

    ``walls``: distances of grid points from walls, with a border of one point, shape (r, c) [m].
    ``spacing``: of the grid [m]. ``centers``: of all points and the border, shape (r c, 2) [m].
    ``work``: grid points visited so far.

    :param occupancy_map: the ``OccupancyMap``.
    """

    def __init__(self, occupancy_map: OccupancyMap) -> None:
        rows, columns = occupancy_map.occupied.shape
        side = occupancy_map.resolution
        self.spacing = max(side, SPACING, side * math.sqrt(rows * columns / MAX_POINTS))
        count = [math.ceil(cells * side / self.spacing - 1e-6) + 2 for cells in (rows, columns)]
        y, x = (self.spacing * (np.arange(size) - 0.5) for size in count)
        self._shape = count[0], count[1]
        self.centers = np.stack(np.meshgrid(x, y), axis=2).reshape(-1, 2)
        self.walls: Field = occupancy_map.clearance_in_map_frame(
            *self.centers.T).reshape(self._shape).astype(np.float32)
        self.work = 0

    def distances_from(self, obj: PushedObject, pose: Pose) -> Field:
        """
        Compute the distances of grid points from an object.

        :param pose: ``Pose`` in the frame of the map.
        """
        self.work += self.walls.size
        distances = distances_to_object(self.centers, obj, pose)
        return distances.reshape(self._shape).astype(np.float32)

    def near(self, x: float, y: float, radius: float) -> BoolArray:
        """Tell of all grid points whether they are within a radius [m] of a point."""
        away = self.centers - (x, y)
        return ((away ** 2).sum(axis=1) < radius ** 2).reshape(self._shape)

    def off_directions(self, pose: Pose, radius: float, directions: FloatArray) -> BoolArray:
        """
        Tell of all grid points whether they lie near a pose, but in none of some directions.

        The points next to the pose are in all directions.

        :param radius: within which points are near [m].
        :param directions: unit vectors, shape (n, 2).
        """
        away = self.centers - pose[:2]
        distances = np.hypot(*away.T)
        along = (away @ directions.T).max(axis=1, initial=-math.inf)
        is_off = along < MIN_ALONG * distances
        return (is_off & (distances < radius)
                & (distances > NEXT_POINTS * self.spacing)).reshape(self._shape)

    def lengths_to(self, goal: Pose, distances: Field, needed: float) -> DistanceGrid:
        """
        Find the shortest paths to a goal.

        :param distances: from what is in the way.
        :param needed: distance that paths keep, at least [m].
        """
        self.work += distances.size
        return distance_grid(Floor(distances, 1.0 / self.spacing), (goal.x, goal.y), needed)

    def connected_parts(self, is_free: BoolArray) -> IntArray:
        """Label the connected parts of free floor by numbers from 1 on; 0 elsewhere."""
        from scipy.ndimage import label
        self.work += is_free.size
        return np.asarray(cast(Any, label)(is_free)[0], dtype=np.int64)

    def distances_from_points(self, points: FloatArray) -> Field:
        """
        Compute the distances of grid points from the nearest of some points.

        :param points: shape (n, 2) [m], one or more.
        """
        from scipy.ndimage import distance_transform_edt
        self.work += self.walls.size
        is_beside = np.ones(self._shape, dtype=np.bool_)
        indices = np.floor(points / self.spacing).astype(int) + 1
        is_beside[indices[:, 1], indices[:, 0]] = False
        return np.asarray(cast(Any, distance_transform_edt)(is_beside, self.spacing),
                          dtype=np.float32)

    def values_at(self, field: NDArray[Any], points: FloatArray) -> NDArray[Any]:
        """
        Read a field at the nearest grid points.

        :param field: shape (r, c).
        :param points: shape (n, 2) [m].
        :return: shape (n,).
        """
        indices = np.floor(points / self.spacing).astype(int) + 1
        rows, columns = self._shape
        return field[np.clip(indices[:, 1], 0, rows - 1), np.clip(indices[:, 0], 0, columns - 1)]


def path_length(grid: DistanceGrid, pose: Pose) -> float:
    """Return the length of the path from a pose [m]; infinite where there is none."""
    length = length_at(grid, pose.x, pose.y)
    return math.inf if length >= UNREACHED else length


def descend(grid: DistanceGrid, start: Pose, end: Pose) -> FloatArray:
    """
    Follow the shortest path to the goal of a grid.

    :param start: ``Pose`` in the frame of the map, from which there is a path.
    :param end: ``Pose`` of the goal.
    :return: points of the path, shape (n, 2) [m].
    """
    lengths = np.pad(grid.lengths, 1, constant_values=UNREACHED)
    i, j = _nearest_reached(lengths, grid.spacing, start)
    points = [(start.x, start.y)]
    steps = NEIGHBOURS[:, :2].astype(int)
    while True:
        points.append(((j - 0.5) * grid.spacing, (i - 0.5) * grid.spacing))
        around = lengths[i + steps[:, 0], j + steps[:, 1]]
        best = int(np.argmin(around))
        if around[best] >= lengths[i, j]:
            break
        i, j = i + int(steps[best, 0]), j + int(steps[best, 1])
    return np.array([*points, (end.x, end.y)])


def _nearest_reached(lengths: Field, spacing: float, pose: Pose) -> tuple[int, int]:
    """Find the grid point from which the path of a pose goes on, in the padded grid."""
    v, u = pose.y / spacing + 0.5, pose.x / spacing + 0.5
    corners = [(i, j) for i in (math.floor(v), math.floor(v) + 1)
               for j in (math.floor(u), math.floor(u) + 1)
               if 0 < i < len(lengths) - 1 and 0 < j < lengths.shape[1] - 1]
    return min(corners, key=lambda corner: lengths[corner] + spacing * math.hypot(
        corner[0] - v, corner[1] - u))
