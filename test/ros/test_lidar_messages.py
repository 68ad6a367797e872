"""Scans and places: messages to values and back, and what is refused."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseWithCovarianceStamped
import numpy as np
from push_control.ros.robot_placing import mount_of, with_least_deviation
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_model.signals import LidarScan, PoseCovariance
from push_ros.conversions.lidar import (
    from_place_message, from_scan_message, MAX_BEAMS, to_scan_message,
)
from push_ros.conversions.measurements import to_covariance
from push_ros.conversions.primitives import MessageRefused, to_pose_message
import pytest

SCAN = LidarScan(12.5, np.array([1.0, math.inf, 2.5, 0.5]), -1.5, 0.25, 0.0078125, 0.125, 12.0)
PLACE = Pose(1.0, -2.0, 0.5)


def scan_message(**fields):
    """Make a message with some fields changed."""
    message = to_scan_message(SCAN, Time(sec=12, nanosec=500_000_000), 'lidar')
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def place_message(variance=1e-4, frame='odom'):
    """Make a place with equal variances."""
    message = PoseWithCovarianceStamped()
    message.header.stamp, message.header.frame_id = Time(sec=3), frame
    message.pose.pose = to_pose_message(PLACE)
    message.pose.covariance = to_covariance(PoseCovariance(
        variance, 0.0, 0.0, variance, 0.0, variance))
    return message


def test_a_scan_survives_its_message():
    """All that is exact in single precision."""
    read = from_scan_message(scan_message())
    assert np.array_equal(read.ranges, SCAN.ranges)
    assert read._replace(ranges=None) == SCAN._replace(ranges=None)


@pytest.mark.parametrize('fields, name', [
    ({'ranges': [1.0]}, 'scan.ranges: got 1'),
    ({'ranges': [1.0] * (MAX_BEAMS + 1)}, f'scan.ranges: got {MAX_BEAMS + 1}'),
    ({'angle_min': math.nan}, 'scan.angle_min: got nan'),
    ({'angle_increment': 0.0}, 'scan.angle_increment: got 0 '),
    ({'angle_increment': 3.0}, 'scan.angle_increment: got 3 '),
    ({'time_increment': -0.1}, 'scan.time_increment: got -0.1'),
    ({'time_increment': 1.0}, 'scan.time_increment: got 1 '),
    ({'range_max': 0.125}, 'scan.range_max: got 0.125'),
    ({'ranges': [1.0] * 24, 'angle_max': 1.0}, 'scan.ranges: got 24 beams, expected 11'),
    ({'angle_max': math.inf}, 'scan.angle_max: got inf'),
])
def test_what_is_no_scan_is_refused_by_its_field(fields, name):
    """The error names the field and what came."""
    with pytest.raises(MessageRefused, match=name):
        from_scan_message(scan_message(**fields))


def test_a_place_is_less_certain_than_it_states():
    """By its factor, and by what walls err at least."""
    place = from_place_message(place_message(), 'odom', 3.0)
    assert place.time == 3.0 and np.allclose(place.pose, PLACE)
    assert place.covariance.x_x == pytest.approx(3e-4)
    assert place.covariance.theta_theta == pytest.approx(3e-4)
    floored = with_least_deviation(place, 0.02, 0.1).covariance
    assert (floored.x_x, floored.y_y, floored.theta_theta) == pytest.approx((4e-4, 4e-4, 1e-2))
    assert with_least_deviation(place, 0.01, 0.01) == place


@pytest.mark.parametrize('message, reason', [
    (place_message(0.0), 'place.pose.covariance: got none'),
    (place_message(-2.0), 'got the variance -2'),
    (place_message(frame='map'), "got frame 'map'"),
])
def test_a_place_without_certainty_or_of_another_frame_is_refused(message, reason):
    """A pose alone does not say how much it counts."""
    with pytest.raises(MessageRefused, match=reason):
        from_place_message(message, 'odom', 3.0)


def test_a_lidar_that_looks_aslant_is_refused():
    """Its beams end at walls where the map has none."""
    with pytest.raises(MessageRefused, match='tilted by 0.40 rad'):
        mount_of(RigidTransform.from_angles((0.0, 0.0, 0.3), (0.0, 0.4, 0.0)))


@pytest.mark.parametrize('roll', [0.0, math.pi])
def test_a_mounting_is_seen_from_above(roll):
    """Its yaw is that of its angle 0; one that hangs is known as such."""
    mount = mount_of(RigidTransform.from_angles((0.1, -0.2, 0.3), (roll, 0.0, 0.7)))
    assert np.allclose(mount.pose, (0.1, -0.2, 0.7))
    assert mount.is_upside_down == (roll > 0.0)
    forward = RigidTransform.from_angles((0.0, 0.0, 0.0), (roll, 0.0, 0.7)).rotation_matrix[:2, 0]
    assert np.allclose(forward, (math.cos(0.7), math.sin(0.7)))
