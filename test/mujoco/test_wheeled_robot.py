"""Laws of a robot on two wheels and a caster, in an engine that knows none of their equations."""

import dataclasses
import math

from helpers.extras import import_extra
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_mujoco.simulated_robot import read_simulated_robot
from push_sim_node.plant import Plant
import pytest

wheeled_robot = import_extra('mujoco', 'mujoco', 'push_mujoco.wheeled_robot')
comparison = import_extra('mujoco', 'mujoco', 'benchmarks.plant.comparison')
WheeledPlant = wheeled_robot.WheeledPlant
TURTLEBOT_4 = read_simulated_robot('turtlebot4')
pytestmark = pytest.mark.physics
# Its caster stays on the floor and bears no force along it.
HEAVY_FRONT = dataclasses.replace(TURTLEBOT_4, body_center=(0.045, 0.0, 0.09), caster_friction=0.0)


@pytest.mark.parametrize('speed', [0.2, -0.2])
def test_a_straight_drive_goes_radius_times_angle(speed) -> None:
    plant = WheeledPlant(TURTLEBOT_4)
    plant.advance(1.0, speed, 0.0)
    left, right = plant.wheel_angles
    assert left == pytest.approx(right, rel=1e-6)
    assert plant.pose.x == pytest.approx(TURTLEBOT_4.wheel_radius * left, rel=5e-3)
    braked = speed**2 / TURTLEBOT_4.max_acceleration / 2.0
    assert abs(plant.pose.x) == pytest.approx(abs(speed) - braked, rel=0.02)
    assert abs(plant.pose.y) < 1e-6 and abs(plant.pose.theta) < 1e-6


@pytest.mark.parametrize('yaw_rate', [1.0, -1.0])
def test_a_spin_turns_by_the_difference_of_the_wheels(yaw_rate) -> None:
    plant = WheeledPlant(TURTLEBOT_4)
    plant.advance(1.0, 0.0, yaw_rate)
    left, right = plant.wheel_angles
    by_wheels = TURTLEBOT_4.wheel_radius * (right - left) / TURTLEBOT_4.track
    assert plant.pose.theta == pytest.approx(by_wheels, rel=1e-2)
    assert abs(plant.pose.theta) > 0.9 * abs(yaw_rate)
    assert math.hypot(*plant.pose[:2]) < 2e-3


@pytest.mark.parametrize('friction', [0.4, 0.8])
@pytest.mark.parametrize('height', [0.02, 0.04])
def test_wheels_spin_at_the_traction_of_their_load(friction, height) -> None:
    robot = dataclasses.replace(HEAVY_FRONT, wheel_friction=friction, bumper_height=height)
    assert robot.traction < robot.lifting_force
    assert wheeled_robot.pushing_force(robot) == pytest.approx(robot.traction, rel=0.02)


def test_a_robot_that_tilts_pushes_on_its_rear_edge() -> None:
    """Its weight is far behind: the caster is lifted before the wheels spin."""
    robot = dataclasses.replace(TURTLEBOT_4, caster_friction=0.0, rear_clearance=1e-3)
    assert robot.lifting_force < 0.6 * robot.traction
    assert wheeled_robot.pushing_force(robot) == pytest.approx(robot.traction, rel=0.03)


def test_weak_motors_stall_before_the_wheels_spin() -> None:
    robot = dataclasses.replace(HEAVY_FRONT, motor_torque=0.1)
    stalled = 2.0 * robot.motor_torque / robot.wheel_radius
    assert stalled < robot.traction
    assert wheeled_robot.pushing_force(robot) == pytest.approx(stalled, rel=0.02)


@pytest.mark.parametrize('offset', [0.0, 0.02])
def test_a_push_of_a_box_agrees_with_the_plant(offset) -> None:
    """After the same way of the wheels, which slip by 2 mm: motors under load are slower."""
    speed, gap, radius = 0.2, 0.01, TURTLEBOT_4.bumper_radius
    box = dataclasses.replace(comparison.OBJECTS['box'](2.0, 0.3, 0.5), contact_height=0.05,
                              center_of_mass_height=0.05)
    start = Pose(radius + gap + 0.2, offset, 0.0)
    wheeled = WheeledPlant(TURTLEBOT_4, obj=box, object_pose=start)
    wheeled.advance(2.7, speed, 0.0)
    wheeled.advance(0.5, 0.0, 0.0)
    way = TURTLEBOT_4.wheel_radius * float(np.mean(wheeled.wheel_angles))
    assert way > gap + 0.5
    robot = RoundRobot(radius, 'differential', max_speed=1.0, time_constant=0.0,
                       max_acceleration=TURTLEBOT_4.max_acceleration)
    plant = Plant(box, robot, start, Pose(0.0, 0.0, 0.0), 1e-3)
    plant.advance(way / speed, Twist(speed, 0.0, 0.0))
    plant.advance(0.5, STOP)
    distance, angle = comparison.pose_difference(wheeled.object_pose, plant.object_pose)
    assert distance < 2.5e-3 and math.degrees(angle) < 0.1
