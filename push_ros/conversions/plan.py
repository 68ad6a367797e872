"""Plans to messages and back."""

from typing import Any, Iterable, Sequence

from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import PoseStamped, Transform
from nav_msgs.msg import Path
import numpy as np
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.plan_request import PlanFailure
from push_model.trajectory import PushStyle, PushTrajectory
from push_ros.conversions.primitives import (
    check_frame, from_twist_message, MessageRefused, seconds, to_pose_message, to_quaternion,
    to_stamp, to_twist_message, to_yaw,
)
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

JOINTS = ('object', 'contact', 'robot')
# Name of the second joint: a contact that is free may roll and slide along the object.
CONTACT_JOINTS = {PushStyle.STEERED: 'contact', PushStyle.UNSTEERED: 'free_contact',
                  PushStyle.WAYPOINT: 'free_contact_to_waypoint'}


def to_plan_message(trajectory: PushTrajectory, stamp: Time,
                    frame: str) -> MultiDOFJointTrajectory:
    """
    Convert a trajectory to a message: joints ``object``, ``contact`` and ``robot``.

    Where the push is unsteered the second joint is called ``free_contact``, or
    ``free_contact_to_waypoint`` where it does not aim at the goal of the task.

    :param trajectory: ``PushTrajectory``.
    :param stamp: of the newest measurement that the plan starts from, or of its request.
    :param frame: id of the world frame.
    """
    message = MultiDOFJointTrajectory(joint_names=_joint_names(trajectory.style))
    message.header.stamp, message.header.frame_id = stamp, frame
    poses = [getattr(trajectory, f'{joint}_poses').tolist() for joint in JOINTS]
    twists = [getattr(trajectory, f'{joint}_twists').tolist() for joint in JOINTS]
    message.points = [
        MultiDOFJointTrajectoryPoint(
            transforms=[_to_transform(pose) for pose in poses_now],
            velocities=[to_twist_message(twist) for twist in twists_now],
            time_from_start=to_stamp(time, Duration))
        for time, poses_now, twists_now in zip(trajectory.times.tolist(), zip(*poses),
                                               zip(*twists))]
    return message


def no_plan_message(code: PlanFailure, stamp: Time, frame: str) -> MultiDOFJointTrajectory:
    """
    Make the answer to a request for which there is no plan: no points, and why.

    :param code: ``PlanFailure``; its name is the only joint name.
    :param stamp: of the request.
    :param frame: id of the world frame.
    """
    message = MultiDOFJointTrajectory(joint_names=[code.name])
    message.header.stamp, message.header.frame_id = stamp, frame
    return message


def plan_failure(message: MultiDOFJointTrajectory) -> PlanFailure | None:
    """
    Read why there is no plan.

    :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
    :return: ``PlanFailure``; None where the message is a plan.
    """
    if message.points:
        return None
    names = list(message.joint_names)
    if len(names) == 1 and names[0] in PlanFailure.__members__:
        return PlanFailure[names[0]]
    return PlanFailure.INVALID_PLAN


def from_plan_message(message: MultiDOFJointTrajectory, frame: str,
                      topic: str = 'push_plan') -> PushTrajectory:
    """
    Read a trajectory; angles are unwrapped from sample to sample.

    :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :return: ``PushTrajectory``.
    :raises MessageRefused: naming what is wrong with it.
    """
    check_frame(message.header.frame_id, frame, topic)
    style = _style_of(message, topic)
    _check_points(message, topic)
    arrays: dict[str, Any] = {
        'times': [seconds(point.time_from_start) for point in message.points]}
    for joint, name in zip(JOINTS, _joint_names(style)):
        index = list(message.joint_names).index(name)
        arrays[f'{joint}_poses'] = _poses([p.transforms[index] for p in message.points], topic)
        arrays[f'{joint}_twists'] = np.array(
            [from_twist_message(p.velocities[index], topic) for p in message.points])
    try:
        return PushTrajectory(**arrays, style=style)
    except ValueError as error:
        raise MessageRefused(f'{topic}: {error}') from error


def to_path_message(object_poses: Iterable[Coordinates], stamp: Time, frame: str) -> Path:
    """
    Convert the poses of the object to a path for viewers.

    :param object_poses: (x, y, theta) in the world, shape (n, 3).
    :param stamp: of the path.
    :param frame: id of the world frame.
    """
    message = Path()
    message.header.stamp, message.header.frame_id = stamp, frame
    message.poses = [PoseStamped(header=message.header, pose=to_pose_message(pose))
                     for pose in object_poses]
    return message


def _joint_names(style: PushStyle) -> list[str]:
    return [CONTACT_JOINTS[style] if joint == 'contact' else joint for joint in JOINTS]


def _style_of(message: MultiDOFJointTrajectory, topic: str) -> PushStyle:
    """Read the style from the name of the contact; refuse a message that lacks a joint."""
    names = list(message.joint_names)
    styles = [style for style in PushStyle if set(_joint_names(style)) <= set(names)]
    if len(styles) != 1:
        expected = ' or '.join(', '.join(_joint_names(style)) for style in PushStyle)
        raise MessageRefused(f'{topic}: got joints {", ".join(names) or "none"}, expected '
                             + expected)
    return styles[0]


def _check_points(message: MultiDOFJointTrajectory, topic: str) -> None:
    """Refuse a message in which a point lacks a value of a joint."""
    names = list(message.joint_names)
    for number, point in enumerate(message.points):
        for field in ('transforms', 'velocities'):
            count = len(getattr(point, field))
            if count != len(names):
                raise MessageRefused(f'{topic}: got {count} {field} in point {number}, expected '
                                     f'{len(names)}')


def _to_transform(pose: Coordinates) -> Transform:
    transform = Transform(rotation=to_quaternion(pose[2]))
    transform.translation.x, transform.translation.y = pose[0], pose[1]
    return transform


def _poses(transforms: Sequence[Transform], topic: str) -> FloatArray:
    poses = np.array([Pose(t.translation.x, t.translation.y, to_yaw(t.rotation, topic))
                      for t in transforms]).reshape(-1, 3)
    poses[:, 2] = np.unwrap(poses[:, 2])
    return poses
