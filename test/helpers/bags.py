"""Recordings of rosbag2 as robots write them."""

import math

from helpers.extras import import_extra
import numpy as np

import_extra('rosbags', 'record')
from rosbags.rosbag2 import Writer  # noqa: E402, I100
from rosbags.typesys import get_typestore, Stores  # noqa: E402

STORE = get_typestore(Stores.ROS2_JAZZY)


def write_bag(path, tracks, storage):
    """Write robot and object poses as a robot records them, the robot's as odometry."""
    types = STORE.types
    header, stamp = types['std_msgs/msg/Header'], types['builtin_interfaces/msg/Time']
    pose, point = types['geometry_msgs/msg/Pose'], types['geometry_msgs/msg/Point']
    turn, vector = types['geometry_msgs/msg/Quaternion'], types['geometry_msgs/msg/Vector3']
    twist = types['geometry_msgs/msg/Twist']
    with Writer(path, version=9, storage_plugin=storage) as writer:
        odom = writer.add_connection('/odom', 'nav_msgs/msg/Odometry', typestore=STORE)
        poses = writer.add_connection('/object_pose', 'geometry_msgs/msg/PoseStamped',
                                      typestore=STORE)
        for connection, track in zip((odom, poses), tracks):
            for time, (x, y, heading) in zip(*track):
                nanoseconds = round(time * 1e9)
                head = header(stamp(*divmod(nanoseconds, 10 ** 9)), 'odom')
                at = pose(point(x, y, 0.0),
                          turn(0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading)))
                message = types['geometry_msgs/msg/PoseStamped'](head, at)
                if connection is odom:
                    still = twist(vector(0.0, 0.0, 0.0), vector(0.0, 0.0, 0.0))
                    message = types['nav_msgs/msg/Odometry'](
                        head, 'base_link',
                        types['geometry_msgs/msg/PoseWithCovariance'](at, np.zeros(36)),
                        types['geometry_msgs/msg/TwistWithCovariance'](still, np.zeros(36)))
                writer.write(connection, nanoseconds,
                             STORE.serialize_cdr(message, message.__msgtype__))
