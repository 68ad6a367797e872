"""A map of the floor: what is occupied, and how far away it is."""

import functools
import math

import numpy as np
from push_model.geometry import Pose
from push_navigation.obstacle import inflate
from scipy.ndimage import distance_transform_edt, map_coordinates

# Between cell centres the distance to the nearest occupied centre is at most this much shorter
# than interpolated [cells]; an obstacle may fill its cell to the corner.
INTERPOLATION = (2.0 + math.sqrt(2.0)) / 4.0 - math.sqrt(0.5)
CONSERVATIVE = math.sqrt(0.5) + INTERPOLATION


class OccupancyMap:
    """
    An occupancy map; everything outside it is an obstacle.

    :param resolution: side of a cell [m].
    :param origin: ``Pose`` in the world of the outer corner of the first cell; columns go along
        its x axis, rows along its y axis.
    :param occupied: whether each cell is an obstacle or unknown, shape (rows, columns).
    :raises ValueError: naming what is wrong.
    """

    def __init__(self, resolution, origin, occupied):
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise ValueError(f'resolution: got {resolution!r}, expected a finite length above 0 '
                             '[m]')
        if not Pose(*origin).is_finite():
            raise ValueError(f'origin: got {tuple(origin)}, expected finite numbers')
        occupied = np.array(occupied)
        if occupied.ndim != 2 or occupied.size == 0 or occupied.dtype != bool:
            raise ValueError(f'occupied: got an array of {occupied.dtype} of shape '
                             f'{occupied.shape}, expected rows and columns of bool')
        self.resolution, self.origin, self.occupied = float(resolution), Pose(*origin), occupied
        occupied.setflags(write=False)
        c, s = math.cos(self.origin.theta), math.sin(self.origin.theta)
        self._axes = np.array([[c, -s], [s, c]])
        self._cells = distance_transform_edt(~np.pad(occupied, 1, constant_values=True))

    def to_map(self, points):
        """
        Bring points of the world into the frame of the map.

        :param points: (x, y) in the world, shape (n, 2) [m].
        :return: along columns and along rows, from the outer corner of the first cell, shape
            (n, 2) [m].
        """
        return (np.asarray(points, dtype=float) - self.origin[:2]) @ self._axes

    def from_map(self, points):
        """
        Bring points from the frame of the map into the world.

        :param points: along columns and along rows, shape (n, 2) [m].
        :return: (x, y), shape (n, 2) [m].
        """
        return np.asarray(points, dtype=float) @ self._axes.T + self.origin[:2]

    def clearance(self, points):
        """
        Distance to the nearest obstacle, rather too short than too long.

        :param points: (x, y) in the world, shape (n, 2) [m].
        :return: distances [m], negative in obstacles, shape (n,).
        """
        return self.clearance_in_map_frame(*self.to_map(points).T)

    def clearance_in_map_frame(self, x, y):
        """
        Find the same for points in the frame of the map.

        :param x: along columns, from the outer corner of the first cell, of any shape [m].
        :param y: along rows, likewise [m].
        :return: distances [m], of the same shape.
        """
        places = np.stack((y, x)) / self.resolution + 0.5
        cells = map_coordinates(self._cells, places, order=1, mode='nearest')
        return self.resolution * (cells - CONSERVATIVE)

    def first_robot_collision(self, robot, poses, margin):
        """
        Find the first pose at which the robot is nearer to an obstacle than a margin.

        :param robot: the ``RoundRobot``.
        :param poses: (x, y, theta) or (x, y) in the world, shape (n, 3) or (n, 2).
        :param margin: distance [m].
        :return: number of the pose, or None.
        """
        poses = np.asarray(poses, dtype=float)
        return _first(self.clearance(poses[:, :2]) < robot.radius + margin)

    def first_object_collision(self, obj, poses, margin):
        """
        Find the first pose at which the object is nearer to an obstacle than a margin.

        :param obj: the ``PushedObject``.
        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param margin: distance [m].
        :return: number of the pose, or None.
        """
        poses = np.asarray(poses, dtype=float)
        if not obj.outline:
            return _first(self.clearance(poses[:, :2]) < obj.radius + margin)
        points, radius, center = _filled(obj.outline, self.resolution)
        hit = self.clearance(_placed(center[None, :], poses)) < radius + margin
        close = np.flatnonzero(hit)
        if close.size:
            room = self.clearance(_placed(points, poses[close])).reshape(close.size, -1)
            hit[close] = room.min(axis=1) < margin + 0.5 * self.resolution
        return _first(hit)

    def robot_is_free(self, robot, poses, margin):
        """
        Tell whether the robot keeps a margin from all obstacles.

        :param robot: the ``RoundRobot``.
        :param poses: (x, y, theta) or (x, y) in the world, shape (n, 3) or (n, 2).
        :param margin: distance [m].
        """
        return self.first_robot_collision(robot, poses, margin) is None

    def object_is_free(self, obj, poses, margin):
        """
        Tell whether the object keeps a margin from all obstacles.

        :param obj: the ``PushedObject``.
        :param poses: of the object frame (x, y, theta) in the world, shape (n, 3).
        :param margin: distance [m].
        """
        return self.first_object_collision(obj, poses, margin) is None


def _first(hits):
    return int(np.argmax(hits)) if np.any(hits) else None


def _placed(points, poses):
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    x, y = points.T
    return np.stack((poses[:, 0, None] + c * x - s * y,
                     poses[:, 1, None] + s * x + c * y), axis=-1).reshape(-1, 2)


@functools.lru_cache(maxsize=16)
def _filled(outline, spacing):
    corners = np.array(outline)
    rim = [first + (last - first) * np.linspace(0.0, 1.0, 1 + math.ceil(
        np.linalg.norm(last - first) / spacing))[:-1, None]
        for first, last in zip(corners, np.roll(corners, -1, axis=0))]
    low, high = corners.min(axis=0), corners.max(axis=0)
    grid = np.stack(np.meshgrid(*(np.arange(a, b, spacing) for a, b in zip(low, high))), axis=-1)
    grid = grid.reshape(-1, 2)
    points = np.concatenate([*rim, grid[inflate(outline, 0.0, 0.0).distances(grid) < 0.0]])
    center = 0.5 * (low + high)
    return points, float(np.linalg.norm(corners - center, axis=1).max()), center
