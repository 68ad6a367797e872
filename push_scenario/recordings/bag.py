"""Poses from a rosbag2 recording, MCAP or SQLite."""

from collections.abc import Generator
import contextlib
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from push_model.geometry import FloatArray
from push_model.optional import how_to_install

NANOSECOND = 1e-9
POSE_TYPES = ('geometry_msgs/msg/PoseStamped', 'geometry_msgs/msg/PoseWithCovarianceStamped',
              'nav_msgs/msg/Odometry')


class Track(NamedTuple):
    """
    Poses over time.

    :param times: of the stamps, ascending, shape (n,) [s].
    :param poses: (x, y, heading), the heading without jumps, shape (n, 3) [m, rad].
    """

    times: FloatArray
    poses: FloatArray


@contextlib.contextmanager
def open_bag(bag: Path) -> Generator[Any, None, None]:
    """
    Open a recording.

    :param bag: folder of a rosbag2 recording.
    :return: context with the ``AnyReader`` of rosbags.
    :raises ValueError: where the folder is no recording.
    :raises RuntimeError: where rosbags is not installed.
    """
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import get_typestore, Stores
    except ImportError as error:
        raise RuntimeError(f'reading a recording: {how_to_install("rosbags")}') from error
    if not bag.is_dir():
        raise ValueError(f'bag: got {bag}, no folder, expected a rosbag2 recording')
    try:
        with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
            yield reader
    except (AnyReaderError, FileNotFoundError) as error:
        raise ValueError(f'bag: got {bag}, expected a rosbag2 recording: {error}') from None


def read_tracks(bag: Path, topics: tuple[str, ...]) -> tuple[Track, ...]:
    """
    Read the poses of topics.

    :param bag: folder of a rosbag2 recording.
    :param topics: names; types are ``POSE_TYPES``.
    :return: the track of each topic.
    :raises ValueError: where the folder is no recording, or a topic is missing or of another type.
    :raises RuntimeError: where rosbags is not installed.
    """
    rows: dict[str, list[tuple[float, ...]]] = {topic: [] for topic in topics}
    with open_bag(bag) as reader:
        connections = [_connection(reader, topic) for topic in topics]
        for connection, _, data in reader.messages(connections=connections):
            message = reader.deserialize(data, connection.msgtype)
            name = next(topic for topic in topics if _same(topic, connection.topic))
            rows[name].append(_row(message))
    return tuple(_track(topic, poses) for topic, poses in rows.items())


def _same(topic: str, other: str) -> bool:
    return topic.strip('/') == other.strip('/')


def _connection(reader: Any, topic: str) -> Any:
    matches = [connection for connection in reader.connections if _same(topic, connection.topic)]
    if not matches:
        there = ', '.join(sorted(connection.topic for connection in reader.connections))
        raise ValueError(f'topic: got {topic}, expected one of the recording: {there}')
    if matches[0].msgtype not in POSE_TYPES:
        raise ValueError(f'{topic}: got messages {matches[0].msgtype}, expected one of '
                         f'{", ".join(POSE_TYPES)}')
    return matches[0]


def _row(message: Any) -> tuple[float, ...]:
    """Return time [s], x, y [m] and heading [rad]."""
    pose = message.pose if hasattr(message.pose, 'orientation') else message.pose.pose
    turn, stamp = pose.orientation, message.header.stamp
    heading = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y),
                         1.0 - 2.0 * (turn.y ** 2 + turn.z ** 2))
    return (stamp.sec + NANOSECOND * stamp.nanosec, pose.position.x, pose.position.y, heading)


def _track(topic: str, rows: list[tuple[float, ...]]) -> Track:
    if len(rows) < 2:
        raise ValueError(f'{topic}: got {len(rows)} messages, expected a recorded motion')
    table = np.array(sorted(rows))
    table[:, 3] = np.unwrap(table[:, 3])
    return Track(table[:, 0], table[:, 1:])
