"""
Plan requests to messages and back.

A request is a ``trajectory_msgs/JointTrajectory`` of one point, whose joint names say what each
of its positions is: poses of object, robot and goal in the world frame, the centre of friction in
the object frame, and the fraction of the friction cone that the plan should use.
"""

import math
from typing import Any, Dict

from push_model.friction import friction_center, with_friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.plan_request import PlanRequest
from push_ros.conversions.primitives import check_frame, MessageRefused, to_quaternion, to_yaw
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

POSES = ('object', 'robot', 'goal')
FRICTION_CENTER = ('friction_center.x', 'friction_center.y')
CONE_FRACTION = 'cone_fraction'
FIELDS = (*(f'{pose}.{part}' for pose in POSES for part in ('x', 'y', 'heading')),
          *FRICTION_CENTER, CONE_FRACTION)


def to_request_message(request: PlanRequest, stamp: Any, frame: str) -> JointTrajectory:
    """
    Convert a plan request to a message.

    :param request: the ``PlanRequest``.
    :param stamp: ``builtin_interfaces/Time`` of the measurement that it comes from.
    :param frame: id of the world frame.
    :return: ``trajectory_msgs/JointTrajectory``; see the module on its fields.
    """
    values = []
    for pose in (request.object_pose, request.robot_pose, request.goal):
        # The heading as a quaternion carries it, like that of every other pose on a topic.
        values += [pose.x, pose.y, to_yaw(to_quaternion(pose.theta), 'push_request')]
    values += [*friction_center(request.obj), request.cone_fraction]
    message = JointTrajectory(joint_names=list(FIELDS))
    message.header.stamp, message.header.frame_id = stamp, frame
    message.points = [JointTrajectoryPoint(positions=[float(value) for value in values])]
    return message


def from_request_message(message: JointTrajectory, frame: str, obj: PushedObject,
                         topic: str = 'push_request') -> PlanRequest:
    """
    Read a plan request.

    :param message: ``trajectory_msgs/JointTrajectory``.
    :param frame: id of the world frame.
    :param obj: the nominal ``PushedObject``.
    :param topic: what errors call the message.
    :return: the ``PlanRequest``, of an object whose centre of friction is that of the message.
    :raises MessageRefused: naming the field, what came and what was expected.
    """
    check_frame(message.header.frame_id, frame, topic)
    values = _values(message, topic)
    for name, value in values.items():
        if not math.isfinite(value):
            raise MessageRefused(f'{topic}: {name}: got {value:g}, expected a finite number')
    fraction = values[CONE_FRACTION]
    if not 0.0 < fraction <= 1.0:
        raise MessageRefused(f'{topic}: {CONE_FRACTION}: got {fraction:g}, expected a number '
                             'above 0, at most 1')
    object_pose, robot_pose, goal = (
        Pose(values[f'{pose}.x'], values[f'{pose}.y'], values[f'{pose}.heading'])
        for pose in POSES)
    center = tuple(values[name] for name in FRICTION_CENTER)
    return PlanRequest(object_pose, robot_pose, goal, with_friction_center(obj, center), fraction)


def _values(message: JointTrajectory, topic: str) -> Dict[str, float]:
    """Read the numbers of a message by name, each of ``FIELDS`` once and no other."""
    names = list(message.joint_names)
    unknown = sorted(set(names) - set(FIELDS))
    if unknown:
        raise MessageRefused(f'{topic}: got the unknown fields {", ".join(unknown)}, expected '
                             + ', '.join(FIELDS))
    missing = [name for name in FIELDS if name not in names]
    if missing:
        raise MessageRefused(f'{topic}: {", ".join(missing)}: got nothing, expected a number')
    if len(names) != len(FIELDS):
        twice = sorted(name for name in FIELDS if names.count(name) > 1)
        raise MessageRefused(f'{topic}: {", ".join(twice)}: got more than one, expected one')
    if len(message.points) != 1:
        raise MessageRefused(f'{topic}: got {len(message.points)} points, expected 1')
    positions = list(message.points)[0].positions
    if len(positions) != len(names):
        raise MessageRefused(f'{topic}: got {len(positions)} positions, expected {len(names)}, '
                             'one for each joint name')
    return dict(zip(names, positions))
