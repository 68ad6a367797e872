"""What all tasks have in common: object and robot that are drawn, and a scenario of them."""

from typing import NamedTuple

from benchmarks.controller.cases import objects, SENSORS, STRESSES
import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.files import data
from push_model.files.parameter_files import read_robot
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_planner.settings import PlannerSettings
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.definition.task import Task
from push_sim_node.simulation import SimulationSettings

ROBOTS = {'differential': 'disc_017', 'holonomic': 'holonomic_017'}
# Simulated time after which a task is given up [s]; chosen: far longer than tasks take.
TIME_LIMIT = 900.0


class Bodies(NamedTuple):
    """
    Object and robot of a task.

    :param robot: ``RoundRobot``.
    :param believed_object: ``PushedObject`` as it is stated.
    :param true_object: as it is.
    :param speed: of pushes [m/s].
    """

    robot: RoundRobot
    believed_object: PushedObject
    true_object: PushedObject
    speed: float


class TaskPoses(NamedTuple):
    """
    Where a task starts and ends.

    :param start: ``Pose`` of the object.
    :param goal: ``Pose`` that it is to have.
    :param robot_start: ``Pose`` of the robot.
    """

    start: Pose
    goal: Pose
    robot_start: Pose


def draw_bodies(kind: str, seed: int, rng: np.random.Generator) -> Bodies:
    """
    Draw object and robot.

    :param kind: name of the object, and drive of the robot.
    :param seed: of the task.
    """
    name, drive = kind.split(', ')
    robot = read_robot(data.config_file(f'robots/{ROBOTS[drive]}.yaml'))
    believed, true = objects(name, rng, STRESSES[0], seed)
    return Bodies(robot, believed, true, rng.uniform(0.1, 0.25))


def make_scenario(description: str, bodies: Bodies, poses: TaskPoses, seed: int,
                  floor_map: FloorMap | None = None) -> Scenario:
    """
    Make the scenario of a task.

    :param seed: of the simulation.
    :param floor_map: the ``FloorMap``, or None for open floor.
    """
    return Scenario(
        name='random', description=description, object=bodies.believed_object,
        true_object=bodies.true_object, robot=bodies.robot, true_robot=bodies.robot,
        goal=Placement(*poses.goal),
        start=Start(object=Placement(*poses.start), robot=Placement(*poses.robot_start)),
        planner=PlannerSettings(pushing_speed=bodies.speed), sensors=SENSORS,
        simulation=SimulationSettings(seed=seed), time_limit=TIME_LIMIT,
        task=Task(map=floor_map, supervision=SupervisionSettings(disc_heading_free=False)))
