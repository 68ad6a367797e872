"""
Plan requests to messages and back.

A request is a ``trajectory_msgs/JointTrajectory`` of one point, whose joint names say what each
of its positions is: poses of object, robot and goal in the world frame, the friction of each
support and the contact friction as identified, the fraction of the friction cone that the plan
should use, the tolerances, and standard deviations of what was identified.
"""

import dataclasses
import math
from typing import Any

from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.plan_request import PlanRequest
from push_ros.conversions.primitives import check_frame, MessageRefused, to_quaternion, to_yaw
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

POSES = ('object', 'robot', 'goal')
# Prefix of the names of the friction coefficients of the supports, before their numbers from 0.
SUPPORT_FRICTION = 'support_friction.'
CONTACT_FRICTION = 'contact_friction'
CONE_FRACTION = 'cone_fraction'
# Numbers above 0, and of at least 0, that are fields of the request under the same name.
TOLERANCES = ('position_tolerance', 'heading_tolerance')
DEVIATIONS = ('robot_deviation', 'center_deviation', 'contact_friction_deviation')


def request_fields(obj: PushedObject) -> tuple[str, ...]:
    """
    List the names of the numbers in a request.

    :param obj: the ``PushedObject``, for the number of its supports.
    """
    return (*(f'{pose}.{part}' for pose in POSES for part in ('x', 'y', 'heading')),
            *(f'{SUPPORT_FRICTION}{number}' for number in range(len(obj.supports))),
            CONTACT_FRICTION, CONE_FRACTION, *TOLERANCES, *DEVIATIONS)


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
    obj = request.obj
    values += [*(support.friction_coefficient for support in obj.supports),
               obj.contact_friction_coefficient, request.cone_fraction,
               *(getattr(request, name) for name in (*TOLERANCES, *DEVIATIONS))]
    message = JointTrajectory(joint_names=list(request_fields(obj)))
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
    :return: the ``PlanRequest``, of an object with the friction of the message.
    :raises MessageRefused: naming the field, what came and what was expected.
    """
    check_frame(message.header.frame_id, frame, topic)
    values = _values(message, request_fields(obj), topic)
    for name, value in values.items():
        if not math.isfinite(value):
            raise MessageRefused(f'{topic}: {name}: got {value:g}, expected a finite number')
    fraction = values[CONE_FRACTION]
    if not 0.0 < fraction <= 1.0:
        raise MessageRefused(f'{topic}: {CONE_FRACTION}: got {fraction:g}, expected a number '
                             'above 0, at most 1')
    for name in (*TOLERANCES, *DEVIATIONS):
        if values[name] < 0.0 or (name in TOLERANCES and values[name] == 0.0):
            expected = 'above 0' if name in TOLERANCES else 'of at least 0'
            raise MessageRefused(f'{topic}: {name}: got {values[name]:g}, expected a number '
                                 f'{expected}')
    object_pose, robot_pose, goal = (
        Pose(values[f'{pose}.x'], values[f'{pose}.y'], values[f'{pose}.heading'])
        for pose in POSES)
    return PlanRequest(object_pose, robot_pose, goal, _with_friction(obj, values, topic), fraction,
                       *(values[name] for name in (*TOLERANCES, *DEVIATIONS)))


def _with_friction(obj: PushedObject, values: dict[str, float], topic: str) -> PushedObject:
    """Give an object the friction of a message."""
    try:
        supports = tuple(
            dataclasses.replace(support,
                                friction_coefficient=values[f'{SUPPORT_FRICTION}{number}'])
            for number, support in enumerate(obj.supports))
        return dataclasses.replace(obj, supports=supports,
                                   contact_friction_coefficient=values[CONTACT_FRICTION])
    except ValueError as error:
        raise MessageRefused(f'{topic}: {error}') from error


def _values(message: JointTrajectory, fields: tuple[str, ...], topic: str) -> dict[str, float]:
    """Read the numbers of a message by name, each of ``fields`` once and no other."""
    names = list(message.joint_names)
    unknown = sorted(set(names) - set(fields))
    if unknown:
        raise MessageRefused(f'{topic}: got the unknown fields {", ".join(unknown)}, expected '
                             + ', '.join(fields))
    missing = [name for name in fields if name not in names]
    if missing:
        raise MessageRefused(f'{topic}: {", ".join(missing)}: got nothing, expected a number')
    if len(names) != len(fields):
        twice = sorted(name for name in fields if names.count(name) > 1)
        raise MessageRefused(f'{topic}: {", ".join(twice)}: got more than one, expected one')
    if len(message.points) != 1:
        raise MessageRefused(f'{topic}: got {len(message.points)} points, expected 1')
    positions = list(message.points)[0].positions
    if len(positions) != len(names):
        raise MessageRefused(f'{topic}: got {len(positions)} positions, expected {len(names)}, '
                             'one for each joint name')
    return dict(zip(names, positions))
