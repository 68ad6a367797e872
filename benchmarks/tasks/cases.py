"""
Random tasks: on open floor, in maps, disturbed, and on open floor with single pushes only.

Nominal and true parameters differ as in ``benchmarks.controller.cases``. A task is drawn from its
part, kind and seed alone.
"""

import dataclasses
import math
from typing import NamedTuple, Optional

from benchmarks.controller.cases import objects, SENSORS, STRESSES
from benchmarks.controller.tables import Job
from benchmarks.tasks.intervention import Intervention, INTERVENTIONS
from benchmarks.tasks.maps import draw_floor, Floor, MAPS, places, reach
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings, TaskSettings
from push_scenario.definition import data
from push_scenario.definition.loader import read_robot
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.definition.task import Task
from push_sim_node.simulation import SimulationSettings

OPEN = 'open floor'
IN_MAPS = 'maps'
DISTURBED = 'disturbed'
ALONE = 'single pushes'
# The order enters the seeds of the draws: append only.
PARTS = OPEN, IN_MAPS, DISTURBED, ALONE
ROBOTS = {'differential': 'disc_017', 'holonomic': 'holonomic_017'}
OBJECTS = ('box_04', 'carton', 'coffee_table', 'bin')
# A table that is 0.9 m long cannot be rotated between the walls; a differential drive cannot hold
# its contact on a round side.
FITTING = {OPEN: OBJECTS, IN_MAPS: ('box_04', 'carton', 'bin'), DISTURBED: OBJECTS,
           ALONE: OBJECTS}
KINDS = {part: tuple(f'{name}, {drive}' for name in names for drive in ROBOTS
                     if (name, drive) != ('bin', 'differential'))
         for part, names in FITTING.items()}
# Range of the distance of goals, and largest distance of the robot from the object at the start
# [m]; chosen: the size of a room.
NEAREST = 0.05
FARTHEST = 3.0
ROBOT_WITHIN = 2.0
# Latest begin of a disturbance [s], chosen: while most tasks are under way; and longest pose
# drop-out [s], chosen: 40 periods of the pose.
LATEST = 30.0
LONGEST_DROPOUT = 2.0
# Simulated time after which a task is given up [s]; chosen: far longer than tasks take.
TIME_LIMIT = 900.0


class Case(NamedTuple):
    """
    One task.

    :param scenario: the ``Scenario``.
    :param variety: sort of map or of disturbance, empty on open floor.
    :param floor: the ``Floor``, or None for open floor.
    :param intervention: ``Intervention`` that disturbs it, or None.
    """

    scenario: Scenario
    variety: str = ''
    floor: Optional[Floor] = None
    intervention: Optional[Intervention] = None


def jobs(counts: dict[str, int]) -> list[Job]:
    """
    List the tasks; the first ones do not depend on how many there are.

    :param counts: number of tasks of each of ``PARTS``.
    :return: keyword arguments of ``draw``.
    """
    return [{'part': part, 'kind': KINDS[part][index % len(KINDS[part])],
             'seed': index // len(KINDS[part])}
            for part, count in counts.items() for index in range(count)]


def draw(part: str, kind: str, seed: int) -> Case:
    """
    Draw a task.

    :param part: one of ``PARTS``.
    :param kind: one of the ``KINDS`` of this part.
    :param seed: of all draws.
    :return: ``Case``.
    """
    # Single pushes get the very tasks of open floor.
    drawn_as = OPEN if part == ALONE else part
    rng = np.random.default_rng((PARTS.index(drawn_as), KINDS[part].index(kind), seed))
    name, drive = kind.split(', ')
    robot = read_robot(data.config_file(f'robots/{ROBOTS[drive]}.yaml'))
    believed, true = objects(name, rng, STRESSES[0], seed)
    speed = rng.uniform(0.1, 0.25)
    dropouts: tuple[tuple[float, float], ...] = ()
    floor, variety, intervention = None, '', None
    if part == IN_MAPS:
        variety = MAPS[seed % len(MAPS)]
        floor, start, goal = _in_map(variety, true, robot, rng)
    else:
        start, goal = Pose(0.0, 0.0, 0.0), _goal(rng)
    robot_start = _robot_start(true, robot, start, floor, rng)
    if part == DISTURBED:
        variety = INTERVENTIONS[seed % len(INTERVENTIONS)]
        intervention = Intervention(variety, rng.uniform(0.0, LATEST),
                                    rng.uniform(-math.pi, math.pi))
        begin = rng.uniform(0.0, LATEST)
        dropouts = ((begin, begin + rng.uniform(0.0, LONGEST_DROPOUT)),)
    return Case(Scenario(
        name='random', description=f'{part}, {kind}, seed {seed}', object=believed,
        true_object=true, robot=robot, true_robot=robot, goal=Placement(*goal),
        start=Start(object=Placement(*start), robot=Placement(*robot_start)),
        planner=PlannerSettings(pushing_speed=speed),
        sensors=dataclasses.replace(SENSORS, pose_dropouts=dropouts),
        simulation=SimulationSettings(seed=seed), time_limit=TIME_LIMIT,
        task=Task(map=None if floor is None else floor.map, planning=TaskSettings(
            max_pushes=1 if part == ALONE else 4))), variety, floor, intervention)


def _goal(rng: np.random.Generator) -> Pose:
    far = rng.uniform(NEAREST, FARTHEST)
    bearing, heading = rng.uniform(-math.pi, math.pi, 2)
    return Pose(far * math.cos(bearing), far * math.sin(bearing), heading)


def _in_map(name: str, obj: PushedObject, robot: RoundRobot,
            rng: np.random.Generator) -> tuple[Floor, Pose, Pose]:
    """Place object and goal where the robot can drive all round, with a path between them."""
    margin = DriveSettings().map_clearance
    aside = reach(obj) + margin
    around = aside + 2.0 * robot.radius + DriveSettings().clearance
    while True:
        floor = draw_floor(name, rng)
        region, points = places(floor, aside)
        wide = np.flatnonzero(places(floor, around)[0] * region)
        if not wide.size:
            continue
        first, last = rng.choice(wide, 2)
        start, goal = (Pose(float(points[index, 0]), float(points[index, 1]),
                            rng.uniform(-math.pi, math.pi)) for index in (first, last))
        if region[first] == region[last] and _is_valid_goal(name, floor, start, goal):
            return floor, start, goal


def _is_valid_goal(name: str, floor: Floor, start: Pose, goal: Pose) -> bool:
    """Tell whether the goal is in the other of two rooms, or far enough in the only one."""
    if name == 'cluttered room':
        return NEAREST < distance(start, goal) < FARTHEST
    middle = 0.5 * floor.map.resolution * floor.size[0]
    return (start.x - middle) * (goal.x - middle) < 0.0


def _robot_start(obj: PushedObject, robot: RoundRobot, start: Pose, floor: Optional[Floor],
                 rng: np.random.Generator) -> Pose:
    """Place the robot near the object, clear of it and of obstacles."""
    drive = DriveSettings()
    occupancy_map = None if floor is None else floor.map.occupancy_map
    while True:
        # The root spreads the places evenly over the disc.
        away = ROBOT_WITHIN * math.sqrt(rng.uniform())
        bearing, heading = rng.uniform(-math.pi, math.pi, 2)
        pose = Pose(start.x + away * math.cos(bearing), start.y + away * math.sin(bearing),
                    heading)
        clear = find_contact(obj, start, pose[:2], robot.radius)[2] >= drive.clearance
        if clear and (occupancy_map is None
                      or occupancy_map.robot_is_free(robot, [pose], 2.0 * drive.map_clearance)):
            return pose
