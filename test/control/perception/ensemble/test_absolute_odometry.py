"""Odometry that measures the pose in the world keeps the robot's place, however far it drives."""

import math

from helpers.maps import walled_room
from helpers.objects import box
import numpy as np
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanRequest
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP, Twist
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search.planner import plan_push_in_map
from push_sim_node.sensors import OdometrySensor, SensorSettings
import pytest

NOISE, HEADING_NOISE = 2e-3, 5e-3
SPEED, YAW_RATE, PERIOD = 0.3, 0.1, 0.05
BOX = Pose(9.0, 9.0, 0.0)
ROBOT = RoundRobot(radius=0.17, max_speed=0.3)


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


def requested(reference: str, *, has_covariance: bool) -> PlanRequest:
    """Return the plan request for an object behind a wall."""
    supervisor = Supervisor(box(), ROBOT, ControlSettings(), DriveSettings(),
                            SupervisionSettings(odometry_reference=reference))
    supervisor.set_goal(Pose(0.0, 1.5, 0.0))
    covariance = None
    if has_covariance:
        covariance = PoseCovariance.from_deviations(NOISE, HEADING_NOISE)
    robot, seen = Pose(2.0, -1.0, 1.0), Pose(2.0, 1.2, 0.4)
    for i in range(20):
        time = PERIOD * i
        supervisor.step(Observation(time, Odometry(time, robot, STOP, covariance),
                                    ObjectPose(time, seen)), PERIOD)
    request = supervisor.plan_request
    assert request is not None
    return request


@pytest.mark.parametrize('reference, has_covariance, grows', [
    ('absolute', True, False), ('absolute', False, True), ('drifting', True, True)])
def test_a_place_that_is_measured_does_not_get_uncertain(reference, has_covariance, grows):
    """A request says how the place gets uncertain on the way, which is where odometry drifts."""
    request = requested(reference, has_covariance=has_covariance)
    assert 0.0 < request.robot_deviation <= NOISE
    assert (request.odometry_slope > 0.0) == (request.odometry_drift > 0.0) == grows


@pytest.mark.slow
def test_a_robot_that_knows_its_place_gets_through_a_door_far_away():
    """Where its place is measured."""
    # A wall between robot and object, with a door at its end.
    floor = walled_room((-2.4, 3.0, -0.1, 0.1))
    plan = plan_push_in_map(requested('absolute', has_covariance=True), ROBOT, PlannerSettings(),
                            DriveSettings(), floor)
    assert plan.first.approach_path.length > 7.0
