"""
Plans to messages and back.

A plan is a ``trajectory_msgs/JointTrajectory`` whose joint names say what each number is, as those
of a plan request do. Each point has poses of object, contact and robot as positions, and their
rates as velocities. The numbers of the push itself do not move: its style, where it is straight
its line, and where one is stated its outlook. Where there is no plan the only number is the code
of the failure.
"""

from typing import Any, Iterable

from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
import numpy as np
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.outlook import Outlook, OUTLOOK_NAMES
from push_model.plan_request import PlanFailure
from push_model.trajectory import PushLine, PushStyle, PushTrajectory
from push_ros.conversions.joint_names import check_joint_names
from push_ros.conversions.primitives import (
    check_frame, MAX_POSITION, MAX_VELOCITY, MessageRefused, seconds, to_pose_message, to_stamp,
)
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

BODIES = ('object', 'contact', 'robot')
# Numbers of the motion, in the order of the columns of a trajectory.
MOTION = tuple(f'{body}.{part}' for body in BODIES for part in ('x', 'y', 'heading'))
STYLE = 'style'
LINE = ('start.x', 'start.y', 'start.heading', 'curvature', 'length', 'face')
FAILURE = 'failure'
STYLE_CODES = {PushStyle.STEERED: 0, PushStyle.STRAIGHT: 1, PushStyle.WAYPOINT: 2}
FAILURE_CODES = {failure: code for code, failure in enumerate(PlanFailure, 1)}


def to_plan_message(trajectory: PushTrajectory, stamp: Time, frame: str) -> JointTrajectory:
    """
    Convert a trajectory to a message.

    :param stamp: of the newest measurement that the plan starts from, or of its request.
    :param frame: id of the world frame.
    """
    push = _push_values(trajectory)
    poses, rates = (np.hstack([getattr(trajectory, f'{body}_{kind}') for body in BODIES])
                    for kind in ('poses', 'twists'))
    constants = list(push.values())
    at_rest = [0.0] * len(push)
    message = JointTrajectory(joint_names=[*push, *MOTION])
    message.header.stamp, message.header.frame_id = stamp, frame
    message.points = [
        JointTrajectoryPoint(positions=constants + positions, velocities=at_rest + velocities,
                             time_from_start=to_stamp(time, Duration))
        for time, positions, velocities in zip(trajectory.times.tolist(), poses.tolist(),
                                               rates.tolist())]
    return message


def no_plan_message(failure: PlanFailure, stamp: Time, frame: str) -> JointTrajectory:
    """
    Make the answer to a request for which there is no plan.

    :param failure: why.
    :param stamp: of the request.
    :param frame: id of the world frame.
    """
    message = JointTrajectory(joint_names=[FAILURE])
    message.header.stamp, message.header.frame_id = stamp, frame
    message.points = [JointTrajectoryPoint(positions=[float(FAILURE_CODES[failure])])]
    return message


def plan_failure(message: JointTrajectory) -> PlanFailure | None:
    """
    Read why there is no plan.

    :param message: ``trajectory_msgs/JointTrajectory``.
    :return: ``PlanFailure``, ``INVALID_PLAN`` for a code that is unknown; None where the message
        is a plan.
    """
    points = list(message.points)
    if FAILURE not in message.joint_names:
        return None if points else PlanFailure.INVALID_PLAN
    if len(points) == 1 and len(points[0].positions) == 1:
        for failure, code in FAILURE_CODES.items():
            if points[0].positions[0] == code:
                return failure
    return PlanFailure.INVALID_PLAN


def from_plan_message(message: JointTrajectory, frame: str,
                      topic: str = 'push_plan') -> PushTrajectory:
    """
    Read a trajectory; angles are unwrapped from sample to sample.

    :param message: ``trajectory_msgs/JointTrajectory``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: naming what is wrong with it.
    """
    check_frame(message.header.frame_id, frame, topic)
    names = list(message.joint_names)
    check_joint_names(names, (STYLE, *MOTION), topic, optional=(*LINE, *OUTLOOK_NAMES))
    positions = _field_values(message, 'positions', MAX_POSITION, topic)
    velocities = _field_values(message, 'velocities', MAX_VELOCITY, topic)
    style = _style(_constant(STYLE, names, positions, topic), topic)
    expected = (STYLE, *(LINE if style.is_straight else ()),
                *(OUTLOOK_NAMES if OUTLOOK_NAMES[0] in names else ()))
    check_joint_names(names, (*expected, *MOTION), topic)
    arrays: dict[str, Any] = {
        'times': [seconds(point.time_from_start) for point in message.points]}
    columns = [names.index(name) for name in MOTION]
    for index, body in enumerate(BODIES):
        selected = columns[3 * index:3 * index + 3]
        poses = positions[:, selected]
        poses[:, 2] = np.unwrap(poses[:, 2])
        arrays[f'{body}_poses'], arrays[f'{body}_twists'] = poses, velocities[:, selected]
    constants = {name: _constant(name, names, positions, topic) for name in expected}
    line = _line([constants[name] for name in LINE], topic) if style.is_straight else None
    try:
        outlook = Outlook.from_values(constants) if OUTLOOK_NAMES[0] in expected else None
        return PushTrajectory(**arrays, style=style, line=line, outlook=outlook)
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


def _push_values(trajectory: PushTrajectory) -> dict[str, float]:
    """List the numbers of the push itself by name."""
    values = {STYLE: float(STYLE_CODES[trajectory.style])}
    line = trajectory.line
    if line is not None:
        line_values = (*line.start, line.curvature, line.length, line.face)
        values.update(zip(LINE, map(float, line_values)))
    if trajectory.outlook is not None:
        values.update(trajectory.outlook.values())
    return values


def _field_values(message: JointTrajectory, field: str, largest: float, topic: str) -> FloatArray:
    """Read the numbers of a field, shape (points, names)."""
    names = list(message.joint_names)
    rows = [getattr(point, field) for point in message.points]
    for index, row in enumerate(rows):
        if len(row) != len(names):
            raise MessageRefused(f'{topic}: got {len(row)} {field} in point {index}, expected '
                                 f'{len(names)}, one for each joint name')
    values = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    # False for what is not a number as well.
    wrong = np.argwhere(~(np.abs(values) <= largest))
    if wrong.size:
        point, column = wrong[0].tolist()
        raise MessageRefused(f'{topic}: {names[column]}: got {values[point, column]:g} in the '
                             f'{field} of point {point}, expected a finite number of at most '
                             f'{largest:g}')
    return values


def _constant(name: str, names: list[str], positions: FloatArray, topic: str) -> float:
    """Read a number that is the same at all points."""
    column = positions[:, names.index(name)]
    if not column.size:
        raise MessageRefused(f'{topic}: got no points, expected a plan')
    if (column != column[0]).any():
        raise MessageRefused(f'{topic}: {name}: got {column.min():g} to {column.max():g}, '
                             'expected the same at all points')
    return float(column[0])


def _style(code: float, topic: str) -> PushStyle:
    for style, known in STYLE_CODES.items():
        if code == known:
            return style
    expected = ', '.join(f'{known} ({style.value})' for style, known in STYLE_CODES.items())
    raise MessageRefused(f'{topic}: {STYLE}: got {code:g}, expected one of {expected}')


def _line(values: list[float], topic: str) -> PushLine:
    x, y, heading, curvature, length, face = values
    if not face.is_integer():
        raise MessageRefused(f'{topic}: face: got {face:g}, expected a whole number from 0 on')
    return PushLine(Pose(x, y, heading), curvature, length, int(face))
