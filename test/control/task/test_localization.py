"""Localization of the robot: drift of its odometry, and measured errors of its pose."""

import math

import numpy as np
from push_control.task.localization import RobotLocalization
from push_control.task.settings import SupervisionSettings
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import Odometry, STOP
from push_sim_node.sensors import OdometrySensor, SensorSettings
import pytest

SUPERVISION = SupervisionSettings()


def driven(seed, settings, contacts):
    """Drive a robot round a square of 1 m; return its true pose and the localization."""
    sensors = SensorSettings(odometry_scale_noise=settings.odometry_scale,
                             odometry_heading_drift_noise=settings.odometry_drift)
    rng, true = np.random.default_rng(seed), Pose(0.3, 0.2, 0.4)
    odometry = OdometrySensor(sensors, true, rng, rng, rng)
    localization = RobotLocalization(settings)
    localization.predict(odometry.measure(0.0, true, STOP))
    for i in range(1, 401):
        turn = 0.5 * math.pi / 20 if i % 100 >= 80 else 0.0
        true = true @ Pose(0.0 if turn else 0.0125, 0.0, turn)
        localization.predict(odometry.measure(0.02 * i, true, STOP))
        if contacts and i % 50 == 0:
            normal, believed = 0.02 * i, localization.pose
            gap = ((true.x - believed.x) * math.cos(normal)
                   + (true.y - believed.y) * math.sin(normal))
            localization.update_along(normal, gap + rng.normal(0.0, 0.003), 0.003)
    return true, localization


@pytest.mark.parametrize('contacts', [False, True])
def test_errors_spread_as_their_standard_deviations(contacts):
    """Over many runs; with contacts they are a fifth of those without."""
    settings = SupervisionSettings(odometry_walk=0.0, odometry_heading_walk=0.0)
    errors, scores = [], []
    for seed in range(150):
        true, localization = driven(seed, settings, contacts)
        error = np.subtract(localization.pose, true)
        error[2] = wrap_angle(error[2])
        errors.append(math.hypot(*error[:2]))
        scores.append(error / localization.standard_deviations)
    assert np.mean(np.square(scores), axis=0) == pytest.approx([1.0] * 3, abs=0.4)
    assert np.median(errors) < 0.005 if contacts else np.median(errors) > 0.025


def test_a_robot_that_was_carried_off_is_found_again():
    """An error far beyond all drift is used as it is, not averaged with a pose that is gone."""
    _, localization = driven(1, SUPERVISION, contacts=True)
    before = localization.pose
    localization.update_pose((1.0, -0.5, 0.8), np.diag(np.square((0.01, 0.01, 0.03))))
    assert np.subtract(localization.pose, before) == pytest.approx((1.0, -0.5, 0.8), abs=0.02)


def test_an_unlikely_contact_is_rejected_unless_certain():
    """A gap that no drift explains is that of an object that was carried off."""
    for certain in (False, True):
        _, localization = driven(1, SUPERVISION, contacts=True)
        before = localization.pose
        localization.update_along(0.5, 0.2, 0.005, certain)
        moved = distance(localization.pose, before)
        assert moved == pytest.approx(0.2, abs=0.01) if certain else moved == 0.0
    localization.inflate_covariance(0.1)
    assert min(localization.standard_deviations[:2]) >= 0.1


def test_former_poses_are_interpolated():
    """Poses between two odometries are between them, also across the seam of angles."""
    localization = RobotLocalization(SUPERVISION)
    localization.predict(Odometry(0.0, Pose(0.0, 0.0, math.pi - 0.1), STOP))
    localization.predict(Odometry(0.1, Pose(-0.1, 0.0, -math.pi + 0.1), STOP))
    halfway = localization.pose_at(0.05)
    assert halfway[:2] == pytest.approx((-0.05, 0.0))
    assert abs(wrap_angle(halfway.theta)) == pytest.approx(math.pi)
    assert localization.pose_at(9.0) == localization.pose


def localized(pose, deviation):
    """Localize a robot as well along x as along y."""
    localization = RobotLocalization(SUPERVISION)
    localization.predict(Odometry(0.0, pose, STOP))
    localization.inflate_covariance(deviation)
    return localization


@pytest.mark.parametrize('direction', [-2.0, 0.0, 0.7])
def test_an_error_along_a_line_moves_the_robot_along_it(direction):
    """Where it is known as well to all sides, and then only there better than before."""
    localization, here = localized(Pose(1.0, 2.0, 0.3), 0.05), Pose(1.0, 2.0, 0.3)
    localization.update_along(direction, 0.06, 0.001)
    change = np.subtract(localization.pose, here)
    along = np.array((math.cos(direction), math.sin(direction), 0.0))
    assert change == pytest.approx(0.06 * along, abs=1e-4)
    assert localization.standard_deviations[:2] == pytest.approx(
        0.05 * np.abs(along[1::-1]), abs=2e-3)


def test_an_uncertain_pose_is_used_only_where_it_is_likely():
    """An outlier moves nothing; where it is likely, certainty does not matter."""
    noise = np.diag(np.square((0.01, 0.01, 0.02)))
    for error, used in (((0.05, -0.04, 0.02), (True, True)), ((0.5, 0.9, 1.0), (True, False))):
        found = [localized(Pose(1.0, 2.0, 0.3), 0.05) for _ in used]
        for localization, certain in zip(found, (True, False)):
            localization.update_pose(error, noise, certain)
        moved = [distance(localization.pose, (1.0, 2.0)) for localization in found]
        assert [shift > 0.04 for shift in moved] == list(used)
        assert moved[1] == (moved[0] if used[1] else 0.0)
        assert found[1].standard_deviations[0] < 0.011 or not used[1]
