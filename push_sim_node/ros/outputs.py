"""Publishers of the simulator, and how often they publish."""

import math
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry
from push_ros.conversions.markers import MarkerHeader, scene_markers
from push_ros.conversions.measurements import (
    to_object_pose_message, to_odometry_message, to_wrench_message,
)
from push_ros.conversions.primitives import NANOSECONDS, to_quaternion
from push_ros.node import PushNode, RateLimiter
from push_ros.node_settings import Frames, SimOptions
from push_ros.qos import EVENT
from push_sim_node.simulation import Simulation
from push_sim_node.truth import Truth
from rosgraph_msgs.msg import Clock

try:
    # Not installed everywhere.
    from tf2_msgs.msg import TFMessage  # pyright: ignore[reportMissingImports]
except ModuleNotFoundError:
    TFMessage = None

# Rates in simulated time [Hz], chosen for what looks at them: timers and plots, a display, and
# transforms between which tf interpolates.
CLOCK_RATE = 10.0
WRENCH_RATE = 10.0
MARKER_RATE = 5.0
TF_RATE = 20.0


class _Output:
    """A publisher with its rate; None in place of a publisher publishes nothing."""

    def __init__(self, publisher: Any, rate: float) -> None:
        self._publisher = publisher
        self._limiter = RateLimiter(rate)

    def is_due(self, time: float) -> bool:
        """Return whether to publish, and if so count it as done."""
        return self._publisher is not None and self._limiter.due(time)

    def has_subscribers(self) -> bool:
        return self._publisher.get_subscription_count() > 0

    def publish(self, message: Any) -> None:
        if self._publisher is not None:
            self._publisher.publish(message)


class SimOutputs:
    """
    Publishers of the simulator; markers and wrenches are made only for subscribers.

    :param node: the ``PushNode``.
    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param frames: ``Frames``.
    :param options: ``SimOptions``.
    """

    def __init__(self, node: PushNode, obj: PushedObject, robot: RoundRobot, frames: Frames,
                 options: SimOptions) -> None:
        self._node = node
        self._obj = obj
        self._robot = robot
        self._frames = frames
        self._owns_time = options.owns_time
        self._epoch = 0
        self._odometry = node.publisher('odom')
        self._object_pose = node.publisher('object_pose')
        self._wrench = _Output(node.publisher('contact_wrench'), WRENCH_RATE)
        self._markers = _Output(node.publisher('markers'), MARKER_RATE)
        self._clock = _Output(node.publisher('clock') if self._owns_time else None, CLOCK_RATE)
        self._tf = _Output(
            None if TFMessage is None else node.create_publisher(TFMessage, '/tf', EVENT), TF_RATE)
        self.restart_time()

    def restart_time(self) -> None:
        """Let simulated time 0 be now, where stamps are those of the node's clock."""
        if not self._owns_time:
            self._epoch = self._node.get_clock().now().nanoseconds

    def stamp(self, time: float) -> Time:
        """
        Make the stamp of a simulated time.

        :param time: [s].
        """
        whole, part = divmod(self._epoch + math.floor(time * NANOSECONDS + 0.5), NANOSECONDS)
        return Time(sec=whole, nanosec=part)

    def publish_measurement(self, measurement: Odometry | ObjectPose) -> Any:
        """
        Publish a measurement.

        :param measurement: ``Odometry`` or ``ObjectPose``.
        :return: the message.
        """
        if isinstance(measurement, Odometry):
            message = to_odometry_message(measurement, self._frames.world_frame,
                                          self._frames.base_frame)
        else:
            message = to_object_pose_message(measurement, self._frames.world_frame)
        message.header.stamp = self.stamp(measurement.time)
        self.republish(message)
        return message

    def republish(self, message: Any) -> None:
        """
        Publish the message of a measurement as it stands.

        :param message: ``nav_msgs/Odometry`` or ``geometry_msgs/PoseStamped``.
        """
        is_object_pose = hasattr(message.pose, 'position')
        (self._object_pose if is_object_pose else self._odometry).publish(message)

    def publish_clock(self, time: float) -> None:
        """
        Publish the clock, where stamps are simulated time.

        :param time: simulated time [s].
        """
        self._clock.publish(Clock(clock=self.stamp(time)))

    def publish_scene(self, simulation: Simulation) -> None:
        """
        Publish clock, contact wrench, markers and transforms where they are due.

        :param simulation: the ``Simulation``.
        """
        time = simulation.time
        if self._clock.is_due(time):
            self.publish_clock(time)
        if self._wrench.is_due(time) and self._wrench.has_subscribers():
            self._publish_wrench(simulation.truth)
        if self._markers.is_due(time) and self._markers.has_subscribers():
            truth = simulation.truth
            self._markers.publish(scene_markers(
                MarkerHeader(self.stamp(time), self._frames.world_frame, 'sim'), self._obj,
                self._robot, truth.object_pose, truth.robot_pose))
        if self._tf.is_due(time):
            self._publish_transforms(simulation.truth)

    def _publish_wrench(self, truth: Truth) -> None:
        normal_in_object = Pose(0.0, 0.0, truth.normal - truth.object_pose.theta)
        self._wrench.publish(to_wrench_message(
            normal_in_object.rotate((truth.force_n, truth.force_t)), self.stamp(truth.time),
            self._frames.object_frame))

    def _publish_transforms(self, truth: Truth) -> None:
        if TFMessage is None:
            return
        message = TFMessage()
        for child, pose in ((self._frames.base_frame, truth.robot_pose),
                            (self._frames.object_frame, truth.object_pose)):
            transform = TransformStamped(child_frame_id=child)
            transform.header.stamp = self.stamp(truth.time)
            transform.header.frame_id = self._frames.world_frame
            transform.transform.translation.x = pose.x
            transform.transform.translation.y = pose.y
            transform.transform.rotation = to_quaternion(pose.theta)
            message.transforms.append(transform)
        self._tf.publish(message)
