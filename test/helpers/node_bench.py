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

# No wait of a test is a measure of speed: what is awaited comes, or a node dies, which ends the
# wait at once. This only keeps a suite from hanging [s].
TIMEOUT = 200.0
# Wall time after which a service is called again [s].
ANSWER_WAIT = 3.0
REPEAT_PERIOD = 0.2


class Bench:
    """
    One node in its own process, and a node here that talks to it.

    ``received``: dict of topics to the messages that have come. ``base``: time from which the
    times of all methods are counted [s]. ``is_lockstep``: whether commands have the stamps of the
    measurements that they answer.

    :param processes: ``NodeProcesses``.
    :param node: the rclpy node here.
    :param executor: its executor.
    :param folder: for parameters and output.
    """

    def __init__(self, processes, node, executor, folder):
        self.processes = processes
        self.node = node
        self.executor = executor
        self._folder = folder
        self.base = 0.0
        self.is_lockstep = True
        self.received = {}
        self._publishers = {}

    def start(self, name, module, parameters):
        """Start a node in a process of its own."""
        path = self._folder / f'{name}.yaml'
        path.write_text(yaml.safe_dump({name: {'ros__parameters': parameters}}))
        self.processes.start(name, module, path)

    def node_beside(self, name):
        """Make another node in this process; it lives as long as the bench."""
        node = rclpy.create_node(name, context=self.node.context)
        self.executor.add_node(node)
        return node

    def subscribe(self, topic, kind=None):
        """Collect the messages of a topic in ``received``."""
        entry = TOPICS[topic]
        qos = LATCHED if entry.publish_qos is LATCHED else entry.publish_qos
        self.received[topic] = []
        self.node.create_subscription(kind or entry.type, topic, self.received[topic].append, qos)

    def publish(self, topic, message):
        """Publish a message, once there is a subscriber."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(
                type(message), topic, TOPICS[topic].publish_qos)
            self.wait_until(lambda: self._publishers[topic].get_subscription_count())
        self._publishers[topic].publish(message)

    def wait_until(self, condition):
        """Spin until a condition holds; fail where a node dies."""
        end = time.monotonic() + TIMEOUT
        while not condition():
            self.processes.check()
            assert time.monotonic() < end, 'timed out; ' + ''.join(
                self.processes.log_tail(name) for name in self.processes.names)
            self.executor.spin_once(timeout_sec=0.02)
        return True

    def call(self, service):
        """Call a Trigger service."""
        client = self.node.create_client(Trigger, service)
        self.wait_until(client.service_is_ready)
        calls = []

        def is_answered():
            # Called again: a node may answer before it has met the client's reader of answers.
            if not calls or time.monotonic() > calls[-1][0] + ANSWER_WAIT:
                calls.append((time.monotonic(), client.call_async(Trigger.Request())))
            return any(future.done() for _, future in calls)
        self.wait_until(is_answered)
        return next(future.result() for _, future in calls if future.done())

    def spin(self, wall_time):
        """Spin for a while: only to see that something does not come."""
        end = time.monotonic() + wall_time
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def repeat_until(self, action, condition, period=REPEAT_PERIOD):
        """Repeat an action until a condition holds: best effort may fail at first."""
        end = time.monotonic() + TIMEOUT
        while not condition():
            self.processes.check()
            assert time.monotonic() < end, 'timed out'
            action()
            self.spin(period)

    def connect(self, object_pose, robot_pose):
        """Offer the first measurements until each is answered, and let all answers come in."""
        commands = self.received['cmd_vel']
        first = {
            'object_pose': to_object_pose_message(ObjectPose(self.base, object_pose), 'odom'),
            'odom': to_odometry_message(Odometry(self.base, robot_pose, STOP), 'odom',
                                        'base_link')}
        for topic, message in first.items():
            count, published = len(commands), []

            def offer():
                published.append(topic)
                self.publish(topic, message)
            self.repeat_until(offer, lambda: len(commands) > count)
            # Answers to offers that came late would be taken for those of the next measurement.
            self.wait_for_silence(commands)

    def wait_for_silence(self, messages):
        """Spin until nothing has come for a while."""
        count = -1
        while count != len(messages):
            count = len(messages)
            self.spin(REPEAT_PERIOD)

    def clock(self, now):
        """Set the time."""
        self.publish('clock', Clock(clock=to_stamp(self.base + now)))

    def odometry(self, now, pose, frame='odom', twist=STOP):
        """Publish odometry; return the command that answers it."""
        return self._answer('odom', to_odometry_message(
            Odometry(self.base + now, pose, twist), frame, 'base_link'))

    def object_pose(self, now, pose, frame='odom'):
        """Publish an object pose; return the command that answers it."""
        return self._answer('object_pose', to_object_pose_message(
            ObjectPose(self.base + now, Pose(*pose)), frame))

    def _answer(self, topic, message):
        commands = self.received['cmd_vel']
        count = len(commands)
        self.publish(topic, message)
        self.wait_until(lambda: len(commands) > count)
        command = commands[-1]
        if hasattr(command, 'header'):
            stamps = [nanoseconds(item.header.stamp) for item in (command, message)]
            assert stamps[0] == stamps[1] or not self.is_lockstep
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
