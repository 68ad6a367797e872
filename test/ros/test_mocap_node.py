"""Odometry from motion capture, over DDS."""

from geometry_msgs.msg import PoseStamped
from helpers.build_interfaces import available_tf2_msgs
from helpers.node_bench import bench
from nav_msgs.msg import Odometry
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_ros.conversions.measurements import from_odometry_message
from push_ros.conversions.primitives import to_pose_message, to_stamp
from push_ros.topics import MOCAP
from push_ros.transforms.listener import DYNAMIC_QOS, DYNAMIC_TOPIC, transform_message_type
from push_ros.transforms.messages import to_transform_message
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]
MODULE = 'push_tracker.mocap_node'
# The robot drives along y of the world at 0.2 m/s; the body is mounted on it, turned.
SPEED, PERIOD = 0.2, 0.02
MOUNTING = Pose(0.1, 0.0, 0.5)
PARAMETERS = {'world_frame': 'world', 'base_frame': 'base_footprint', 'mocap.x': MOUNTING.x,
              'mocap.yaw': MOUNTING.theta}


class Robot:
    """A robot that drives on whenever it is looked at."""

    def __init__(self):
        self.now = 100.0

    @property
    def pose(self):
        """Its true pose now."""
        return Pose(1.0, SPEED * (self.now - 100.0), 1.5707963267948966)

    def advance(self):
        """Let a period pass; return time and pose of the rigid body."""
        self.now += PERIOD
        return self.now, self.pose @ MOUNTING


def texts(b):
    """Texts that were reported."""
    return [status.message for message in b.received['diagnostics'] for status in message.status]


def check(message, robot):
    """Compare the newest odometry with the robot."""
    odometry = from_odometry_message(message, 'world')
    assert message.child_frame_id == 'base_footprint'
    # Messages under way may be of some periods ago.
    assert odometry.time == pytest.approx(robot.now, abs=50 * PERIOD)
    assert odometry.pose.y == pytest.approx(SPEED * (odometry.time - 100.0), abs=1e-6)
    assert odometry.pose.x == pytest.approx(1.0, abs=1e-9)
    assert odometry.twist == pytest.approx((SPEED, 0.0, 0.0), abs=1e-6)
    assert odometry.covariance is not None


def test_poses_become_odometry(tmp_path):
    """Poses in another frame are refused by name, and nothing is published for them."""
    robot = Robot()
    with bench(tmp_path, MOCAP, MODULE, PARAMETERS) as b:
        b.subscribe('diagnostics')
        b.subscribe('odom', Odometry)

        def publish(frame='world'):
            now, body = robot.advance()
            message = PoseStamped(pose=to_pose_message(body))
            message.header.frame_id, message.header.stamp = frame, to_stamp(now)
            b.publish('robot_pose', message)
        b.repeat_until(lambda: publish('map'),
                       lambda: any("'map'" in text and "'world'" in text for text in texts(b)))
        assert b.received['odom'] == []
        b.repeat_until(publish, lambda: len(b.received['odom']) > 3)
        check(b.received['odom'][-1], robot)
        b.wait_until(lambda: any('gets no poses' in text for text in texts(b)))


def test_transforms_become_odometry(tmp_path):
    robot = Robot()
    with available_tf2_msgs(), bench(tmp_path, MOCAP, MODULE,
                                     {**PARAMETERS, 'robot_frame': 'markers'}) as b:
        b.subscribe('odom', Odometry)
        kind = transform_message_type()
        publisher = b.node.create_publisher(kind, DYNAMIC_TOPIC, DYNAMIC_QOS)

        def publish():
            now, body = robot.advance()
            transform = RigidTransform.from_angles((body.x, body.y, 0.4), (0.0, 0.0, body.theta))
            publisher.publish(kind(transforms=[
                to_transform_message(transform, to_stamp(now), 'world', 'markers')]))
        b.repeat_until(publish, lambda: len(b.received['odom']) > 3)
        check(b.received['odom'][-1], robot)
