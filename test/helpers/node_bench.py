"""A bench for single nodes over DDS: it plays everything around them, and time itself."""

import contextlib
import time

from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.primitives import nanoseconds, to_stamp
from push_ros.qos import LATCHED
from push_ros.topics import TOPICS
from push_scenario.dds.processes import NodeProcesses, private_domain
from push_scenario.dds.replay_client import local_discovery
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger
import yaml

WAIT, ANSWER_WAIT = 20.0, 3.0
START_WAIT = 60.0


class Bench:
    """
    One node in its own process, and a node here that talks to it.

    Times are counted from ``base``.

    :param processes: ``NodeProcesses``.
    :param node: the rclpy node here.
    :param executor: its executor.
    :param folder: for parameters and output.
    """

    def __init__(self, processes, node, executor, folder):
        self.processes, self.node, self._executor = processes, node, executor
        self._folder = folder
        self.base = 0.0
        self.heard = {}
        self._publishers = {}

    def start(self, name, module, parameters):
        """Start a node in a process of its own."""
        path = self._folder / f'{name}.yaml'
        path.write_text(yaml.safe_dump({name: {'ros__parameters': parameters}}))
        self.processes.start(name, module, path)

    def listen(self, topic, kind=None):
        """Collect the messages of a topic in ``heard``."""
        entry = TOPICS[topic]
        qos = LATCHED if entry.publish_qos is LATCHED else entry.publish_qos
        self.heard[topic] = []
        self.node.create_subscription(kind or entry.type, topic, self.heard[topic].append, qos)

    def speak(self, topic, message):
        """Publish a message, once somebody listens."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(
                type(message), topic, TOPICS[topic].publish_qos)
            self.until(lambda: self._publishers[topic].get_subscription_count(), START_WAIT)
        self._publishers[topic].publish(message)

    def until(self, condition, timeout=WAIT):
        """Spin until something holds; fail where it does not come."""
        end = time.monotonic() + timeout
        while not condition():
            self.processes.check()
            assert time.monotonic() < end, 'waited in vain; ' + ''.join(
                self.processes.log_tail(name) for name in self.processes.names)
            self._executor.spin_once(timeout_sec=0.02)
        return True

    def call(self, service):
        """Call a Trigger service."""
        client = self.node.create_client(Trigger, service)
        self.until(client.service_is_ready, START_WAIT)
        asked = []

        def answered():
            # Asked anew: a node may answer before it has met the client's reader of answers.
            if not asked or time.monotonic() > asked[-1][0] + ANSWER_WAIT:
                asked.append((time.monotonic(), client.call_async(Trigger.Request())))
            return asked[-1][1].done()
        self.until(answered)
        return asked[-1][1].result()

    def spin(self, wall_time):
        """Spin for a while: only to see that something does not come."""
        end = time.monotonic() + wall_time
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def repeat(self, action, condition, timeout=START_WAIT):
        """Do something every 0.2 s until a condition holds: best effort may fail at first."""
        end = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < end, 'repeated in vain'
            action()
            self.spin(0.2)

    def meet(self, object_pose, robot_pose):
        """Offer the first measurements until each is answered, and let all answers come in."""
        commands = self.heard['cmd_vel']
        first = {
            'object_pose': to_object_pose_message(ObjectPose(self.base, object_pose), 'odom'),
            'odom': to_odometry_message(Odometry(self.base, robot_pose, STOP), 'odom',
                                        'base_link')}
        for topic, message in first.items():
            count = len(commands)
            self.repeat(lambda: self.speak(topic, message), lambda: len(commands) > count)
            self.spin(0.2)

    def clock(self, now):
        """Set the time."""
        self.speak('clock', Clock(clock=to_stamp(self.base + now)))

    def odometry(self, now, pose, frame='odom', twist=STOP):
        """Publish odometry; return the command that answers it."""
        return self._answer('odom', to_odometry_message(
            Odometry(self.base + now, pose, twist), frame, 'base_link'))

    def object_pose(self, now, pose, frame='odom'):
        """Publish an object pose; return the command that answers it."""
        return self._answer('object_pose', to_object_pose_message(
            ObjectPose(self.base + now, Pose(*pose)), frame))

    def _answer(self, topic, message):
        commands = self.heard['cmd_vel']
        count = len(commands)
        self.speak(topic, message)
        self.until(lambda: len(commands) > count)
        command = commands[-1]
        if hasattr(command, 'header'):
            assert nanoseconds(command.header.stamp) == nanoseconds(message.header.stamp)
            command = command.twist
        return command.linear.x, command.linear.y, command.angular.z


@contextlib.contextmanager
def bench(folder, name, module, parameters):
    """
    Start one node.

    :param folder: for its parameters and output.
    :param name: of the node.
    :param module: Python module.
    :param parameters: dict of parameters.
    """
    with private_domain() as domain, NodeProcesses(domain, folder) as processes:
        context = rclpy.Context()
        with local_discovery():
            rclpy.init(args=[], context=context, domain_id=domain)
        node = rclpy.create_node('bench', context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        try:
            b = Bench(processes, node, executor, folder)
            b.start(name, module, parameters)
            yield b
        finally:
            executor.shutdown()
            node.destroy_node()
            rclpy.shutdown(context=context)
