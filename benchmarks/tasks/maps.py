"""
Random maps: two rooms joined by a door or a corridor, one cluttered room, and flats.

Walls and obstacles are rectangles of whole cells, so that collisions are found with the exact
geometry that the map represents, and not only with its cells.
"""

import math
from typing import cast, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from push_model.geometry import FloatArray, IntArray
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_scenario.definition.floor_map import FloorMap, FREE, OCCUPIED
from push_scenario.definition.placement import Placement
from scipy.ndimage import label

# Side of a cell [m]; chosen: usual for occupancy maps of buildings.
RESOLUTION = 0.05
# The texts stand in records, and their order enters the draws: append only.
MAPS = ('door', 'corridor', 'cluttered room')
# Three rooms at a hallway, with furniture; a part of its own.
FLAT = 'flat'
# Lengths in cells, chosen for floors as in homes: thickness of walls, range of the widths of
# doors (0.9 to 1.2 m), (width, length) of the corridor, side of the square cluttered room, and
# size of the floor of two rooms without what joins them: columns of one room, rows.
WALL = 2
DOORS = 18, 24
CORRIDOR = 20, 40
CLUTTERED_ROOM = 120
ROOM_COLUMNS = 60
ROOM_ROWS = 64
# Of a flat: its side, range of the width of the hallway (1.1 to 1.4 m), of its doors (0.8 to 1 m),
# of the number of pieces of furniture in a room and of their sides.
FLAT_SIDE = 200
HALLWAY = 22, 28
FLAT_DOORS = 16, 20
FURNITURE = 1, 3
FURNITURE_SIDES = 8, 24
# Ranges of the number of obstacles in the cluttered room, and of their sides in cells.
CLUTTER = 6, 9
OBSTACLE_SIDES = 6, 14
# Poses are rounded to this before the clearance is computed once for each [m, rad]; chosen: far
# below a cell.
POSE_ROUNDING = 1e-3


class Floor(NamedTuple):
    """
    Walls and obstacles on a floor.

    :param size: columns and rows of cells.
    :param blocks: occupied cells, (first column, first row, last column + 1, last row + 1) of each
        block, shape (n, 4).
    """

    size: tuple[int, int]
    blocks: IntArray

    @property
    def rectangles(self) -> FloatArray:
        """The blocks as (x_min, y_min, x_max, y_max), shape (n, 4) [m]."""
        return cast(FloatArray, RESOLUTION * self.blocks)

    @property
    def map(self) -> FloorMap:  # noqa: A003
        """The floor as a ``FloorMap``."""
        cells = np.full(self.size[::-1], FREE)
        for first, low, last, high in self.blocks:
            cells[low:high, first:last] = OCCUPIED
        return FloorMap(RESOLUTION, '\n'.join(''.join(row) for row in cells[::-1]))


def draw_floor(name: str, rng: np.random.Generator) -> Floor:
    """
    Draw a floor.

    :param name: one of ``MAPS``, or ``FLAT``.
    :param rng: ``numpy.random.Generator``.
    :return: ``Floor``.
    """
    if name == FLAT:
        return _draw_flat(rng)
    if name == 'cluttered room':
        size = CLUTTERED_ROOM, CLUTTERED_ROOM
        count = rng.integers(*CLUTTER, endpoint=True)
        corners = rng.integers(WALL, size[0] - WALL - OBSTACLE_SIDES[1], (count, 2))
        sides = rng.integers(*OBSTACLE_SIDES, (count, 2), endpoint=True)
        obstacles = np.hstack([corners, corners + sides])
        return Floor(size, np.vstack([_walls(*size), obstacles]))
    width, length = CORRIDOR
    if name == 'door':
        width, length = rng.integers(*DOORS, endpoint=True), WALL
    room, rows = ROOM_COLUMNS, ROOM_ROWS
    low = rng.integers(rows // 4, rows - rows // 4 - width, endpoint=True)
    size = 2 * room + length, rows
    sides = np.array([(room, WALL, room + length, low),
                      (room, low + width, room + length, rows - WALL)])
    return Floor(size, np.vstack([_walls(*size), sides]))


def _draw_flat(rng: np.random.Generator) -> Floor:
    """Draw a hallway across a square, two rooms on one side of it and one on the other."""
    side, third = FLAT_SIDE, FLAT_SIDE // 3
    width = int(rng.integers(*HALLWAY, endpoint=True))
    low = int(rng.integers(third, side - third - width, endpoint=True))
    split = int(rng.integers(third, side - third, endpoint=True))
    high = low + width
    blocks = [(split, high, split + WALL, side)]
    rooms = [((WALL, high + WALL), (split, side - WALL)),
             ((split + WALL, high + WALL), (side - WALL, side - WALL)),
             ((WALL, WALL), (side - WALL, low - WALL))]
    for ((first, _), (last, _)), wall in zip(rooms, (high, high, low - WALL)):
        door = int(rng.integers(*FLAT_DOORS, endpoint=True))
        begin = int(rng.integers(first + WALL, last - WALL - door, endpoint=True))
        blocks += [(first, wall, begin, wall + WALL), (begin + door, wall, last, wall + WALL)]
    for first, last in rooms:
        for _ in range(rng.integers(*FURNITURE, endpoint=True)):
            size = rng.integers(*FURNITURE_SIDES, 2, endpoint=True)
            corner = rng.integers(first, np.array(last) - size, endpoint=True)
            blocks.append((*corner.tolist(), *(corner + size).tolist()))
    return Floor((side, side), np.vstack([_walls(side, side), np.array(blocks)]))


def drawn_map(occupancy_map: OccupancyMap) -> FloorMap:
    """Draw a map as a ``FloorMap``."""
    rows = np.where(occupancy_map.occupied[::-1], OCCUPIED, FREE)
    return FloorMap(occupancy_map.resolution, '\n'.join(''.join(row) for row in rows),
                    Placement(*occupancy_map.origin))


def places(floor: Floor, radius: float) -> tuple[IntArray, FloatArray]:
    """
    Find where a disc fits, and the connected regions that it can move in.

    :param floor: ``Floor``.
    :param radius: of the disc [m].
    :return: number of the region of each place, 0 where the disc does not fit, and the places
        (x, y) [m], shapes (n,) and (n, 2).
    """
    columns, rows = floor.size
    x, y = np.meshgrid(*(RESOLUTION * (np.arange(count) + 0.5) for count in (columns, rows)))
    points = np.column_stack([x.ravel(), y.ravel()])
    free = to_rectangles(points, floor.rectangles).min(axis=1) > radius
    regions = np.empty((rows, columns), dtype=np.int_)
    label(free.reshape(rows, columns), output=regions)
    return regions.ravel(), points


def places_in_flat(floor: Floor, radius: float) -> tuple[IntArray, FloatArray]:
    """
    Find the same from the cells, which is faster where there are many rectangles.

    :param floor: ``Floor``.
    :param radius: of the disc [m].
    :return: as of ``places``.
    """
    columns, rows = floor.size
    x, y = np.meshgrid(*(RESOLUTION * (np.arange(count) + 0.5) for count in (columns, rows)))
    free = floor.map.occupancy_map.distances[1:-1, 1:-1] > radius
    regions = np.empty((rows, columns), dtype=np.int_)
    label(free, output=regions)
    return regions.ravel(), np.column_stack([x.ravel(), y.ravel()])


def to_rectangles(points: FloatArray, rectangles: FloatArray) -> FloatArray:
    """
    Compute the signed distances of points from rectangles, negative inside.

    :param points: (x, y), shape (n, 2) [m].
    :param rectangles: (x_min, y_min, x_max, y_max), shape (m, 4) [m].
    :return: distances [m], shape (n, m).
    """
    points = np.asarray(points)[:, None, :]
    beyond = np.maximum(rectangles[None, :, :2] - points, points - rectangles[None, :, 2:])
    return np.hypot(*np.moveaxis(np.maximum(beyond, 0.0), -1, 0)) + np.minimum(
        beyond.max(axis=-1), 0.0)


def robot_clearance(robot: RoundRobot, poses: ArrayLike, rectangles: FloatArray) -> float:
    """
    Return the least clearance of the robot along its path [m]; negative where it collides.

    :param robot: the ``RoundRobot``.
    :param poses: of the robot, shape (n, 3).
    :param rectangles: of the floor, shape (m, 4) [m].
    """
    return float(to_rectangles(distinct_poses(poses)[:, :2], rectangles).min() - robot.radius)


def object_clearance(obj: PushedObject, poses: ArrayLike, rectangles: FloatArray) -> float:
    """
    Return the least clearance of the object along its path [m]; negative where it collides.

    By separating axes: the largest gap across an edge of either polygon, over both. It is exact in
    sign, and underestimates the distance between two corners.

    :param obj: the ``PushedObject``.
    :param poses: of the object, shape (n, 3).
    :param rectangles: of the floor, shape (m, 4) [m].
    """
    distinct = distinct_poses(poses)
    if not obj.outline:
        return float(to_rectangles(distinct[:, :2], rectangles).min() - obj.radius)
    outline = np.array(obj.outline) @ (1.0, 1j)
    rotation = np.exp(1j * distinct[:, 2, None])
    position = distinct[:, 0, None] + 1j * distinct[:, 1, None]
    corners = position + rotation * outline
    low = np.column_stack([corners.real.min(axis=1), corners.imag.min(axis=1)])[:, None]
    high = np.column_stack([corners.real.max(axis=1), corners.imag.max(axis=1)])[:, None]
    across = np.maximum(rectangles[:, :2] - high, low - rectangles[:, 2:]).max(axis=-1)
    edges = np.roll(outline, -1) - outline
    for edge, corner in zip(edges / abs(edges), outline):
        seen = [((x + 1j * y - position) / rotation - corner) / edge
                for x in rectangles.T[[0, 2]] for y in rectangles.T[[1, 3]]]
        across = np.maximum(across, -np.max([points.imag for points in seen], axis=0))
    return float(across.min())


def reach(obj: PushedObject) -> float:
    """
    Return the radius of the disc about the object frame that contains the object [m].

    :param obj: the ``PushedObject``.
    """
    return max((math.hypot(*corner) for corner in obj.outline), default=obj.radius)


def inner_reach(obj: PushedObject) -> float:
    """
    Return the radius of the greatest disc about the object frame that the object contains [m].

    :param obj: the ``PushedObject``.
    """
    if not obj.outline:
        return obj.radius
    first = np.array(obj.outline)
    edges = np.roll(first, -1, axis=0) - first
    return float((np.abs(first[:, 0] * edges[:, 1] - first[:, 1] * edges[:, 0])
                  / np.hypot(*edges.T)).min())


def _walls(columns: int, rows: int) -> IntArray:
    return np.array([(0, 0, columns, WALL), (0, rows - WALL, columns, rows), (0, 0, WALL, rows),
                     (columns - WALL, 0, columns, rows)])


def distinct_poses(poses: ArrayLike) -> FloatArray:
    """
    Round the poses and drop duplicates.

    :param poses: shape (n, 3).
    :return: shape (m, 3).
    """
    return POSE_ROUNDING * np.unique(np.round(np.asarray(poses) / POSE_ROUNDING), axis=0)
