"""Whatever a message holds, it is read as finite values, or refused by name."""

import math

from geometry_msgs.msg import (
    Point, Pose as PoseMessage, PoseStamped, PoseWithCovarianceStamped, Quaternion,
    Twist as TwistMessage, Vector3,
)
from helpers.fuzzing import hypothesis, NUMBERS, settings, st, TEXTS
from nav_msgs.msg import OccupancyGrid, Odometry as OdometryMessage
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_model.plan_request import PlanRequest
from push_ros.conversions.map import from_map_message
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import (
    FAILURE, from_plan_message, LINE, MOTION, plan_failure, STYLE)
from push_ros.conversions.plan_request import from_request_message, to_request_message
from push_ros.conversions.primitives import (
    from_twist_message, MessageRefused, seconds, to_stamp,
)
from push_ros.diagnostics import MAX_TEXT, shortened
import pytest
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

OBJECT = PushedObject(mass=5.0, supports=(Support(0.0, 0.0, 0.3),),
                      outline=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)))
REQUEST = PlanRequest(Pose(0.0, 0.0, 0.1), Pose(-1.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0), OBJECT)
STAMPS = st.builds(lambda sec, nanosec: to_stamp(sec + 1e-9 * nanosec),
                   st.integers(-2 ** 31, 2 ** 31 - 2), st.integers(0, 10 ** 9 - 1))
POSES = st.builds(
    lambda p, q: PoseMessage(position=Point(x=p[0], y=p[1], z=p[2]),
                             orientation=Quaternion(x=q[0], y=q[1], z=q[2], w=q[3])),
    st.tuples(NUMBERS, NUMBERS, NUMBERS),
    st.one_of(st.just((0.0, 0.0, 0.6, 0.8)), st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS)))
TWISTS = st.builds(lambda v: TwistMessage(linear=Vector3(x=v[0], y=v[1]), angular=Vector3(z=v[2])),
                   st.tuples(NUMBERS, NUMBERS, NUMBERS))
COVARIANCES = st.dictionaries(st.integers(0, 35), NUMBERS, max_size=5).map(
    lambda entries: [entries.get(place, 0.0) for place in range(36)])


def read(function, *arguments):
    """Read a message; a refusal is short once it is logged, and says what was expected."""
    try:
        return function(*arguments)
    except MessageRefused as error:
        assert str(error) and len(shortened(str(error))) < 2 * MAX_TEXT
        return None


def stamped(message, frame, stamp):
    """Put a header on a message."""
    message.header.frame_id, message.header.stamp = frame, stamp
    return message


@settings()
@hypothesis.given(POSES, TWISTS, COVARIANCES, TEXTS, STAMPS)
def test_odometry(pose, twist, covariance, frame, stamp):
    """All of what is read is finite."""
    message = stamped(OdometryMessage(), frame, stamp)
    message.pose.pose, message.twist.twist = pose, twist
    message.pose.covariance = np.array(covariance)
    measured = read(from_odometry_message, message, 'odom')
    if measured is not None:
        assert frame.lstrip('/') == 'odom' and math.isfinite(measured.time)
        assert measured.pose.is_finite() and all(map(math.isfinite, measured.twist))
        assert measured.covariance is None or all(map(math.isfinite, measured.covariance))


@settings()
@hypothesis.given(POSES, COVARIANCES, TEXTS, st.booleans())
def test_object_poses_and_goals(pose, covariance, frame, with_covariance):
    """Likewise; and they stand upright."""
    if with_covariance:
        message = stamped(PoseWithCovarianceStamped(), frame, to_stamp(1.0))
        message.pose.pose, message.pose.covariance = pose, np.array(covariance)
    else:
        message = stamped(PoseStamped(pose=pose), frame, to_stamp(1.0))
    measured = read(from_object_pose_message, message, 'odom')
    if measured is not None:
        assert measured.pose.is_finite() and abs(measured.pose.theta) <= math.pi


@settings()
@hypothesis.given(TWISTS)
def test_commands(twist):
    """Of somebody else."""
    command = read(from_twist_message, twist)
    assert command is None or all(map(math.isfinite, command))


@settings()
@hypothesis.given(st.one_of(st.floats(width=32), st.just(0.05)), st.integers(0, 5),
                  st.integers(0, 5), st.lists(st.integers(-128, 127), max_size=30), POSES, TEXTS)
def test_maps(resolution, width, height, cells, origin, frame):
    """They have the cells that they state."""
    message = stamped(OccupancyGrid(), frame, to_stamp(0.0))
    message.info.resolution, message.info.origin = resolution, origin
    message.info.width, message.info.height = width, height
    message.data = cells
    found = read(from_map_message, message, 'odom')
    if found is not None:
        assert found.occupied.shape == (height, width) and found.resolution > 0.0


@settings()
@hypothesis.given(st.lists(st.sampled_from([*LINE, STYLE, FAILURE, '']), max_size=8),
                  st.booleans(), st.lists(st.tuples(st.integers(-5, 5), st.integers(-1, 1),
                                                    st.integers(-1, 1), NUMBERS), max_size=4))
def test_plans(names, has_motion, points):
    """Nothing but a plan passes for one."""
    names = names + list(MOTION) if has_motion else names
    message = stamped(JointTrajectory(joint_names=names), 'odom', to_stamp(0.0))
    for time, positions, velocities, number in points:
        message.points.append(JointTrajectoryPoint(
            positions=[number] * max(0, len(names) + positions // 2),
            velocities=[number] * max(0, len(names) + velocities // 2)))
        message.points[-1].time_from_start.sec = time
    plan_failure(message)
    plan = read(from_plan_message, message, 'odom')
    if plan is not None:
        assert np.isfinite(plan.object_poses).all() and np.isfinite(plan.robot_twists).all()
        assert (np.diff(plan.times) > 0.0).all()


@settings()
@hypothesis.given(st.dictionaries(st.integers(0, 40), NUMBERS, max_size=4),
                  st.dictionaries(st.integers(0, 40), TEXTS, max_size=2), st.integers(0, 2))
def test_plan_requests(numbers, texts, count):
    """A request that was spoilt somewhere."""
    message = to_request_message(REQUEST, to_stamp(0.0), 'odom')
    values, names = list(message.points[0].positions), list(message.joint_names)
    for index, number in numbers.items():
        values[index % len(values)] = number
    for index, text in texts.items():
        names[index % len(names)] = text
    message.points[0].positions, message.joint_names = values, names
    message.points = [message.points[0]] * count
    request = read(from_request_message, message, 'odom')
    if request is not None:
        assert request.goal.is_finite() and request.object_pose.is_finite()
        assert 0.0 < request.cone_fraction <= 1.0


def test_a_request_that_is_not_spoilt_is_read():
    """The strategies begin with messages that pass."""
    message = to_request_message(REQUEST, to_stamp(2.0), 'odom')
    assert from_request_message(message, 'odom').goal == pytest.approx(REQUEST.goal)
    assert seconds(message.header.stamp) == 2.0
