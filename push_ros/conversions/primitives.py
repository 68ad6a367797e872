"""Parts of messages to values and back: stamps, frames, poses, twists."""

import math
from typing import TypeVar

from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Pose as PoseMessage, Quaternion, Twist as TwistMessage
from push_model.geometry import Coordinates, Pose
from push_model.signals import Twist

NANOSECONDS = 1_000_000_000
# Length below which a quaternion has no direction, as one that nobody has filled in; chosen: far
# below any rounding of one of length 1.
MIN_QUATERNION = 1e-3
# Angle between the z axes of a pose and of the world above which it is no pose in the plane [rad];
# chosen: the rotation of a tag errs by less, and an object on another face is off by far more.
MAX_TILT = 0.26
# Largest coordinate of a pose [m], and largest velocity [m/s], [rad/s]; chosen: far beyond any
# floor and any robot, and far below where products of such numbers overflow.
MAX_POSITION = 1e7
MAX_VELOCITY = 1e3
Stamp = TypeVar('Stamp', Time, Duration)


class MessageRefused(ValueError):
    """A message that cannot be used, and why."""


def nanoseconds(stamp: Time | Duration) -> int:
    """
    Read a stamp exactly [ns].

    :param stamp: ``builtin_interfaces/Time`` or ``Duration``.
    """
    return stamp.sec * NANOSECONDS + stamp.nanosec


def seconds(stamp: Time | Duration) -> float:
    """
    Read a stamp [s].

    :param stamp: ``builtin_interfaces/Time`` or ``Duration``.
    """
    return nanoseconds(stamp) / NANOSECONDS


def to_stamp(time: float, kind: type[Stamp] = Time) -> Stamp:
    """
    Make a stamp.

    :param time: [s]; whole nanoseconds survive the conversion to a stamp and back.
    :param kind: ``builtin_interfaces/Time`` or ``Duration``.
    """
    return exact_stamp(math.floor(time * NANOSECONDS + 0.5), kind)


def exact_stamp(time: int, kind: type[Stamp] = Time) -> Stamp:
    """
    Make a stamp of whole nanoseconds.

    :param time: [ns].
    :param kind: ``builtin_interfaces/Time`` or ``Duration``.
    """
    whole, part = divmod(time, NANOSECONDS)
    return kind(sec=whole, nanosec=part)


def to_quaternion(angle: float) -> Quaternion:
    """
    Convert a yaw angle to a quaternion.

    :param angle: about z [rad].
    """
    z, w = yaw_quaternion(angle)
    return Quaternion(z=z, w=w)


def yaw_quaternion(angle: float) -> tuple[float, float]:
    """
    Convert a yaw angle to the parts z and w of its quaternion, whose others are 0.

    :param angle: about z [rad].
    """
    return math.sin(0.5 * angle), math.cos(0.5 * angle)


def to_yaw(quaternion: Quaternion, topic: str) -> float:
    """
    Read the yaw angle of a quaternion of any length but 0 [rad].

    :param quaternion: ``geometry_msgs/Quaternion``.
    :param topic: what errors call the message.
    :raises MessageRefused: where it is not finite, or 0.
    """
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not (math.isfinite(length) and length > MIN_QUATERNION):
        raise MessageRefused(f'{topic}: got the quaternion ({x:g}, {y:g}, {z:g}, {w:g}), '
                             'expected one of length 1')
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def check_upright(quaternion: Quaternion, topic: str) -> None:
    """
    Refuse a pose that does not stand upright; one that has no rotation passes here.

    :param quaternion: ``geometry_msgs/Quaternion``.
    :param topic: what the error calls the message.
    :raises MessageRefused: naming the tilt.
    """
    tilt = 2.0 * math.atan2(math.hypot(quaternion.x, quaternion.y),
                            math.hypot(quaternion.z, quaternion.w))
    if tilt > MAX_TILT:
        raise MessageRefused(f'{topic}: got a pose whose z axis is tilted by {tilt:.2f} rad, '
                             f'expected an upright one (at most {MAX_TILT:g} rad)')


def to_pose_message(pose: Coordinates) -> PoseMessage:
    """
    Convert a pose in the plane to a message.

    :param pose: ``Pose`` or (x, y, theta).
    """
    message = PoseMessage()
    message.position.x, message.position.y = float(pose[0]), float(pose[1])
    message.orientation = to_quaternion(pose[2])
    return message


def from_pose_message(message: PoseMessage, topic: str) -> Pose:
    """
    Read a pose in the plane.

    :param message: ``geometry_msgs/Pose``.
    :param topic: what errors call the message.
    :raises MessageRefused: where it is not finite, or its quaternion is 0.
    """
    x, y = message.position.x, message.position.y
    # False for what is not a number as well.
    if not (abs(x) <= MAX_POSITION and abs(y) <= MAX_POSITION):
        raise MessageRefused(f'{topic}: got the position ({x:g}, {y:g}), expected finite numbers '
                             f'of at most {MAX_POSITION:g} m')
    return Pose(x, y, to_yaw(message.orientation, topic))


def check_frame(frame: str, expected: str, topic: str) -> None:
    """
    Refuse a message in another frame.

    :param frame: frame id that came; a leading slash is ignored.
    :param expected: frame id that is expected.
    :param topic: what the error calls the message.
    :raises MessageRefused: naming both frames.
    """
    if frame.lstrip('/') != expected.lstrip('/'):
        raise MessageRefused(f'{topic}: got frame {frame!r}, expected {expected!r}')


def to_twist_message(twist: Coordinates) -> TwistMessage:
    """
    Convert a twist in the plane to a message.

    :param twist: ``Twist`` or (v_x, v_y, omega).
    """
    message = TwistMessage()
    message.linear.x, message.linear.y = float(twist[0]), float(twist[1])
    message.angular.z = float(twist[2])
    return message


def from_twist_message(message: TwistMessage, topic: str = 'cmd_vel') -> Twist:
    """
    Read a twist in the plane.

    :param message: ``geometry_msgs/Twist``.
    :param topic: what errors call the message.
    :raises MessageRefused: where a number is not finite.
    """
    twist = Twist(message.linear.x, message.linear.y, message.angular.z)
    if not all(abs(value) <= MAX_VELOCITY for value in twist):
        raise MessageRefused(f'{topic}: got the twist {tuple(twist)}, expected finite numbers '
                             f'of at most {MAX_VELOCITY:g} [m/s, m/s, rad/s]')
    return twist
