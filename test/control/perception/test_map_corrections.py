"""Corrections of a map: motion is separated from them, and they tell as much as is true."""

import math

from helpers.objects import box
import numpy as np
from push_control.perception.localization import Localization
from push_control.perception.map_corrections import has_lasting_errors, MapCorrections
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, PoseCovariance, Twist
from push_sim_node.sensors import OdometrySensor, SensorSettings
import pytest

STD, HEADING_STD = 0.05, 0.03
COVARIANCE = PoseCovariance.from_deviations(STD, HEADING_STD)
PERIOD, SPEED, YAW_RATE = 0.05, 0.2, 0.3
JUMP_PERIOD, JUMPS = 2.0, 12


def step_of(corrections, jump):
    """Drive on by one message in which the map corrects itself by a jump."""
    twist = Twist(SPEED, 0.0, 0.0)
    before = Odometry(0.0, Pose(1.0, 2.0, 0.3), twist, COVARIANCE)
    moved = before.pose @ Pose(SPEED * PERIOD, 0.0, 0.0)
    pose = Pose(moved.x + jump.x, moved.y + jump.y, moved.theta + jump.theta)
    return corrections.step(before, Odometry(PERIOD, pose, twist, COVARIANCE), COVARIANCE)


def test_motion_that_the_twist_explains_tells_nothing_of_the_map():
    step, growth = step_of(MapCorrections(), Pose(0.0, 0.0, 0.0))
    assert math.isinf(growth)
    np.testing.assert_allclose(step, (SPEED * PERIOD, 0.0, 0.0), atol=1e-12)


@pytest.mark.parametrize('jump', [Pose(0.1, -0.05, 0.0), Pose(0.0, 0.0, 0.05)])
def test_a_correction_does_not_move_the_robot(jump):
    """It moves on as its twist says."""
    step, growth = step_of(MapCorrections(), jump)
    assert 1.0 <= growth < math.inf
    np.testing.assert_allclose(step, (SPEED * PERIOD, 0.0, 0.0), atol=1e-12)


def test_independent_errors_count_fully_and_lasting_ones_by_their_correlation():
    """With a correlation of r from one to the next: (1 + r) / (1 - r)."""
    for correlation in (0.0, 0.5, 0.9):
        rng, corrections = np.random.default_rng(7), MapCorrections()
        error, growth = rng.standard_normal(3), 0.0
        for _ in range(2000):
            following = (correlation * error
                         + math.sqrt(1.0 - correlation ** 2) * rng.standard_normal(3))
            jump = (following - error) * (STD, STD, HEADING_STD)
            _, growth = step_of(corrections, Pose(*jump.tolist()))
            error = following
        expected = (1.0 + correlation) / (1.0 - correlation)
        assert (growth if math.isfinite(growth) else expected) == pytest.approx(expected, rel=0.15)


def test_motion_capture_has_no_lasting_errors():
    assert not has_lasting_errors(None)
    assert not has_lasting_errors(PoseCovariance.from_deviations(2e-3, 2e-3))
    assert has_lasting_errors(COVARIANCE)


def normalized_errors(seed):
    """Drive a circle in a map that jumps; return errors over their deviations, and the errors."""
    sensors = SensorSettings(
        odometry_reference='absolute', odometry_position_noise=1e-3,
        odometry_heading_noise=1e-3, odometry_jump=STD, odometry_heading_jump=HEADING_STD,
        odometry_jump_period=JUMP_PERIOD)
    sensor = OdometrySensor(sensors, Pose(0.0, 0.0, 0.0),
                            *(np.random.default_rng((seed, k)) for k in range(3)))
    localization = Localization(box(), RoundRobot(radius=0.17), ControlSettings(),
                                SupervisionSettings(odometry_reference='absolute'))
    radius, true = SPEED / YAW_RATE, Pose(0.0, 0.0, 0.0)
    for i in range(round(JUMPS * JUMP_PERIOD / PERIOD)):
        angle = YAW_RATE * PERIOD * i
        true = Pose(radius * math.sin(angle), radius * (1.0 - math.cos(angle)), angle)
        odometry = sensor.measure(PERIOD * i, true, Twist(SPEED, 0.0, YAW_RATE))
        localization.move(odometry)
        localization.correct_by(odometry)
    x, y, theta = localization.pose
    errors = np.array((x - true.x, y - true.y, wrap_angle(theta - true.theta)))
    return errors / localization.standard_deviations, errors


def test_a_robot_in_a_map_that_jumps_is_known_as_well_as_it_is():
    """Better than by one correction, and no better than is true."""
    normalized, errors = map(np.array, zip(*map(normalized_errors, range(16))))
    assert 0.4 < (normalized ** 2).mean() < 1.6
    assert ((errors ** 2).mean(axis=0) < np.array((STD, STD, HEADING_STD)) ** 2 / 3.0).all()


@pytest.mark.parametrize('std, gap, is_learned', [(0.07, 0.05, False), (0.01, -0.01, True)])
def test_an_object_that_a_robot_may_have_passed_by_is_not_slippery(std, gap, is_learned):
    """It does not move where some members touch it: that tells of the robot, not of friction."""
    covariance = PoseCovariance.from_deviations(std, 0.02)
    robot, obj = RoundRobot(radius=0.17), box()
    localization = Localization(obj, robot, ControlSettings(),
                                SupervisionSettings(odometry_reference='absolute'))
    side = min(y for _, y in obj.outline) - robot.radius - gap
    frictions = []
    for i in range(120):
        pose = Pose(-0.6 + SPEED * PERIOD * i, side, 0.0)
        localization.move(Odometry(PERIOD * i, pose, Twist(SPEED, 0.0, 0.0), covariance))
        localization.update(ObjectPose(PERIOD * i, Pose(0.0, 0.0, 0.0)))
        frictions.append(localization.knowledge.contact_friction)
    assert (abs(frictions[-1] - frictions[0]) > 0.02 * frictions[0]) is is_learned
