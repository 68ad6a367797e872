"""Measurements and commands, the pure counterparts of the topics."""

from typing import NamedTuple

from push_model.geometry import Pose


class Twist(NamedTuple):
    """Velocity (v_x, v_y) [m/s] and yaw rate omega [rad/s], in robot axes."""

    v_x: float = 0.0
    v_y: float = 0.0
    omega: float = 0.0


STOP = Twist()


class Odometry(NamedTuple):
    """Robot pose in the world frame and twist in robot axes, measured at a time [s]."""

    time: float
    pose: Pose
    twist: Twist


class ObjectPose(NamedTuple):
    """Object pose in the world frame, measured at a time [s]."""

    time: float
    pose: Pose
