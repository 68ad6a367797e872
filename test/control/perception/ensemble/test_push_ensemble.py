"""The ensemble filter: what pushes, touches and poses of the object tell, and what not."""

import functools
import math

from helpers.ensemble_runs import (
    CONTROL, HOME, mirrored, NO_NOISE, NOISE, ONE_PUSH, ROBOT, run, START, TWO_PUSHES,
)
from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.measurement_update import LOST_STDS, MAX_OUTLIERS, MIN_STDS
from push_control.perception.ensemble.pose_history import HISTORY_TIME
from push_control.perception.ensemble.prediction import START_HEADING_STD, START_POSITION_STD
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_sim_node.sensors import SensorSettings
import pytest

DRIFTING = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                          pose_latency=0.08, odometry_scale_noise=0.02,
                          odometry_heading_drift_noise=0.02)
# Errors at which odometry alone is a decimetre off after a few metres.
WORSE = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08,
                       odometry_scale_noise=0.04, odometry_heading_drift_noise=0.04)
WORSE_NOISE = NOISE._replace(scale=0.04, drift=0.04)
SEEDS = range(6)
STEP = 0.05
AWAY = Pose(1.5, -0.8, 2.0)


@functools.lru_cache(maxsize=None)
def drifted(seed):
    """Push at two faces with odometry that drifts."""
    return run(TWO_PUSHES, box(friction=(0.25, 0.35, 0.3, 0.3)), sensors=WORSE,
               noise=WORSE_NOISE, seed=seed)


def resting(noise=NOISE, poses=20):
    """Return an ensemble that sees robot and object at rest for a while, and the time."""
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, noise)
    rng = np.random.default_rng(5)
    for k in range(poses):
        ensemble.predict(Odometry(k * STEP, AWAY, STOP))
        error = rng.standard_normal(3) * (2e-3, 2e-3, 5e-3)
        ensemble.update(ObjectPose(k * STEP, Pose(*error)))
    return ensemble, poses * STEP


@pytest.mark.parametrize('heading', [0.0, math.pi])
def test_an_object_at_rest_is_known_as_well_at_any_heading(heading: float) -> None:
    """No pose is an outlier, and no average is surer than the poses of a tracker allow."""
    ensemble, rng = PushEnsemble(box(), ROBOT, CONTROL, NOISE), np.random.default_rng(5)
    for k in range(300):
        x, y, error = (rng.standard_normal(3) * (2e-3, 2e-3, 5e-3)).tolist()
        ensemble.predict(Odometry(k * STEP, AWAY, STOP))
        assert ensemble.update(ObjectPose(k * STEP, Pose(x, y, wrap_angle(heading + error))))
    assert np.all(ensemble.object_deviations > 0.5 * np.array(MIN_STDS))


def drive_ahead(ensemble, start, time, distance, steps=20):
    """Let odometry tell of a straight path; return the last pose and the time."""
    pose = start
    for k in range(steps):
        time += STEP
        pose = start @ Pose(distance * (k + 1) / steps, 0.0, 0.0)
        ensemble.predict(Odometry(time, pose, STOP))
    return pose, time


def test_without_errors_the_estimate_stays_at_the_truth():
    """Neither contacts nor corrections lead it away by more than it began with."""
    outcome = run(TWO_PUSHES, noise=NO_NOISE)
    assert np.all(np.abs(outcome.error[:2]) < 2.0 * START_POSITION_STD)
    assert abs(outcome.error[2]) < 2.0 * START_HEADING_STD
    assert np.all(np.abs(outcome.object_error) < 1e-3)
    assert np.hypot(*outcome.simulation.truth.object_pose[:2]) > 0.2


@pytest.mark.parametrize('seed', SEEDS)
def test_pushes_find_the_robot_where_odometry_drifts(seed):
    """It is within three standard deviations, and its errors of odometry are identified."""
    outcome = drifted(seed)
    deviations = outcome.ensemble.standard_deviations
    assert np.all(np.abs(outcome.error) < 3.0 * deviations)
    assert np.all(deviations[:2] < 0.015)
    assert np.all(np.abs(outcome.object_error) < (2e-3, 2e-3, 5e-3))


def test_pushes_find_the_robot_far_better_than_odometry():
    """In the root mean square over some robots, position and heading."""
    errors = np.array([drifted(seed).error for seed in SEEDS])
    alone = np.array([drifted(seed).odometry_error for seed in SEEDS])
    positions = [math.sqrt(np.square(rows[:, :2]).sum(axis=1).mean()) for rows in (errors, alone)]
    headings = [math.sqrt(np.square(rows[:, 2]).mean()) for rows in (errors, alone)]
    assert positions[1] > 0.05 and positions[0] < 0.2 * positions[1]
    assert headings[0] < 0.35 * headings[1]


@pytest.mark.parametrize('distance', [0.5, 2.0, 8.0])
def test_a_random_walk_grows_with_the_root_of_the_distance(distance):
    """Its variance is that of its steps, added up, whatever their number."""
    noise = OdometryNoise(0.0, 0.0, walk=0.01, heading_walk=0.02)
    for steps in (20, 200):
        ensemble, time = resting(noise)
        drive_ahead(ensemble, AWAY, time, distance, steps)
        walked = noise.heading_walk * math.sqrt(distance)
        # The standard deviation of a standard deviation of a hundred numbers is 7 %.
        assert ensemble.standard_deviations[2] == pytest.approx(
            math.hypot(START_HEADING_STD, walked), rel=0.25)
        # The heading along the way counts with the integral of its walk, across the path.
        ahead, across = spread_along(ensemble, AWAY.theta)
        assert ahead == pytest.approx(math.hypot(
            START_POSITION_STD, noise.walk * math.sqrt(distance)), rel=0.25)
        assert across == pytest.approx(math.sqrt(
            START_POSITION_STD ** 2 + noise.walk ** 2 * distance
            + (START_HEADING_STD * distance) ** 2 + walked ** 2 * distance ** 2 / 3.0), rel=0.25)


@pytest.mark.parametrize('distance', [1.0, 4.0])
def test_scale_and_drift_grow_with_the_distance(distance):
    """A scale ahead of the robot, a drift of its heading across."""
    for noise in (NO_NOISE._replace(scale=0.03), NO_NOISE._replace(drift=0.03)):
        ensemble, time = resting(noise)
        drive_ahead(ensemble, AWAY, time, distance, steps=50)
        ahead, across = spread_along(ensemble, AWAY.theta)
        turned = math.hypot(START_HEADING_STD, noise.drift * distance)
        if noise.scale:
            assert ahead == pytest.approx(
                math.hypot(START_POSITION_STD, noise.scale * distance), rel=0.25)
        assert ensemble.standard_deviations[2] == pytest.approx(turned, rel=0.25)
        assert across == pytest.approx(math.sqrt(
            START_POSITION_STD ** 2 + (START_HEADING_STD * distance) ** 2
            + (0.5 * noise.drift * distance ** 2) ** 2), rel=0.25)


def spread_along(ensemble, direction):
    """Return the standard deviations of the robot's position along a direction and across it."""
    x, y = ensemble.members.robot_poses[:, :2].T
    c, s = math.cos(direction), math.sin(direction)
    return float((c * x + s * y).std()), float((c * y - s * x).std())


@pytest.mark.parametrize('direction', [0.0, 0.7, -2.5])
def test_a_touch_tells_of_the_robot_along_the_normal_alone(direction):
    """Its mean moves by what the variances say, and it is never surer than that."""
    ensemble, _ = resting()
    ensemble.inflate_covariance(0.03)
    before, (along, across) = np.array(ensemble.pose), spread_along(ensemble, direction)
    ensemble.update_along(direction, 0.02, 0.01)
    weight = along ** 2 / (along ** 2 + 0.01 ** 2)
    c, s = math.cos(direction), math.sin(direction)
    moved = np.array(ensemble.pose) - before
    assert c * moved[0] + s * moved[1] == pytest.approx(0.02 * weight, rel=0.02)
    assert abs(c * moved[1] - s * moved[0]) < 0.005
    narrower, same = spread_along(ensemble, direction)
    assert math.sqrt(1.0 - weight) * along < narrower < 0.7 * along
    assert same == pytest.approx(across, rel=0.05)


def test_several_touches_tell_more_than_one():
    """They come down to the noise of one of them."""
    ensemble, _ = resting()
    ensemble.inflate_covariance(0.03)
    for _ in range(8):
        ensemble.update_along(0.0, 0.0, 0.004)
    assert spread_along(ensemble, 0.0)[0] < 0.004


def test_an_object_that_nobody_touches_tells_nothing_of_the_robot():
    """Neither its pose nor its odometry nor friction change by a single bit."""
    ensemble, time = resting()
    pose, time = drive_ahead(ensemble, AWAY, time, 0.5)
    members = ensemble.members
    robots, parameters = members.robot_poses, members.parameters.copy()
    objects = members.object_poses
    for k in range(5):
        ensemble.update(ObjectPose(time + 0.001 * k, Pose(0.004, -0.003, 0.005)))
    assert np.array_equal(members.robot_poses, robots)
    assert np.array_equal(members.parameters, parameters)
    assert not np.array_equal(members.object_poses, objects)


def test_an_object_that_somebody_moves_is_found_again():
    """After as many poses as no tracker's jump lasts; the robot is where it was."""
    ensemble, time = resting()
    elsewhere, robots = Pose(0.4, 0.3, -2.0), ensemble.members.robot_poses
    for k in range(MAX_OUTLIERS):
        assert np.hypot(*ensemble.object_pose[:2]) < 3e-3
        ensemble.predict(Odometry(time + k * STEP, AWAY, STOP))
        ensemble.update(ObjectPose(time + k * STEP, elsewhere))
    assert np.array(ensemble.object_pose) == pytest.approx(elsewhere, abs=1e-9)
    assert np.array_equal(ensemble.members.robot_poses, robots)


def test_an_object_that_is_elsewhere_after_a_push_leaves_the_robot_uncertain() -> None:
    """Where the robot touches it, both may be elsewhere; the law above has one that does not."""
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, NOISE)
    pose, speed = Pose(-0.41, 0.0, 0.0), 0.15
    for k in range(20):
        pose = pose @ Pose(STEP * speed, 0.0, 0.0)
        ensemble.predict(Odometry(k * STEP, pose, Twist(speed, 0.0, 0.0)))
        if k < 3:
            ensemble.update(ObjectPose(k * STEP, HOME))
    assert ensemble.contact_ratio > 0.9
    before = ensemble.position_deviation
    for k in range(20, 20 + MAX_OUTLIERS):
        ensemble.update(ObjectPose(k * STEP, Pose(0.4, 0.6, -2.0)))
    assert math.hypot(before, 0.9 * LOST_STDS[0]) < ensemble.position_deviation


def test_a_jump_of_a_pose_is_ignored():
    """However often there is one, if poses between them are right."""
    ensemble, time = resting()
    for k in range(12):
        ensemble.predict(Odometry(time + k * STEP, AWAY, STOP))
        before = ensemble.members.states.copy()
        is_jump = k % MAX_OUTLIERS < MAX_OUTLIERS - 1
        ensemble.update(ObjectPose(time + k * STEP, Pose(0.3, 0.1, 0.5) if is_jump else HOME))
        if is_jump:
            assert np.array_equal(ensemble.members.states, before)
    assert np.hypot(*ensemble.object_pose[:2]) < 3e-3


@pytest.mark.parametrize('latency', [0.05, 0.12, HISTORY_TIME - 0.01])
def test_late_poses_of_an_object_at_rest_tell_the_same(latency):
    """While the robot drives, too: each one is compared with its own time."""
    rng = np.random.default_rng(3)
    measured = [ObjectPose(0.1 * k, Pose(*(rng.standard_normal(3) * (2e-3, 2e-3, 5e-3))))
                for k in range(8)]
    ensembles = []
    for delay in (0.0, latency):
        ensemble = PushEnsemble(box(), ROBOT, CONTROL, NO_NOISE)
        ensemble.update(ObjectPose(-1.0, HOME))
        for k in range(240):
            time = 0.01 * k
            ensemble.predict(Odometry(time, AWAY @ Pose(0.001 * k, 0.0, 0.0), STOP))
            for pose in measured:
                if pose.time + delay <= time + 1e-9 < pose.time + delay + 0.01:
                    ensemble.update(pose)
        ensembles.append(ensemble.members)
    timely, late = ensembles
    assert np.hypot(*timely.object_poses.mean(axis=0)[:2]) > 1e-4
    np.testing.assert_allclose(late.object_poses, timely.object_poses, atol=1e-12)
    assert np.array_equal(late.robot_poses, timely.robot_poses)


def test_the_robot_is_looked_up_at_any_time_of_the_history():
    """Between two odometries by interpolation, and beyond the newest at that."""
    ensemble, time = resting(NO_NOISE)
    start = ensemble.pose
    end, time = drive_ahead(ensemble, AWAY, time, 0.2, steps=10)
    assert ensemble.pose_at(time) == pytest.approx(ensemble.pose)
    assert ensemble.pose_at(time + 1.0) == pytest.approx(ensemble.pose)
    path = [ensemble.pose_at(time - ago) for ago in (0.0, 0.125, 0.25)]
    steps = [math.dist(a[:2], b[:2]) for a, b in zip(path, path[1:])]
    assert steps == pytest.approx([0.05, 0.05], abs=1e-3)
    assert math.dist(start[:2], ensemble.pose[:2]) == pytest.approx(0.2, abs=1e-3)


def test_the_same_measurements_give_the_same_estimate():
    """Bit by bit; another seed gives other members."""
    one, two, other = (run(ONE_PUSH, sensors=DRIFTING, ensemble_seed=seed) for seed in (0, 0, 1))
    assert np.array_equal(one.ensemble.members.states, two.ensemble.members.states)
    assert np.array_equal(one.ensemble.members.parameters, two.ensemble.members.parameters)
    assert not np.array_equal(one.ensemble.members.states, other.ensemble.members.states)


@pytest.mark.slow
def test_a_mirrored_world_is_estimated_mirrored():
    """In the mean over several ensembles, within three standard errors of it."""
    sensors = SensorSettings(odometry_scale=0.03, odometry_heading_drift=0.03)
    reflected = SensorSettings(odometry_scale=0.03, odometry_heading_drift=-0.03)
    here = box(friction=(0.25, 0.3, 0.35, 0.3))
    there = box(friction=(0.3, 0.35, 0.3, 0.25))
    differences = []
    for seed in range(8):
        one = run(ONE_PUSH, here, sensors=sensors, ensemble_seed=seed)
        two = run(mirrored(ONE_PUSH), there, sensors=reflected, ensemble_seed=seed + 50,
                  start=Pose(START.x, -START.y, 0.0))
        differences.append([
            *(one.error - two.error * (1.0, -1.0, -1.0)),
            *np.subtract(one.ensemble.friction_center,
                         np.multiply(two.ensemble.friction_center, (1.0, -1.0)))])
    errors = np.std(differences, axis=0, ddof=1) / math.sqrt(len(differences))
    assert np.all(np.abs(np.mean(differences, axis=0)) < 3.0 * errors)


@pytest.mark.parametrize('friction', [(0.4, 0.4, 0.3, 0.3), (0.3, 0.4, 0.4, 0.3)])
def test_pushes_from_two_sides_find_the_centre_of_friction(friction):
    """Each one tells of it across the push."""
    true = box(friction=friction)
    outcome = run(TWO_PUSHES, true)
    center, knowledge = np.array(friction_center(true)), outcome.ensemble.knowledge
    error = np.hypot(*np.subtract(outcome.ensemble.friction_center, center))
    assert error < 0.3 * np.hypot(*center)
    assert error < 2.0 * knowledge.center_deviation < 0.03


@pytest.mark.parametrize('friction', [0.1, 0.2])
def test_a_contact_that_slides_is_found_slippery(friction):
    """A push far aslant slides where friction is less than believed."""
    aslant = ((-0.30, 0.0), (-0.10, 0.12), (-0.35, 0.12))
    before = run(()).ensemble.knowledge
    knowledge = run(aslant, box(contact_friction_coefficient=friction)).ensemble.knowledge
    assert knowledge.contact_friction == pytest.approx(friction, abs=0.05)
    assert knowledge.contact_friction_deviation < 0.5 * before.contact_friction_deviation


def test_before_any_odometry_there_is_no_pose():
    """The error names what is missing."""
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, NOISE)
    assert not ensemble.is_initialized and not ensemble.has_object
    with pytest.raises(RuntimeError, match='got no odometry'):
        _ = ensemble.pose


def test_a_robot_is_taken_over_with_what_is_known_of_it():
    """Another object, the same robot: where it is, how sure that is, and its odometry."""
    former, time = resting()
    pose, time = drive_ahead(former, AWAY, time, 0.5)
    former.update_pose((0.1, -0.05, 0.02), np.diag((1e-6, 1e-6, 1e-6)))
    ensemble = PushEnsemble(box(side=0.6), ROBOT, CONTROL, NOISE, seed=3)
    ensemble.take_over_robot(former)
    assert ensemble.pose == pytest.approx(former.pose, abs=1e-9)
    assert ensemble.standard_deviations == pytest.approx(former.standard_deviations, rel=1e-9)
    assert not ensemble.has_object
    for each in (former, ensemble):
        drive_ahead(each, pose, time, 0.5)
    assert ensemble.pose == pytest.approx(former.pose, abs=5e-3)
