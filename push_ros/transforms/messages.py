"""Transforms to messages and back, and messages brought to another frame."""

import copy
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose as PoseMessage, TransformStamped
import numpy as np
from push_model.rigid_transform import RigidTransform
from push_ros.conversions.primitives import MessageRefused


def from_transform_message(message: TransformStamped) -> RigidTransform:
    """
    Read a transform.

    :param message: ``geometry_msgs/TransformStamped``.
    :return: pose of its child frame in its header's frame.
    :raises ValueError: where a number is not finite, or the quaternion is 0.
    """
    translation, rotation = message.transform.translation, message.transform.rotation
    return RigidTransform.from_parts((translation.x, translation.y, translation.z),
                                     (rotation.x, rotation.y, rotation.z, rotation.w))


def to_transform_message(transform: RigidTransform, stamp: Time, parent: str,
                         child: str) -> TransformStamped:
    """
    Convert a transform to a message.

    :param transform: pose of the child in the parent.
    :param stamp: ``builtin_interfaces/Time``.
    :param parent: frame id.
    :param child: frame id.
    """
    message = TransformStamped(child_frame_id=child)
    message.header.stamp, message.header.frame_id = stamp, parent
    translation, rotation = message.transform.translation, message.transform.rotation
    translation.x, translation.y, translation.z = transform[:3]
    rotation.x, rotation.y, rotation.z, rotation.w = transform.quaternion
    return message


def transformed(message: Any, transform: RigidTransform, frame: str, topic: str) -> Any:
    """
    Bring a message to another frame.

    :param message: ``PoseStamped``, ``PoseWithCovarianceStamped`` or ``OccupancyGrid``.
    :param transform: pose of the frame that it is in, in the new one.
    :param frame: id of the new frame.
    :param topic: what errors call the message.
    :return: message of the same type, with the same stamp.
    :raises MessageRefused: where its pose is not finite, or its quaternion is 0.
    """
    result = copy.copy(message)
    result.header = copy.deepcopy(message.header)
    result.header.frame_id = frame
    if hasattr(message, 'info'):
        result.info = copy.deepcopy(message.info)
        result.info.origin = _transformed_pose(message.info.origin, transform, topic)
    elif hasattr(message.pose, 'covariance'):
        result.pose = copy.deepcopy(message.pose)
        result.pose.pose = _transformed_pose(message.pose.pose, transform, topic)
        covariance = np.reshape(message.pose.covariance, (6, 6))
        if covariance.diagonal().min() > 0.0:
            # Both position and rotation have their errors along the axes of the frame.
            rotation = np.kron(np.eye(2), transform.rotation_matrix)
            result.pose.covariance = (rotation @ covariance @ rotation.T).ravel()
    else:
        result.pose = _transformed_pose(message.pose, transform, topic)
    return result


def _transformed_pose(message: PoseMessage, transform: RigidTransform, topic: str) -> PoseMessage:
    position, orientation = message.position, message.orientation
    try:
        pose = transform @ RigidTransform.from_parts(
            (position.x, position.y, position.z),
            (orientation.x, orientation.y, orientation.z, orientation.w))
    except ValueError as error:
        raise MessageRefused(f'{topic}: {error}') from error
    result = PoseMessage()
    result.position.x, result.position.y, result.position.z = pose[:3]
    (result.orientation.x, result.orientation.y, result.orientation.z,
     result.orientation.w) = pose.quaternion
    return result
