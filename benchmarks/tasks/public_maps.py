"""
Tasks in maps of others: files of ``map_server`` in a folder that the user names.

Object and goal stand anywhere, 5 cm and more from obstacles, the goal up to 6 m away on a floor
that is wide enough for the greatest disc in the object. The robot stands anywhere from which its
own path to the object is at most 10 m long, along rows and columns.
"""

import functools
import math
from pathlib import Path
from typing import NamedTuple

from benchmarks.tasks.maps import inner_reach
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import BoolArray, distance, FloatArray, IntArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.map_file import GridMap, read_map
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_scenario.definition.floor_map import floor_map_values, FloorMap
from push_scenario.definition.placement import Placement
from scipy.ndimage import binary_dilation, label

# Least clearance of object, goal and robot, range of the distance of goals, longest path of the
# robot [m]; the aims of tasks in maps are stated for these.
CLEARANCE = 0.05
GOAL_DISTANCES = 0.3, 6.0
MAX_ROBOT_PATH = 10.0
# The robot may be so near to the object that it could touch it by a step of a cell and this [m].
TOUCHING = 0.02
# What of a map is kept round a task [m]; chosen: more than a room.
SURROUNDINGS = 5.0
# Attempts until another map is tried; chosen: none of eleven maps needs as many for a box.
MAX_ATTEMPTS = 300


class PublicTask(NamedTuple):
    """
    A task in a map of others.

    :param name: of the map.
    :param floor_map: its part round the task.
    :param start: ``Pose`` of the object.
    :param goal: ``Pose`` that it is to have.
    :param robot_start: ``Pose`` of the robot.
    """

    name: str
    floor_map: FloorMap
    start: Pose
    goal: Pose
    robot_start: Pose


class _Places(NamedTuple):
    """
    Where bodies fit in a map.

    :param occupancy_map: the ``OccupancyMap``.
    :param regions: of the greatest disc in the object: number of the region of each cell, 0 where
        it does not fit, shape (rows, columns).
    :param robot_fits: whether the robot fits, of each cell, shape (rows, columns).
    """

    occupancy_map: OccupancyMap
    regions: IntArray
    robot_fits: BoolArray


def map_files(folder: str) -> list[Path]:
    """
    List the maps of a folder, by name.

    :raises FileNotFoundError: where it has none.
    """
    files = sorted(Path(folder).glob('*.yaml'))
    if not files:
        raise FileNotFoundError(f'{folder}: got no map, expected YAML files of map_server')
    return files


def draw_public_task(folder: str, number: int, obj: PushedObject, robot: RoundRobot,
                     rng: np.random.Generator) -> PublicTask:
    """
    Draw a task in one of the maps of a folder.

    :param number: of the task; it chooses the map, the next one where the object fits nowhere.
    :raises ValueError: where the object fits into none of them.
    """
    files = map_files(folder)
    for index in range(len(files)):
        path = files[(number + index) % len(files)]
        grid = _grid(path)
        places = _places(grid, inner_reach(obj), robot.radius)
        for _ in range(MAX_ATTEMPTS):
            poses = _draw_poses(places, obj, robot, rng)
            if poses is None:
                continue
            part = _part_round(grid, poses)
            if is_connected(part.occupancy_map, inner_reach(obj) + CLEARANCE, *poses[:2]):
                return PublicTask(path.stem, part, *poses)
    raise ValueError(f'{folder}: got no map in which the object fits, expected one')


@functools.lru_cache(maxsize=16)
def _grid(path: Path) -> GridMap:
    return read_map(path)


@functools.lru_cache(maxsize=8)
def _places(grid: GridMap, inner_radius: float, robot_radius: float) -> _Places:
    threshold = MapSettings().lethal_cost_threshold
    occupancy_map = OccupancyMap(grid.resolution, grid.origin,
                                 (grid.cells >= threshold) | (grid.cells < 0))
    gaps = occupancy_map.distances[1:-1, 1:-1]
    regions = np.empty(gaps.shape, dtype=np.int_)
    label(gaps > inner_radius + CLEARANCE, output=regions)
    return _Places(occupancy_map, regions, gaps > robot_radius + CLEARANCE)


def _draw_poses(places: _Places, obj: PushedObject, robot: RoundRobot,
                rng: np.random.Generator) -> tuple[Pose, Pose, Pose] | None:
    """Draw start, goal and start of the robot; None where they do not suit."""
    start_cell = rng.choice(np.flatnonzero(places.regions))
    region = places.regions.flat[start_cell]
    goal_cell = rng.choice(np.flatnonzero(places.regions == region))
    start, goal = (_at_cell(places, int(cell), rng) for cell in (start_cell, goal_cell))
    if not GOAL_DISTANCES[0] <= distance(start, goal) <= GOAL_DISTANCES[1]:
        goal = _nearer(places, start, goal, region, rng)
    if goal is None or places.occupancy_map.object_clearances(
            obj, [start, goal], 2.0 * CLEARANCE).min() < CLEARANCE:
        return None
    cells = np.flatnonzero(robot_cells(places.occupancy_map, places.robot_fits, obj, start,
                                       robot.radius))
    if not cells.size:
        return None
    return start, goal, _at_cell(places, int(rng.choice(cells)), rng)


def _nearer(places: _Places, start: Pose, goal: Pose, region: int,
            rng: np.random.Generator) -> Pose | None:
    """Draw the goal nearer to the start, in the same region; None where it is not."""
    away = math.sqrt(rng.uniform(*np.square(GOAL_DISTANCES)))
    bearing = rng.uniform(-math.pi, math.pi)
    x, y = start.x + away * math.cos(bearing), start.y + away * math.sin(bearing)
    (column, row), = (places.occupancy_map.to_map([(x, y)])
                      / places.occupancy_map.resolution).astype(int).tolist()
    rows, columns = places.regions.shape
    if not (0 <= row < rows and 0 <= column < columns) or places.regions[row, column] != region:
        return None
    return Pose(x, y, goal.theta)


def robot_cells(occupancy_map: OccupancyMap, robot_fits: BoolArray, obj: PushedObject,
                start: Pose, radius: float) -> BoolArray:
    """
    Find from where the robot gets to the object, along rows and columns, in cells.

    It begins with the cells from which the robot could touch the object by a small step. Where
    there are none, nobody can push the object.

    :param robot_fits: whether the robot keeps clear of obstacles in each cell.
    :param start: ``Pose`` of the object.
    :param radius: of the robot [m].
    :return: shape as of ``robot_fits``.
    """
    free, touching = contact_cells(occupancy_map, robot_fits, obj, start, radius)
    if not touching.any():
        return touching
    reached = binary_dilation(touching, mask=free,
                              iterations=round(MAX_ROBOT_PATH / occupancy_map.resolution))
    return reached & (_gaps(occupancy_map, obj, start, radius) > CLEARANCE)


def contact_cells(occupancy_map: OccupancyMap, robot_fits: BoolArray, obj: PushedObject,
                  start: Pose, radius: float) -> tuple[BoolArray, BoolArray]:
    """
    Find where the robot fits beside the object, and from where it could touch it by a small step.

    :param robot_fits: whether the robot keeps clear of obstacles in each cell.
    :param start: ``Pose`` of the object.
    :param radius: of the robot [m].
    :return: both of the shape of ``robot_fits``.
    """
    gaps = _gaps(occupancy_map, obj, start, radius)
    free = robot_fits & (gaps > 0.0)
    return free, free & (gaps < occupancy_map.resolution + TOUCHING)


def is_connected(occupancy_map: OccupancyMap, radius: float, start: Pose, goal: Pose) -> bool:
    """
    Tell whether a disc fits all along some path between two poses.

    A path that leaves the map does not count: around a part of a larger map there may be one.

    :param radius: of the disc [m].
    """
    regions = np.empty(occupancy_map.occupied.shape, dtype=np.int_)
    label(occupancy_map.distances[1:-1, 1:-1] > radius, output=regions)
    cells = occupancy_map.to_map([start[:2], goal[:2]]) / occupancy_map.resolution
    first, last = (int(regions[row, column]) for column, row in cells.astype(int).tolist())
    return first == last > 0


def _gaps(occupancy_map: OccupancyMap, obj: PushedObject, start: Pose,
          radius: float) -> FloatArray:
    """Measure the gap between object and robot in each cell, infinite where it is large [m]."""
    side = occupancy_map.resolution
    extent = max((math.hypot(*corner) for corner in obj.outline), default=obj.radius)
    shape = occupancy_map.occupied.shape
    rows, columns = np.indices(shape)
    x, y = occupancy_map.to_map([start[:2]])[0] / side
    near = np.hypot(columns + 0.5 - x, rows + 0.5 - y) * side < extent + radius + 2.0 * side
    gaps = np.full(shape, math.inf)
    centers = side * (np.argwhere(near)[:, ::-1] + 0.5)
    gaps[near] = [find_contact(obj, start, point, radius)[2]
                  for point in occupancy_map.from_map(centers).tolist()]
    return gaps


def _at_cell(places: _Places, cell: int, rng: np.random.Generator) -> Pose:
    """Draw a pose in a cell."""
    row, column = divmod(cell, places.regions.shape[1])
    point = places.occupancy_map.resolution * (np.array([column, row]) + rng.uniform(size=2))
    (x, y), = places.occupancy_map.from_map([point]).tolist()
    return Pose(x, y, rng.uniform(-math.pi, math.pi))


def _part_round(grid: GridMap, poses: tuple[Pose, ...]) -> FloorMap:
    """Cut out the part of a map round some poses."""
    to_map = grid.origin.inverse()
    cells = np.array([(to_map @ pose)[:2] for pose in poses]) / grid.resolution
    margin = SURROUNDINGS / grid.resolution
    low = np.maximum(0, np.floor(cells.min(axis=0) - margin)).astype(int)
    high = np.ceil(cells.max(axis=0) + margin).astype(int)
    corner = grid.origin @ Pose(grid.resolution * low[0], grid.resolution * low[1], 0.0)
    part = GridMap(grid.resolution, corner, grid.cells[low[1]:high[1], low[0]:high[0]])
    values = floor_map_values(part, MapSettings().lethal_cost_threshold)
    return FloorMap(values['resolution'], values['rows'], Placement(*corner))
