"""Messages that are read and written as bytes: the same as by rclpy, whatever they hold."""

import struct

from geometry_msgs.msg import (
    PoseStamped, PoseWithCovarianceStamped, Twist as TwistMessage, TwistStamped,
)
import hypothesis
from hypothesis import strategies as st
from nav_msgs.msg import Odometry as OdometryMessage, Path
import numpy as np
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, Twist
from push_ros.conversions.measurements import (
    from_odometry_message, to_object_pose_message, to_odometry_message,
)
from push_ros.conversions.primitives import nanoseconds, to_twist_message
from push_ros.conversions.serialized import (
    message_reader, serialize_command, serialize_object_pose, serialize_odometry,
)
import pytest
from rclpy.serialization import deserialize_message, serialize_message

KINDS = (OdometryMessage, PoseStamped, PoseWithCovarianceStamped, TwistStamped, TwistMessage)
ODOMETRY = Odometry(12.34, Pose(1.0, 2.0, 0.5), Twist(0.2, -0.1, 0.3))


def filled(message, numbers, texts):
    """Fill a message of any type, field by field."""
    for name, kind in message.get_fields_and_field_types().items():
        if kind == 'double':
            setattr(message, name, next(numbers))
        elif kind == 'string':
            setattr(message, name, next(texts))
        elif kind == 'double[36]':
            setattr(message, name, np.array([next(numbers) for _ in range(36)]))
        elif kind in ('int32', 'uint32'):
            setattr(message, name, 2 ** 31 - 1 if kind == 'int32' else 2 ** 32 - 2)
        else:
            filled(getattr(message, name), numbers, texts)
    return message


def leaves(value, shape):
    """List all fields of a message, or of what has the same attributes."""
    if not hasattr(shape, 'get_fields_and_field_types'):
        return [np.asarray(value).tolist()]
    return [leaf for name in shape.get_fields_and_field_types()
            for leaf in leaves(getattr(value, name), getattr(shape, name))]


@pytest.mark.parametrize('kind', KINDS)
@hypothesis.settings(max_examples=30, deadline=None, derandomize=True, database=None)
@hypothesis.given(st.lists(st.text(st.characters(exclude_characters='\0', codec='utf-8'),
                                   max_size=12), min_size=2, max_size=2),
                  st.integers(0, 2 ** 32 - 1))
def test_what_is_read_is_the_message(kind, texts, seed):
    """Every field of every type, with frames of any length in any script."""
    numbers = np.random.default_rng(seed).normal(size=85)
    message = filled(kind(), iter(numbers.tolist()), iter(texts))
    value = message_reader(kind)(serialize_message(message))
    assert not isinstance(value, kind)
    assert leaves(value, message) == leaves(message, message)


@pytest.mark.parametrize('data', [b'', b'\0\1\0\0', b'\0\1\0\0' + bytes(40)])
def test_what_is_too_short_is_left_to_rclpy(data):
    """Its error is that of any such message."""
    with pytest.raises(Exception) as expected:
        deserialize_message(data, OdometryMessage)
    with pytest.raises(type(expected.value)):
        message_reader(OdometryMessage)(data)


def test_big_endian_messages_are_read():
    """As a computer of the other kind sends them: a whole message."""
    data = b'\0\0\0\0' + struct.pack('>6d', 0.1, 0.2, 0.0, 0.0, 0.0, 0.3)
    assert message_reader(TwistMessage)(data) == to_twist_message(Twist(0.1, 0.2, 0.3))


def test_other_types_are_left_to_rclpy():
    """They have no reader."""
    assert message_reader(Path) is None


def test_beside_the_frame_there_are_whole_messages():
    """They can be changed, as by a transform."""
    message = to_object_pose_message(ObjectPose(1.0, Pose(1.0, 2.0, 0.5)), 'camera')
    assert message_reader(PoseStamped, 'odom')(serialize_message(message)) == message
    assert not isinstance(message_reader(PoseStamped, 'camera')(serialize_message(message)),
                          PoseStamped)


@pytest.mark.parametrize('covariance', [None, PoseCovariance(4e-6, 1e-6, -2e-6, 9e-6, 3e-6, 1e-4)])
@pytest.mark.parametrize('frames', [('odom', 'base_link'), ('world', 'b'), ('', 'r/base')])
def test_measurements_are_written_as_by_rclpy(covariance, frames):
    """With covariances, and frames of any length."""
    odometry = ODOMETRY._replace(covariance=covariance)
    message = to_odometry_message(odometry, *frames)
    message.twist.covariance = np.arange(36.0)
    stamp = nanoseconds(message.header.stamp)
    data = serialize_odometry(odometry, stamp, frames, range(36))
    assert deserialize_message(data, OdometryMessage) == message
    assert from_odometry_message(message_reader(OdometryMessage)(data), frames[0]) == \
        from_odometry_message(message, frames[0])
    pose = ObjectPose(ODOMETRY.time, ODOMETRY.pose)
    assert deserialize_message(serialize_object_pose(pose, stamp, frames[0]), PoseStamped) \
        == to_object_pose_message(pose, frames[0])


@pytest.mark.parametrize('stamped', [True, False])
def test_commands_are_written_as_by_rclpy(stamped):
    """The stamp is that of the measurement, untouched."""
    command = Twist(0.1, 0.2, 0.3)
    data = serialize_command(command, 12_340_000_001, 'base_link', stamped=stamped)
    message = deserialize_message(data, TwistStamped if stamped else TwistMessage)
    assert (message.twist if stamped else message) == to_twist_message(command)
    if stamped:
        assert nanoseconds(message.header.stamp) == 12_340_000_001
        assert message.header.frame_id == 'base_link'
