"""MuJoCo behind the simulation: the same measurements and pushes as in the package's own plant."""

import dataclasses
import math
import sys
from typing import Any

from helpers.extras import import_extra
import numpy as np
from push_dynamics.walls import Wall
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject
from push_model.signals import LidarScan, STOP, Twist
from push_mujoco.simulated_robot import read_simulated_robot
from push_scenario import cli
from push_scenario.definition.loader import load_scenario, scenario_from_text, scenario_text
from push_scenario.simulation.loop import make_simulation
from push_sim_node.lidar import LidarSensorSettings
from push_sim_node.plant import Plant
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
import pytest

ENGINE = import_extra('mujoco', 'mujoco', 'push_mujoco.engine_plant')
engine_plant = ENGINE.engine_plant
pytestmark = pytest.mark.physics
BOX, CREATE = read_object('box_04'), read_robot('create3')
HOLONOMIC = read_robot('holonomic_017')
TURTLEBOT_4 = read_simulated_robot('turtlebot4')
ROOM = (Wall(2.0, -1.5, 2.0, 1.0), Wall(2.0, 1.0, -1.0, 1.4), Wall(-1.0, 1.4, -1.3, -1.5),
        Wall(-1.3, -1.5, 2.0, -1.5))
SCAN = SensorSettings(lidar=LidarSensorSettings(rate=10.0, beams=120, noise=0.0,
                                                outlier_probability=0.0, mount_x=-0.04))


def scan_after_a_drive(plant_type: Any) -> LidarScan:
    """Return the third scan of a robot that drives in a bend past a box."""
    simulation = Simulation(BOX, CREATE, Pose(0.9, 0.3, 0.4), Pose(0.0, 0.0, 0.0),
                            SimulationSettings(walls=ROOM), SCAN, plant_type=plant_type)
    scans: list[LidarScan] = []
    while len(scans) < 3:
        simulation.command(Twist(0.2, 0.0, 0.5))
        measurement = simulation.next_measurement()
        scans += [measurement] if isinstance(measurement, LidarScan) else []
    return scans[-1]


def test_the_lidar_measures_what_the_package_computes() -> None:
    """To where beams leave from one place for a fortieth of a second, but for edges of the box."""
    engine, own = (scan_after_a_drive(kind).ranges for kind in (engine_plant(), Plant))
    difference = np.abs(engine - own)
    assert np.median(difference) < 2e-3
    assert (difference < 0.01).mean() > 0.95


def pushed(plant: Plant, command: Twist, duration: float) -> Plant:
    """Push, and wait until everything stands."""
    for _ in range(round(duration / 0.1)):
        plant.advance(0.1, command)
    plant.advance(1.0, STOP)
    return plant


@pytest.mark.parametrize('robot, command', [(CREATE, Twist(0.2, 0.0, 0.0)),
                                            (HOLONOMIC, Twist(0.2, 0.02, 0.0)),
                                            (HOLONOMIC, Twist(0.2, 0.0, 0.1))])
def test_a_push_ends_where_it_does_in_the_package(robot, command) -> None:
    """After the same command: motors lag by 20 ms, and wheels slip by some millimetres."""
    start = Pose(0.4, 0.01, 0.0), Pose(0.0, 0.0, 0.0)
    engine = pushed(engine_plant()(BOX, robot, *start), command, 2.0)
    own = pushed(Plant(BOX, robot, *start), command, 2.0)
    assert own.object_pose.x > 0.7
    assert distance(engine.object_pose, own.object_pose) < 0.012
    assert abs(engine.object_pose.theta - own.object_pose.theta) < math.radians(1.5)
    assert engine.object_pose != own.object_pose


def heavy(mass: float) -> PushedObject:
    """Return a box that takes a force of 0.3 m g."""
    return dataclasses.replace(BOX, mass=mass, inertia=0.0)


def test_wheels_that_slip_count_on() -> None:
    """Odometry goes on while the robot cannot; pushing a light box it stays with the robot."""
    slips = {}
    for mass in (2.0, 20.0):
        plant = pushed(engine_plant()(heavy(mass), CREATE, Pose(0.4, 0.0, 0.0),
                                      Pose(0.0, 0.0, 0.0)), Twist(0.2, 0.0, 0.0), 2.0)
        slips[mass] = plant.odometry_pose.x - plant.robot_pose.x
        assert abs(plant.odometry_pose.theta) < math.radians(1.0)
    assert abs(slips[2.0]) < 0.01
    assert slips[20.0] > 0.2
    assert 20.0 * 9.81 * 0.3 > TURTLEBOT_4.traction > 2.0 * 9.81 * 0.3


@pytest.mark.parametrize('has_gyro', [False, True])
def test_odometry_and_motion_agree_in_a_turn(has_gyro: bool) -> None:
    robot = dataclasses.replace(TURTLEBOT_4, has_gyro=has_gyro)
    plant = engine_plant(robot)(BOX, CREATE, Pose(2.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
    pushed(plant, Twist(0.1, 0.0, 1.5), 5.0)
    assert plant.robot_pose.theta > 6.9
    error = plant.odometry_pose.theta - plant.robot_pose.theta
    assert abs(error) < 0.03 or has_gyro
    assert not has_gyro or error == pytest.approx(
        robot.gyro_scale * plant.robot_pose.theta, abs=1e-6)
    assert distance(plant.odometry_pose, plant.robot_pose) < 5e-3


def test_a_gyro_knows_the_heading_of_wheels_that_slip() -> None:
    """A heavy box in a bend takes more than they hold: by ticks alone the robot turned farther."""
    errors: list[float] = []
    for has_gyro in (False, True):
        robot = dataclasses.replace(TURTLEBOT_4, has_gyro=has_gyro)
        plant = engine_plant(robot)(heavy(5.0), CREATE, Pose(0.4, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
        pushed(plant, Twist(0.15, 0.0, 0.15), 4.0)
        errors.append(abs(plant.odometry_pose.theta - plant.robot_pose.theta))
        assert (plant.odometry_twist.omega == plant.robot_twist.omega) == has_gyro
    assert errors[0] > math.radians(5.0) > 10.0 * errors[1]


def test_the_bumper_closes_while_it_pushes() -> None:
    plant = engine_plant()(BOX, CREATE, Pose(0.4, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
    plant.advance(0.1, STOP)
    assert not plant.is_bumper_pressed(1.5, 0.1)
    plant.advance(1.0, Twist(0.2, 0.0, 0.0))
    assert plant.is_bumper_pressed(1.5, 1.1)
    plant.advance(1.0, Twist(-0.2, 0.0, 0.0))
    assert not plant.is_bumper_pressed(1.5, 0.1)


def test_more_friction_of_a_foot_takes_more_force() -> None:
    """The force grows as friction under all feet does."""
    forces = []
    for factor in (1.0, 2.0):
        plant = engine_plant()(heavy(1.5), CREATE, Pose(0.4, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
        plant.set_friction_factors([factor] * 4)
        plant.advance(1.0, Twist(0.1, 0.0, 0.0))
        samples = []
        for _ in range(50):
            plant.advance(0.01, Twist(0.1, 0.0, 0.0))
            samples.append(plant.engine.normal_force('skirt'))
        forces.append(np.mean(samples))
    assert forces[0] == pytest.approx(1.5 * 9.81 * 0.3, rel=0.15)
    assert forces[1] == pytest.approx(2.0 * forces[0], rel=0.1)


def test_what_it_cannot_do_is_refused() -> None:
    start = Pose(0.5, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match='robot.drive'):
        engine_plant(TURTLEBOT_4)(BOX, HOLONOMIC, *start)
    with pytest.raises(ValueError, match='robot.radius'):
        engine_plant()(BOX, dataclasses.replace(CREATE, radius=0.0), *start)


def test_a_scenario_says_which_engine_moves_it(monkeypatch) -> None:
    """And, where that is not installed, what to install."""
    scenario = dataclasses.replace(load_scenario('task_own_camera'), engine='mujoco')
    assert scenario_from_text(scenario_text(scenario), scenario.name) == scenario
    assert isinstance(make_simulation(scenario).plant, ENGINE.EnginePlant)
    for name in [name for name in sys.modules if name.startswith('push_mujoco')]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, 'mujoco', None)
    with pytest.raises(RuntimeError, match=r'engine: got .mujoco.*push_control\[mujoco\]'):
        make_simulation(scenario)


@pytest.mark.slow
def test_a_task_ends_at_its_goal(tmp_path) -> None:
    """The tape is that of a robot whose wheels slip, not of the package's own plant."""
    words = ['task_own_camera', '--no-pictures', '--out', str(tmp_path)]
    assert cli.main([*words, '--engine', 'mujoco']) == 0
    engine = (tmp_path / 'task_own_camera_feedback.csv').read_text()
    assert cli.main([*words, '--in-process']) == 0
    assert (tmp_path / 'task_own_camera_feedback.csv').read_text() != engine
