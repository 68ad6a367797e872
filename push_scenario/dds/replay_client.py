"""The replay's own end of DDS: it listens to topics, sets the goal and calls services."""

from collections.abc import Callable, Collection, Sequence
import time

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_pose_message, to_stamp
from push_ros.topics import SERVICES, TOPICS
from push_scenario.dds.recorder import TopicListener
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

# Wait where no message has come [s]; chosen: messages are taken in bulk, and nobody notices it.
IDLE_PAUSE = 0.01
# A service is called again after this time, as an answer may be lost during discovery [s].
RETRY_PERIOD = 2.0


class ReplayFailed(RuntimeError):
    """A replay that could not be carried through, and why."""


class ReplayClient:
    """
    A context with a node that calls and a node that listens, on a ROS domain.

    :param domain: ROS domain, as ``private_domain`` yields it.
    :param stamped: whether commands have a stamp.
    :param on_message: called with (topic, serialized message) for every message, in ``pump``.
    :param check: called in every ``pump``; raises what ends the replay.
    :param topics: names of the topics to listen to; None for all.
    """

    def __init__(self, domain: int, stamped: bool, on_message: Callable[[str, bytes], None],
                 check: Callable[[], None], topics: Collection[str] | None = None) -> None:
        self._on_message = on_message
        self._check = check
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node('replay', context=self._context)
        self._recorder_node = rclpy.create_node('recorder', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._publishers = {
            topic: self._node.create_publisher(kind, topic, TOPICS[topic].publish_qos)
            for topic, kind in (('goal_pose', PoseStamped), ('map', OccupancyGrid))}
        self._clients = {name: self._node.create_client(entry.type, name)
                         for name, entry in SERVICES.items()}
        self._listener = TopicListener(self._recorder_node, stamped, topics)
        self.types = self._listener.types

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        for node in (self._node, self._recorder_node):
            node.destroy_node()
        rclpy.shutdown(context=self._context)

    def pump(self) -> None:
        """Hand on what has come; pause where nothing has."""
        self._check()
        if not self.drain():
            time.sleep(IDLE_PAUSE)

    def drain(self) -> bool:
        """Hand on what has come; return whether there was anything."""
        received = self._listener.take_all()
        for topic, data in received:
            self._on_message(topic, data)
        return bool(received)

    def wait_for(self, missing: Callable[[], Sequence[str]], timeout: float) -> None:
        """
        Pump until nothing is missing.

        :param missing: lists what is, for the error.
        :param timeout: wall time [s].
        :raises ReplayFailed: where it does not come in time, naming it.
        """
        end = time.monotonic() + timeout
        while what := missing():
            if time.monotonic() > end:
                raise ReplayFailed(f'timed out after {timeout:g} s waiting for {", ".join(what)}')
            self.pump()

    def missing(self) -> list[str]:
        """List what has not been discovered yet: services, and subscribers of the goal."""
        # One subscriber more than the nodes: the recorder.
        expected = len(TOPICS['goal_pose'].subscribers) + ('goal_pose' in self.types)
        count = self._publishers['goal_pose'].get_subscription_count()
        subscribers = [f'{count} of {expected} subscribers of goal_pose'] * (count < expected)
        return subscribers + [f'service {name}' for name, client in self._clients.items()
                              if not client.service_is_ready()]

    def send_goal(self, pose: Pose, frame: str, time: float = 0.0) -> None:
        """
        Publish a goal.

        :param pose: goal ``Pose`` of the object.
        :param frame: id of the world frame.
        :param time: when it starts to hold, in a task in lockstep [s].
        """
        message = PoseStamped(pose=to_pose_message(pose))
        message.header.stamp, message.header.frame_id = to_stamp(time), frame
        self._publishers['goal_pose'].publish(message)

    def send_map(self, occupancy_map: OccupancyMap, frame: str) -> None:
        """
        Publish a map.

        :param frame: id of the world frame.
        """
        self._publishers['map'].publish(to_map_message(occupancy_map, to_stamp(0.0), frame))

    def call(self, service: str, timeout: float) -> None:
        """
        Call a Trigger service until it reports success.

        :param service: its name.
        :param timeout: wall time [s].
        :raises ReplayFailed: where it does not succeed in time, with its last answer.
        """
        client, end = self._clients[service], time.monotonic() + timeout
        answer = 'no answer'
        while time.monotonic() < end:
            future = client.call_async(SERVICES[service].type.Request())
            called_at = time.monotonic()
            while not future.done() and time.monotonic() < called_at + RETRY_PERIOD:
                self._executor.spin_once(timeout_sec=IDLE_PAUSE)
                self.pump()
            response = future.result() if future.done() else None
            if response is not None:
                if response.success:
                    return
                answer = response.message
            self.pump()
        raise ReplayFailed(f'{service} did not succeed within {timeout:g} s: {answer}')
