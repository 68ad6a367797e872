"""
Plan requests to messages and back.

A request is a ``trajectory_msgs/JointTrajectory`` of one point, whose joint names say what each
of its positions is: poses of object, robot and goal in the world frame, the parameters of the
object with friction as identified, the fraction of the friction cone that the plan should use, the
tolerances, standard deviations of what was identified, and the kind of plan, as its number in
``RequestKind``. The planner need know neither the object nor what the controller does with it.
"""

from typing import Any, Sequence

from push_model.files.flat_values import (
    from_parameter_values, parameter_specs, to_parameter_values,
)
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.plan_request import (
    MAX_HEADING_TOLERANCE, MAX_TOLERANCE, MIN_TOLERANCE, PlanRequest, RequestKind)
from push_ros.conversions.joint_names import check_joint_names
from push_ros.conversions.primitives import check_frame, MessageRefused, to_quaternion, to_yaw
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

POSES = ('object', 'robot', 'goal')
# Largest number of a request, in its unit; chosen: as the largest position of other messages, far
# below where products of such numbers overflow.
MAX_VALUE = 1e7
# Prefix of the parameters of the object; numbers of a list follow, from 0 on: outline.0, ...
PARAMETERS = 'object.'
CONE_FRACTION = 'cone_fraction'
KIND = 'kind'
KINDS = tuple(RequestKind)
# Tolerances, and numbers of at least 0, that are fields of the request under the same name.
TOLERANCES = {'position_tolerance': MAX_TOLERANCE, 'heading_tolerance': MAX_HEADING_TOLERANCE}
DEVIATIONS = ('robot_deviation', 'center_deviation', 'contact_friction_deviation',
              'odometry_slope', 'odometry_drift')
# Parameters of any object that are one number, and those that are lists.
SCALARS = tuple(spec.name for spec in parameter_specs(PushedObject, PARAMETERS)
                if spec.kind is float)
LISTS = tuple(spec.name for spec in parameter_specs(PushedObject, PARAMETERS)
              if spec.kind is not float)
FIELDS = (*(f'{pose}.{part}' for pose in POSES for part in ('x', 'y', 'heading')),
          KIND, CONE_FRACTION, *TOLERANCES, *DEVIATIONS, *SCALARS)


def to_request_message(request: PlanRequest, stamp: Any, frame: str) -> JointTrajectory:
    """
    Convert a plan request to a message.

    :param stamp: ``builtin_interfaces/Time`` of the measurement that it comes from.
    :param frame: id of the world frame.
    :return: ``trajectory_msgs/JointTrajectory``; see the module on its fields.
    """
    values: dict[str, float] = {}
    for name, pose in zip(POSES, (request.object_pose, request.robot_pose, request.goal)):
        # The heading as a quaternion carries it, like that of every other pose on a topic.
        heading = to_yaw(to_quaternion(pose.theta), 'push_request')
        values.update({f'{name}.x': pose.x, f'{name}.y': pose.y, f'{name}.heading': heading})
    values[KIND] = KINDS.index(request.kind)
    values.update({name: getattr(request, name)
                   for name in (CONE_FRACTION, *TOLERANCES, *DEVIATIONS)})
    values.update(_object_values(request.obj))
    message = JointTrajectory(joint_names=list(values))
    message.header.stamp, message.header.frame_id = stamp, frame
    message.points = [JointTrajectoryPoint(
        positions=[float(value) for value in values.values()])]
    return message


def from_request_message(message: JointTrajectory, frame: str,
                         topic: str = 'push_request') -> PlanRequest:
    """
    Read a plan request.

    :param message: ``trajectory_msgs/JointTrajectory``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :raises MessageRefused: naming the field, what came and what was expected.
    """
    check_frame(message.header.frame_id, frame, topic)
    values = _values(message, topic)
    _check_ranges(values, topic)
    object_pose, robot_pose, goal = (
        Pose(values[f'{pose}.x'], values[f'{pose}.y'], values[f'{pose}.heading'])
        for pose in POSES)
    return PlanRequest(object_pose, robot_pose, goal, _object(values, topic),
                       values[CONE_FRACTION],
                       *(values[name] for name in (*TOLERANCES, *DEVIATIONS)),
                       kind=KINDS[int(values[KIND])])


def _check_ranges(values: dict[str, float], topic: str) -> None:
    """Refuse numbers with which nobody can compute."""
    for name, value in values.items():
        # False for what is not a number as well.
        if not abs(value) <= MAX_VALUE:
            raise MessageRefused(f'{topic}: {name}: got {value:g}, expected a finite number of at '
                                 f'most {MAX_VALUE:g}')
    if values[KIND] not in range(len(KINDS)):
        raise MessageRefused(f'{topic}: {KIND}: got {values[KIND]:g}, expected a whole number '
                             f'from 0 to {len(KINDS) - 1}')
    fraction = values[CONE_FRACTION]
    if not 0.0 < fraction <= 1.0:
        raise MessageRefused(f'{topic}: {CONE_FRACTION}: got {fraction:g}, expected a number '
                             'above 0, at most 1')
    for name, most in TOLERANCES.items():
        if not MIN_TOLERANCE <= values[name] <= most:
            raise MessageRefused(f'{topic}: {name}: got {values[name]:g}, expected a number from '
                                 f'{MIN_TOLERANCE:g} to {most:g}')
    for name in DEVIATIONS:
        if values[name] < 0.0:
            raise MessageRefused(f'{topic}: {name}: got {values[name]:g}, expected a number of at '
                                 'least 0')


def _object_values(obj: PushedObject) -> dict[str, float]:
    """List the parameters of an object, each number of a list under its own name."""
    values: dict[str, float] = {}
    for name, value in to_parameter_values(obj, PARAMETERS).items():
        if isinstance(value, list):
            values.update({f'{name}.{index}': item for index, item in enumerate(value)})
        else:
            values[name] = value
    return values


def _object(values: dict[str, float], topic: str) -> PushedObject:
    """Make the object of the parameters in a message."""
    parameters = {**{name: values[name] for name in SCALARS},
                  **{name: _list(name, values, topic) for name in LISTS}}
    try:
        return from_parameter_values(PushedObject, parameters, PARAMETERS)
    except ValueError as error:
        raise MessageRefused(f'{topic}: {error}') from error


def _list(name: str, values: dict[str, float], topic: str) -> list[float]:
    """Read a list, whose numbers are there from 0 on without a gap."""
    count = sum(_list_name(field) == name for field in values)
    fields = [f'{name}.{index}' for index in range(count)]
    missing = [field for field in fields if field not in values]
    if missing:
        raise MessageRefused(f'{topic}: {missing[0]}: got nothing, expected a number')
    return [values[field] for field in fields]


def _list_name(field: str) -> str:
    """Return the name of the list that a field belongs to; empty where it belongs to none."""
    name, _, index = field.rpartition('.')
    return name if index.isdecimal() and name in LISTS else ''


def _values(message: JointTrajectory, topic: str) -> dict[str, float]:
    """Read the numbers of a message by name: each of ``FIELDS``, and of the lists, once."""
    names: Sequence[str] = list(message.joint_names)
    # Lists may be longer than the one number that errors name.
    optional = {*(f'{name}.0' for name in LISTS), *filter(_list_name, names)}
    check_joint_names(names, FIELDS, topic, sorted(optional))
    if len(message.points) != 1:
        raise MessageRefused(f'{topic}: got {len(message.points)} points, expected 1')
    positions = list(message.points)[0].positions
    if len(positions) != len(names):
        raise MessageRefused(f'{topic}: got {len(positions)} positions, expected {len(names)}, '
                             'one for each joint name')
    return dict(zip(names, positions))
