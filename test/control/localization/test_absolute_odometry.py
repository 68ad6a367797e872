"""Odometry that measures the pose in the world keeps the robot's place, however far it drives."""

import math

from helpers.objects import box
import numpy as np
from push_control.observation import Observation
from push_control.settings import ControlSettings
from push_control.task.perception import TaskPerception
from push_control.task.settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Twist
from push_sim_node.sensors import OdometrySensor, SensorSettings
import pytest

NOISE, HEADING_NOISE = 2e-3, 5e-3
SPEED, YAW_RATE, PERIOD = 0.3, 0.1, 0.05
BOX = Pose(9.0, 9.0, 0.0)


def localized(reference, duration=30.0):
    """Drive a circle of 3 m radius away from the object; yield true and estimated poses."""
    sensors = SensorSettings(odometry_reference='absolute', odometry_position_noise=NOISE,
                             odometry_heading_noise=HEADING_NOISE)
    sensor = OdometrySensor(sensors, Pose(0.0, 0.0, 0.0),
                            *(np.random.default_rng(seed) for seed in (1, 2, 3)))
    perception = TaskPerception(box(), RoundRobot(radius=0.17), ControlSettings(),
                                SupervisionSettings(odometry_reference=reference))
    radius = SPEED / YAW_RATE
    for i in range(round(duration / PERIOD)):
        time = PERIOD * i
        angle = YAW_RATE * time
        true = Pose(radius * math.sin(angle), radius * (1.0 - math.cos(angle)), angle)
        odometry = sensor.measure(time, true, Twist(SPEED, 0.0, YAW_RATE))
        perception.update(Observation(time, odometry, ObjectPose(0.0, BOX)))
        yield true, perception


@pytest.mark.slow
def test_the_robot_is_where_absolute_odometry_has_it():
    """Without drift over 9 m, with no more error than one measurement has, and it knows so."""
    errors = np.array([
        (found.robot_pose.x - true.x, found.robot_pose.y - true.y,
         math.remainder(found.robot_pose.theta - true.theta, math.tau))
        for true, found in localized('absolute')])
    noise = np.array((NOISE, NOISE, HEADING_NOISE))
    assert (np.abs(errors).max(axis=0) < 4.5 * noise).all()
    assert (errors.std(axis=0) < 1.1 * noise).all()
    *_, (_, found) = localized('absolute', 1.0)
    assert found.localization.position_deviation < NOISE


def test_a_covariance_of_drifting_odometry_is_not_believed():
    """The robot gets less and less sure of its place, as wheels would have it."""
    *_, (_, found) = localized('drifting', 15.0)
    assert found.localization.position_deviation > 10.0 * NOISE
