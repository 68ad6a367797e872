"""Occupancy map of the floor: what is occupied, and how far away it is."""

import copy
import functools
import math
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from push_model.geometry import BoolArray, Coordinates, FloatArray, IntArray, Pose
from push_model.parameters import Outline, PushedObject, RoundRobot
from push_navigation.distance_field import distance_field, INTERPOLATION_ERROR
from push_navigation.footprint_clearance import footprint_clearances

# Range of the sides of cells [m]; chosen: below it no sensor measures, and points on the rim of an
# object, a few per cell, take all memory; above it a cell is a room.
MIN_RESOLUTION, MAX_RESOLUTION = 1e-3, 10.0
RESOLUTION_RANGE = f'a length from {MIN_RESOLUTION:g} to {MAX_RESOLUTION:g} m'
# Overlap that is no collision, rounding [m].
TOUCHING = 1e-6
# Clearance from which on that of the circle round the object is exact enough [m]; chosen: nothing
# that is decided depends on it.
FAR_CLEARANCE = 1.0
# Distance from obstacles that were freed up to which clearances are computed anew [m]; chosen:
# more than object and robot ever need.
FREED_RANGE = 2.0


class OccupancyMap:
    """
    An occupancy map; everything outside it is an obstacle.

    :param resolution: side of a cell [m], from ``MIN_RESOLUTION`` to ``MAX_RESOLUTION``.
    :param origin: ``Pose`` in the world of the outer corner of the first cell; columns go along
        its x axis, rows along its y axis.
    :param occupied: whether each cell is an obstacle or unknown, shape (rows, columns).
    :raises ValueError: naming what is wrong.
    """

    def __init__(self, resolution: float, origin: Coordinates, occupied: ArrayLike) -> None:
        if not MIN_RESOLUTION <= resolution <= MAX_RESOLUTION:
            raise ValueError(f'resolution: got {resolution!r}, expected {RESOLUTION_RANGE}')
        if not Pose(*origin).is_finite():
            raise ValueError(f'origin: got {tuple(origin)}, expected finite numbers')
        cells = np.array(occupied)
        if cells.ndim != 2 or cells.size == 0 or cells.dtype != bool:
            raise ValueError(f'occupied: got an array of {cells.dtype} of shape '
                             f'{cells.shape}, expected rows and columns of bool')
        cells.setflags(write=False)
        self.resolution = float(resolution)
        self.occupied: BoolArray = cells
        self._set_origin(Pose(*origin))
        # With a border of occupied cells round the map, and nowhere too long.
        self._distances = distance_field(np.pad(cells, 1, constant_values=True))
        self._distances -= INTERPOLATION_ERROR
        self._distances *= np.float32(self.resolution)
        self._distances.setflags(write=False)

    def _set_origin(self, origin: Pose) -> None:
        self.origin = origin
        c, s = math.cos(origin.theta), math.sin(origin.theta)
        self._rotation = np.array([[c, -s], [s, c]])

    def moved(self, correction: Pose) -> 'OccupancyMap':
        """
        Return the same map elsewhere, as where the frame that it is in has drifted.

        :param correction: ``Pose`` that takes the previous origin to the new one,
            ``correction @ origin``.
        """
        result = copy.copy(self)
        result._set_origin(correction @ self.origin)
        return result

    def freed(self, cells: BoolArray) -> 'OccupancyMap':
        """
        Return the same map with some cells free.

        Only distances near them are computed anew: those of more than ``FREED_RANGE`` may be too
        short.

        :param cells: whether each cell is to be free, shape (rows, columns).
        :return: the map itself where they are free already.
        """
        rows, columns = np.nonzero(self.occupied & cells)
        if not rows.size:
            return self
        result = copy.copy(self)
        result.occupied = self.occupied & ~cells
        result._distances = self._distances.copy()
        margin = math.ceil(FREED_RANGE / self.resolution)
        inner = _window_round(rows, columns, margin)
        # Obstacles count that are as far from what is computed.
        outer = _window_round(rows, columns, 2 * margin)
        nearby = distance_field(_bordered(result.occupied, outer))
        inner_in_outer = tuple(
            slice(part.start - whole.start, min(part.stop, size) - whole.start)
            for part, whole, size in zip(inner, outer, self._distances.shape))
        distances = self.resolution * (nearby[inner_in_outer] - INTERPOLATION_ERROR)
        result._distances[inner] = np.maximum(result._distances[inner],
                                              np.minimum(distances, FREED_RANGE))
        for array in (result.occupied, result._distances):
            array.setflags(write=False)
        return result

    def to_map(self, points: ArrayLike) -> FloatArray:
        """
        Transform points of the world to the frame of the map.

        :param points: (x, y) in the world, shape (n, 2) [m].
        :return: along columns and along rows, from the outer corner of the first cell, shape
            (n, 2) [m].
        """
        return (np.asarray(points, dtype=float) - self.origin[:2]) @ self._rotation

    def from_map(self, points: ArrayLike) -> FloatArray:
        """
        Transform points from the frame of the map to the world.

        :param points: along columns and along rows, shape (n, 2) [m].
        :return: (x, y), shape (n, 2) [m].
        """
        return np.asarray(points, dtype=float) @ self._rotation.T + self.origin[:2]

    def clearance(self, points: ArrayLike) -> FloatArray:
        """
        Distance to the nearest obstacle, rather too short than too long.

        :param points: (x, y) in the world, shape (n, 2) [m].
        :return: distances [m], negative in obstacles, shape (n,).
        """
        return self.clearance_in_map_frame(*self.to_map(points).T)

    @property
    def distances(self) -> NDArray[np.float32]:
        """
        Clearances of the centres of all cells [m], with a border of one occupied cell round them.

        Shape (rows + 2, columns + 2); between the centres they are interpolated linearly.
        """
        return self._distances

    def clearance_in_map_frame(self, x: ArrayLike, y: ArrayLike) -> FloatArray:
        """
        Find the same for points in the frame of the map.

        :param x: along columns, from the outer corner of the first cell, of any shape [m].
        :param y: along rows, of the same shape [m].
        :return: distances [m], of the same shape.
        """
        from scipy.ndimage import map_coordinates
        cells = np.stack((y, x)) / self.resolution + 0.5
        return cast(FloatArray, map_coordinates(self._distances, cells, output=float, order=1,
                                                mode='nearest'))

    def first_robot_collision(self, robot: RoundRobot, poses: ArrayLike,
                              margin: float) -> int | None:
        """
        Find the first pose at which the robot is nearer to an obstacle than a margin.

        :param poses: (x, y, theta) or (x, y) in the world, shape (n, 3) or (n, 2).
        :param margin: distance [m].
        :return: number of the pose, or None.
        """
        return _first(self.robot_collisions(robot, poses, margin))

    def robot_collisions(self, robot: RoundRobot, poses: ArrayLike, margin: float) -> BoolArray:
        """
        Tell for each pose whether the robot is nearer to an obstacle than a margin.

        :param poses: (x, y, theta) or (x, y) in the world, shape (n, 3) or (n, 2).
        :param margin: distance [m].
        :return: shape (n,).
        """
        poses = np.asarray(poses, dtype=float)
        return self.clearance(poses[:, :2]) < robot.radius + margin

    def first_object_collision(self, obj: PushedObject, poses: ArrayLike,
                               margin: float) -> int | None:
        """
        Find the first pose at which the object is nearer to an obstacle than a margin.

        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param margin: distance [m].
        :return: number of the pose, or None.
        """
        return _first(self.object_collisions(obj, poses, margin))

    def object_collisions(self, obj: PushedObject, poses: ArrayLike, margin: float) -> BoolArray:
        """
        Tell for each pose whether the object is nearer to an obstacle than a margin.

        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param margin: distance [m].
        :return: shape (n,).
        """
        return self.object_clearances(obj, poses, margin) < margin - TOUCHING

    def object_clearance(self, obj: PushedObject, poses: ArrayLike) -> float:
        """
        Find the least clearance of the object at some poses [m]; negative where it collides.

        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        """
        return float(self.object_clearances(obj, poses).min())

    def object_clearances(self, obj: PushedObject, poses: ArrayLike,
                          enough: float = math.inf) -> FloatArray:
        """
        Find the clearances of the object at some poses, exact to the squares of cells.

        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param enough: clearance from which on no exact value is needed [m].
        :return: shape (n,) [m], negative where it overlaps an obstacle.
        """
        poses = np.asarray(poses, dtype=float)
        in_map = np.column_stack([self.to_map(poses[:, :2]), poses[:, 2] - self.origin.theta])
        vertices, radius = footprint(obj)
        clearances = self.clearance(poses[:, :2]) - math.hypot(*np.abs(vertices).max(axis=0))
        clearances -= radius
        close = np.flatnonzero(clearances < min(enough, FAR_CLEARANCE))
        exact = np.empty(close.size)
        footprint_clearances(self._distances, 1.0 / self.resolution, (vertices, radius),
                             in_map[close], enough, exact)
        clearances[close] = exact
        return clearances

    def robot_is_free(self, robot: RoundRobot, poses: ArrayLike, margin: float) -> bool:
        """
        Tell whether the robot keeps a margin from all obstacles.

        :param poses: (x, y, theta) or (x, y) in the world, shape (n, 3) or (n, 2).
        :param margin: distance [m].
        """
        return self.first_robot_collision(robot, poses, margin) is None

    def object_is_free(self, obj: PushedObject, poses: ArrayLike, margin: float) -> bool:
        """
        Tell whether the object keeps a margin from all obstacles.

        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param margin: distance [m].
        """
        return self.first_object_collision(obj, poses, margin) is None


def _window_round(rows: IntArray, columns: IntArray, margin: int) -> tuple[slice, ...]:
    """Return the rows and columns near some cells, in the grid with its border."""
    return tuple(slice(max(0, int(indices.min()) + 1 - margin), int(indices.max()) + 2 + margin)
                 for indices in (rows, columns))


def _bordered(occupied: BoolArray, window: tuple[slice, ...]) -> BoolArray:
    """Cut a window out of a grid with a border of one occupied cell, without making all of it."""
    padding, parts = [], []
    for part, size in zip(window, occupied.shape):
        start, stop = part.start, min(part.stop, size + 2)
        padding.append((int(start == 0), int(stop == size + 2)))
        parts.append(slice(max(start - 1, 0), min(stop - 1, size)))
    return np.pad(occupied[tuple(parts)], padding, constant_values=True)


def _first(collides: BoolArray) -> int | None:
    return int(np.argmax(collides)) if np.any(collides) else None


# As many outlines as a process pushes.
@functools.lru_cache(maxsize=16)
def _core(outline: Outline) -> FloatArray:
    vertices = np.array(outline or ((0.0, 0.0),), dtype=float)
    vertices.setflags(write=False)
    return vertices


def footprint(obj: PushedObject) -> tuple[FloatArray, float]:
    """
    Return the vertices of the object and the radius by which they are inflated.

    :return: vertices, counter-clockwise, shape (n, 2) [m], one of a disc; radius, 0 of a polygon.
    """
    return _core(obj.outline), 0.0 if obj.outline else obj.radius
