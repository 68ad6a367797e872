"""Interfaces that tests build from their definitions, over DDS."""

import os
import subprocess
import sys

from geometry_msgs.msg import TransformStamped
from helpers.build_interfaces import available_tf2_msgs
from push_scenario.dds.private_network import private_domain, private_environment
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor

pytestmark = [pytest.mark.dds, pytest.mark.slow]
# Publishes one transform until it is interrupted.
PUBLISHER = """
import rclpy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
rclpy.init()
node = rclpy.create_node('publisher')
publisher = node.create_publisher(TFMessage, '/tf', 10)
message = TFMessage(transforms=[TransformStamped(child_frame_id='object')])
node.create_timer(0.1, lambda: publisher.publish(message))
rclpy.spin(node)
"""


def test_a_process_with_built_messages_sends_them_here():
    """What another process publishes comes here with its content."""
    environment = dict(os.environ)
    with available_tf2_msgs(), private_domain() as domain:
        from tf2_msgs.msg import TFMessage
        context = rclpy.Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        other = subprocess.Popen([sys.executable, '-c', PUBLISHER], stdin=subprocess.DEVNULL,
                                 env=private_environment(domain))
        try:
            node = rclpy.create_node('receiver', context=context)
            executor = SingleThreadedExecutor(context=context)
            executor.add_node(node)
            received = []
            node.create_subscription(TFMessage, '/tf', received.append, 10)
            while not received:
                assert other.poll() is None
                executor.spin_once(timeout_sec=0.1)
            executor.shutdown()
            node.destroy_node()
        finally:
            other.kill()
            other.wait()
            rclpy.shutdown(context=context)
    assert received[0].transforms == [TransformStamped(child_frame_id='object')]
    assert dict(os.environ) == environment
