"""Publishers of the simulator, and how often they publish."""

import math
from typing import Any, NamedTuple

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import LidarScan, ObjectPose, Odometry
from push_ros.conversions.lidar import to_scan_message
from push_ros.conversions.markers import MarkerHeader, scene_markers
from push_ros.conversions.measurements import to_wrench_message, VARIANCE_INDICES
from push_ros.conversions.primitives import exact_stamp, NANOSECONDS, to_quaternion
from push_ros.conversions.serialized import serialize_object_pose, serialize_odometry
from push_ros.node import PushNode, RateLimiter
from push_ros.node_settings import Frames, SimOptions
from push_ros.qos import EVENT
from push_ros.topics import topic_of_object
from push_sim_node.sensors import MIN_DEVIATION, SensorSettings
from push_sim_node.simulation import Measurement, Simulation
from push_sim_node.truth import Truth
from rclpy.duration import Duration
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool

try:
    # Not installed everywhere.
    from tf2_msgs.msg import TFMessage  # pyright: ignore[reportMissingImports]
except ModuleNotFoundError:
    TFMessage = None

# Rates in simulated time [Hz], chosen for what looks at them: plots, a display, and transforms
# between which tf interpolates.
WRENCH_RATE = 10.0
MARKER_RATE = 5.0
TRUTH_RATE = 20.0
# Time within which recorders must acknowledge the last measurements [s]; chosen: enough for some
# resends to one whose computer is busy.
FLUSH_TIMEOUT = Duration(seconds=1.0)
# Frame of scans, which hangs on the robot as the settings of the lidar say.
LIDAR_FRAME = 'lidar'
# Fraction of a period of the clock by which a time may be early, for its rounding.
CLOCK_ROUNDING = 1e-6


class PublishedMeasurement(NamedTuple):
    """
    A measurement as it was published.

    :param stamp: of it [ns].
    :param topic: name of its topic.
    :param data: the message, serialized.
    """

    stamp: int
    topic: str
    data: bytes


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
    :param robot: the true ``RoundRobot``.
    :param sensors: ``SensorSettings``.
    :param frames: ``Frames``.
    :param options: ``SimOptions``.
    """

    def __init__(self, node: PushNode, robot: RoundRobot, sensors: SensorSettings, frames: Frames,
                 options: SimOptions) -> None:
        self._node = node
        self._robot = robot
        self._frames = frames
        self._options = options
        self._owns_time = options.owns_time
        self._twist_covariance = twist_covariance(sensors)
        self._epoch = 0
        self._measurements = {topic: node.publisher(topic) for topic in (
            'odom', *(['scan'] if sensors.lidar.rate > 0.0 else []))}
        for name in [entry.name for entry in options.objects] or ['']:
            self._measurements[topic_of_object('object_pose', name)] = node.publisher(
                'object_pose', object_name=name)
        self._bumper = node.publisher('bumper') if sensors.bumper_force > 0.0 else None
        self._wrench = _Output(node.publisher('contact_wrench'), WRENCH_RATE)
        self._markers = _Output(node.publisher('markers'), MARKER_RATE)
        self._clock = node.publisher('clock') if self._owns_time else None
        self._clock_rate = options.clock_rate
        self._clock_period = -1
        if TFMessage is None:
            node.get_logger().info('publishes no tf: tf2_msgs is not installed')
        self._tf = _Output(
            None if TFMessage is None else node.create_publisher(TFMessage, '/tf', EVENT),
            TRUTH_RATE)
        self.restart_time()

    def restart_time(self) -> None:
        """Let simulated time 0 be now, where stamps are those of the node's clock."""
        self._clock_period = -1
        if not self._owns_time:
            self._epoch = self._node.get_clock().now().nanoseconds

    def keep_clock(self, time: float) -> None:
        """
        Let the clock go on where the simulation starts over: one that fell back would break nodes.

        In lockstep it starts over as well, so that a replay has the same stamps again.

        :param time: simulated time that was reached [s].
        """
        if self._options.publish_clock and not self._options.lockstep:
            self._epoch = self._nanoseconds(time)

    def skip_time(self, delay: float) -> None:
        """
        Move stamps on by a time in which nothing was simulated, where the node's clock makes them.

        :param delay: on the wall [s].
        """
        if not self._owns_time:
            self._epoch += math.floor(delay * NANOSECONDS)

    def stamp(self, time: float) -> Time:
        """
        Make the stamp of a simulated time.

        :param time: [s].
        """
        return exact_stamp(self._nanoseconds(time))

    def _nanoseconds(self, time: float) -> int:
        return self._epoch + math.floor(time * NANOSECONDS + 0.5)

    def publish_measurement(self, measurement: Measurement,
                            object_name: str = '') -> PublishedMeasurement:
        """
        Publish a measurement.

        :param measurement: the measurement; a scan is in ``LIDAR_FRAME``.
        :param object_name: of the object, where there are several.
        :return: what was published.
        """
        self.publish_clock(measurement.time)
        stamp, world = self._nanoseconds(measurement.time), self._frames.world_frame
        if isinstance(measurement, Odometry):
            base = self._frames.base_frame
            published = PublishedMeasurement(stamp, 'odom', serialize_odometry(
                measurement, stamp, (world, base), self._twist_covariance))
            self._publish_transforms(measurement.time, {base: measurement.pose})
        elif isinstance(measurement, LidarScan):
            published = PublishedMeasurement(stamp, 'scan', serialize_message(to_scan_message(
                measurement, exact_stamp(stamp), LIDAR_FRAME)))
        elif measurement.relative is not None:
            published = PublishedMeasurement(
                stamp, topic_of_object('object_pose', object_name), serialize_object_pose(
                    measurement._replace(pose=measurement.relative), stamp,
                    self._frames.base_frame))
        else:
            published = self._pose_message(object_name, measurement)
        self.republish(published)
        return published

    def publish_bumper(self, is_pressed: bool) -> None:
        """Publish whether the bumper is pressed, where the robot has one."""
        if self._bumper is not None:
            self._bumper.publish(Bool(data=is_pressed))

    def publish_standing(self, name: str, pose: ObjectPose) -> PublishedMeasurement:
        """
        Publish the pose of an object beside the pushed one.

        :param name: of the object.
        :return: what was published.
        """
        published = self._pose_message(name, pose)
        self.republish(published)
        return published

    def _pose_message(self, name: str, pose: ObjectPose) -> PublishedMeasurement:
        stamp = self._nanoseconds(pose.time)
        return PublishedMeasurement(
            stamp, topic_of_object('object_pose', name),
            serialize_object_pose(pose, stamp, self._frames.world_frame))

    def republish(self, published: PublishedMeasurement) -> None:
        """Publish a measurement as it stands."""
        self._measurements[published.topic].publish(published.data)

    def publish_clock(self, time: float) -> None:
        """
        Publish the clock where stamps are simulated time, and where it is due.

        :param time: simulated time [s].
        """
        period = math.floor(time * self._clock_rate + CLOCK_ROUNDING)
        if self._clock is not None and period > self._clock_period:
            self._clock_period = period
            self._clock.publish(Clock(clock=self.stamp(time)))

    def next_clock_time(self, time: float) -> float:
        """
        Compute the next simulated time at which the clock is due, infinite where there is none.

        :param time: simulated time [s].
        """
        if self._clock is None:
            return math.inf
        return (math.floor(time * self._clock_rate + CLOCK_ROUNDING) + 1) / self._clock_rate

    def publish_scene(self, simulation: Simulation) -> None:
        """Publish contact wrench, markers and transforms of the truth where they are due."""
        time = simulation.time
        if self._wrench.is_due(time) and self._wrench.has_subscribers():
            self._publish_wrench(simulation.truth)
        if self._markers.is_due(time) and self._markers.has_subscribers():
            truth = simulation.truth
            self._markers.publish(scene_markers(
                MarkerHeader(self.stamp(time), self._frames.world_frame, 'sim'), simulation.obj,
                self._robot, truth.object_pose, truth.robot_pose))
        if self._tf.is_due(time):
            truth = simulation.truth
            self._publish_transforms(truth.time, {
                self._options.truth_prefix + self._frames.base_frame: truth.robot_pose,
                self._options.truth_prefix + self._frames.object_frame: truth.object_pose})

    def flush(self) -> None:
        """Wait until recorders have the measurements: at the end, before publishers go."""
        for publisher in self._measurements.values():
            publisher.wait_for_all_acked(FLUSH_TIMEOUT)

    def _publish_wrench(self, truth: Truth) -> None:
        normal_in_object = Pose(0.0, 0.0, truth.normal - truth.object_pose.theta)
        self._wrench.publish(to_wrench_message(
            normal_in_object.rotate((truth.force_n, truth.force_t)), self.stamp(truth.time),
            self._options.truth_prefix + self._frames.object_frame))

    def _publish_transforms(self, time: float, poses: dict[str, Pose]) -> None:
        """Publish where frames are in the world frame at a simulated time [s], by their ids."""
        if TFMessage is None:
            return
        message, stamp = TFMessage(), self.stamp(time)
        for child, pose in poses.items():
            transform = TransformStamped(child_frame_id=child)
            transform.header.stamp = stamp
            transform.header.frame_id = self._frames.world_frame
            transform.transform.translation.x = pose.x
            transform.transform.translation.y = pose.y
            transform.transform.rotation = to_quaternion(pose.theta)
            message.transforms.append(transform)
        self._tf.publish(message)


def twist_covariance(sensors: SensorSettings) -> list[float]:
    """
    State the noise of the velocity of odometry, as a message has it.

    :return: covariance of (x, y, z, roll, pitch, yaw) in the axes of the robot, by rows.
    """
    covariance = [0.0] * 36
    for axis, index in VARIANCE_INDICES.items():
        deviation = (sensors.odometry_yaw_rate_noise if axis == 'yaw'
                     else sensors.odometry_speed_noise)
        covariance[index] = max(deviation, MIN_DEVIATION) ** 2
    return covariance
