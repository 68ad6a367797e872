"""Random messages: every one can be sent, and they differ."""

from benchmarks.faults.wire_fuzz import MessageSource
from push_ros.topics import TOPICS
import pytest
from rclpy.serialization import serialize_message


@pytest.mark.parametrize('topic', ['odom', 'object_pose', 'goal_pose', 'map', 'push_request',
                                   'push_plan', 'cmd_vel', 'initialpose'])
def test_random_messages_can_be_sent_and_are_drawn_from_the_seed(topic: str) -> None:
    """Whatever their fields hold; two of one seed are the same, two in a row are not."""
    kind = TOPICS[topic].type
    source = MessageSource(3)
    messages = [source.make(kind) for _ in range(30)]
    assert all(map(serialize_message, messages))
    # As text, in which what is not a number is what it was.
    assert len(set(map(str, messages))) == len(messages)
    assert str(MessageSource(3).make(kind)) == str(messages[0])
