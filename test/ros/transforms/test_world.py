"""Messages in any frame come to a node in the world frame, over DDS."""

import math
import time

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from helpers.build_interfaces import available_tf2_msgs
from nav_msgs.msg import OccupancyGrid
import numpy as np
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_ros.conversions.primitives import from_pose_message, to_pose_message, to_stamp
from push_ros.node import PushNode
from push_ros.transforms.listener import (
    DYNAMIC_QOS, DYNAMIC_TOPIC, STATIC_QOS, STATIC_TOPIC, transform_message_type,
)
from push_ros.transforms.messages import to_transform_message
from push_ros.transforms.world import Handlers, WorldFrame
from push_scenario.dds.private_network import private_domain
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor

pytestmark = [pytest.mark.dds, pytest.mark.slow]
PATIENCE = 400.0
# A camera that looks straight down from a mast of 2 m: its z axis points to the floor.
CAMERA = RigidTransform.from_angles((0.5, 0.0, 2.0), (math.pi, 0.0, 0.0))


class Receiver:
    """A node that brings messages to the frame ``odom``, and somebody who publishes transforms."""

    def __init__(self, timeout):
        self.node = PushNode('receiver', ())
        self.world = WorldFrame(self.node, 'odom', timeout, 'base_link')
        self.other = rclpy.create_node('localization')
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.executor.add_node(self.other)
        self.publishers = {
            is_static: self.other.create_publisher(transform_message_type(), topic, quality)
            for is_static, topic, quality in ((False, DYNAMIC_TOPIC, DYNAMIC_QOS),
                                              (True, STATIC_TOPIC, STATIC_QOS))}
        # Messages in the world frame and in the base frame, reasons of refusals, corrections of
        # what lasts.
        self.accepted = []
        self.relative = []
        self.refused = []
        self.moved = []

    def receive(self, message, topic='object_pose', lasting=False, takes_relative=False):
        """Give the node a message, as its subscription would."""
        self.world.receive(topic, message, Handlers(
            self.accepted.append, lambda error, _: self.refused.append(str(error)),
            (lambda correction: self.moved.append(correction)) if lasting else None,
            is_latched=topic == 'map',
            accept_relative=self.relative.append if takes_relative else None))

    def transform(self, parent, child, now, transform, is_static=False):
        """Publish a transform."""
        kind = transform_message_type()
        self.publishers[is_static].publish(kind(transforms=[
            to_transform_message(transform, to_stamp(now), parent, child)]))

    def spin_until(self, condition, action=lambda: None):
        """Spin until a condition holds, repeating an action."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end
            action()
            self.executor.spin_once(timeout_sec=0.02)

    def close(self):
        """End both nodes."""
        self.executor.shutdown()
        self.node.destroy_node()
        self.other.destroy_node()


@pytest.fixture(scope='module')
def ros():
    """Start ROS on a domain of its own."""
    with available_tf2_msgs(), private_domain() as domain:
        rclpy.init(args=[], domain_id=domain)
        yield
        rclpy.shutdown()


@pytest.fixture
def receiver(ros):
    """Make a receiver that waits a minute for transforms."""
    made = Receiver(PATIENCE)
    yield made
    made.close()


def upright(x, y, yaw):
    """Make a transform in the plane."""
    return RigidTransform.from_angles((x, y, 0.0), (0.0, 0.0, yaw))


def pose_message(frame, now, pose):
    """Make a pose in a frame."""
    message = PoseStamped(pose=to_pose_message(pose))
    message.header.stamp, message.header.frame_id = to_stamp(now), frame
    return message


def test_an_object_in_a_camera_waits_for_the_transform_at_its_stamp(receiver):
    """It is transformed at its own time, though the robot has driven on since."""
    # Seen from above, upside down: the object stands upright in the world.
    seen = CAMERA.inverse() @ upright(1.0, 0.3, 0.2)
    message = pose_message('camera', 10.5, (0.0, 0.0, 0.0))
    position, orientation = message.pose.position, message.pose.orientation
    position.x, position.y, position.z = seen[:3]
    orientation.x, orientation.y, orientation.z, orientation.w = seen.quaternion
    receiver.receive(message)

    def drive():
        receiver.transform('base_link', 'camera', 0.0, CAMERA, is_static=True)
        for now in range(10, 13):
            receiver.transform('odom', 'base_link', float(now), upright(now - 10.0, 0.0, 0.0))
    receiver.spin_until(lambda: receiver.accepted, drive)
    accepted, = receiver.accepted
    assert accepted.header.frame_id == 'odom' and accepted.header.stamp == message.header.stamp
    assert from_pose_message(accepted.pose, '') == pytest.approx(Pose(1.5, 0.3, 0.2))
    assert accepted.pose.position.z == pytest.approx(0.0)
    assert not receiver.refused


def test_a_pose_that_a_camera_on_the_robot_measures_is_relative_without_odometry(receiver):
    """In the base frame at once, in that of the camera once its place on the robot is known."""
    receiver.receive(pose_message('base_link', 10.0, (1.0, 0.2, 0.3)), takes_relative=True)
    relative, = receiver.relative
    assert from_pose_message(relative.pose, '') == pytest.approx(Pose(1.0, 0.2, 0.3))
    seen = CAMERA.inverse() @ upright(1.0, 0.3, 0.2)
    message = pose_message('camera', 10.5, (0.0, 0.0, 0.0))
    position, orientation = message.pose.position, message.pose.orientation
    position.x, position.y, position.z = seen[:3]
    orientation.x, orientation.y, orientation.z, orientation.w = seen.quaternion
    receiver.receive(message, takes_relative=True)
    receiver.spin_until(lambda: len(receiver.relative) > 1, lambda: receiver.transform(
        'base_link', 'camera', 0.0, CAMERA, is_static=True))
    relative = receiver.relative[1]
    assert relative.header.frame_id == 'base_link' and relative.header.stamp == to_stamp(10.5)
    assert from_pose_message(relative.pose, '') == pytest.approx(Pose(1.0, 0.3, 0.2))
    assert not receiver.accepted and not receiver.refused


def test_a_pose_of_a_camera_beside_the_robot_goes_to_the_world(receiver):
    """Although it hangs below the base frame, where that link moves."""
    receiver.receive(pose_message('mast', 10.5, (1.0, 0.0, 0.0)), takes_relative=True)

    def drive():
        for now in (10.0, 11.0):
            receiver.transform('odom', 'base_link', now, upright(1.0, 0.0, 0.0))
            receiver.transform('base_link', 'mast', now, upright(0.0, now, 0.0))
    receiver.spin_until(lambda: receiver.accepted, drive)
    assert from_pose_message(receiver.accepted[0].pose, '') == pytest.approx(
        Pose(2.0, 10.5, 0.0))
    assert not receiver.relative


def test_the_covariance_turns_with_the_pose(receiver):
    """What was uncertain along x of a frame turned by a right angle is so along y."""
    message = PoseWithCovarianceStamped()
    message.header.frame_id, message.header.stamp = 'turned', to_stamp(1.0)
    covariance = np.diag([4e-4, 1e-4, 1.0, 1.0, 1.0, 0.01])
    message.pose.covariance = covariance.ravel()
    receiver.receive(message)
    receiver.spin_until(lambda: receiver.accepted, lambda: receiver.transform(
        'odom', 'turned', 0.0, upright(1.0, 0.0, math.pi / 2), is_static=True))
    found = np.reshape(receiver.accepted[0].pose.covariance, (6, 6))
    np.testing.assert_allclose(found, np.diag([1e-4, 4e-4, 1.0, 1.0, 1.0, 0.01]), atol=1e-12)


def test_a_message_that_names_no_frame_is_refused(receiver):
    """It is not taken for one in the world frame."""
    receiver.receive(pose_message('', 1.0, (1.0, 0.0, 0.0)))
    error, = receiver.refused
    assert not receiver.accepted
    assert "got frame '', expected 'odom'" in error and 'no frame_id' in error


def map_message(origin):
    """Make a map of two cells in the frame of maps."""
    grid = OccupancyGrid(data=[0, 100])
    grid.header.frame_id = 'map'
    grid.info.width, grid.info.height, grid.info.resolution = 2, 1, 0.05
    grid.info.origin = to_pose_message(origin)
    return grid


def test_a_map_that_came_before_its_frame_is_taken_then(ros):
    """It comes once, and localization may begin later: refused, it waits; the newest counts."""
    receiver = Receiver(timeout=0.1)
    for x in (-5.0, -1.0):
        receiver.receive(map_message((x, 0.0, 0.0)), 'map', lasting=True)
        receiver.spin_until(lambda: receiver.refused, lambda: receiver.transform(
            'odom', 'base_link', 5.0, upright(1.0, 0.0, 0.0)))
        assert len(receiver.refused) == 1 and not receiver.accepted
        receiver.refused.clear()
    receiver.world.reset()
    receiver.spin_until(lambda: receiver.accepted, lambda: receiver.transform(
        'map', 'odom', 6.0, upright(1.0, 0.0, 0.0)))
    in_world, = receiver.accepted
    assert from_pose_message(in_world.info.origin, '') == pytest.approx(Pose(-2.0, 0.0, 0.0))
    assert not receiver.refused
    receiver.close()


def test_a_goal_and_a_map_follow_what_drifts(receiver):
    """They are moved with the correction of the frame that they hold in."""
    receiver.receive(pose_message('map', 0.0, (3.0, 0.0, 0.0)), 'goal_pose', lasting=True)
    receiver.receive(map_message((-1.0, 0.0, 0.0)), 'map', lasting=True)
    receiver.spin_until(lambda: len(receiver.accepted) == 2, lambda: receiver.transform(
        'map', 'odom', 5.0, upright(1.0, 0.0, 0.0)))
    goal, in_world = receiver.accepted
    assert from_pose_message(goal.pose, '') == pytest.approx(Pose(2.0, 0.0, 0.0))
    assert from_pose_message(in_world.info.origin, '') == pytest.approx(Pose(-2.0, 0.0, 0.0))
    assert list(in_world.data) == [0, 100]

    # Localization finds that odometry has turned.
    correction = upright(1.0, 0.2, 0.1)
    receiver.spin_until(lambda: len(receiver.moved) == 2, lambda: receiver.transform(
        'map', 'odom', 6.0, correction))
    for moved in receiver.moved:
        found = correction.planar @ (moved @ from_pose_message(goal.pose, ''))
        assert found == pytest.approx(Pose(3.0, 0.0, 0.0))


def test_a_goal_ahead_of_the_robot_does_not_run_away(receiver):
    """In a frame below the world's it holds where it was at its stamp."""
    receiver.receive(pose_message('base_link', 1.0, (1.0, 0.0, 0.0)), 'goal_pose', lasting=True)
    receiver.spin_until(lambda: receiver.accepted, lambda: receiver.transform(
        'odom', 'base_link', 1.0, upright(0.0, 2.0, 0.0)))
    receiver.transform('odom', 'base_link', 2.0, upright(5.0, 2.0, 0.0))
    receiver.receive(pose_message('base_link', 1.5, (0.0, 0.0, 0.0)))
    receiver.spin_until(lambda: len(receiver.accepted) == 2)
    first, second = (from_pose_message(message.pose, '') for message in receiver.accepted)
    assert first == pytest.approx(Pose(1.0, 2.0, 0.0))
    assert second == pytest.approx(Pose(2.5, 2.0, 0.0))
    assert not receiver.moved


def test_a_goal_of_a_clock_that_is_ahead_takes_the_newest_transform(ros):
    """It is not refused because its stamp is never reached."""
    receiver = Receiver(timeout=0.1)
    receiver.receive(pose_message('map', 1e6, (3.0, 0.0, 0.0)), 'goal_pose', lasting=True)
    receiver.spin_until(lambda: receiver.accepted, lambda: receiver.transform(
        'map', 'odom', 5.0, upright(1.0, 0.0, 0.0)))
    assert from_pose_message(receiver.accepted[0].pose, '') == pytest.approx(Pose(2.0, 0.0, 0.0))
    receiver.close()


def test_what_gets_no_transform_is_refused_by_name(ros):
    """With topic, frame, stamp and what is known; messages in the world frame go on coming."""
    receiver = Receiver(timeout=0.1)
    receiver.receive(pose_message('caméra', 12.25, (0.0, 0.0, 0.0)))
    receiver.spin_until(lambda: receiver.refused, lambda: receiver.transform(
        'map', 'odom', 5.0, upright(1.0, 0.0, 0.0)))
    refusal, = receiver.refused
    assert "object_pose: got frame 'caméra', expected 'odom' or a frame with" in refusal
    assert "at 12.250 s: no transform of 'caméra' has come; known: map -> odom" in refusal
    receiver.receive(pose_message('/odom', 12.25, (0.0, 1.0, 0.0)))
    assert [message.pose.position.y for message in receiver.accepted] == [1.0]
    receiver.close()
