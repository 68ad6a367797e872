"""What a push tells of the robot's pose: laws of the innovation and of its covariance."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_control.push.status import ControllerStatus
from push_control.settings import ControlSettings
from push_control.task.object_model import ObjectModelEstimator
from push_control.task.push_innovation import (
    HEADING_STD, lateral_offset, LateralOffset, POSITION_STD, push_innovation, PushInnovation,
)
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
import pytest

ROBOT = RoundRobot(radius=0.17)
WORLD = Pose(3.0, -1.0, 2.0)


def status(robot_pose, **values):
    """Report a push along the x axis of a box at the origin."""
    return ControllerStatus(object_pose=Pose(0.0, 0.0, 0.0), robot_pose=robot_pose, **values)


@pytest.mark.parametrize('direction', [0.0, 0.7, -2.0])
def test_the_covariance_has_its_axes(direction):
    """Lateral, longitudinal and heading are its principal axes."""
    innovation = PushInnovation((0.0, 0.0, 0.0), direction, 0.05, 0.01, 0.02)
    lateral = np.array((math.cos(direction), math.sin(direction), 0.0))
    along = np.array((-math.sin(direction), math.cos(direction), 0.0))
    heading = np.array((0.0, 0.0, 1.0))
    for axis, deviation in ((lateral, 0.05), (along, 0.01), (heading, 0.02)):
        assert innovation.covariance @ axis == pytest.approx(deviation ** 2 * axis, abs=1e-15)


@pytest.mark.parametrize('lag', [0.0, 0.1])
def test_a_robot_where_it_is_localized_has_no_error(lag):
    """One lag ahead, on the arc of its steady twist."""
    twist, pose = Twist(0.2, 0.0, 0.3), Pose(0.4, -0.2, 1.0)
    ahead = pose @ Pose(0.0, 0.0, 0.15 * lag) @ Pose(0.2 * lag, 0.0, 0.0)
    seen = status(Pose(ahead.x, ahead.y, pose.theta + 0.3 * lag))
    innovation = push_innovation(seen, Odometry(0.0, pose, twist), twist, lag, LateralOffset())
    assert innovation.error == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_an_offset_of_the_contact_is_one_of_the_robot():
    """The error is that of a robot that stands to the other side."""
    odometry = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)
    offset = LateralOffset(0.5 * math.pi, 0.03, 0.04)
    innovation = push_innovation(status(Pose(0.0, 0.0, 0.1)), odometry, STOP, 0.0, offset)
    assert innovation.error == pytest.approx((0.0, -0.03, 0.1))
    assert innovation.lateral_std == pytest.approx(math.hypot(POSITION_STD, 0.04))
    assert innovation.longitudinal_std == POSITION_STD
    assert innovation.heading_std == HEADING_STD


def test_slips_and_losses_of_contact_make_it_less_certain():
    """All deviations grow by one factor; the error is the same."""
    odometry = Odometry(0.0, Pose(0.1, 0.0, 0.0), STOP)
    steady = status(Pose(0.0, 0.0, 0.0))
    sliding = dataclasses.replace(steady, slips=1, contact_losses=1)
    one, two = (push_innovation(report, odometry, STOP, 0.0, LateralOffset(0.3, 0.02, 0.01))
                for report in (steady, sliding))
    assert two.error == one.error
    assert two.covariance == pytest.approx(25.0 * one.covariance)


@pytest.mark.parametrize('obj, ratio', [(box(), 1.0), (bin_(), None)])
def test_a_seen_offset_of_the_centre_is_an_offset_of_the_contact(obj, ratio):
    """As much on a flat side; more for the robot's centre on a round one; in any world frame."""
    estimator = ObjectModelEstimator(obj, ControlSettings())
    extent = obj.radius or 0.2
    report = status(Pose(-extent - ROBOT.radius, 0.0, 0.0), friction_center=(0.0, 0.02))
    found = lateral_offset(estimator, ROBOT, report)
    expected = ratio or 1.0 + ROBOT.radius / obj.radius
    assert found.offset == pytest.approx(0.02 * expected)
    assert found.direction == pytest.approx(0.5 * math.pi)
    moved = dataclasses.replace(report, object_pose=WORLD @ report.object_pose,
                                robot_pose=WORLD @ report.robot_pose)
    elsewhere = lateral_offset(estimator, ROBOT, moved)
    assert elsewhere.offset == pytest.approx(found.offset)
    assert elsewhere.direction == pytest.approx(found.direction + WORLD.theta)
