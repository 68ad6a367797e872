"""Random tasks in maps: passages of a width, flats, and buildings of many cells."""

import enum
import math
from typing import NamedTuple

from benchmarks.tasks.cases import CLEARANCE, draw, FLATS, ROBOTS
from benchmarks.tasks.maps import inner_reach, reach
from benchmarks.tasks.public_maps import draw_public_task
import numpy as np
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import BoolArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.map_file import FREE, GridMap, OCCUPIED
from push_navigation.occupancy_map import OccupancyMap
from push_planner.settings import PlannerSettings
from push_scenario.definition.floor_map import floor_map_values, FloorMap
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.definition.task import Task

# Side of a cell [m]; chosen: usual for maps of buildings. That of a passage differs a little, so
# that its width is a whole number of cells.
RESOLUTION = 0.05
# Depth of the rooms on either side of a passage, and their width [m]; chosen: every object can be
# turned there.
ROOM_DEPTH = 3.0
ROOM_WIDTH = 4.0
# Length of a passage [m]: the thickness of a wall.
PASSAGE_LENGTH = 0.1
# Room with objects or goals at its walls: sides without the walls, thickness of those, and depth
# of a niche [m]; range of the gaps between object and walls, and of what a niche is wider than the
# object [m]; chosen: as furniture stands.
ROOM_SIDES = 4.0, 5.0
WALL = 0.1
NICHE_DEPTH = 0.6
GAPS = 0.0, 0.05
NICHE_EXCESS = 0.1, 0.3
# Pitch of the rooms of a building, with their walls, and width of its doors [m].
ROOM_PITCH = 4.0
DOOR = 1.0


class Nook(enum.Enum):
    """Where the object starts, or is to go."""

    FROM_WALL = 'from a wall'
    FROM_CORNER = 'from a corner'
    FROM_NICHE = 'from a niche'
    TO_WALL = 'to a wall'
    TO_CORNER = 'to a corner'
    TO_NICHE = 'to a niche'


FROM = Nook.FROM_WALL, Nook.FROM_CORNER, Nook.FROM_NICHE
CORNERS = Nook.FROM_CORNER, Nook.TO_CORNER
NICHES = Nook.FROM_NICHE, Nook.TO_NICHE


class Instance(NamedTuple):
    """
    One task in a map.

    :param occupancy_map: the ``OccupancyMap``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object.
    :param robot_start: ``Pose`` of the robot.
    :param goal: ``Pose`` of the object.
    """

    occupancy_map: OccupancyMap
    obj: PushedObject
    robot: RoundRobot
    start: Pose
    robot_start: Pose
    goal: Pose

    @property
    def scenario(self) -> Scenario:
        """The same as a ``Scenario``, to be driven."""
        grid = GridMap(self.occupancy_map.resolution, self.occupancy_map.origin,
                       np.where(self.occupancy_map.occupied, OCCUPIED, FREE).astype(np.int8))
        values = floor_map_values(grid, OCCUPIED)
        floor_map = FloorMap(values['resolution'], values['rows'],
                             Placement(*self.occupancy_map.origin))
        return Scenario(
            name='map', description='a task in a map', object=self.obj, true_object=self.obj,
            robot=self.robot, true_robot=self.robot, goal=Placement(*self.goal),
            start=Start(object=Placement(*self.start), robot=Placement(*self.robot_start)),
            planner=PlannerSettings(), task=Task(map=floor_map), time_limit=600.0)


def bodies(name: str, drive: str) -> tuple[PushedObject, RoundRobot]:
    """
    Read an object and a robot.

    :param name: of the file of the object.
    :param drive: of the robot.
    """
    return (read_object(data.config_file(f'objects/{name}.yaml')),
            read_robot(data.config_file(f'robots/{ROBOTS[drive]}.yaml')))


def passage(name: str, drive: str, ratio: float, seed: int) -> Instance:
    """
    Draw a task through a passage.

    :param name: of the object.
    :param drive: of the robot.
    :param ratio: width of the passage over that of the object, across its narrow side.
    :param seed: of all draws.
    """
    obj, robot = bodies(name, drive)
    width = 2.0 * ratio * inner_reach(obj)
    count = round(width / RESOLUTION)
    resolution = width / count
    rng = np.random.default_rng((round(100 * ratio), seed))
    depth, rows = round(ROOM_DEPTH / resolution), round(ROOM_WIDTH / resolution)
    length = round(PASSAGE_LENGTH / resolution)
    occupied = _walled(rows, 2 * depth + length)
    low = int(rng.integers(rows // 4, rows - rows // 4 - count, endpoint=True))
    occupied[:low, depth:depth + length] = True
    occupied[low + count:, depth:depth + length] = True
    occupancy_map = OccupancyMap(resolution, Pose(0.0, 0.0, 0.0), occupied)
    start, goal = (_pose_in(rng, obj, robot, occupancy_map, span) for span in (
        (0.0, ROOM_DEPTH), (ROOM_DEPTH + PASSAGE_LENGTH, 2.0 * ROOM_DEPTH + PASSAGE_LENGTH)))
    return Instance(occupancy_map, obj, robot, start,
                    _beside(rng, obj, robot, occupancy_map, start), goal)


def flat(name: str, drive: str, seed: int) -> Instance:
    """
    Draw a task in a flat, as in the part of ``benchmarks.tasks`` of that name.

    :param name: of the object.
    :param drive: of the robot.
    :param seed: of all draws.
    :raises ValueError: where it has no map.
    """
    scenario = draw(FLATS, f'{name}, {drive}', seed).scenario
    if (scenario.task is None or scenario.task.occupancy_map is None
            or scenario.start.robot is None):
        raise ValueError(f'{FLATS}: got no map for seed {seed}, expected one')
    return Instance(scenario.task.occupancy_map, scenario.object, scenario.robot,
                    scenario.start.object.pose, scenario.start.robot.pose, scenario.goal.pose)


def building(name: str, drive: str, side: int, rooms: int, seed: int) -> Instance:
    """
    Draw a task along a row of rooms in the middle of a map of any size.

    :param name: of the object.
    :param drive: of the robot.
    :param side: of the map [cells].
    :param rooms: to be passed through, at least 1; as many as the map has room for.
    :param seed: of all draws.
    """
    obj, robot = bodies(name, drive)
    rng = np.random.default_rng((side, rooms, seed))
    pitch, door = round(ROOM_PITCH / RESOLUTION), round(DOOR / RESOLUTION)
    rooms = min(rooms, side // pitch)
    occupied = _walled(side, side)
    first, low = (side - rooms * pitch) // 2, (side - pitch) // 2
    occupied[low:low + 2, first:first + rooms * pitch] = True
    occupied[low + pitch - 2:low + pitch, first:first + rooms * pitch] = True
    for index in range(rooms + 1):
        wall = first + index * pitch
        occupied[low:low + pitch, wall:wall + 2] = True
        if 0 < index < rooms:
            door_at = low + int(rng.integers(pitch // 4, pitch - pitch // 4 - door, endpoint=True))
            occupied[door_at:door_at + door, wall:wall + 2] = False
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    spans = [((first + room * pitch) * RESOLUTION, (first + (room + 1) * pitch) * RESOLUTION)
             for room in (0, rooms - 1)]
    across = low * RESOLUTION, (low + pitch) * RESOLUTION
    start, goal = (_pose_in(rng, obj, robot, occupancy_map, span, across) for span in spans)
    return Instance(occupancy_map, obj, robot, start,
                    _beside(rng, obj, robot, occupancy_map, start), goal)


def nook(kind: Nook, name: str, drive: str, seed: int) -> Instance:
    """
    Draw a task in a room of which the object starts, or is to end, within 5 cm of walls.

    The map has a random origin and rotation. In niches, and in every other task elsewhere, a face
    is parallel to the wall.

    :param name: of the object.
    :param drive: of the robot.
    :param seed: of all draws.
    """
    obj, robot = bodies(name, drive)
    rng = np.random.default_rng((list(Nook).index(kind), seed))
    occupied = _walled(*(round((side + 2.0 * WALL) / RESOLUTION) for side in ROOM_SIDES[::-1]))
    thickness = round(WALL / RESOLUTION)
    occupied[thickness - 1] = occupied[-thickness] = True
    occupied[:, thickness - 1] = occupied[:, -thickness] = True
    turns = int(rng.integers(0, 4))
    heading = wrap_angle(0.5 * math.pi * turns)
    if kind not in NICHES and seed % 2:
        heading = rng.uniform(-math.pi, math.pi)
    low_x, low_y, high_y = _extents(obj, heading)
    x = WALL + rng.uniform(*GAPS) - low_x
    y = rng.uniform(1.2, ROOM_SIDES[1] - 1.2)
    if kind in CORNERS:
        y = WALL + rng.uniform(*GAPS) - low_y
    elif kind in NICHES:
        # Two blocks beside it stand out from the wall.
        first = round((y + low_y) / RESOLUTION)
        count = math.ceil((high_y - low_y + rng.uniform(*NICHE_EXCESS)) / RESOLUTION)
        end, side = round((WALL + NICHE_DEPTH) / RESOLUTION), round(0.5 / RESOLUTION)
        occupied[first - side:first, :end] = True
        occupied[first + count:first + count + side, :end] = True
        y = (first + 0.5 * count) * RESOLUTION - 0.5 * (low_y + high_y)
    at_wall = Pose(x, y, heading)
    plain = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    elsewhere = _pose_in(rng, obj, robot, plain, (0.0, ROOM_SIDES[0]))
    start, goal = (at_wall, elsewhere) if kind in FROM else (elsewhere, at_wall)
    beside = _robot_in(rng, obj, robot, plain, start)
    origin = Pose(rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-math.pi, math.pi))
    occupancy_map = OccupancyMap(RESOLUTION, origin, occupied)
    return Instance(occupancy_map, obj, robot, origin @ start, origin @ beside, origin @ goal)


def public(name: str, drive: str, seed: int, folder: str) -> Instance:
    """
    Draw a task in a map of a folder, as in the part of ``benchmarks.tasks`` of that name.

    :param name: of the object.
    :param drive: of the robot.
    :param seed: of all draws; it chooses the map.
    :param folder: with maps of ``map_server``.
    """
    obj, robot = bodies(name, drive)
    task = draw_public_task(folder, seed, obj, robot, np.random.default_rng(seed))
    return Instance(task.floor_map.occupancy_map, obj, robot, task.start, task.robot_start,
                    task.goal)


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


def _walled(rows: int, columns: int) -> BoolArray:
    occupied = np.zeros((rows, columns), dtype=np.bool_)
    occupied[[0, -1]] = True
    occupied[:, [0, -1]] = True
    return occupied


def _pose_in(rng: np.random.Generator, obj: PushedObject, robot: RoundRobot,
             occupancy_map: OccupancyMap, along: tuple[float, float],
             across: tuple[float, float] | None = None) -> Pose:
    """Draw a pose of the object round which the robot can drive."""
    rows, _ = occupancy_map.occupied.shape
    across = across or (0.0, rows * occupancy_map.resolution)
    around = reach(obj) + 2.0 * (robot.radius + CLEARANCE)
    while True:
        x, y = rng.uniform(*along), rng.uniform(*across)
        if occupancy_map.clearance([(x, y)])[0] > around:
            return Pose(x, y, rng.uniform(-math.pi, math.pi))


def _beside(rng: np.random.Generator, obj: PushedObject, robot: RoundRobot,
            occupancy_map: OccupancyMap, start: Pose) -> Pose:
    """Draw a pose of the robot near the object."""
    away = reach(obj) + robot.radius + 2.0 * CLEARANCE
    bearing, heading = rng.uniform(-math.pi, math.pi, 2)
    return Pose(start.x + away * math.cos(bearing), start.y + away * math.sin(bearing), heading)
