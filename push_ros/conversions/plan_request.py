"""Requests for plans to messages and back."""

from geometry_msgs.msg import PoseArray
from push_model.friction import friction_center, with_friction_center
from push_model.plan_request import PlanRequest
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, MessageRefused, to_pose_message,
)

POSES = ('object', 'robot', 'goal', 'friction centre')


def to_request_message(wanted, stamp, frame):
    """
    Turn what is wanted into poses of object, robot, goal and friction centre.

    The last is in the object frame; its z is the boldness.

    :param wanted: ``push_model.plan_request.PlanRequest``.
    :param stamp: of the measurement that it comes from.
    :param frame: id of the world frame.
    :return: ``geometry_msgs/PoseArray``.
    """
    message = PoseArray()
    message.header.stamp, message.header.frame_id = stamp, frame
    message.poses = [to_pose_message(pose) for pose in (
        wanted.object_pose, wanted.robot_pose, wanted.goal, (*friction_center(wanted.obj), 0.0))]
    message.poses[-1].position.z = wanted.cone_fraction
    return message


def from_request_message(message, frame, obj, topic='push_request'):
    """
    Read what is wanted.

    :param message: ``geometry_msgs/PoseArray``.
    :param frame: id of the world frame.
    :param obj: the ``PushedObject`` as believed.
    :param topic: what errors call the message.
    :return: ``push_model.plan_request.PlanRequest``, of an object whose friction is as learnt.
    :raises MessageRefused: naming what is wrong with it.
    """
    check_frame(message.header.frame_id, frame, topic)
    if len(message.poses) != len(POSES):
        raise MessageRefused(f'{topic}: got {len(message.poses)} poses, expected {len(POSES)}: '
                             + ', '.join(POSES))
    *poses, center = (from_pose_message(pose, f'{topic}: {name}')
                      for name, pose in zip(POSES, message.poses))
    cone_fraction = message.poses[-1].position.z
    if not 0.0 < cone_fraction <= 1.0:
        raise MessageRefused(f'{topic}: {POSES[-1]}: got the boldness z = {cone_fraction:g}, expected '
                             'a number above 0, at most 1')
    return PlanRequest(*poses, with_friction_center(obj, center[:2]), cone_fraction)
