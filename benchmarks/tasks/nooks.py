"""Random tasks at walls, in corners and in niches of a room."""

import enum
import math
from typing import NamedTuple

from benchmarks.tasks.maps import reach
import numpy as np
from push_model.geometry import BoolArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.occupancy_map import OccupancyMap

# Side of a cell [m]; chosen: usual for maps of buildings.
RESOLUTION = 0.05
# Sides without the walls, thickness of those, depth of a niche and width of what is beside it [m];
# ranges of the gaps between object and walls, of what a niche is wider than the object, and of the
# distance along a wall [m]; chosen: as furniture stands.
ROOM_SIDES = 4.0, 5.0
WALL = 0.1
NICHE_DEPTH, NICHE_SIDE = 0.6, 0.5
GAPS = 0.0, 0.05
NICHE_EXCESS = 0.1, 0.3
ALONG = 0.5, 2.0
# Distance of the middle of the object from corners of the room, where it is not in one [m].
FROM_CORNERS = 1.2
# Least distance of the robot from the object and of both from obstacles [m]; chosen.
CLEARANCE = 0.05


class Nook(enum.Enum):
    """Where the object starts, or is to go."""

    FROM_WALL = 'from a wall'
    FROM_CORNER = 'from a corner'
    FROM_NICHE = 'from a niche'
    TO_WALL = 'to a wall'
    TO_CORNER = 'to a corner'
    TO_NICHE = 'to a niche'
    ALONG_WALL = 'along a wall'


FROM = Nook.FROM_WALL, Nook.FROM_CORNER, Nook.FROM_NICHE
CORNERS = Nook.FROM_CORNER, Nook.TO_CORNER
NICHES = Nook.FROM_NICHE, Nook.TO_NICHE
# Those in which a face is always parallel to the wall.
SQUARE = *NICHES, Nook.ALONG_WALL
# Those that a robot that only pushes can do: it does not get behind what stands in a corner.
POSSIBLE = Nook.FROM_WALL, Nook.TO_WALL, Nook.TO_CORNER, Nook.TO_NICHE, Nook.ALONG_WALL


class NookTask(NamedTuple):
    """
    A task in a room.

    :param occupancy_map: the ``OccupancyMap``.
    :param start: ``Pose`` of the object.
    :param robot_start: ``Pose`` of the robot.
    :param goal: ``Pose`` that the object is to have.
    """

    occupancy_map: OccupancyMap
    start: Pose
    robot_start: Pose
    goal: Pose


def draw_nook_task(kind: Nook, obj: PushedObject, robot: RoundRobot, rng: np.random.Generator, *,
                   is_square: bool, resolution: float = RESOLUTION) -> NookTask:
    """
    Draw a task in a room of which the object starts, or is to end, within 5 cm of walls.

    The map has a random origin and rotation.

    :param is_square: whether a face is parallel to the wall, where it is not always.
    :param resolution: side of a cell, of which a wall is a multiple [m].
    """
    occupied = _room(resolution)
    turns = int(rng.integers(0, 4))
    heading = wrap_angle(0.5 * math.pi * turns)
    if not (kind in SQUARE or is_square):
        heading = rng.uniform(-math.pi, math.pi)
    low_x, low_y, high_y = _extents(obj, heading)
    x = WALL + rng.uniform(*GAPS) - low_x
    y = rng.uniform(FROM_CORNERS, ROOM_SIDES[1] - FROM_CORNERS)
    if kind in CORNERS:
        y = WALL + rng.uniform(*GAPS) - low_y
    elif kind in NICHES:
        y = _add_niche(occupied, resolution, y + low_y,
                       high_y - low_y + rng.uniform(*NICHE_EXCESS)) - 0.5 * (low_y + high_y)
    at_wall = Pose(x, y, heading)
    plain = OccupancyMap(resolution, Pose(0.0, 0.0, 0.0), occupied)
    if kind is Nook.ALONG_WALL:
        elsewhere = Pose(WALL + rng.uniform(*GAPS) - low_x, _along_wall(rng, y), heading)
    else:
        elsewhere = pose_in(rng, obj, robot, plain, (0.0, ROOM_SIDES[0]))
    start, goal = (at_wall, elsewhere) if kind in FROM else (elsewhere, at_wall)
    beside = _robot_in(rng, obj, robot, plain, start)
    origin = Pose(rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-math.pi, math.pi))
    return NookTask(OccupancyMap(resolution, origin, occupied), origin @ start, origin @ beside,
                    origin @ goal)


def _along_wall(rng: np.random.Generator, y: float) -> float:
    """Draw where along the wall an object at y is to come from [m]."""
    while True:
        other = rng.uniform(FROM_CORNERS, ROOM_SIDES[1] - FROM_CORNERS)
        if ALONG[0] <= abs(other - y) <= ALONG[1]:
            return other


def _room(resolution: float) -> BoolArray:
    """Return the cells of a room with walls, shape (rows, columns)."""
    rows, columns = (round((side + 2.0 * WALL) / resolution) for side in ROOM_SIDES[::-1])
    thickness = round(WALL / resolution)
    occupied = walled(rows, columns)
    occupied[:thickness] = occupied[-thickness:] = True
    occupied[:, :thickness] = occupied[:, -thickness:] = True
    return occupied


def _add_niche(occupied: BoolArray, resolution: float, low: float, width: float) -> float:
    """
    Add two blocks that stand out from the wall, with a niche between them.

    :param occupied: is written.
    :param low: where the niche begins, about [m].
    :param width: of the niche at least [m].
    :return: y of its middle [m].
    """
    first, count = round(low / resolution), math.ceil(width / resolution)
    end, side = round((WALL + NICHE_DEPTH) / resolution), round(NICHE_SIDE / resolution)
    occupied[max(0, first - side):first, :end] = True
    occupied[first + count:first + count + side, :end] = True
    return (first + 0.5 * count) * resolution


def _extents(obj: PushedObject, heading: float) -> tuple[float, float, float]:
    """Find least x, least y and largest y of the object at the origin [m]."""
    if not obj.outline:
        return -obj.radius, -obj.radius, obj.radius
    corners = np.array([Pose(0.0, 0.0, heading).transform(corner) for corner in obj.outline])
    return float(corners[:, 0].min()), float(corners[:, 1].min()), float(corners[:, 1].max())


def _robot_in(rng: np.random.Generator, obj: PushedObject, robot: RoundRobot,
              occupancy_map: OccupancyMap, start: Pose) -> Pose:
    """Draw a pose of the robot anywhere on the floor, clear of walls and object."""
    rows, columns = occupancy_map.occupied.shape
    sides = occupancy_map.resolution * columns, occupancy_map.resolution * rows
    while True:
        x, y = rng.uniform(0.0, sides[0]), rng.uniform(0.0, sides[1])
        if (occupancy_map.clearance([(x, y)])[0] > robot.radius + CLEARANCE
                and math.hypot(x - start.x, y - start.y) > reach(obj) + robot.radius + CLEARANCE):
            return Pose(x, y, rng.uniform(-math.pi, math.pi))


def walled(rows: int, columns: int) -> BoolArray:
    """Return cells of which the outermost are occupied, shape (rows, columns)."""
    occupied = np.zeros((rows, columns), dtype=np.bool_)
    occupied[[0, -1]] = True
    occupied[:, [0, -1]] = True
    return occupied


def pose_in(rng: np.random.Generator, obj: PushedObject, robot: RoundRobot,
            occupancy_map: OccupancyMap, along: tuple[float, float],
            across: tuple[float, float] | None = None) -> Pose:
    """
    Draw a pose of the object round which the robot can drive.

    :param along: range of x [m].
    :param across: range of y [m]; None for all of the map.
    """
    rows, _ = occupancy_map.occupied.shape
    across = across or (0.0, rows * occupancy_map.resolution)
    around = reach(obj) + 2.0 * (robot.radius + CLEARANCE)
    while True:
        x, y = rng.uniform(*along), rng.uniform(*across)
        if occupancy_map.clearance([(x, y)])[0] > around:
            return Pose(x, y, rng.uniform(-math.pi, math.pi))
