"""What the simulator publishes, and how often."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from push_model.geometry import Pose
from push_model.signals import Odometry
from push_ros.conversions.markers import scene_markers
from push_ros.conversions.measurements import (
    to_object_pose_message, to_odometry_message, to_wrench_message,
)
from push_ros.conversions.primitives import NANOSECONDS, to_quaternion
from push_ros.node import RateLimiter
from push_ros.qos import EVENT
from rosgraph_msgs.msg import Clock

try:
    from tf2_msgs.msg import TFMessage
except ModuleNotFoundError:
    TFMessage = None

CLOCK_RATE, WRENCH_RATE, MARKER_RATE, TF_RATE = 10.0, 10.0, 5.0, 20.0


class SimOutputs:
    """
    Publishers of the simulator; what few look at is published seldom, and only to them.

    :param node: the ``PushNode``.
    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param frames: ``Frames``.
    :param options: ``SimOptions``.
    """

    def __init__(self, node, obj, robot, frames, options):
        self._node, self._obj, self._robot, self._frames = node, obj, robot, frames
        self._owns_time = options.owns_time
        self.epoch = self.now_epoch()
        self._odometry = node.publisher('odom')
        self._object_pose = node.publisher('object_pose')
        self._wrench, self._wrench_rate = node.publisher('contact_wrench'), RateLimiter(WRENCH_RATE)
        self._markers, self._marker_rate = node.publisher('markers'), RateLimiter(MARKER_RATE)
        self._clock = node.publisher('clock') if self._owns_time else None
        self._clock_rate = RateLimiter(CLOCK_RATE)
        self._tf = TFMessage and node.create_publisher(TFMessage, '/tf', EVENT)
        self._tf_rate = RateLimiter(TF_RATE)

    def now_epoch(self):
        """Stamp of simulated time 0, where that is now [ns]."""
        return 0 if self._owns_time else self._node.get_clock().now().nanoseconds

    def stamp(self, time):
        """
        Make the stamp of a simulated time.

        :param time: [s].
        """
        whole, part = divmod(self.epoch + math.floor(time * NANOSECONDS + 0.5), NANOSECONDS)
        return Time(sec=whole, nanosec=part)

    def measurement(self, measurement):
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
        self.again(message)
        return message

    def again(self, message):
        """
        Publish a measurement as it stands.

        :param message: ``nav_msgs/Odometry`` or ``geometry_msgs/PoseStamped``.
        """
        is_pose = hasattr(message.pose, 'position')
        (self._object_pose if is_pose else self._odometry).publish(message)

    def clock(self, time):
        """
        Publish the clock, where time is ours.

        :param time: simulated time [s].
        """
        if self._clock is not None:
            self._clock.publish(Clock(clock=self.stamp(time)))

    def scene(self, simulation):
        """
        Publish clock, contact wrench, markers and transforms where they are due.

        :param simulation: the ``Simulation``.
        """
        time = simulation.time
        if self._clock_rate.due(time):
            self.clock(time)
        if self._wrench_rate.due(time) and self._wrench.get_subscription_count():
            truth = simulation.truth
            n, t = truth.force_n, truth.force_t
            angle = truth.normal - truth.object_pose.theta
            self._wrench.publish(to_wrench_message(
                Pose(0.0, 0.0, angle).rotate((n, t)), self.stamp(time), self._frames.object_frame))
        if self._marker_rate.due(time) and self._markers.get_subscription_count():
            truth = simulation.truth
            self._markers.publish(scene_markers(
                self.stamp(time), self._frames.world_frame, 'sim', self._obj, self._robot,
                truth.object_pose, truth.robot_pose))
        if self._tf is not None and self._tf_rate.due(time):
            self._send_transforms(simulation.truth)

    def _send_transforms(self, truth):
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
