"""Where the robot stands: drift of odometry, and what touches and moved objects tell of it."""

import math

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.observation import Observation
from push_control.settings import ControlSettings
from push_control.task.localization import RobotLocalization
from push_control.task.perception import TaskPerception
from push_control.task.settings import SupervisionSettings
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, STOP
from push_sim_node.sensors import OdometrySensor, SensorSettings
import pytest

HOME, SUPERVISION = Pose(0.0, 0.0, 0.0), SupervisionSettings()


def driven(seed, settings, touches):
    """Drive a robot round a square of 1 m; return its true pose and what is made of odometry."""
    sensors = SensorSettings(odometry_scale_noise=settings.odometry_scale,
                             odometry_heading_drift_noise=settings.odometry_drift)
    rng, true = np.random.default_rng(seed), Pose(0.3, 0.2, 0.4)
    odometry, localization = OdometrySensor(sensors, true, rng, rng), RobotLocalization(settings)
    localization.predict(odometry.measure(0.0, true, STOP))
    for i in range(1, 401):
        turn = 0.5 * math.pi / 20 if i % 100 >= 80 else 0.0
        true = true @ Pose(0.0 if turn else 0.0125, 0.0, turn)
        localization.predict(odometry.measure(0.02 * i, true, STOP))
        if touches and i % 50 == 0:
            normal, believed = 0.02 * i, localization.pose
            gap = ((true.x - believed.x) * math.cos(normal)
                   + (true.y - believed.y) * math.sin(normal))
            localization.update_along(normal, gap + rng.normal(0.0, 0.003), 0.003)
    return true, localization


@pytest.mark.parametrize('touches', [False, True])
def test_the_robot_is_where_it_is_placed_within_what_is_said(touches):
    """Errors over many runs spread as told; with touches they are a fifth of those without."""
    settings = SupervisionSettings(odometry_walk=0.0, odometry_heading_walk=0.0)
    errors, scores = [], []
    for seed in range(150):
        true, localization = driven(seed, settings, touches)
        error = np.subtract(localization.pose, true)
        error[2] = wrap_angle(error[2])
        errors.append(math.hypot(*error[:2]))
        scores.append(error / localization.standard_deviations)
    assert np.mean(np.square(scores), axis=0) == pytest.approx([1.0] * 3, abs=0.4)
    assert np.median(errors) < 0.005 if touches else np.median(errors) > 0.025


def test_a_robot_that_was_carried_off_is_found_again():
    """An error far beyond all drift is taken as it is, not averaged with a pose that is gone."""
    _, localization = driven(1, SUPERVISION, touches=True)
    before = localization.pose
    localization.update_pose((1.0, -0.5, 0.8), np.diag(np.square((0.01, 0.01, 0.03))))
    assert np.subtract(localization.pose, before) == pytest.approx((1.0, -0.5, 0.8), abs=0.02)


def test_a_touch_that_cannot_be_is_not_learnt_from():
    """A gap that no drift explains is of an object that was carried off, unless it is sure."""
    for sure in (False, True):
        _, localization = driven(1, SUPERVISION, touches=True)
        before = localization.pose
        localization.update_along(0.5, 0.2, 0.005, sure)
        moved = distance(localization.pose, before)
        assert moved == pytest.approx(0.2, abs=0.01) if sure else moved == 0.0
    localization.inflate_covariance(0.1)
    assert min(localization.standard_deviations[:2]) >= 0.1


def test_where_the_robot_was_lies_on_its_way():
    """Poses between two odometries are between them, also across the seam of angles."""
    localization = RobotLocalization(SUPERVISION)
    localization.predict(Odometry(0.0, Pose(0.0, 0.0, math.pi - 0.1), STOP))
    localization.predict(Odometry(0.1, Pose(-0.1, 0.0, -math.pi + 0.1), STOP))
    halfway = localization.pose_at(0.05)
    assert halfway[:2] == pytest.approx((-0.05, 0.0))
    assert abs(wrap_angle(halfway.theta)) == pytest.approx(math.pi)
    assert localization.pose_at(9.0) == localization.pose


def corrected_observation(pose, deviation):
    """Know the robot as well along x as along y."""
    localization = RobotLocalization(SUPERVISION)
    localization.predict(Odometry(0.0, pose, STOP))
    localization.inflate_covariance(deviation)
    return localization


@pytest.mark.parametrize('direction', [-2.0, 0.0, 0.7])
def test_what_is_told_along_a_line_moves_the_robot_along_it(direction):
    """Where it is known as well to all sides, and then only there better than before."""
    localization, here = corrected_observation(Pose(1.0, 2.0, 0.3), 0.05), Pose(1.0, 2.0, 0.3)
    localization.update_along(direction, 0.06, 0.001)
    change = np.subtract(localization.pose, here)
    along = np.array((math.cos(direction), math.sin(direction), 0.0))
    assert change == pytest.approx(0.06 * along, abs=1e-4)
    assert localization.standard_deviations[:2] == pytest.approx(0.05 * np.abs(along[1::-1]), abs=2e-3)


def test_a_place_that_is_not_sure_is_taken_only_if_it_may_be():
    """An odd one moves nothing; where it is likely, being sure does not matter."""
    noise = np.diag(np.square((0.01, 0.01, 0.02)))
    for error, taken in (((0.05, -0.04, 0.02), (True, True)), ((0.5, 0.9, 1.0), (True, False))):
        found = [corrected_observation(Pose(1.0, 2.0, 0.3), 0.05) for _ in taken]
        for localization, sure in zip(found, (True, False)):
            localization.update_pose(error, noise, sure)
        moved = [distance(localization.pose, (1.0, 2.0)) for localization in found]
        assert [way > 0.04 for way in moved] == list(taken)
        assert moved[1] == (moved[0] if taken[1] else 0.0)
        assert found[1].standard_deviations[0] < 0.011 or not taken[1]


def seen(robot_pose, object_pose, deviation):
    """Look at robot and object at rest for half a second."""
    perception = TaskPerception(ControlSettings(), SUPERVISION)
    for time in np.arange(11) * 0.05:
        perception.update(Observation(time, Odometry(time, robot_pose, STOP),
                                    ObjectPose(time, object_pose)))
    perception.localization.inflate_covariance(deviation)
    return perception


@pytest.mark.parametrize('deviation', [0.01, 0.1])
@pytest.mark.parametrize('obj', [box(), bin_()])
def test_a_robot_does_not_stand_inside_the_object(obj, deviation):
    """It is placed beside it, the nearest way; one that is clear of it is left alone."""
    inside, clear = (seen(Pose(x, 0.04, 1.0), HOME, deviation) for x in (-0.31, -0.40))
    for perception in (inside, clear):
        perception.correct_overlap(obj, HOLONOMIC, 0.001)
    assert abs(inside.gap(obj, HOLONOMIC)) < 2e-3
    assert 0.03 < distance(inside.robot_pose, (-0.31, 0.04)) < 0.07
    assert clear.robot_pose == Pose(-0.40, 0.04, 1.0)


@pytest.mark.parametrize('angle', [0.0, 0.4, 2.0, -2.9])
def test_what_moves_an_object_twice_is_the_robot_behind_it(angle):
    """The first time it may be somebody else, and again after a push that went well."""
    pose = Pose(0.06 * math.cos(angle), 0.06 * math.sin(angle), 0.25)
    believed = Pose(1.6 * math.cos(angle + 2.0), 1.6 * math.sin(angle + 2.0), 0.5)
    perception = seen(believed, pose, 0.01)
    for moves in (1, 1, 2):
        if moves == 1:
            perception.on_push_succeeded()
        assert perception.robot_pose == believed
        perception.on_object_moved(box(), HOLONOMIC, HOME)
    back = Pose(0.0, 0.0, -angle).rotate(np.subtract(perception.robot_pose, pose)[:2])
    assert back[0] < -0.3 and abs(back[1]) < 0.02
    assert abs(perception.gap(box(), HOLONOMIC)) < 0.02
