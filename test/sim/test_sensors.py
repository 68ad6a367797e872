"""Statistics and independence of the simulated measurements."""

import dataclasses
import math

import numpy as np
from push_model.geometry import Pose
from push_model.signals import PoseCovariance, Twist
from push_sim_node.sensors import (
    MIN_DEVIATION, OdometrySensor, PoseSensor, SensorSettings, Sighting, ViewBias,
)
import pytest

TRUE = Pose(1.0, -2.0, 3.0)


def measured(settings, count=4000, seeds=(1, 2, 3), bearing=0.0):
    """Measure one pose many times, at 10 Hz."""
    sensor = PoseSensor(settings, *(np.random.default_rng(seed) for seed in seeds))
    return [sensor.measure(0.1 * i, TRUE, Sighting(bearing)) for i in range(count)]


def odometer(settings, pose=Pose(0.0, 0.0, 0.0), seed=1):
    """Return an odometry sensor."""
    return OdometrySensor(settings, pose, np.random.default_rng(seed), np.random.default_rng(9),
                          np.random.default_rng(10))


def travelled(settings, twist, seconds=2.0, seed=1):
    """Drive along an arc and return the last odometry and the true pose."""
    sensor, pose = odometer(settings, seed=seed), Pose(0.0, 0.0, 0.0)
    for i in range(1, 101):
        time = seconds * i / 100
        rotation = twist.omega * time
        along, across = 1.0, 0.0
        if rotation:
            along = math.sin(rotation) / rotation
            across = (1.0 - math.cos(rotation)) / rotation
        pose = Pose(twist.v_x * time * along, twist.v_x * time * across, rotation)
        odometry = sensor.measure(time, pose, twist)
    return odometry, pose


def test_perfect_sensors_tell_the_truth():
    assert all(pose.pose == pytest.approx(TRUE) for pose in measured(SensorSettings(), 10))
    odometry, pose = travelled(SensorSettings(), Twist(0.3, 0.0, 0.9))
    assert odometry.pose == pytest.approx(pose, abs=1e-12)
    assert odometry.twist == pytest.approx((0.3, 0.0, 0.9))


def test_pose_noise_has_its_deviation_and_no_bias():
    settings = SensorSettings(pose_noise=2e-3, pose_heading_noise=5e-3)
    errors = np.array([pose.pose for pose in measured(settings)]) - TRUE
    spread = np.array([2e-3, 2e-3, 5e-3])
    assert errors.std(axis=0) == pytest.approx(spread, rel=0.05)
    assert (np.abs(errors.mean(axis=0)) < 4.0 * spread / math.sqrt(4000)).all()
    assert np.abs(np.corrcoef(errors.T) - np.eye(3)).max() < 0.08


def test_poses_are_dropped_at_random_and_in_intervals():
    settings = SensorSettings(pose_drop_probability=0.2, pose_dropouts=[[5.0, 6.0], [8.0, 8.5]])
    poses = measured(settings)
    lost = [0.1 * i for i, pose in enumerate(poses) if pose is None]
    assert all(any(t == 0.1 * i for t in lost) for i in (*range(50, 60), *range(80, 85)))
    assert np.mean([pose is None for pose in poses[100:]]) == pytest.approx(0.2, abs=0.02)


def test_losses_leave_the_noise_of_other_measurements_alone():
    noisy = SensorSettings(pose_noise=1e-3)
    lossy = dataclasses.replace(noisy, pose_drop_probability=0.5, pose_dropouts=((1.0, 2.0),))
    for one, other in zip(measured(noisy, 200), measured(lossy, 200)):
        assert other is None or other == one


def test_the_view_bias_is_systematic_bounded_and_averages_out():
    """Two poses from one side agree; over all sides nothing is left; it turns with the object."""
    settings = SensorSettings(pose_bias=0.03, pose_heading_bias=0.02)
    bearings = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    for seed in range(20):
        bias = ViewBias(settings, np.random.default_rng(seed))
        errors = np.array([bias.error(bearing) for bearing in bearings])
        assert np.hypot(*errors[:, :2].T).max() <= 0.03
        assert np.abs(errors[:, 2]).max() <= 0.02
        assert np.abs(errors.mean(axis=0)).max() < 1e-12
        assert np.sqrt(np.mean(errors[:, 0] ** 2 + errors[:, 1] ** 2)) == pytest.approx(0.015)
        # One degree further on it is nearly the same.
        assert np.abs(np.diff(errors[:, :2], axis=0)).max() < 1.5 * 0.03 * math.radians(1.0)
    poses = {pose.pose for pose in measured(settings, 50, bearing=0.7)}
    assert len(poses) == 1 and poses != {TRUE}
    turned = PoseSensor(settings, *(np.random.default_rng(seed) for seed in (1, 2, 3))).measure(
        0.0, Pose(0.0, 0.0, 0.0), Sighting(0.7)).pose
    assert TRUE.inverse() @ poses.pop() == pytest.approx(turned, abs=1e-12)


def test_some_poses_jump():
    """As often and as far as stated; the others, and the noise, are as without jumps."""
    noisy = SensorSettings(pose_noise=1e-4)
    jumping = dataclasses.replace(noisy, pose_jump_probability=0.1, pose_jump=0.05,
                                  pose_heading_jump=0.2)
    errors = np.array([np.subtract(pose.pose, other.pose)
                       for pose, other in zip(measured(jumping), measured(noisy))])
    errors[:, 2] = np.arctan2(np.sin(errors[:, 2]), np.cos(errors[:, 2]))
    jumps = errors[np.abs(errors).max(axis=1) > 0.0]
    assert len(jumps) / len(errors) == pytest.approx(0.1, abs=0.015)
    assert jumps.std(axis=0) == pytest.approx([0.05, 0.05, 0.2], rel=0.12)
    assert np.abs(jumps.mean(axis=0)).max() < 0.04


def test_headings_are_wrapped():
    rotated = Pose(0.0, 0.0, 100.0)
    sensor = PoseSensor(SensorSettings(), *(np.random.default_rng(seed) for seed in range(3)))
    measured_heading = sensor.measure(0.0, rotated).pose.theta
    assert measured_heading == pytest.approx(math.remainder(100.0, math.tau))
    heading = odometer(SensorSettings(), rotated).measure(0.0, rotated, Twist()).pose.theta
    assert heading == pytest.approx(math.remainder(100.0, math.tau))


def test_scale_error_stretches_the_path():
    odometry, pose = travelled(SensorSettings(odometry_scale=0.02), Twist(0.3, 0.0, 0.0))
    assert odometry.pose == pytest.approx((1.02 * pose.x, 0.0, 0.0))
    assert odometry.twist.v_x == pytest.approx(1.02 * 0.3)


def test_yaw_scale_error_stretches_the_rotation():
    odometry, pose = travelled(SensorSettings(odometry_yaw_scale=0.05), Twist(0.0, 0.0, 0.9))
    assert odometry.pose == pytest.approx((0.0, 0.0, 1.05 * 1.8))


@pytest.mark.parametrize('speed', [0.3, -0.3])
def test_heading_drifts_with_the_distance(speed):
    odometry, pose = travelled(SensorSettings(odometry_heading_drift=0.05), Twist(speed, 0.0, 0.0))
    assert odometry.pose.theta == pytest.approx(0.05 * 0.6)
    assert math.hypot(pose.x - odometry.pose.x, pose.y - odometry.pose.y) == pytest.approx(
        0.5 * 0.05 * 0.6 ** 2, rel=1e-3)
    assert odometry.twist.omega == pytest.approx(0.05 * 0.3)


def test_random_errors_stay_for_a_run_and_vary_from_run_to_run():
    settings = SensorSettings(odometry_scale_noise=0.02, odometry_heading_drift_noise=0.03)
    runs = [travelled(settings, Twist(0.5, 0.0, 0.0), seed=seed)[0] for seed in range(300)]
    scales = np.array([run.twist.v_x / 0.5 - 1.0 for run in runs])
    drifts = np.array([run.pose.theta for run in runs])
    assert scales.std() == pytest.approx(0.02, rel=0.15)
    assert drifts.std() == pytest.approx(0.03, rel=0.15)
    assert abs(scales.mean()) < 0.005 and abs(drifts.mean()) < 0.007


def test_heading_offset_turns_the_whole_course():
    odometry, pose = travelled(SensorSettings(odometry_heading_offset=0.1), Twist(0.3, 0.0, 0.9))
    assert odometry.pose == pytest.approx(Pose(0.0, 0.0, 0.1) @ pose)


def test_velocity_noise():
    settings = SensorSettings(odometry_speed_noise=0.01, odometry_yaw_rate_noise=0.02)
    sensor = odometer(settings)
    twists = np.array([sensor.measure(i, Pose(0.0, 0.0, 0.0), Twist(0.2, 0.0, 0.5)).twist
                       for i in range(3000)])
    assert twists.std(axis=0) == pytest.approx([0.01, 0.01, 0.02], rel=0.06)
    assert twists.mean(axis=0) == pytest.approx([0.2, 0.0, 0.5], abs=2e-3)


def test_absolute_odometry_does_not_drift_and_states_its_noise():
    """However far the robot has gone; its velocity has the errors that it has anyway."""
    drifting = SensorSettings(odometry_scale=0.05, odometry_heading_drift=0.1,
                              odometry_speed_noise=0.01)
    absolute = dataclasses.replace(drifting, odometry_reference='absolute',
                                   odometry_position_noise=2e-3, odometry_heading_noise=5e-3)
    before, sensor = odometer(drifting), odometer(absolute)
    errors, covariances = [], set()
    for i in range(3000):
        pose, twist = Pose(0.01 * i, -0.02 * i, 0.03 * i), Twist(0.3, 0.0, 0.2)
        odometry = sensor.measure(0.1 * i, pose, twist)
        assert odometry.twist == before.measure(0.1 * i, pose, twist).twist
        errors.append((odometry.pose.x - pose.x, odometry.pose.y - pose.y,
                       math.remainder(odometry.pose.theta - pose.theta, math.tau)))
        covariances.add(odometry.covariance)
    covariance, = covariances
    assert np.cov(np.array(errors).T) == pytest.approx(covariance.matrix, rel=0.1, abs=1e-6)
    assert np.abs(np.mean(errors, axis=0)).max() < 4.0 * 5e-3 / math.sqrt(3000)


def test_drifting_odometry_states_the_covariance_of_what_it_sums_up():
    """That of many runs, along an arc; at first, and without errors, what encoders resolve."""
    settings = SensorSettings(odometry_scale_noise=0.03, odometry_heading_drift_noise=0.02)
    runs = [travelled(settings, Twist(0.3, 0.0, 0.9), seed=seed) for seed in range(300)]
    errors = np.array([odometry.pose for odometry, _ in runs]) - runs[0][1]
    stated = runs[0][0].covariance.matrix
    deviations = np.sqrt(np.diag(stated))
    assert errors.std(axis=0) == pytest.approx(deviations, rel=0.15)
    correlation = stated / np.outer(deviations, deviations)
    assert np.corrcoef(errors.T) == pytest.approx(correlation, abs=0.2)
    least = PoseCovariance.from_deviations(MIN_DEVIATION, MIN_DEVIATION)
    assert travelled(SensorSettings(), Twist(0.3, 0.0, 0.9))[0].covariance == least
    first = odometer(settings).measure(0.0, Pose(0.0, 0.0, 0.0), Twist())
    assert first.covariance == least


def test_fixed_errors_of_odometry_are_covered_by_what_it_states():
    """Yaw scale and offset as well; each error is about one standard deviation."""
    for name, value in (('odometry_scale', 0.02), ('odometry_yaw_scale', 0.05),
                        ('odometry_heading_drift', 0.03), ('odometry_heading_offset', 0.04)):
        odometry, pose = travelled(SensorSettings(**{name: value}), Twist(0.3, 0.0, 0.9))
        error = np.array(odometry.pose) - pose
        variance = error @ np.linalg.solve(odometry.covariance.matrix, error)
        assert 0.9 < math.sqrt(variance) < 1.5, name


@pytest.mark.parametrize('intervals', [((2.0, 1.0),), ((1.0,),), (1.0, 2.0)])
def test_malformed_intervals_are_refused(intervals):
    with pytest.raises(ValueError, match='pose_dropouts'):
        SensorSettings(pose_dropouts=intervals)


@pytest.mark.parametrize('reference', ['drifting', 'absolute'])
def test_odometry_is_rounded_to_its_steps_and_no_further(reference):
    """Every coordinate is a multiple, half a step off at most; errors do not add up."""
    exact = SensorSettings(odometry_reference=reference, odometry_scale=0.02)
    coarse = dataclasses.replace(exact, odometry_step=0.005, odometry_angle_step=0.02)
    steps = np.array([0.005, 0.005, 0.02])
    offsets = []
    for speed in np.linspace(0.03, 0.6, 40):
        twist = Twist(speed, 0.0, 0.9)
        rounded, plain = (np.array(travelled(each, twist)[0].pose) for each in (coarse, exact))
        assert np.abs(rounded / steps - np.round(rounded / steps)).max() < 1e-9
        offsets.append(np.abs(rounded - plain) / steps)
    assert 0.45 < np.max(offsets) <= 0.5 + 1e-9


def test_steps_of_odometry_leave_its_velocity_alone():
    settings = SensorSettings(odometry_step=0.01, odometry_angle_step=0.1)
    twist = Twist(0.123, 0.0, 0.77)
    assert travelled(settings, twist)[0].twist == travelled(SensorSettings(), twist)[0].twist


def test_absolute_odometry_jumps_and_states_so():
    """At stated times, by errors that are drawn anew each time; in between it only has noise."""
    settings = SensorSettings(odometry_reference='absolute', odometry_jump=0.05,
                              odometry_heading_jump=0.02, odometry_jump_period=2.0)
    sensor = odometer(settings)
    pose = Pose(3.0, -1.0, 0.7)
    measured_poses = [sensor.measure(2.0 * i + 1.0, pose, Twist()) for i in range(1500)]
    errors = np.array([odometry.pose for odometry in measured_poses]) - pose
    assert errors.std(axis=0) == pytest.approx([0.05, 0.05, 0.02], rel=0.08)
    assert np.abs(np.corrcoef(errors[:-1].T, errors[1:].T)[:3, 3:]).max() < 0.1
    stated = measured_poses[0].covariance.matrix
    assert np.cov(errors.T) == pytest.approx(stated, rel=0.15, abs=2e-4)
    steady = odometer(settings)
    within = [steady.measure(4.0 + 0.02 * i, pose, Twist()).pose for i in range(90)]
    assert np.std(within, axis=0) == pytest.approx([1e-3, 1e-3, 2e-3], rel=0.3)


def test_before_the_first_jump_absolute_odometry_is_as_without():
    plain, jumping = (odometer(SensorSettings(odometry_reference='absolute', odometry_jump=jump,
                                              odometry_jump_period=2.0)) for jump in (0.0, 0.1))
    for i in range(99):
        one, other = (each.measure(0.02 * i, TRUE, Twist()) for each in (plain, jumping))
        assert one.pose == other.pose and one.twist == other.twist


@pytest.mark.parametrize('flip', ['half_turn', 'mirrored_tilt'])
def test_flips_come_as_often_as_stated_and_leave_other_poses_alone(flip):
    sighting = Sighting(flip=Pose(0.01, 0.02, 0.6))
    turned = TRUE @ (Pose(0.0, 0.0, math.pi) if flip == 'half_turn' else sighting.flip)
    noisy = SensorSettings(pose_noise=1e-4)
    flipping = dataclasses.replace(noisy, pose_flip_probability=0.2, pose_flip=flip)
    sensors = [PoseSensor(settings, *(np.random.default_rng(seed) for seed in (1, 2, 3)))
               for settings in (noisy, flipping)]
    count = 0
    for i in range(2000):
        plain, flipped = (sensor.measure(0.1 * i, TRUE, sighting).pose for sensor in sensors)
        if flipped != plain:
            count += 1
            error = np.subtract(flipped, turned)
            error[2] = math.remainder(error[2], math.tau)
            assert np.abs(error - np.subtract(plain, TRUE)).max() < 1e-9
    assert count / 2000 == pytest.approx(0.2, abs=0.03)
