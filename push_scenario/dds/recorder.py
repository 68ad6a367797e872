"""Recording: all topics, as they come, into a rosbag2 MCAP file."""

from collections.abc import Collection, Generator, Mapping
import contextlib
from pathlib import Path
import struct
from typing import Any

from push_ros.conversions.primitives import NANOSECONDS
from push_ros.executor import take_message
from push_ros.qos import QUEUE_DEPTH
from push_ros.topics import interface_name, Topic, TOPICS
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

# CDR: four bytes of encapsulation header, then the stamp as int32 seconds, uint32 nanoseconds.
CDR_HEADER = 4
STAMP = struct.Struct('<iI')
# Length of the array, before its first element.
ARRAY_LENGTH = 4
# Messages begin with their stamp; on these topics, the first element of their array does.
ARRAY_TOPICS = 'markers', 'plan_markers', 'planning_markers'
TYPE_WITHOUT_STAMP = 'Twist'
# Period of stamps at which a recording is written to the disk [ns]; chosen: what may be lost where
# the process is killed.
FLUSH_PERIOD = NANOSECONDS
# rosbag2 writes the longest duration where a deadline, lifespan or lease is not set.
UNLIMITED = 9223372036, 854775807


class TopicListener:
    """
    Receives the serialized messages of topics.

    It takes them in bulk, not one by one through an executor: a replay in lockstep has thousands
    a second, and must not be slowed down by its recording.

    :param node: the rclpy node that subscribes; no executor may spin it.
    :param stamped: whether commands have a stamp.
    :param topics: names of the topics; None for all.
    """

    def __init__(self, node: Node, stamped: bool = True,
                 topics: Collection[str] | None = None) -> None:
        self.types: dict[str, type] = {name: entry.message_type(stamped)
                                       for name, entry in TOPICS.items()
                                       if topics is None or name in topics}
        self._subscriptions = {
            name: node.create_subscription(kind, name, _ignore, _subscriber_qos(TOPICS[name]),
                                           raw=True)
            for name, kind in self.types.items()}

    def take_all(self) -> list[tuple[str, bytes]]:
        """
        Take all messages that have come.

        :return: (topic, serialized message) list, in order within each topic.
        """
        received: list[tuple[str, bytes]] = []
        for name, subscription in self._subscriptions.items():
            while (data := take_message(subscription)) is not None:
                received.append((name, data))
        return received


class RecordingFailed(RuntimeError):
    """A recording that cannot be written, and how far it has come."""


class BagWriter:
    """
    Writes serialized messages with their own stamps; an empty bag is not left behind.

    :param path: folder of the bag; it must not exist.
    :param types: message types by topic.
    :raises RuntimeError: where rosbags is not installed.
    """

    def __init__(self, path: Path, types: Mapping[str, type]) -> None:
        try:
            from rosbags.rosbag2 import StoragePlugin, Writer
            from rosbags.typesys import get_typestore, Stores
        except ModuleNotFoundError as error:
            raise RuntimeError(f'recording needs rosbags: no module {error.name}; install it, or '
                               'do without a recording') from error
        self._writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self._writer.open()
        store = get_typestore(Stores.ROS2_JAZZY)
        self._connections = {
            topic: self._writer.add_connection(
                f'/{topic}', interface_name(kind), typestore=store,
                offered_qos_profiles=_offered_qos(TOPICS[topic]))
            for topic, kind in types.items()}
        self._types = types
        self._path = path
        self._has_failed = False
        self._newest = 0
        self._flush_due = 0

    def write(self, topic: str, data: bytes) -> None:
        """
        Write a message; one without a stamp gets the newest of those before it.

        :param topic: its topic.
        :param data: the message, serialized.
        :raises RecordingFailed: where the disk is full, or otherwise does not take it.
        """
        stamp = stamp_of(topic, data, self._types[topic])
        time = self._newest if stamp is None else stamp
        self._newest = max(self._newest, time)
        with self._named_errors():
            self._writer.write(self._connections[topic], time, data)
            if time >= self._flush_due:
                self._flush_due = time + FLUSH_PERIOD
                self._flush()

    def _flush(self) -> None:
        """Write what there is to the disk, for the case that this process is killed."""
        storage: Any = self._writer.storage
        storage.close_chunk()
        storage.bio.flush()

    def close(self) -> None:
        """
        Write the index and ``metadata.yaml``, but for a recording that has failed.

        :raises RecordingFailed: where the disk is full, or otherwise does not take them.
        """
        if not self._has_failed:
            with self._named_errors():
                self._writer.close()

    @contextlib.contextmanager
    def _named_errors(self) -> Generator[None, None, None]:
        try:
            yield
        except OSError as error:
            self._has_failed = True
            raise RecordingFailed(f'{self._path}: {error.strerror}: the recording has ended at '
                                  f'{self._newest / NANOSECONDS:.1f} s; what it has by then is '
                                  'kept') from error


def stamp_of(topic: str, data: bytes, kind: type) -> int | None:
    """
    Read the stamp of a serialized message, without deserializing the rest.

    :param topic: its topic.
    :param data: little-endian CDR, as Fast DDS makes it.
    :param kind: message type.
    :return: [ns]; None where it has none.
    """
    offset = CDR_HEADER
    if topic in ARRAY_TOPICS:
        offset += ARRAY_LENGTH
    if kind.__name__ == TYPE_WITHOUT_STAMP or len(data) < offset + STAMP.size:
        return None
    seconds, nanoseconds = STAMP.unpack_from(data, offset)
    return seconds * NANOSECONDS + nanoseconds


def _subscriber_qos(entry: Topic) -> QoSProfile:
    latched = entry.publish_qos.durability == DurabilityPolicy.TRANSIENT_LOCAL
    return QoSProfile(depth=QUEUE_DEPTH, reliability=entry.publish_qos.reliability,
                      durability=entry.publish_qos.durability if latched
                      else DurabilityPolicy.VOLATILE)


def _offered_qos(entry: Topic) -> list[Any]:
    from rosbags.interfaces import (
        Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime)
    profile = entry.publish_qos
    reliable = profile.reliability == ReliabilityPolicy.RELIABLE
    latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    unlimited = QosTime(*UNLIMITED)
    return [Qos(QosHistory.KEEP_LAST, profile.depth,
                QosReliability.RELIABLE if reliable else QosReliability.BEST_EFFORT,
                QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
                unlimited, unlimited, QosLiveliness.AUTOMATIC, unlimited, False)]


def _ignore(_: object) -> None:
    pass
