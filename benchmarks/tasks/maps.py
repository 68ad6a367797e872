"""
Maps that tasks are set in: two rooms with a door or a corridor between them, a cluttered room.

Walls and things are rectangles of whole cells, so that collisions can be looked for in what the
map stands for, and not only in its cells.
"""

import math
from typing import NamedTuple

import numpy as np
from push_scenario.definition.floor_map import FloorMap, FREE, OCCUPIED
from scipy.ndimage import label

RESOLUTION, WALL = 0.05, 2
MAPS = ('door', 'corridor', 'cluttered room')
DOORS = 18, 24
CORRIDOR = 20, 40
CLUTTER, THINGS = (6, 9), (6, 14)
STILL = 1e-3


class Floor(NamedTuple):
    """
    What stands on a floor.

    :param size: columns and rows of cells.
    :param blocks: occupied cells, (first column, first row, last column + 1, last row + 1) of each
        block, shape (n, 4).
    """

    size: tuple
    blocks: np.ndarray

    @property
    def rectangles(self):
        """The same as (least x, least y, most x, most y), shape (n, 4) [m]."""
        return RESOLUTION * self.blocks

    @property
    def map(self):  # noqa: A003
        """The same as a ``FloorMap``."""
        cells = np.full(self.size[::-1], FREE)
        for first, low, last, high in self.blocks:
            cells[low:high, first:last] = OCCUPIED
        return FloorMap(RESOLUTION, '\n'.join(''.join(row) for row in cells[::-1]))


def draw_floor(name, rng):
    """
    Draw a floor.

    :param name: one of ``MAPS``.
    :param rng: ``numpy.random.Generator``.
    :return: ``Floor``.
    """
    if name == 'cluttered room':
        size = 120, 120
        count = rng.integers(*CLUTTER, endpoint=True)
        corners = rng.integers(WALL, size[0] - WALL - THINGS[1], (count, 2))
        sides = rng.integers(*THINGS, (count, 2), endpoint=True)
        things = np.hstack([corners, corners + sides])
        return Floor(size, np.vstack([_walls(*size), things]))
    width, length = (rng.integers(*DOORS, endpoint=True), WALL) if name == 'door' else CORRIDOR
    room, rows = 60, 64
    low = rng.integers(rows // 4, rows - rows // 4 - width, endpoint=True)
    size = 2 * room + length, rows
    sides = [(room, WALL, room + length, low), (room, low + width, room + length, rows - WALL)]
    return Floor(size, np.vstack([_walls(*size), sides]))


def places(floor, room):
    """
    Find where a disc has room, by the region that such a disc stays in.

    :param floor: ``Floor``.
    :param room: radius of the disc [m].
    :return: number of the region of each place, 0 where there is no room, and the places (x, y)
        [m], shapes (n,) and (n, 2).
    """
    columns, rows = floor.size
    x, y = np.meshgrid(*(RESOLUTION * (np.arange(count) + 0.5) for count in (columns, rows)))
    points = np.column_stack([x.ravel(), y.ravel()])
    free = to_rectangles(points, floor.rectangles).min(axis=1) > room
    return label(free.reshape(rows, columns))[0].ravel(), points


def to_rectangles(points, rectangles):
    """
    Distance of points from rectangles, negative inside.

    :param points: (x, y), shape (n, 2) [m].
    :param rectangles: (least x, least y, most x, most y), shape (m, 4) [m].
    :return: distances [m], shape (n, m).
    """
    points = np.asarray(points)[:, None, :]
    beyond = np.maximum(rectangles[None, :, :2] - points, points - rectangles[None, :, 2:])
    return np.hypot(*np.moveaxis(np.maximum(beyond, 0.0), -1, 0)) + np.minimum(
        beyond.max(axis=-1), 0.0)


def robot_clearance(robot, poses, rectangles):
    """
    Least distance of the robot from obstacles on its way [m]; negative where it collides.

    :param robot: the ``RoundRobot``.
    :param poses: of the robot, shape (n, 3).
    :param rectangles: of the floor, shape (m, 4) [m].
    """
    return float(to_rectangles(_moved(poses)[:, :2], rectangles).min() - robot.radius)


def object_clearance(obj, poses, rectangles):
    """
    Least distance of the object from obstacles on its way [m]; negative where it collides.

    Between two corners it is rather too short: the widest gap across an edge of either.

    :param obj: the ``PushedObject``.
    :param poses: of the object, shape (n, 3).
    :param rectangles: of the floor, shape (m, 4) [m].
    """
    poses = _moved(poses)
    if not obj.outline:
        return float(to_rectangles(poses[:, :2], rectangles).min() - obj.radius)
    outline = np.array(obj.outline) @ (1.0, 1j)
    turn, place = np.exp(1j * poses[:, 2, None]), poses[:, 0, None] + 1j * poses[:, 1, None]
    corners = place + turn * outline
    low = np.column_stack([corners.real.min(axis=1), corners.imag.min(axis=1)])[:, None]
    high = np.column_stack([corners.real.max(axis=1), corners.imag.max(axis=1)])[:, None]
    across = np.maximum(rectangles[:, :2] - high, low - rectangles[:, 2:]).max(axis=-1)
    edges = np.roll(outline, -1) - outline
    for edge, corner in zip(edges / abs(edges), outline):
        seen = [((x + 1j * y - place) / turn - corner) / edge
                for x in rectangles.T[[0, 2]] for y in rectangles.T[[1, 3]]]
        across = np.maximum(across, -np.max([points.imag for points in seen], axis=0))
    return float(across.min())


def reach(obj):
    """
    Radius of a disc about the object frame that holds the object [m].

    :param obj: the ``PushedObject``.
    """
    return max((math.hypot(*corner) for corner in obj.outline), default=obj.radius)


def _walls(columns, rows):
    return np.array([(0, 0, columns, WALL), (0, rows - WALL, columns, rows), (0, 0, WALL, rows),
                     (columns - WALL, 0, columns, rows)])


def _moved(poses):
    """Leave out poses that are as good as others."""
    return STILL * np.unique(np.round(np.asarray(poses) / STILL), axis=0)
