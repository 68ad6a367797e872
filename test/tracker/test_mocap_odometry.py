"""Odometry from motion capture: exact for constant motion, and robust against what occurs."""

import dataclasses
import math

import numpy as np
from push_model.geometry import Pose
from push_tracker.mocap_odometry import MocapOdometry
from push_tracker.mocap_settings import MocapSettings
import pytest

PERIOD = 0.01
SETTINGS = MocapSettings()


def follow(motion, settings=SETTINGS, count=40, noise=None):
    """Take in poses of a rigid body; return odometry of each."""
    odometry = MocapOdometry(settings)
    results = []
    for k in range(count):
        pose = motion(k * PERIOD) @ settings.mounting
        if noise is not None:
            pose = Pose(*np.add(pose, noise[k]))
        results.append(odometry.update(k * PERIOD, pose))
    return results


def on_arc(v, omega, start=Pose(0.3, -0.2, 3.0)):
    """Drive an arc with constant velocities."""
    def motion(time):
        angle = omega * time
        x, y = ((v * time, 0.0) if omega == 0.0 else
                (v / omega * math.sin(angle), v / omega * (1.0 - math.cos(angle))))
        return start @ Pose(x, y, angle)
    return motion


@pytest.mark.parametrize('mounting', [{}, {'x': -0.05, 'y': 0.1, 'yaw': 2.0}])
def test_the_pose_is_that_of_the_robot_and_the_velocity_of_a_straight_line_is_exact(mounting):
    motion = on_arc(0.25, 0.0)
    results = follow(motion, dataclasses.replace(SETTINGS, **mounting))
    assert results[0] is None
    for k, odometry in enumerate(results[1:], 1):
        assert odometry.pose == pytest.approx(motion(k * PERIOD), abs=1e-12)
        assert odometry.twist == pytest.approx((0.25, 0.0, 0.0), abs=1e-12)


def test_on_an_arc_the_speed_is_less_by_the_square_of_the_angle_in_the_window():
    """The error is (omega T)^2 / 40 of the speed, whatever the rotation is wrapped to."""
    v, omega = 0.3, 1.5
    errors = []
    for window in (0.1, 0.2):
        settings = dataclasses.replace(SETTINGS, window=window)
        twist = follow(on_arc(v, omega), settings, count=60)[-1].twist
        assert twist.omega == pytest.approx(omega, rel=1e-9)
        assert twist.v_y == pytest.approx(0.0, abs=1e-9)
        errors.append(1.0 - twist.v_x / v)
    assert errors[1] / errors[0] == pytest.approx(4.0, rel=0.15)
    assert errors[1] == pytest.approx((omega * 0.2) ** 2 / 40.0, rel=0.2)


def test_a_mounted_body_that_swings_round_does_not_move_the_robot():
    settings = dataclasses.replace(SETTINGS, x=0.2, y=-0.1, yaw=1.0)
    for odometry in follow(on_arc(0.0, 1.0), settings)[2:]:
        assert odometry.pose[:2] == pytest.approx((0.3, -0.2), abs=1e-12)
        assert odometry.twist == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)


def test_the_noise_of_the_velocity_is_as_stated():
    """It is sigma sqrt(12 / n) / T, within 10 %, over independent windows."""
    sigma, count = 1e-4, 11 * 400
    noise = np.random.default_rng(5).normal(0.0, sigma, (count, 3))
    results = follow(on_arc(0.0, 0.0), count=count, noise=noise)
    speeds = [odometry.twist.v_x for odometry in results[10::11]]
    assert np.std(speeds) == pytest.approx(sigma * math.sqrt(12.0 / 11) / SETTINGS.window, rel=0.1)


def test_a_body_mistaken_for_another_is_an_outlier_and_one_put_elsewhere_is_believed():
    motion, elsewhere = on_arc(0.2, 0.0), Pose(2.0, 2.0, 0.0)
    odometry = MocapOdometry(SETTINGS)
    for k in range(20):
        before = odometry.update(k * PERIOD, motion(k * PERIOD))
    for k in range(20, 20 + SETTINGS.confirmations - 1):
        assert odometry.update(k * PERIOD, elsewhere) is None
    assert odometry.outliers == SETTINGS.confirmations - 1
    # Longer ago than the window: the first pose tells no velocity.
    assert odometry.update(0.3, motion(0.3)) is None
    assert odometry.outliers == 0
    after = odometry.update(0.31, motion(0.31))
    assert after.twist == pytest.approx(before.twist, abs=1e-9)
    results = [odometry.update(k * PERIOD, elsewhere)
               for k in range(32, 33 + SETTINGS.confirmations)]
    assert results[:-1] == [None] * SETTINGS.confirmations
    assert results[-1].pose == pytest.approx(elsewhere)
    assert results[-1].twist == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_stamp_that_is_not_newer_changes_nothing():
    motion = on_arc(0.2, 0.5)
    once, twice = MocapOdometry(SETTINGS), MocapOdometry(SETTINGS)
    for k in range(20):
        first = once.update(k * PERIOD, motion(k * PERIOD))
        assert twice.update(k * PERIOD, motion(k * PERIOD)) == first
        assert twice.update(k * PERIOD, motion(9.0)) is None
        assert twice.update((k - 1) * PERIOD, motion(9.0)) is None


def test_the_covariance_is_that_of_one_pose():
    covariance = follow(on_arc(0.1, 0.1))[-1].covariance
    assert covariance.position_deviation == pytest.approx(SETTINGS.position_noise)
    assert covariance.theta_theta == pytest.approx(SETTINGS.heading_noise ** 2)
