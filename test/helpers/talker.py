"""
A node that talks to every node it finds, on topics and services of a robot.

It prints what it has heard of each kind, by the senders' names, whenever that is more; it ends
when its input does.
"""

import json
import os
import select
import sys

from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import Trigger

KINDS = {'cmd_vel': TwistStamped, 'odom': Odometry, 'goal_pose': PoseStamped}
PERIOD = 0.05


class Talker:
    """
    Talks to everyone.

    :param context: ROS context.
    """

    def __init__(self, context):
        self.name = f'talker_{os.getpid()}'
        self.heard = {kind: set() for kind in ('nodes', 'services', *KINDS)}
        self._node = rclpy.create_node(self.name, context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self._node)
        self._publishers = {}
        for topic, kind in KINDS.items():
            self._publishers[topic] = self._node.create_publisher(kind, topic, 10)
            self._node.create_subscription(
                kind, topic, lambda message, topic=topic: self.hear(topic, message), 10)
        self._node.create_service(Trigger, f'{self.name}/start', self.answer)
        self._clients = {}

    def hear(self, topic, message):
        """Note who has sent a message."""
        self.heard[topic].add(message.header.frame_id)

    def answer(self, _, response):
        """Answer a call with the name."""
        response.success, response.message = True, self.name
        return response

    def talk(self):
        """Publish, call and listen once."""
        for topic, kind in KINDS.items():
            message = kind()
            message.header.frame_id = self.name
            self._publishers[topic].publish(message)
        self.heard['nodes'].update(self._node.get_node_names())
        for name in self.heard['nodes'] - self._clients.keys():
            self._clients[name] = self._node.create_client(Trigger, f'{name}/start')
        for client in self._clients.values():
            if client.service_is_ready():
                client.call_async(Trigger.Request()).add_done_callback(
                    lambda future: self.heard['services'].add(future.result().message))
        self._executor.spin_once(timeout_sec=PERIOD)
        for _ in range(20):
            self._executor.spin_once(timeout_sec=0.0)


def print_line(value):
    """Print a line of JSON at once."""
    print(json.dumps(value), flush=True)


def talk(context, has_ended):
    """Talk until a condition holds, and print what is new."""
    talker = Talker(context)
    printed = None
    while not has_ended():
        talker.talk()
        heard = {kind: sorted(names) for kind, names in talker.heard.items()}
        if heard != printed:
            print_line({'name': talker.name, 'heard': heard})
            printed = heard


def input_has_ended():
    """Tell whether the standard input has been closed."""
    return bool(select.select([sys.stdin], [], [], 0.0)[0])


def main():
    """Talk in the domain of the environment; as a node of ``NodeProcesses``, until killed."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    talk(context, (lambda: False) if '--ros-args' in sys.argv else input_has_ended)


if __name__ == '__main__':
    main()
