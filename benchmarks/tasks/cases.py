"""
Random tasks, as wrong as those of ``controller_cases.py``: on open floor, in maps, disturbed.

And the tasks on open floor once more for a planner that knows single pushes only.

A task is drawn from its part, kind and seed alone.
"""

import dataclasses
import math
from typing import NamedTuple

from benchmarks.controller.cases import objects, SENSORS, STRESSES
from benchmarks.tasks.intervention import Intervention, INTERVENTIONS
from benchmarks.tasks.maps import draw_floor, Floor, MAPS, places, reach
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings, TaskSettings
from push_scenario.definition import data
from push_scenario.definition.loader import read_robot
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.definition.task import Task
from push_sim_node.simulation import SimulationSettings

OPEN, IN_MAPS, DISTURBED, ALONE = 'open floor', 'maps', 'disturbed', 'single pushes'
PARTS = OPEN, IN_MAPS, DISTURBED, ALONE
ROBOTS = {'differential': 'disc_017', 'holonomic': 'holonomic_017'}
OBJECTS = ('box_04', 'carton', 'coffee_table', 'bin')
# A table that is 0.9 m long cannot be turned between the walls; a differential drive cannot hold a
# round side.
FITTING = {OPEN: OBJECTS, IN_MAPS: ('box_04', 'carton', 'bin'), DISTURBED: OBJECTS,
           ALONE: OBJECTS}
KINDS = {part: tuple(f'{name}, {drive}' for name in names for drive in ROBOTS
                     if (name, drive) != ('bin', 'differential'))
         for part, names in FITTING.items()}
NEAREST, FARTHEST, ROBOT_WITHIN = 0.05, 3.0, 2.0
LATEST, LONGEST_LOST = 30.0, 2.0
TIME_LIMIT = 900.0


class Case(NamedTuple):
    """
    One task.

    :param scenario: the ``Scenario``.
    :param variety: what sets it apart within its part, empty on open floor.
    :param floor: ``tasks_maps.Floor``, or None for open floor.
    :param intervention: ``Intervention`` that disturbs it, or None.
    """

    scenario: Scenario
    variety: str = ''
    floor: Floor | None = None
    intervention: Intervention | None = None


def jobs(counts):
    """
    List the tasks; the first ones do not depend on how many there are.

    :param counts: how many, for each of ``PARTS``.
    """
    return [{'part': part, 'kind': KINDS[part][index % len(KINDS[part])],
             'seed': index // len(KINDS[part])}
            for part, count in counts.items() for index in range(count)]


def draw(part, kind, seed):
    """
    Draw a task.

    :param part: one of ``PARTS``.
    :param kind: one of the ``KINDS`` of this part.
    :param seed: of all draws.
    :return: ``Case``.
    """
    like = OPEN if part == ALONE else part
    rng = np.random.default_rng((PARTS.index(like), KINDS[part].index(kind), seed))
    name, drive = kind.split(', ')
    robot = read_robot(data.config_file(f'robots/{ROBOTS[drive]}.yaml'))
    believed, true = objects(name, rng, STRESSES[0], seed)
    speed, dropouts, floor, variety, intervention = rng.uniform(0.1, 0.25), (), None, '', None
    if part == IN_MAPS:
        variety = MAPS[seed % len(MAPS)]
        floor, start, goal = _in_map(variety, true, robot, rng)
    else:
        start, goal = Pose(0.0, 0.0, 0.0), _goal(rng)
    stand = _stand(true, robot, start, floor, rng)
    if part == DISTURBED:
        variety = INTERVENTIONS[seed % len(INTERVENTIONS)]
        intervention = Intervention(variety, rng.uniform(0.0, LATEST),
                                    rng.uniform(-math.pi, math.pi))
        begin = rng.uniform(0.0, LATEST)
        dropouts = ((begin, begin + rng.uniform(0.0, LONGEST_LOST)),)
    return Case(Scenario(
        name='random', description=f'{part}, {kind}, seed {seed}', object=believed,
        true_object=true, robot=robot, true_robot=robot, goal=Placement(*goal),
        start=Start(object=Placement(*start), robot=Placement(*stand)),
        planner=PlannerSettings(pushing_speed=speed),
        sensors=dataclasses.replace(SENSORS, pose_dropouts=dropouts),
        simulation=SimulationSettings(seed=seed), time_limit=TIME_LIMIT,
        task=Task(map=floor and floor.map, planning=TaskSettings(
            max_pushes=1 if part == ALONE else 4))), variety, floor, intervention)


def _goal(rng):
    far, bearing, heading = (rng.uniform(NEAREST, FARTHEST), *rng.uniform(-math.pi, math.pi, 2))
    return Pose(far * math.cos(bearing), far * math.sin(bearing), heading)


def _in_map(name, obj, robot, rng):
    """Place object and goal where the robot gets all round, and the object can be carried over."""
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
        start, goal = (Pose(*map(float, points[index]), rng.uniform(-math.pi, math.pi))
                       for index in (first, last))
        if region[first] == region[last] and _apart(name, floor, start, goal):
            return floor, start, goal


def _apart(name, floor, start, goal):
    """In rooms with something between them they are in different ones."""
    if name == 'cluttered room':
        return NEAREST < distance(start, goal) < FARTHEST
    middle = 0.5 * floor.map.resolution * floor.size[0]
    return (start.x - middle) * (goal.x - middle) < 0.0


def _stand(obj, robot, start, floor, rng):
    """Place the robot near the object, clear of it and of what stands around."""
    drive = DriveSettings()
    occupancy_map = floor and floor.map.occupancy_map
    while True:
        away, bearing, heading = (ROBOT_WITHIN * math.sqrt(rng.uniform()),
                                  *rng.uniform(-math.pi, math.pi, 2))
        pose = Pose(start.x + away * math.cos(bearing), start.y + away * math.sin(bearing),
                    heading)
        clear = find_contact(obj, start, pose[:2], robot.radius)[2] >= drive.clearance
        if clear and (floor is None
                      or occupancy_map.robot_is_free(robot, [pose], 2.0 * drive.map_clearance)):
            return pose
