"""The replay's own end of DDS: it hears everything, sets the goal and calls services."""

import contextlib
import os
import time

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_pose_message, to_stamp
from push_ros.topics import SERVICES, TOPICS
from push_scenario.dds.recorder import Listener
import rclpy
from rclpy.executors import SingleThreadedExecutor

PAUSE, PATIENCE = 0.002, 2.0
RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'


class ReplayFailed(RuntimeError):
    """A replay that could not be carried through, and why."""


class ReplayClient:
    """
    A context, a node that calls and a node that listens, on a domain.

    :param domain: ROS domain.
    :param stamped: whether commands have a stamp.
    :param watch: called with (topic, serialized message) for every message, in :meth:`pump`.
    :param check: called in every :meth:`pump`; raises what ends the replay.
    """

    def __init__(self, domain, stamped, watch, check):
        self._watch, self._check = watch, check
        self._context = rclpy.Context()
        with local_discovery():
            rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node('replay', context=self._context)
        self._ear = rclpy.create_node('recorder', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._goal = self._node.create_publisher(PoseStamped, 'goal_pose',
                                                 TOPICS['goal_pose'].publish_qos)
        self._map = self._node.create_publisher(OccupancyGrid, 'map', TOPICS['map'].publish_qos)
        self._clients = {name: self._node.create_client(kind, name)
                         for name, (kind, _, _) in SERVICES.items()}
        self._listener = Listener(self._ear, stamped)
        self.types = self._listener.types

    def close(self):
        """Leave the domain."""
        self._executor.shutdown()
        for node in (self._node, self._ear):
            node.destroy_node()
        rclpy.shutdown(context=self._context)

    def pump(self):
        """Hand on what has come; wait a moment where nothing has."""
        self._check()
        taken = self._listener.take_message()
        for topic, data in taken:
            self._watch(topic, data)
        if not taken:
            time.sleep(PAUSE)

    def drain(self):
        """Hand on what has come and nobody has taken, once the nodes have ended."""
        for topic, data in self._listener.take_message():
            self._watch(topic, data)

    def wait_for(self, condition, timeout, what):
        """
        Pump until something holds.

        :param condition: takes nothing, tells whether it holds.
        :param timeout: wall time [s].
        :param what: what is waited for, for the error.
        :raises ReplayFailed: where it does not come in time.
        """
        end = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > end:
                raise ReplayFailed(f'waited {timeout:g} s for {what}, in vain')
            self.pump()

    def is_connected(self):
        """Tell whether nodes, services and recorder have found each other."""
        return (self._goal.get_subscription_count() > len(TOPICS['goal_pose'].subscribers)
                and all(client.service_is_ready() for client in self._clients.values()))

    def send_goal(self, pose, frame, time=0.0):
        """
        Publish a goal.

        :param pose: ``Pose`` wanted for the object.
        :param frame: id of the world frame.
        :param time: when it begins to hold, in a task [s].
        """
        message = PoseStamped(pose=to_pose_message(pose))
        message.header.stamp, message.header.frame_id = to_stamp(time), frame
        self._goal.publish(message)

    def send_map(self, occupancy_map, frame):
        """
        Publish a map.

        :param occupancy_map: ``push_navigation.occupancy_map.OccupancyMap``.
        :param frame: id of the world frame.
        """
        self._map.publish(to_map_message(occupancy_map, to_stamp(0.0), frame))

    def call(self, service, timeout):
        """
        Call a Trigger service, again and again until it agrees.

        :param service: its name.
        :param timeout: wall time [s].
        :raises ReplayFailed: where it does not agree in time, with its last answer.
        """
        client, end = self._clients[service], time.monotonic() + timeout
        answer = 'no answer'
        while time.monotonic() < end:
            # Asked anew after a while: an answer can be lost while both sides get acquainted.
            future = client.call_async(SERVICES[service][0].Request())
            asked = time.monotonic()
            while not future.done() and time.monotonic() < asked + PATIENCE:
                self._executor.spin_once(timeout_sec=PAUSE)
                self.pump()
            if future.done():
                if future.result().success:
                    return
                answer = future.result().message
            self.pump()
        raise ReplayFailed(f'{service} did not agree within {timeout:g} s: {answer}')


@contextlib.contextmanager
def local_discovery():
    """Let contexts that are made in the block find only nodes of this machine."""
    before = os.environ.get(RANGE)
    os.environ[RANGE] = 'LOCALHOST'
    try:
        yield
    finally:
        if before is None:
            del os.environ[RANGE]
        else:
            os.environ[RANGE] = before
