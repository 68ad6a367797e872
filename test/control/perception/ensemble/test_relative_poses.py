"""Poses relative to the robot: laws of relations, and what they tell of robot and object."""

import math

from helpers.ensemble_runs import CONTROL, NOISE, ROBOT
from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.independent_samples import independent_samples
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.relation import composed_poses, relative_poses
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest

OBJECT = Pose(1.0, 0.2, 0.4)


def test_composing_undoes_relating():
    """For all frames, as the poses of one robot and one object do."""
    rng = np.random.default_rng(0)
    frames, poses = rng.normal(size=(20, 3)), rng.normal(size=(20, 3))
    relations = relative_poses(frames, poses)
    assert composed_poses(frames, relations) == pytest.approx(poses)
    for frame, pose, relation in zip(frames, poses, relations):
        expected = Pose(*frame).inverse() @ Pose(*pose)
        assert relation[:2] == pytest.approx(expected[:2])
        assert math.remainder(relation[2] - expected.theta, 2.0 * math.pi) == pytest.approx(0.0)


def driven(motion, turns, count=80, offset=Pose(0.0, 0.0, 0.0)):
    """
    Drive round an object that is seen relative to the robot.

    :param offset: ``Pose`` of the frame of odometry in the world.
    """
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, NOISE)
    true = odometry = Pose(0.0, 0.0, 0.0)
    for index in range(count):
        time = 0.05 * index
        ensemble.predict(Odometry(time, offset @ odometry, STOP))
        ensemble.update(ObjectPose(time, OBJECT, relative=true.inverse() @ OBJECT))
        true = true @ Pose(motion, 0.0, turns)
        odometry = odometry @ Pose(1.03 * motion, 0.0, turns)
    return ensemble


def test_where_odometry_has_its_origin_does_not_matter():
    """The relation is the same, and robot and object move with the frame."""
    plain, moved = driven(-0.01, 0.01), driven(-0.01, 0.01, offset=Pose(3.0, -2.0, 1.0))
    assert plain.position_deviation == pytest.approx(moved.position_deviation, rel=0.1)
    relation, other = (each.pose.inverse() @ each.object_pose for each in (plain, moved))
    assert relation == pytest.approx(other, abs=2e-3)


def test_an_object_at_rest_is_a_landmark():
    """It tells that odometry means more motion than there is; friction stays as it was."""
    before, ensemble = driven(0.0, 0.0, count=2), driven(-0.02, 0.0)
    assert ensemble.odometry_scale == pytest.approx(0.03, abs=0.015)
    assert np.array_equal(before.members.parameters[:, 3:], ensemble.members.parameters[:, 3:])
    error = ensemble.pose.x - ensemble.odometry.pose.x
    assert error == pytest.approx(-0.02 * 79 * -0.03, abs=0.02)


def test_the_relation_is_better_known_than_the_place_in_the_world():
    """And it is that of the measurements; their noise is what remains."""
    ensemble = driven(-0.02, 0.01)
    assert ensemble.is_relative
    assert ensemble.position_deviation < ensemble.members.position_deviation
    assert ensemble.position_uncertainty.position == ensemble.members.position_deviation


def test_a_pose_in_the_world_is_not_relative():
    """What is known of the robot is then its place in the world."""
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, NOISE)
    ensemble.predict(Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP))
    ensemble.update(ObjectPose(0.0, OBJECT))
    assert not ensemble.is_relative
    assert ensemble.position_deviation == ensemble.members.position_deviation


def test_the_greatest_deviation_does_not_depend_on_the_axes() -> None:
    """It is that along the longer axis of the ellipse, wherever that points."""
    for angle in np.linspace(0.0, math.pi, 7):
        c, s = math.cos(angle), math.sin(angle)
        turned = np.eye(3)
        turned[:2, :2] = (c, -s), (s, c)
        matrix = turned @ np.diag([0.04, 0.01, 0.09]) @ turned.T
        deviation = PoseCovariance.from_matrix(matrix).deviation
        assert deviation == pytest.approx((0.2, 0.3))


def test_independent_samples_have_exact_moments() -> None:
    """Mean 0, variance 1, no correlation with the state; and they are nearly what was drawn."""
    rng = np.random.default_rng(0)
    drawn, state = rng.standard_normal((100, 3)), 7.0 + rng.standard_normal((100, 9))
    # As poses of robots and objects are: nearly the same, and one of them known.
    state[:, 3] = state[:, 0] + 1e-4 * state[:, 1]
    state[:, 4] = 2.0
    samples = independent_samples(drawn, state)
    assert samples.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.cov(samples.T) == pytest.approx(np.eye(3), abs=1e-12)
    assert state.T @ samples == pytest.approx(np.zeros((9, 3)), abs=1e-9)
    assert (samples * drawn).mean(axis=0) == pytest.approx(np.ones(3), abs=0.2)


def watched(seed: int, scale: float, start: tuple[float, float, float],
            count: int = 600) -> tuple[PushEnsemble, Pose]:
    """
    Drive before an object that is seen five times a second; return the robot's true pose, too.

    :param scale: standard deviation of the relative error of distances.
    :param start: standard deviations of the robot at first.
    :param count: of odometry, 50 a second.
    """
    rng = np.random.default_rng(seed)
    noise = OdometryNoise(scale, 0.0, walk=0.003, heading_walk=0.01)
    ensemble = PushEnsemble(box(), ROBOT, CONTROL, noise, seed)
    error, period = scale * rng.standard_normal(), 0.02
    true, odometry = Pose(*(start * rng.standard_normal(3)).tolist()), Pose(0.0, 0.0, 0.0)
    ensemble.predict(Odometry(0.0, odometry, STOP))
    ensemble.place_robot(odometry, start)
    deviations = np.array((0.001, 0.001, 0.003))
    covariance = PoseCovariance.from_matrix(np.diag(deviations**2))
    for index in range(count):
        time = period * (index + 1)
        step = Pose(0.2 * math.cos(1.5 * time) * period, 0.0, 0.6 * math.sin(time) * period)
        walk = math.sqrt(abs(step.x)) * rng.standard_normal(3)
        odometry = odometry @ step
        true = true @ Pose(step.x / (1.0 + error) + noise.walk * float(walk[0]),
                           noise.walk * float(walk[1]),
                           step.theta + noise.heading_walk * float(walk[2]))
        ensemble.predict(Odometry(time, odometry, STOP))
        if index % 10 == 0:
            seen = np.array(true.inverse() @ OBJECT) + deviations * rng.standard_normal(3)
            relation = Pose(*seen.tolist())
            ensemble.update(ObjectPose(time, true @ relation, covariance, relative=relation))
    return ensemble, true


def test_images_of_an_object_tell_nothing_of_the_frame_of_the_world() -> None:
    """Of where robot and object are together they know what they knew, however many come."""
    first, last = (watched(0, 0.0, (0.02, 0.02, 0.1), count)[0] for count in (1, 600))
    assert last.standard_deviations[2] == pytest.approx(first.standard_deviations[2], rel=0.05)
    assert last.object_deviations[2] == pytest.approx(first.object_deviations[2], rel=0.05)


def test_errors_of_the_world_are_as_large_as_stated() -> None:
    """Of robots that see one object, in the root mean square."""
    squares: list[float] = []
    for seed in range(8):
        ensemble, true = watched(seed, 0.02, (0.002, 0.002, 0.05))
        robot = np.cov(ensemble.members.robot_poses.T)
        error = np.array(ensemble.pose) - true
        squares.append(float(error @ np.linalg.solve(robot, error)) / 3.0)
    assert 0.5 < np.mean(squares) < 1.5
