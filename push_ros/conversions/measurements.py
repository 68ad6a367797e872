"""Whole messages to values and back: measurements, goals, commands, forces."""

from typing import Any, Sequence

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, WrenchStamped
from nav_msgs.msg import Odometry as OdometryMessage
from push_model.geometry import Coordinates
from push_model.signals import ObjectPose, Odometry, PoseCovariance
from push_ros.conversions.primitives import (
    check_frame, check_upright, from_pose_message, from_twist_message, MessageRefused, seconds,
    to_pose_message, to_stamp, to_twist_message,
)

# Places of ``PoseCovariance`` in the 6 x 6 covariance of a message, by rows of (x, y, z, roll,
# pitch, yaw), and of its diagonal.
COVARIANCE_INDICES = (0, 1, 5, 7, 11, 35)
VARIANCE_INDICES = {'x': 0, 'y': 7, 'yaw': 35}
# What the diagonal of a covariance holds where nothing is stated: what a message is made with, and
# what some drivers write.
NOT_STATED = (0.0, -1.0)
# Largest variance of a pose [m^2] or [rad^2]; chosen: far above what any driver writes for a value
# that it does not know, and far below what arithmetic cannot take.
MAX_VARIANCE = 1e12


def to_odometry_message(odometry: Odometry, frame: str, child_frame: str) -> OdometryMessage:
    """
    Convert odometry to a message.

    :param frame: id of the world frame.
    :param child_frame: id of the robot's frame, in whose axes the twist is.
    """
    message = OdometryMessage(child_frame_id=child_frame)
    message.header.stamp, message.header.frame_id = to_stamp(odometry.time), frame
    message.pose.pose = to_pose_message(odometry.pose)
    message.twist.twist = to_twist_message(odometry.twist)
    if odometry.covariance is not None:
        message.pose.covariance = to_covariance(odometry.covariance)
    return message


def from_odometry_message(message: OdometryMessage, frame: str,
                          topic: str = 'odom') -> Odometry:
    """
    Read odometry.

    :param message: ``nav_msgs/Odometry``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: where the frame is another, a number is not finite, or the covariance
        of the pose is none.
    """
    check_frame(message.header.frame_id, frame, topic)
    return Odometry(seconds(message.header.stamp), from_pose_message(message.pose.pose, topic),
                    from_twist_message(message.twist.twist, topic),
                    from_covariance(list(map(float, message.pose.covariance)),
                                    f'{topic}.pose.covariance'))


def to_covariance(covariance: PoseCovariance) -> list[float]:
    """
    Write the covariance of a pose in the plane.

    :return: of (x, y, z, roll, pitch, yaw), by rows, 36 numbers; those out of the plane are 0.
    """
    values = [0.0] * 36
    for index, value in zip(COVARIANCE_INDICES, covariance):
        row, column = divmod(index, 6)
        values[index] = values[6 * column + row] = value
    return values


def from_covariance(values: Sequence[float], name: str) -> PoseCovariance | None:
    """
    Read the covariance of a pose in the plane.

    :param values: of (x, y, z, roll, pitch, yaw), by rows, 36 numbers; of those only the upper
        triangle of x, y and yaw is read.
    :param name: what errors call it.
    :return: ``PoseCovariance``; None where the variance of x, y or yaw is 0 or -1, that is not
        stated.
    :raises MessageRefused: where one of them is negative or too large, or where the errors would
        be more than fully correlated.
    """
    variances = {axis: values[index] for axis, index in VARIANCE_INDICES.items()}
    for axis, variance in variances.items():
        if not (0.0 <= variance <= MAX_VARIANCE or variance in NOT_STATED):
            raise MessageRefused(
                f'{name}: got the variance {variance:g} of {axis}, expected a number from 0 to '
                f'{MAX_VARIANCE:g}, or -1 where none is stated')
    if any(variance in NOT_STATED for variance in variances.values()):
        return None
    covariance = PoseCovariance(*(values[index] for index in COVARIANCE_INDICES))
    x_x, x_y, x_theta, y_y, y_theta, theta_theta = covariance
    # A square of so large a float as messages may have is an error, a product is infinite.
    if not (x_y * x_y <= x_x * y_y and x_theta * x_theta <= x_x * theta_theta
            and y_theta * y_theta <= y_y * theta_theta):
        raise MessageRefused(f'{name}: got {tuple(covariance)} for the upper triangle of x, y and '
                             'yaw, expected covariances within those of full correlation')
    return covariance


def to_object_pose_message(
        object_pose: ObjectPose, frame: str, *,
        with_covariance: bool = False) -> PoseStamped | PoseWithCovarianceStamped:
    """
    Convert an object pose to a message.

    :param frame: id of the world frame.
    :param with_covariance: whether to make a ``PoseWithCovarianceStamped``, whose covariance is 0
        where none is stated; else a ``PoseStamped``.
    """
    pose = to_pose_message(object_pose.pose)
    if with_covariance:
        message = PoseWithCovarianceStamped()
        message.pose.pose = pose
        if object_pose.covariance is not None:
            message.pose.covariance = to_covariance(object_pose.covariance)
    else:
        message = PoseStamped(pose=pose)
    message.header.stamp, message.header.frame_id = to_stamp(object_pose.time), frame
    return message


def from_object_pose_message(message: PoseStamped | PoseWithCovarianceStamped, frame: str,
                             topic: str = 'object_pose') -> ObjectPose:
    """
    Read an object pose, or a goal.

    :param message: ``geometry_msgs/PoseStamped`` or ``PoseWithCovarianceStamped``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: where the frame is another, a number is not finite, the quaternion is
        0, the pose is tilted, or the covariance is none.
    """
    check_frame(message.header.frame_id, frame, topic)
    pose: Any = message.pose
    covariance = None
    if hasattr(pose, 'covariance'):
        covariance = from_covariance(list(map(float, pose.covariance)),
                                     f'{topic}.pose.covariance')
        pose = pose.pose
    check_upright(pose.orientation, topic)
    return ObjectPose(seconds(message.header.stamp), from_pose_message(pose, topic), covariance)


def from_relative_pose_message(message: PoseStamped | PoseWithCovarianceStamped, frame: str,
                               topic: str = 'object_pose') -> ObjectPose:
    """
    Read an object pose that is relative to the robot.

    :param message: as of ``from_object_pose_message``.
    :param frame: id of the base frame.
    :param topic: what errors call the message.
    :return: ``ObjectPose`` with ``relative``; its ``pose`` is the same until odometry places it.
    :raises MessageRefused: as ``from_object_pose_message``.
    """
    measured = from_object_pose_message(message, frame, topic)
    return measured._replace(relative=measured.pose)


def to_wrench_message(force: Coordinates, stamp: Time, frame: str) -> WrenchStamped:
    """
    Convert a contact force to a message.

    :param force: (f_x, f_y) along the axes of the frame [N].
    :param stamp: when it acts.
    :param frame: frame id.
    """
    message = WrenchStamped()
    message.header.stamp, message.header.frame_id = stamp, frame
    message.wrench.force.x, message.wrench.force.y = float(force[0]), float(force[1])
    return message
