"""Whole messages to values and back: measurements, goals, commands, forces."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import (
    PoseStamped, Twist as TwistMessage, TwistStamped, WrenchStamped,
)
from nav_msgs.msg import Odometry as OdometryMessage
from push_model.geometry import Coordinates
from push_model.signals import ObjectPose, Odometry, Twist
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, from_twist_message, seconds, to_pose_message, to_stamp,
    to_twist_message,
)


def to_odometry_message(odometry: Odometry, frame: str, child_frame: str) -> OdometryMessage:
    """
    Convert odometry to a message.

    :param odometry: ``Odometry``.
    :param frame: id of the world frame.
    :param child_frame: id of the robot's frame, in whose axes the twist is.
    """
    message = OdometryMessage(child_frame_id=child_frame)
    message.header.stamp, message.header.frame_id = to_stamp(odometry.time), frame
    message.pose.pose = to_pose_message(odometry.pose)
    message.twist.twist = to_twist_message(odometry.twist)
    return message


def from_odometry_message(message: OdometryMessage, frame: str,
                          topic: str = 'odom') -> Odometry:
    """
    Read odometry.

    :param message: ``nav_msgs/Odometry``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: where the frame is another or a number is not finite.
    """
    check_frame(message.header.frame_id, frame, topic)
    return Odometry(seconds(message.header.stamp), from_pose_message(message.pose.pose, topic),
                    from_twist_message(message.twist.twist, topic))


def to_object_pose_message(object_pose: ObjectPose, frame: str) -> PoseStamped:
    """
    Convert an object pose to a message.

    :param object_pose: ``ObjectPose``.
    :param frame: id of the world frame.
    """
    message = PoseStamped(pose=to_pose_message(object_pose.pose))
    message.header.stamp, message.header.frame_id = to_stamp(object_pose.time), frame
    return message


def from_object_pose_message(message: PoseStamped, frame: str,
                             topic: str = 'object_pose') -> ObjectPose:
    """
    Read an object pose, or a goal.

    :param message: ``geometry_msgs/PoseStamped``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: where the frame is another, a number is not finite or the quaternion
        is 0.
    """
    check_frame(message.header.frame_id, frame, topic)
    return ObjectPose(seconds(message.header.stamp), from_pose_message(message.pose, topic))


def to_command_message(twist: Twist, stamp: Time, frame: str,
                       stamped: bool) -> TwistStamped | TwistMessage:
    """
    Convert a command to a message.

    :param twist: ``Twist`` in the robot's axes.
    :param stamp: stamp of the measurement that it answers.
    :param frame: id of the robot's frame.
    :param stamped: whether to make a ``TwistStamped``, else a ``Twist``.
    """
    if not stamped:
        return to_twist_message(twist)
    message = TwistStamped(twist=to_twist_message(twist))
    message.header.stamp, message.header.frame_id = stamp, frame
    return message


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
