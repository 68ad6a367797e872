"""Odometry at the time of a measurement: interpolated, and composed with relative poses."""

import math

from push_model.geometry import Pose, wrap_angle
from push_model.odometry_history import HISTORY_TIME, OdometryHistory
from push_model.signals import ObjectPose, Odometry, Twist
import pytest


def history(count=20, period=0.02):
    """Drive straight at 0.5 m/s while turning at 10 rad/s past pi; odometry is wrapped."""
    poses = OdometryHistory()
    for i in range(count):
        time = i * period
        poses.append(Odometry(time, Pose(0.5 * time, 0.0, wrap_angle(3.0 + 10.0 * time)),
                              Twist()))
    return poses


def test_poses_between_are_on_the_line_and_turn_the_shorter_way():
    poses = history()
    for time in (0.0, 0.011, 0.014, 0.02, 0.333):
        pose = poses.pose_at(time)
        assert pose.x == pytest.approx(0.5 * time)
        assert wrap_angle(pose.theta - 3.0 - 10.0 * time) == pytest.approx(0.0, abs=1e-9)


def test_the_newest_serves_for_later_and_nothing_for_earlier_times():
    poses = history()
    assert poses.pose_at(9.0) == poses.pose_at(0.38)
    assert poses.pose_at(-0.01) is None
    assert OdometryHistory().pose_at(0.0) is None
    relative = ObjectPose(-0.01, Pose(1.0, 0.0, 0.0), relative=Pose(1.0, 0.0, 0.0))
    assert poses.place(relative) is None


def test_old_odometry_is_forgotten_and_repeated_one_ignored():
    poses = history(count=round(2.0 * HISTORY_TIME / 0.02))
    newest = 2.0 * HISTORY_TIME - 0.02
    assert poses.pose_at(newest - HISTORY_TIME - 0.03) is None
    assert poses.pose_at(newest - HISTORY_TIME + 0.03) is not None
    before = poses.pose_at(newest)
    poses.append(Odometry(newest, Pose(9.0, 9.0, 9.0), Twist()))
    assert poses.pose_at(newest) == before


def test_a_relative_pose_is_placed_by_odometry_of_its_time():
    relative = Pose(1.0, 0.2, 3.0)
    placed = history().place(ObjectPose(0.01, Pose(0.0, 0.0, 0.0), relative=relative))
    robot = history().pose_at(0.01)
    assert placed.relative == relative and abs(placed.pose.theta) <= math.pi
    back = robot.inverse() @ placed.pose
    assert back[:2] == pytest.approx(relative[:2])
    assert wrap_angle(back.theta - relative.theta) == pytest.approx(0.0, abs=1e-9)


def test_only_relative_poses_are_placed():
    with pytest.raises(ValueError, match='relative'):
        history().place(ObjectPose(0.0, Pose(0.0, 0.0, 0.0)))
