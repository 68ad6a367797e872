"""Poses relative to the robot: laws of relations, and what they tell of robot and object."""

import math

from helpers.ensemble_runs import CONTROL, NOISE, ROBOT
from helpers.objects import box
import numpy as np
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
