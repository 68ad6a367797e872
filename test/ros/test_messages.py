"""Values survive the way through messages, and bad messages are refused by name."""

import dataclasses
import math

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Quaternion, Twist as TwistMessage
from helpers.outlooks import OUTLOOK
import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, PoseCovariance, Twist
from push_model.trajectory import COLUMNS, PushLine, PushStyle, PushTrajectory
from push_ros.conversions.measurements import (
    from_object_pose_message, from_odometry_message, to_object_pose_message, to_odometry_message,
    to_wrench_message,
)
from push_ros.conversions.plan import from_plan_message, to_path_message, to_plan_message
from push_ros.conversions.primitives import (
    check_frame, from_pose_message, from_twist_message, MessageRefused, nanoseconds, seconds,
    to_pose_message, to_stamp, to_yaw,
)
import pytest
from rclpy.serialization import deserialize_message, serialize_message

ANGLES = np.linspace(-math.pi, math.pi, 49)[1:]


def sent(message):
    """Send a message through serialization and back."""
    return deserialize_message(serialize_message(message), type(message))


def trajectory(count=40):
    """Make a trajectory whose object turns twice round."""
    times = np.linspace(0.0, 8.0, count)
    rng = np.random.default_rng(3)
    arrays = {name: rng.normal(size=(count, 3)) for name in COLUMNS}
    for name in ('object_poses', 'contact_poses', 'robot_poses'):
        arrays[name][:, 2] = np.linspace(-0.5, 12.0, count)
    return PushTrajectory(times=times, **arrays)


@pytest.mark.parametrize('number', [0, 1, 999_999_999, 20_000_000, 123_456_789_012_345])
def test_stamps_keep_every_nanosecond(number):
    """Time in seconds, as the plant counts it, finds its stamp again."""
    assert nanoseconds(to_stamp(number / 1e9)) == number
    assert seconds(to_stamp(number / 1e9)) == number / 1e9


def test_a_duration_is_made_as_asked():
    """The type of a stamp can be chosen."""
    assert to_stamp(1.5, Duration) == Duration(sec=1, nanosec=500_000_000)


@pytest.mark.parametrize('angle', ANGLES)
def test_poses_survive(angle):
    """Positions exactly, angles to rounding."""
    pose = from_pose_message(sent(to_pose_message((0.1, -7.3, angle))), 'pose')
    assert pose[:2] == (0.1, -7.3)
    assert abs(wrap_angle(pose.theta - angle)) < 1e-15


def test_yaw_does_not_depend_on_the_length_or_sign_of_the_quaternion():
    """q, -q and 3 q are one rotation."""
    q = to_pose_message((0.0, 0.0, 2.2)).orientation
    for factor in (1.0, -1.0, 3.0, 0.01):
        scaled = Quaternion(x=factor * q.x, y=factor * q.y, z=factor * q.z, w=factor * q.w)
        assert to_yaw(scaled, 'pose') == pytest.approx(2.2, abs=1e-14)


def test_yaw_of_a_tilted_body_is_that_of_its_x_axis():
    """Against the rotation matrix of the quaternion."""
    x, y, z, w = np.array([0.1, -0.2, 0.6, 0.7]) / np.linalg.norm([0.1, -0.2, 0.6, 0.7])
    axis = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z)])
    assert to_yaw(Quaternion(x=x, y=y, z=z, w=w), 'pose') == pytest.approx(
        math.atan2(axis[1], axis[0]))


@pytest.mark.parametrize('field, value', [('x', math.nan), ('y', math.inf)])
def test_a_position_that_is_not_finite_is_refused(field, value):
    """The error names the topic and what came."""
    message = to_pose_message((0.0, 0.0, 0.0))
    setattr(message.position, field, value)
    with pytest.raises(MessageRefused, match=f'object_pose: got the position .*{value}'):
        from_pose_message(message, 'object_pose')


@pytest.mark.parametrize('w', [0.0, math.nan, 1e-9])
def test_a_quaternion_without_direction_is_refused(w):
    """Zero is what an uninitialised message has."""
    with pytest.raises(MessageRefused, match='goal_pose: got the quaternion'):
        to_yaw(Quaternion(w=w), 'goal_pose')


def test_frames_must_agree_but_for_a_leading_slash():
    """The error names both frames."""
    check_frame('/odom', 'odom', 'odom')
    with pytest.raises(MessageRefused, match="object_pose: got frame 'map', expected 'odom'"):
        check_frame('map', 'odom', 'object_pose')


def test_measurements_survive():
    """Odometry and object poses, with stamps and frames."""
    odometry = Odometry(1.02, Pose(1.0, 2.0, 0.5), Twist(0.2, -0.1, 0.3))
    message = sent(to_odometry_message(odometry, 'odom', 'base_link'))
    assert message.child_frame_id == 'base_link'
    back = from_odometry_message(message, 'odom')
    assert (back.time, back.twist) == (odometry.time, odometry.twist)
    assert back.pose == pytest.approx(odometry.pose, abs=1e-15)
    pose = ObjectPose(0.35, Pose(-1.0, 0.0, -3.0))
    back = from_object_pose_message(sent(to_object_pose_message(pose, 'odom')), 'odom')
    assert back.time == pose.time and back.pose == pytest.approx(pose.pose, abs=1e-15)
    with pytest.raises(MessageRefused, match="'odom'.*'world'"):
        from_odometry_message(message, 'world')


def test_a_stated_covariance_survives():
    """Of x, y and yaw, in both triangles of the message; the other axes state nothing."""
    covariance = PoseCovariance(4e-6, 1e-6, -2e-6, 9e-6, 3e-6, 1e-4)
    odometry = Odometry(1.0, Pose(1.0, 2.0, 0.5), Twist(), covariance)
    message = sent(to_odometry_message(odometry, 'odom', 'base_link'))
    matrix = np.array(message.pose.covariance).reshape(6, 6)
    plane = np.ix_((0, 1, 5), (0, 1, 5))
    assert np.array_equal(matrix[plane], covariance.matrix)
    assert np.count_nonzero(matrix) == 9
    assert from_odometry_message(message, 'odom').covariance == covariance


@pytest.mark.parametrize('covariance', [None, PoseCovariance(4e-6, 1e-6, -2e-6, 9e-6, 3e-6, 1e-4)])
def test_an_object_pose_states_its_covariance_or_none(covariance):
    """Both types of message carry the same pose."""
    pose = ObjectPose(0.35, Pose(-1.0, 0.0, 0.0), covariance)
    stated = sent(to_object_pose_message(pose, 'odom', with_covariance=True))
    assert from_object_pose_message(stated, 'odom') == pose
    plain = sent(to_object_pose_message(pose, 'odom'))
    assert from_object_pose_message(plain, 'odom') == pose._replace(covariance=None)


@pytest.mark.parametrize('tilt, is_refused', [(0.2, False), (0.3, True), (math.pi, True)])
@pytest.mark.parametrize('with_covariance', [False, True])
def test_an_object_that_does_not_stand_upright_is_refused(tilt, is_refused, with_covariance):
    """Whatever its yaw; a few degrees are the noise of a tag."""
    message = to_object_pose_message(ObjectPose(0.0, Pose(0.0, 0.0, 0.0)), 'odom',
                                     with_covariance=with_covariance)
    pose = message.pose.pose if with_covariance else message.pose
    pose.orientation = Quaternion(x=math.sin(tilt / 2) * 0.6, y=math.sin(tilt / 2) * 0.8,
                                  z=math.cos(tilt / 2) * 0.6, w=math.cos(tilt / 2) * 0.8)
    if not is_refused:
        assert from_object_pose_message(message, 'odom').pose[:2] == (0.0, 0.0)
        return
    with pytest.raises(MessageRefused, match=rf'object_pose: .* tilted by {tilt:.2f} rad'):
        from_object_pose_message(message, 'odom')


@pytest.mark.parametrize('diagonal', [(0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (-1.0, -1.0, -1.0),
                                      (1e-3, 1e-3, 0.0), (0.0, 1e-3, 1e-2)])
def test_a_covariance_that_is_not_stated_is_none(diagonal):
    """As drivers leave it, or with the heading or a position left out."""
    message = to_odometry_message(Odometry(1.0, Pose(0.0, 0.0, 0.0), Twist()), 'odom', 'base')
    for place, variance in zip((0, 7, 35), diagonal):
        message.pose.covariance[place] = variance
    assert from_odometry_message(sent(message), 'odom').covariance is None


@pytest.mark.parametrize('place, value, text', [
    (0, math.nan, 'variance nan of x'), (7, -0.5, 'variance -0.5 of y'),
    (35, math.inf, 'variance inf of yaw'), (7, 1e200, 'variance 1e\\+200 of y'),
    (1, 2e-3, 'full correlation'), (1, -1e200, 'full correlation'),
    (11, math.nan, 'full correlation')])
def test_a_covariance_that_is_none_is_refused(place, value, text):
    """The error names the field and the axis."""
    covariance = PoseCovariance.from_deviations(0.03, 0.03)
    message = to_odometry_message(Odometry(1.0, Pose(0.0, 0.0, 0.0), Twist(), covariance), 'odom',
                                  'base')
    message.pose.covariance[place] = value
    with pytest.raises(MessageRefused, match=rf'odom\.pose\.covariance: .*{text}'):
        from_odometry_message(message, 'odom')


def test_a_twist_that_is_not_finite_is_refused():
    """The error names the topic."""
    message = TwistMessage()
    message.angular.z = math.nan
    with pytest.raises(MessageRefused, match='cmd_vel: .*nan'):
        from_twist_message(message)


def test_a_wrench_is_a_force_in_its_frame():
    """Nothing but the two components."""
    message = to_wrench_message((1.0, -2.0), to_stamp(1.0), 'object')
    assert (message.wrench.force.x, message.wrench.force.y, message.wrench.force.z) == (1, -2, 0)
    assert message.header.frame_id == 'object'


def straight(style=PushStyle.STRAIGHT):
    """Make the trajectory of a push along an arc; its times are whole nanoseconds."""
    line = PushLine(Pose(-0.37, 0.051, 0.1), -1.2, 0.4, 3)
    plan = trajectory()
    distances = np.linspace(0.0, line.length, len(plan.times))
    return dataclasses.replace(
        plan, times=np.arange(len(plan.times)) / 5.0, style=style, line=line,
        robot_poses=line.robot_poses(Pose(*plan.object_poses[0].tolist()), distances),
        outlook=OUTLOOK)


def test_steered_plans_survive_with_whole_turns_within_them():
    """All arrays come back to the bit, times to the nanosecond."""
    plan = trajectory()
    back = from_plan_message(sent(to_plan_message(plan, to_stamp(2.0), 'odom')), 'odom')
    assert np.abs(back.times - plan.times).max() < 1e-9
    for name in COLUMNS:
        assert np.array_equal(getattr(back, name), getattr(plan, name))
    assert back.style is PushStyle.STEERED and back.line is None


@pytest.mark.parametrize('style', [PushStyle.STRAIGHT, PushStyle.WAYPOINT])
def test_a_plan_says_which_push_it_is(style):
    """Style, start, curvature, length and face come back as they were, and so do the samples."""
    plan = straight(style)
    back = from_plan_message(sent(to_plan_message(plan, to_stamp(2.0), 'odom')), 'odom')
    assert (back.style, back.line) == (style, plan.line)
    for name in ('times', *COLUMNS):
        assert np.array_equal(getattr(back, name), getattr(plan, name))


def test_a_plan_carries_what_it_states_of_the_end() -> None:
    """All of it or nothing."""
    message = sent(to_plan_message(straight(), to_stamp(2.0), 'odom'))
    assert from_plan_message(message, 'odom').outlook == OUTLOOK
    _remove('time.p90')(message)
    with pytest.raises(MessageRefused, match='time.p90: got nothing, expected a number'):
        from_plan_message(message, 'odom')


def test_joints_may_come_in_another_order():
    """They are found by name."""
    plan = straight()
    message = to_plan_message(plan, to_stamp(0.0), 'odom')
    message.joint_names = list(reversed(message.joint_names))
    for point in message.points:
        point.positions = list(reversed(point.positions))
        point.velocities = list(reversed(point.velocities))
    back = from_plan_message(message, 'odom')
    assert np.array_equal(back.object_twists, plan.object_twists)
    assert back.line == plan.line


def set_number(message, name, value, points=slice(None)):
    """Write a number of some points."""
    column = list(message.joint_names).index(name)
    for point in message.points[points]:
        point.positions[column] = value


def _remove(name):
    def spoil(message):
        column = list(message.joint_names).index(name)
        del message.joint_names[column]
        for point in message.points:
            del point.positions[column], point.velocities[column]
    return spoil


def _set(name, value, points=slice(None)):
    return lambda message: set_number(message, name, value, points)


def _unknown(message):
    message.joint_names[-1] = 'arm.heading'


def _twice(message):
    message.joint_names[-1] = 'object.x'


def _short_point(message):
    message.points[3].velocities.pop()


def _one_point(message):
    message.points = message.points[:1]


def _no_point(message):
    message.points = []


def _backwards(message):
    message.points[5].time_from_start = to_stamp(0.1, Duration)


def _map(message):
    message.header.frame_id = 'map'


@pytest.mark.parametrize('spoil, text', [
    (_unknown, 'unknown fields arm.heading'), (_twice, 'robot.heading: got nothing'),
    (_remove('contact.y'), 'contact.y: got nothing, expected a number'),
    *((_remove(name), f'{name}: got nothing, expected a number')
      for name in ('style', 'start.x', 'start.y', 'start.heading', 'curvature', 'length', 'face')),
    (_short_point, '28 velocities in point 3, expected 29'), (_one_point, 'got 1 samples'),
    (_no_point, 'got no points'), (_backwards, 'increasing'),
    (_map, "frame 'map', expected 'odom'"),
    (_set('contact.x', math.nan, slice(2, 3)), 'contact.x: got nan in the positions of point 2'),
    (_set('style', 7.0), '0 .steered., 1 .straight., 2 .waypoint.'),
    (_set('style', 0.0), 'unknown fields curvature, face, length, start.heading'),
    (_set('curvature', 0.5, slice(4, 5)), 'curvature: got -1.2 to 0.5, expected the same at all'),
    (_set('curvature', 0.5), 'got ends 0.1.* m beside those of robot_poses'),
    (_set('start.x', -0.3), 'got ends 0.07 m beside'), (_set('length', 0.0), 'a length above 0'),
    (_set('face', 1.5), 'face: got 1.5, expected a whole number'),
    (_set('face', -1.0), 'a face from 0 on'), (_set('chance', 1.5), 'chance: got 1.5'),
    (_set('time.p95', 10.0), 'time: got .* that do not fall')])
def test_a_malformed_plan_is_refused(spoil, text):
    """The error says what is wrong."""
    message = to_plan_message(straight(), to_stamp(0.0), 'odom')
    spoil(message)
    with pytest.raises(MessageRefused, match=f'(?s)push_plan: .*{text}'):
        from_plan_message(message, 'odom')


def test_the_path_is_the_way_of_the_object():
    """One pose per sample, in the frame of the path."""
    plan = trajectory()
    path = to_path_message(plan.object_poses, to_stamp(1.0), 'odom')
    assert [(p.pose.position.x, p.pose.position.y) for p in path.poses] \
        == [tuple(row[:2]) for row in plan.object_poses.tolist()]
    assert {p.header.frame_id for p in path.poses} == {'odom'} == {path.header.frame_id}
