"""A bench for single nodes over DDS: it plays everything around them, and time itself."""

import contextlib
import math
import time

from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.primitives import nanoseconds, to_stamp
from push_ros.qos import LATCHED
from push_ros.topics import TOPICS
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger
import yaml

# No wait of a test is a measure of speed: what is awaited comes, or a node dies, which ends the
# wait at once. This only keeps a suite from hanging [s].
TIMEOUT = 400.0
# The same for the reaction of a node that has nothing to compile or to plan for it, as a zero or
# the end of a cancelled goal: a test of a node that does not react ends earlier [s].
REACTION_TIMEOUT = 60.0
# Wall time after which a service is called, or a measurement sent, again [s]: long enough for a
# node that has to wait for the processor, as what is repeated must have been lost.
ANSWER_WAIT = 20.0
REPEAT_PERIOD = 0.2


class Bench:
    """
    One node in its own process, and a node here that talks to it.

    ``received``: dict of topics to the messages that have come. ``base``: time from which the
    times of all methods are counted [s]. ``latest``: newest time that was measured at [s].
    ``is_lockstep``: whether commands have the stamps of the
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
        self.base = self.latest = 0.0
        self.is_lockstep = True
        self.received = {}
        self._publishers = {}
        self._clients = {}

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

    def publish_bytes(self, topic, data):
        """Publish bytes in place of a message, on a topic that was published to before."""
        self._publishers[topic].publish(data)

    def wait_until(self, condition, timeout=TIMEOUT):
        """Spin until a condition holds; fail where a node dies."""
        end = time.monotonic() + timeout
        while not condition():
            self.processes.check()
            assert time.monotonic() < end, 'timed out; ' + ''.join(
                self.processes.log_tail(name) for name in self.processes.names)
            self.executor.spin_once(timeout_sec=0.02)
        return True

    def call(self, service):
        """Call a Trigger service."""
        return self.request(Trigger, service, Trigger.Request())

    def client(self, kind, service):
        """Make the client of a service, and wait until both ends have met; each is made once."""
        if service not in self._clients:
            self._clients[service] = self.node.create_client(kind, service)
            self.wait_until(self._clients[service].service_is_ready)
        return self._clients[service]

    def request(self, kind, service, request):
        """Call a service of any kind."""
        client = self.client(kind, service)
        calls = []

        def is_answered():
            # Called again: a node may answer before it has met the client's reader of answers.
            if not calls or time.monotonic() > calls[-1][0] + ANSWER_WAIT:
                calls.append((time.monotonic(), client.call_async(request)))
            return any(future.done() for _, future in calls)
        self.wait_until(is_answered)
        return next(future.result() for _, future in calls if future.done())

    def wait_until_handled(self, topic, service):
        """Wait until what was published has come, and a call after it has been answered."""
        self._publishers[topic].wait_for_all_acked(Duration(seconds=TIMEOUT))
        self.call(service)

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
            self.wait_for_silence('cmd_vel')

    def wait_for_silence(self, *topics):
        """Spin until nothing has come for a while on any of the topics."""
        def total():
            return sum(len(self.received[topic]) for topic in topics)

        count = -1
        while count != total():
            count = total()
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
        """Publish a measurement, best effort, until a command answers it."""
        commands = self.received['cmd_vel']
        count, sent = len(commands), [-math.inf]
        self.latest = max(self.latest, 1e-9 * nanoseconds(message.header.stamp))

        def answers():
            if time.monotonic() > sent[-1] + ANSWER_WAIT:
                sent.append(time.monotonic())
                self.publish(topic, message)
            return [command for command in commands[count:] if self._may_answer(command, message)]
        self.wait_until(answers)
        command = answers()[0]
        command = command.twist if hasattr(command, 'header') else command
        return command.linear.x, command.linear.y, command.angular.z

    def _may_answer(self, command, message):
        """Tell an answer to a message from a late one to another; only stamps can."""
        return (not self.is_lockstep or not hasattr(command, 'header')
                or nanoseconds(command.header.stamp) == nanoseconds(message.header.stamp))


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
