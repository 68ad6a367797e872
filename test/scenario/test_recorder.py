"""Recordings: what is published is in the file, with its own stamps and in order."""

import contextlib
import struct
import time

from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from helpers.disk import full_disk
from helpers.extras import import_extra
from nav_msgs.msg import Odometry
from push_ros.conversions.primitives import to_stamp
from push_ros.topics import TOPICS
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.recorder import BagWriter, RecordingFailed, stamp_of, TopicListener
import pytest
import rclpy
from rclpy.context import Context
from rclpy.serialization import serialize_message
from visualization_msgs.msg import Marker, MarkerArray

AnyReader = import_extra('rosbags', 'record', 'rosbags.highlevel').AnyReader
make_reader = import_extra('mcap', 'test', 'mcap.reader').make_reader
StreamReader = import_extra('mcap', 'test', 'mcap.stream_reader').StreamReader
EndOfFile = import_extra('mcap', 'test', 'mcap.exceptions').EndOfFile
Message = import_extra('mcap', 'test', 'mcap.records').Message
NANOSECONDS = 10 ** 9
DISCOVERY_TIMEOUT = 400.0
TYPES = {name: entry.message_type(False) for name, entry in TOPICS.items()}


def stamped(kind, seconds):
    """Make a message with a stamp."""
    message = kind()
    message.header.stamp = to_stamp(seconds)
    return message


def markers(seconds):
    """Make an array whose first element has a stamp."""
    return MarkerArray(markers=[stamped(Marker, seconds), stamped(Marker, seconds + 9.0)])


MESSAGES = [('odom', stamped(Odometry, 0.02), 20_000_000),
            ('object_pose', stamped(PoseStamped, 0.5), 500_000_000),
            # Without a stamp: that of the newest message before.
            ('cmd_vel', Twist(), 500_000_000),
            # Older than what came before: it keeps its own stamp.
            ('odom', stamped(Odometry, 0.04), 40_000_000),
            ('markers', markers(12.25), 12 * NANOSECONDS + 250_000_000),
            ('cmd_vel', Twist(), 12 * NANOSECONDS + 250_000_000),
            ('markers', MarkerArray(), 12 * NANOSECONDS + 250_000_000)]


# Serialized once: the padding between fields may hold anything.
PAYLOADS = [serialize_message(message) for _, message, _ in MESSAGES]


def write(path):
    """Write the messages to a new bag."""
    with contextlib.closing(BagWriter(path, TYPES)) as writer:
        for (topic, _, _), payload in zip(MESSAGES, PAYLOADS):
            writer.write(topic, payload)
    return path


def test_every_message_is_in_the_file_with_its_stamp_and_bytes(tmp_path):
    """Read by another library than the one that wrote, in the order of each topic."""
    bag = write(tmp_path / 'bag')
    with next(bag.glob('*.mcap')).open('rb') as file:
        found = [(channel.topic, message.log_time, message.data)
                 for _, channel, message in make_reader(file).iter_messages(log_time_order=False)]
    assert found == [(f'/{topic}', stamp, payload)
                     for (topic, _, stamp), payload in zip(MESSAGES, PAYLOADS)]


def test_the_file_names_its_types_and_reads_back(tmp_path):
    """All topics are announced, also those without a message."""
    with AnyReader([write(tmp_path / 'bag')]) as reader:
        assert set(reader.topics) >= {'/odom', '/object_pose', '/cmd_vel', '/markers'}
        assert reader.topics['/cmd_vel'].msgtype == 'geometry_msgs/msg/Twist'
        poses = [reader.deserialize(data, connection.msgtype)
                 for connection, _, data in reader.messages()
                 if connection.topic == '/object_pose']
    assert [pose.header.stamp.nanosec for pose in poses] == [500_000_000]


def test_a_recording_that_is_interrupted_is_readable(tmp_path):
    """The writer is closed on the way out, whatever ends the run."""
    with pytest.raises(KeyboardInterrupt), contextlib.ExitStack() as stack:
        writer = BagWriter(tmp_path / 'bag', TYPES)
        stack.callback(writer.close)
        for _ in range(100):
            writer.write('odom', serialize_message(stamped(Odometry, 1.0)))
        raise KeyboardInterrupt
    with AnyReader([tmp_path / 'bag']) as reader:
        assert reader.message_count == 100


def test_a_full_disk_ends_the_recording_with_its_name_and_loses_nothing_before(tmp_path):
    """Chunks that were written can be read without an index."""
    bag, count = tmp_path / 'bag', 0
    writer = BagWriter(bag, TYPES)
    with full_disk(100_000), pytest.raises(RecordingFailed, match=f'{bag}: .* has ended at'):
        for count in range(10_000):
            writer.write('odom', serialize_message(stamped(Odometry, count)))
    writer.close()
    with next(bag.glob('*.mcap')).open('rb') as file:
        kept = 0
        with contextlib.suppress(EndOfFile, struct.error):
            for record in StreamReader(file).records:
                kept += isinstance(record, Message)
    assert count < 9_999 and kept >= 0.9 * count


@pytest.mark.parametrize('topic, message, stamp', MESSAGES)
def test_stamps_are_read_without_deserializing(topic, message, stamp):
    """None where a message has none, or an array no element."""
    found = stamp_of(topic, serialize_message(message), type(message))
    has_stamp = not isinstance(message, Twist) and message != MarkerArray()
    assert found == (stamp if has_stamp else None)


def test_a_stamp_before_the_epoch_survives():
    """Seconds have a sign."""
    message = TwistStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = -3, 5
    assert stamp_of('cmd_vel', serialize_message(message), TwistStamped) == -3 * NANOSECONDS + 5


@pytest.mark.dds
@pytest.mark.slow
def test_the_listener_receives_every_message_in_order():
    """In bulk, as the bytes that were published."""
    # Serialized once: the padding between fields may hold anything.
    sent = [serialize_message(stamped(Odometry, 0.02 * number)) for number in range(500)]
    with private_domain() as domain:
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        sender, receiver = (rclpy.create_node(name, context=context) for name in ('a', 'b'))
        try:
            listener = TopicListener(receiver)
            publisher = sender.create_publisher(Odometry, 'odom', TOPICS['odom'].publish_qos)
            received, end = [], time.monotonic() + DISCOVERY_TIMEOUT
            while not publisher.get_subscription_count() and time.monotonic() < end:
                time.sleep(0.01)
            for payload in sent:
                publisher.publish(payload)
                received += listener.take_all()
            while len(received) < len(sent) and time.monotonic() < end:
                received += listener.take_all()
        finally:
            sender.destroy_node()
            receiver.destroy_node()
            rclpy.shutdown(context=context)
    assert received == [('odom', payload) for payload in sent]
