"""Recordings of rosbag2 as numbers over time: poses, velocities and forces, topic by topic."""

from collections.abc import Callable, Iterator
import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
from push_model.geometry import FloatArray
from push_model.optional import how_to_install
from push_scenario.recordings.bag import NANOSECOND, open_bag

Numbers = tuple[float, ...]


@dataclasses.dataclass(frozen=True, eq=False)
class Series:
    """
    Messages of a topic as numbers.

    :param type: of the messages, such as ``nav_msgs/msg/Odometry``.
    :param frame: ``frame_id`` of the first message; empty where it has none.
    :param times: of the stamps, or of the recording where messages have none, shape (n,) [s].
    :param columns: names of the values.
    :param values: shape (n, k), see ``READERS``.
    """

    type: str
    frame: str
    times: FloatArray
    columns: tuple[str, ...]
    values: FloatArray

    def __repr__(self) -> str:
        """Say in one line what it holds."""
        return (f'<Series of {len(self.times)} {self.type}, {self.times[0]:g} to '
                f'{self.times[-1]:g} s: {", ".join(self.columns)}>')

    def __getitem__(self, name: str) -> FloatArray:
        """
        Look up a column.

        :return: its numbers, shape (n,).
        :raises KeyError: where there is none, with those there are.
        """
        if name not in self.columns:
            raise KeyError(f'{name}: expected one of {", ".join(self.columns)}')
        return self.values[:, self.columns.index(name)]

    def to_pandas(self) -> Any:
        """
        Return a ``pandas.DataFrame`` over the times.

        :raises RuntimeError: where pandas is not installed.
        """
        # Imported here: nothing else needs pandas.
        try:
            from pandas import DataFrame, Index
        except ImportError as error:
            raise RuntimeError(f'to_pandas: {how_to_install("pandas")}') from error
        return DataFrame(self.values, Index(self.times, name='time'), list(self.columns))


def _pose(pose: Any) -> Numbers:
    turn = pose.orientation
    return (pose.position.x, pose.position.y,
            math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y),
                       1.0 - 2.0 * (turn.y ** 2 + turn.z ** 2)))


def _twist(twist: Any) -> Numbers:
    return twist.linear.x, twist.linear.y, twist.angular.z


def _wrench(wrench: Any) -> Numbers:
    return wrench.force.x, wrench.force.y, wrench.torque.z


POSE, TWIST = ('x', 'y', 'heading'), ('v_x', 'v_y', 'omega')
# Names of the values of each type of message, and what reads them: x, y [m], heading [rad], v_x,
# v_y [m/s], omega [rad/s], force_x, force_y [N], torque_z [N m].
READERS: dict[str, tuple[tuple[str, ...], Callable[[Any], Numbers]]] = {
    'geometry_msgs/msg/PoseStamped': (POSE, lambda message: _pose(message.pose)),
    'geometry_msgs/msg/PoseWithCovarianceStamped': (
        POSE, lambda message: _pose(message.pose.pose)),
    'nav_msgs/msg/Odometry': (
        POSE + TWIST, lambda message: _pose(message.pose.pose) + _twist(message.twist.twist)),
    'geometry_msgs/msg/Twist': (TWIST, _twist),
    'geometry_msgs/msg/TwistStamped': (TWIST, lambda message: _twist(message.twist)),
    'geometry_msgs/msg/WrenchStamped': (
        ('force_x', 'force_y', 'torque_z'), lambda message: _wrench(message.wrench)),
}


def read_recording(bag: str | Path) -> dict[str, Series]:
    """
    Read poses, velocities and forces of a recording; other topics are left to rosbags.

    :param bag: folder of a rosbag2 recording, MCAP or SQLite.
    :return: the ``Series`` of each topic with messages of the types of ``READERS``, by its name
        without the first slash, in the order of the recording.
    :raises ValueError: where the folder is no recording.
    :raises RuntimeError: where rosbags is not installed.
    """
    rows: dict[str, list[Numbers]] = {}
    first: dict[str, tuple[str, str]] = {}
    for topic, kind, stamp, message in _messages(Path(bag)):
        header = getattr(message, 'header', None)
        if header is not None:
            stamp = header.stamp.sec * 10 ** 9 + header.stamp.nanosec
        first.setdefault(topic, (kind, '' if header is None else header.frame_id))
        rows.setdefault(topic, []).append((NANOSECOND * stamp, *READERS[kind][1](message)))
    return {topic: _series(*first[topic], np.array(numbers)) for topic, numbers in rows.items()}


def _messages(bag: Path) -> Iterator[tuple[str, str, int, Any]]:
    """Yield topic, type, time of recording [ns] and message."""
    with open_bag(bag) as reader:
        connections = [item for item in reader.connections if item.msgtype in READERS]
        if not connections:
            return
        for connection, time, data in reader.messages(connections=connections):
            yield (connection.topic.lstrip('/'), connection.msgtype, time,
                   reader.deserialize(data, connection.msgtype))


def _series(kind: str, frame: str, table: FloatArray) -> Series:
    columns = READERS[kind][0]
    values = table[:, 1:]
    if 'heading' in columns:
        index = columns.index('heading')
        values[:, index] = np.unwrap(values[:, index])
    return Series(kind, frame, table[:, 0], columns, values)
