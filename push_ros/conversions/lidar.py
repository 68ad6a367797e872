"""Scans of a lidar, and places of the robot in a map, to values and back."""

import array
import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseWithCovarianceStamped
import numpy as np
from push_model.geometry import FloatArray
from push_model.signals import LidarScan, PoseCovariance, RobotPlace
from push_ros.conversions.measurements import from_covariance
from push_ros.conversions.primitives import (
    check_frame, check_upright, from_pose_message, MessageRefused, seconds,
)
from sensor_msgs.msg import LaserScan

# Beams beyond which a message is none of a lidar; chosen: a hundred in every degree.
MAX_BEAMS = 36_000
# Longest time that a scan may take [s]; chosen: the slowest lidars turn five times a second.
MAX_DURATION = 1.0
# Beams, and part of all of them, by which the last one may be off the stated angle; chosen:
# drivers count the beam that closes the turn or do not, and a truncated scan lacks more.
MAX_EXCESS_BEAMS, MAX_EXCESS_RATIO = 1.5, 0.02


def to_scan_message(scan: LidarScan, stamp: Time, frame: str) -> LaserScan:
    """
    Convert a scan to a message.

    :param stamp: of the first beam.
    :param frame: id of the frame of the lidar.
    """
    count = len(scan.ranges)
    message = LaserScan(
        angle_min=scan.angle_min, angle_max=scan.angle_min + (count - 1) * scan.angle_increment,
        angle_increment=scan.angle_increment, time_increment=scan.time_increment,
        scan_time=count * scan.time_increment, range_min=scan.range_min, range_max=scan.range_max)
    message.header.stamp, message.header.frame_id = stamp, frame
    # An array is taken as it is, a list number by number.
    message.ranges = array.array('f', scan.ranges.astype(np.float32).tobytes())
    return message


def from_scan_message(message: LaserScan, topic: str = 'scan') -> LidarScan:
    """
    Read a scan; ranges that are not numbers, or out of range, are kept as they are.

    :param message: ``sensor_msgs/LaserScan``.
    :param topic: what errors call the message.
    :raises MessageRefused: naming the field, what came and what was expected.
    """
    count = len(message.ranges)
    if not 1 < count <= MAX_BEAMS:
        raise MessageRefused(f'{topic}.ranges: got {count} beams, expected 2 to {MAX_BEAMS}')
    for name in ('angle_min', 'angle_max', 'angle_increment', 'time_increment', 'range_min',
                 'range_max'):
        value = getattr(message, name)
        if not math.isfinite(value):
            raise MessageRefused(f'{topic}.{name}: got {value:g}, expected a finite number')
    if message.angle_increment == 0.0 or abs(count * message.angle_increment) > 2.1 * math.pi:
        raise MessageRefused(f'{topic}.angle_increment: got {message.angle_increment:g} for '
                             f'{count} beams, expected at most one turn in all, and not 0 [rad]')
    stated = (message.angle_max - message.angle_min) / message.angle_increment + 1.0
    if not abs(stated - count) <= MAX_EXCESS_BEAMS + MAX_EXCESS_RATIO * count:
        raise MessageRefused(f'{topic}.ranges: got {count} beams, expected {stated:.0f}, as '
                             'angle_min, angle_max and angle_increment have it')
    if not 0.0 <= count * message.time_increment <= MAX_DURATION:
        raise MessageRefused(f'{topic}.time_increment: got {message.time_increment:g} for {count} '
                             f'beams, expected 0 to {MAX_DURATION:g} s in all')
    if not 0.0 <= message.range_min < message.range_max:
        raise MessageRefused(f'{topic}.range_max: got {message.range_max:g}, expected more than '
                             f'range_min, which is {message.range_min:g} and at least 0 [m]')
    ranges: FloatArray = np.array(message.ranges, dtype=float)
    return LidarScan(seconds(message.header.stamp), ranges, message.angle_min,
                     message.angle_increment, message.time_increment, message.range_min,
                     message.range_max)


def from_place_message(message: PoseWithCovarianceStamped, frame: str, factor: float,
                       topic: str = 'place') -> RobotPlace:
    """
    Read the place of the robot in its map, as another localization has it.

    :param message: ``geometry_msgs/PoseWithCovarianceStamped``.
    :param frame: id of the world frame.
    :param factor: by which its covariance is multiplied.
    :param topic: what errors call the message.
    :raises MessageRefused: where the frame is another, a number is not finite, or no covariance is
        stated.
    """
    check_frame(message.header.frame_id, frame, topic)
    check_upright(message.pose.pose.orientation, topic)
    covariance = from_covariance(list(map(float, message.pose.covariance)),
                                 f'{topic}.pose.covariance')
    if covariance is None:
        raise MessageRefused(f'{topic}.pose.covariance: got none, expected variances of x, y and '
                             'yaw above 0')
    return RobotPlace(seconds(message.header.stamp), from_pose_message(message.pose.pose, topic),
                      PoseCovariance(*(factor * value for value in covariance)))
