"""Listening to all topics, and writing them to a rosbag2 MCAP file."""

import struct

from push_ros.conversions.primitives import NANOSECONDS
from push_ros.executor import take_message
from push_ros.topics import TOPICS
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

STAMP = struct.Struct('<iI')
HEADER = 4
DEPTH = 2000
# Topics whose messages begin with their stamp; in an array, the first element does.
FIRST_OF_ARRAY = 'markers'
NO_STAMP = 'Twist'


class Listener:
    """
    Takes serialized messages of the topics of the list.

    It takes them in bulk, not one by one through an executor: a replay in lockstep has thousands
    a second, and must not be slowed by whoever listens.

    :param node: the rclpy node that subscribes; no executor may spin it.
    :param stamped: whether commands have a stamp.
    """

    def __init__(self, node, stamped=True):
        self.types = {name: entry.message_type(stamped) for name, entry in TOPICS.items()}
        self._subscriptions = {
            name: node.create_subscription(kind, name, _nothing, _quality(TOPICS[name]), raw=True)
            for name, kind in self.types.items()}

    def take_message(self):
        """
        Take what has come.

        :return: (topic, serialized message) list, in order within each topic.
        """
        taken = []
        for name, subscription in self._subscriptions.items():
            while (data := take_message(subscription)) is not None:
                taken.append((name, data))
        return taken


class BagWriter:
    """
    Writes serialized messages with their own stamps; an empty bag is not left behind.

    :param path: folder of the bag; it must not exist.
    :param types: dict of topics to message types.
    :raises RuntimeError: where rosbags is not installed.
    """

    def __init__(self, path, types):
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
            topic: self._writer.add_connection(f'/{topic}', _type_name(kind), typestore=store,
                                               offered_qos_profiles=_offered(TOPICS[topic]))
            for topic, kind in types.items()}
        self._types, self._newest = types, 0

    def write(self, topic, data):
        """
        Write a message.

        :param topic: its topic.
        :param data: the message, serialized.
        """
        time = stamp_of(topic, data, self._types[topic])
        time = self._newest if time is None else time
        self._newest = max(self._newest, time)
        self._writer.write(self._connections[topic], time, data)

    def close(self):
        """Write the index and ``metadata.yaml``."""
        self._writer.close()


def stamp_of(topic, data, kind):
    """
    Read the stamp of a serialized message, without deserializing the rest.

    :param topic: its topic.
    :param data: little-endian CDR, as Fast DDS makes it.
    :param kind: message type.
    :return: [ns]; None where it has none.
    """
    offset = HEADER
    if topic == FIRST_OF_ARRAY:
        offset += 4
    if kind.__name__ == NO_STAMP or len(data) < offset + STAMP.size:
        return None
    whole, part = STAMP.unpack_from(data, offset)
    return whole * NANOSECONDS + part


def _quality(entry):
    latched = entry.publish_qos.durability == DurabilityPolicy.TRANSIENT_LOCAL
    return QoSProfile(depth=DEPTH, reliability=entry.publish_qos.reliability,
                      durability=entry.publish_qos.durability if latched
                      else DurabilityPolicy.VOLATILE)


def _offered(entry):
    from rosbags.interfaces import (Qos, QosDurability, QosHistory, QosLiveliness, QosReliability,
                                    QosTime)
    profile = entry.publish_qos
    reliable = profile.reliability == ReliabilityPolicy.RELIABLE
    latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    forever = QosTime(9223372036, 854775807)
    return [Qos(QosHistory.KEEP_LAST, profile.depth,
                QosReliability.RELIABLE if reliable else QosReliability.BEST_EFFORT,
                QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
                forever, forever, QosLiveliness.AUTOMATIC, forever, False)]


def _type_name(kind):
    package, folder = kind.__module__.split('.')[:2]
    return f'{package}/{folder}/{kind.__name__}'


def _nothing(_):
    pass
