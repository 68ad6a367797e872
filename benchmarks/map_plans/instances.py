"""Random tasks in maps: passages of a width, flats, and buildings of many cells."""

import math
from typing import NamedTuple

from benchmarks.tasks.cases import CLEARANCE, draw, FLATS
from benchmarks.tasks.drawn_scenario import ROBOTS
from benchmarks.tasks.maps import drawn_map, inner_reach, reach
from benchmarks.tasks.nooks import draw_nook_task, Nook, pose_in, walled
from benchmarks.tasks.public_maps import draw_public_task
import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_planner.settings import PlannerSettings
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
# Pitch of the rooms of a building, with their walls, and width of its doors [m].
ROOM_PITCH = 4.0
DOOR = 1.0


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
        return Scenario(
            name='map', description='a task in a map', object=self.obj, true_object=self.obj,
            robot=self.robot, true_robot=self.robot, goal=Placement(*self.goal),
            start=Start(object=Placement(*self.start), robot=Placement(*self.robot_start)),
            planner=PlannerSettings(), task=Task(
                map=drawn_map(self.occupancy_map),
                supervision=SupervisionSettings(disc_heading_free=False)),
            time_limit=600.0)


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
    occupied = walled(rows, 2 * depth + length)
    low = int(rng.integers(rows // 4, rows - rows // 4 - count, endpoint=True))
    occupied[:low, depth:depth + length] = True
    occupied[low + count:, depth:depth + length] = True
    occupancy_map = OccupancyMap(resolution, Pose(0.0, 0.0, 0.0), occupied)
    start, goal = (pose_in(rng, obj, robot, occupancy_map, span) for span in (
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
    occupied = walled(side, side)
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
    start, goal = (pose_in(rng, obj, robot, occupancy_map, span, across) for span in spans)
    return Instance(occupancy_map, obj, robot, start,
                    _beside(rng, obj, robot, occupancy_map, start), goal)


def nook(kind: Nook, name: str, drive: str, seed: int) -> Instance:
    """
    Draw a task in a room of which the object starts, or is to end, within 5 cm of walls.

    In niches, and in every other task elsewhere, a face is parallel to the wall.

    :param name: of the object.
    :param drive: of the robot.
    :param seed: of all draws.
    """
    obj, robot = bodies(name, drive)
    rng = np.random.default_rng((list(Nook).index(kind), seed))
    task = draw_nook_task(kind, obj, robot, rng, is_square=seed % 2 == 0)
    return Instance(task.occupancy_map, obj, robot, task.start, task.robot_start, task.goal)


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


def _beside(rng: np.random.Generator, obj: PushedObject, robot: RoundRobot,
            occupancy_map: OccupancyMap, start: Pose) -> Pose:
    """Draw a pose of the robot near the object."""
    away = reach(obj) + robot.radius + 2.0 * CLEARANCE
    bearing, heading = rng.uniform(-math.pi, math.pi, 2)
    return Pose(start.x + away * math.cos(bearing), start.y + away * math.sin(bearing), heading)
