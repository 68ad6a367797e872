"""
Measurements and commands as they are serialized: read and written without message objects.

rclpy makes an object of each part of a message and checks each of its fields, which takes longer
than all else that is done with odometry. Measurements and commands are alike, so that a few
functions read and write all of them. In plain CDR, by which every middleware of Jazzy serializes:

    4 bytes          00 01 00 00, for plain and little-endian
    int32, uint32    stamp, where there is a header
    strings          length with the final 0 (uint32, aligned to 4), text, 0
    float64          all numbers, aligned to 8 from behind the first 4 bytes

Whatever looks different is left to rclpy, which knows what it is, or that it is nothing.
"""

import struct
from typing import Any, Callable, NamedTuple, Sequence

from geometry_msgs.msg import (
    PoseStamped, PoseWithCovarianceStamped, Twist as TwistMessage, TwistStamped,
)
from nav_msgs.msg import Odometry as OdometryMessage
from push_model.signals import ObjectPose, Odometry, Twist
from push_ros.conversions.measurements import to_covariance
from push_ros.conversions.primitives import NANOSECONDS, yaw_quaternion
from rclpy.serialization import deserialize_message

PLAIN_CDR = b'\x00\x01\x00\x00'
STAMP = struct.Struct('<iI')
LENGTH = struct.Struct('<I')
# Alignments of the lengths of strings and of numbers [B].
LENGTH_ALIGNMENT, DOUBLE_ALIGNMENT = 4, 8
# Numbers of a pose (position, quaternion), a twist (linear, angular), a covariance by rows.
POSE_SIZE, TWIST_SIZE, COVARIANCE_SIZE = 7, 6, 36
NO_COVARIANCE = (0.0,) * COVARIANCE_SIZE


class StampValue(NamedTuple):
    """What ``builtin_interfaces/Time`` has."""

    sec: int
    nanosec: int


class HeaderValue(NamedTuple):
    """What ``std_msgs/Header`` has."""

    stamp: StampValue
    frame_id: str


class VectorValue(NamedTuple):
    """What ``geometry_msgs/Point`` and ``Vector3`` have."""

    x: float
    y: float
    z: float


class QuaternionValue(NamedTuple):
    """What ``geometry_msgs/Quaternion`` has."""

    x: float
    y: float
    z: float
    w: float


class PoseValue(NamedTuple):
    """What ``geometry_msgs/Pose`` has."""

    position: VectorValue
    orientation: QuaternionValue


class TwistValue(NamedTuple):
    """What ``geometry_msgs/Twist`` has."""

    linear: VectorValue
    angular: VectorValue


class UncertainPose(NamedTuple):
    """What ``geometry_msgs/PoseWithCovariance`` has."""

    pose: PoseValue
    covariance: tuple[float, ...]


class UncertainTwist(NamedTuple):
    """What ``geometry_msgs/TwistWithCovariance`` has."""

    twist: TwistValue
    covariance: tuple[float, ...]


class StampedPose(NamedTuple):
    """What ``geometry_msgs/PoseStamped`` and ``PoseWithCovarianceStamped`` have."""

    header: HeaderValue
    pose: PoseValue | UncertainPose


class StampedTwist(NamedTuple):
    """What ``geometry_msgs/TwistStamped`` has."""

    header: HeaderValue
    twist: TwistValue


class OdometryValue(NamedTuple):
    """What ``nav_msgs/Odometry`` has."""

    header: HeaderValue
    child_frame_id: str
    pose: UncertainPose
    twist: UncertainTwist


def message_reader(kind: type[Any], frame: str | None = None) -> Callable[[bytes], Any] | None:
    """
    Make a function that reads serialized messages.

    It returns values with the attributes of the message, or a message of rclpy where the text of
    bytes is not as above.

    :param kind: message type.
    :param frame: id of the frame beside which messages are made by rclpy, for who has to change
        them; None where messages of all frames are only read.
    :return: None for a type that only rclpy reads.
    """
    layout = LAYOUTS.get(kind)
    if layout is None:
        return None

    def read(data: bytes) -> Any:
        try:
            value = layout.read(data)
        except (ValueError, struct.error):
            return deserialize_message(data, kind)
        if frame is not None and value.header.frame_id != frame:
            return deserialize_message(data, kind)
        return value
    return read


def serialize_odometry(odometry: Odometry, stamp: int, frames: tuple[str, str],
                       twist_covariance: Sequence[float] = NO_COVARIANCE) -> bytes:
    """
    Make a serialized ``nav_msgs/Odometry``.

    :param stamp: [ns].
    :param frames: ids of the world frame and of the robot's, in whose axes the twist is.
    :param twist_covariance: of (x, y, z, roll, pitch, yaw) in the axes of the robot, by rows.
    """
    covariance = NO_COVARIANCE if odometry.covariance is None else to_covariance(
        odometry.covariance)
    return _serialized(stamp, frames, (
        *_pose_values(odometry.pose), *covariance, *_twist_values(odometry.twist),
        *twist_covariance))


def serialize_object_pose(object_pose: ObjectPose, stamp: int, frame: str) -> bytes:
    """
    Make a serialized ``geometry_msgs/PoseStamped``.

    :param stamp: [ns].
    :param frame: id of the world frame.
    """
    return _serialized(stamp, (frame,), _pose_values(object_pose.pose))


def serialize_command(twist: Twist, stamp: int, frame: str, *, stamped: bool) -> bytes:
    """
    Make a serialized command.

    :param twist: ``Twist`` in the robot's axes.
    :param stamp: [ns].
    :param frame: id of the robot's frame.
    :param stamped: whether to make a ``geometry_msgs/TwistStamped``, else a ``Twist``.
    """
    values = _twist_values(twist)
    return _serialized(stamp, (frame,), values) if stamped else _serialized(None, (), values)


def _serialized(stamp: int | None, texts: Sequence[str], values: Sequence[float]) -> bytes:
    data = bytearray(PLAIN_CDR)
    if stamp is not None:
        data += STAMP.pack(*divmod(stamp, NANOSECONDS))
    for text in texts:
        encoded = text.encode() + b'\0'
        data += bytes(-len(data) % LENGTH_ALIGNMENT) + LENGTH.pack(len(encoded)) + encoded
    data += bytes((len(PLAIN_CDR) - len(data)) % DOUBLE_ALIGNMENT)
    return bytes(data) + struct.pack(f'<{len(values)}d', *values)


def _pose_values(pose: Sequence[float]) -> tuple[float, ...]:
    x, y, theta = pose
    return (x, y, 0.0, 0.0, 0.0, *yaw_quaternion(theta))


def _twist_values(twist: Sequence[float]) -> tuple[float, ...]:
    v_x, v_y, omega = twist
    return v_x, v_y, 0.0, 0.0, 0.0, omega


class _Layout:
    """The strings and numbers of a message type, and what is made of them."""

    def __init__(self, string_count: int, value_count: int,
                 make: Callable[[Any, Any, Sequence[str]], Any]) -> None:
        """
        Describe a type.

        :param string_count: ids of frames, the first in the header; without any there is none.
        :param value_count: float64 behind them.
        :param make: takes header, numbers and the other strings.
        """
        self._string_count = string_count
        self._values = struct.Struct(f'<{value_count}d')
        self._make = make

    def read(self, data: bytes) -> Any:
        """
        Read a message.

        :param data: of it.
        :raises ValueError: where it is not plain CDR, or a string is not UTF-8.
        :raises struct.error: where it is too short.
        """
        if data[:len(PLAIN_CDR)] != PLAIN_CDR:
            raise ValueError(f'got {data[:len(PLAIN_CDR)]!r}, expected {PLAIN_CDR!r}')
        offset = len(PLAIN_CDR)
        header, texts = None, []
        if self._string_count:
            stamp = StampValue(*STAMP.unpack_from(data, offset))
            offset += STAMP.size
            for _ in range(self._string_count):
                offset += -offset % LENGTH_ALIGNMENT
                end = offset + LENGTH.size + LENGTH.unpack_from(data, offset)[0]
                texts.append(str(data[offset + LENGTH.size:end - 1], 'utf-8'))
                offset = end
            header = HeaderValue(stamp, texts.pop(0))
        offset += (len(PLAIN_CDR) - offset) % DOUBLE_ALIGNMENT
        return self._make(header, self._values.unpack_from(data, offset), texts)


def _pose(values: tuple[float, ...]) -> PoseValue:
    return PoseValue(VectorValue(*values[:3]), QuaternionValue(*values[3:]))


def _twist(values: tuple[float, ...]) -> TwistValue:
    return TwistValue(VectorValue(*values[:3]), VectorValue(*values[3:]))


def _uncertain_pose(values: tuple[float, ...]) -> UncertainPose:
    return UncertainPose(_pose(values[:POSE_SIZE]), values[POSE_SIZE:])


def _odometry(header: HeaderValue, values: tuple[float, ...],
              texts: Sequence[str]) -> OdometryValue:
    pose, twist = values[:POSE_SIZE + COVARIANCE_SIZE], values[POSE_SIZE + COVARIANCE_SIZE:]
    return OdometryValue(header, texts[0], _uncertain_pose(pose),
                         UncertainTwist(_twist(twist[:TWIST_SIZE]), twist[TWIST_SIZE:]))


LAYOUTS = {
    OdometryMessage: _Layout(2, POSE_SIZE + TWIST_SIZE + 2 * COVARIANCE_SIZE, _odometry),
    PoseStamped: _Layout(
        1, POSE_SIZE, lambda header, values, _: StampedPose(header, _pose(values))),
    PoseWithCovarianceStamped: _Layout(
        1, POSE_SIZE + COVARIANCE_SIZE,
        lambda header, values, _: StampedPose(header, _uncertain_pose(values))),
    TwistStamped: _Layout(
        1, TWIST_SIZE, lambda header, values, _: StampedTwist(header, _twist(values))),
    TwistMessage: _Layout(0, TWIST_SIZE, lambda _header, values, _texts: _twist(values)),
}
