"""
Jumps of odometry, which is wrong, or the robot was put elsewhere.

No robot moves in jumps. One that is at rest when its odometry jumps, or stops at once, was put
elsewhere, as by a simulator that was reset, or its odometry starts again; odometry says where it
is then. The odometry of one that drives on is wrong, and may come back.
"""

import math

from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import Odometry
from push_safety.stop import is_at_rest
from push_safety.tolerances import REST_SPEED

# What odometry that has come back may differ by from where it would be [m], [rad]; chosen: what
# the steps err by that were not added up.
RETURN_DISTANCE = 0.03
RETURN_ROTATION = 0.05


class OdometryShift:
    """
    Adds up the jumps of odometry.

    ``is_robot_elsewhere``: whether the robot was put elsewhere by one that has not come back.
    """

    def __init__(self, max_acceleration: float) -> None:
        """
        Start without a jump.

        :param max_acceleration: of the robot [m/s^2].
        """
        self._max_acceleration = max_acceleration
        self._shift = Pose(0.0, 0.0, 0.0)
        self.is_robot_elsewhere = False

    def add(self, before: Odometry, after: Odometry, step: Pose) -> None:
        """
        Add a jump.

        :param before: the last ``Odometry`` before it.
        :param after: the first one after it.
        :param step: motion of the robot meanwhile as ``Pose`` in its axes before.
        """
        expected = before.pose @ step
        self._shift = after.pose @ expected.inverse() @ self._shift
        unshifted = self._shift.inverse() @ after.pose
        if (distance(unshifted, after.pose) < RETURN_DISTANCE
                and abs(wrap_angle(self._shift.theta)) < RETURN_ROTATION):
            self._shift = Pose(0.0, 0.0, 0.0)
            self.is_robot_elsewhere = False
        elif is_at_rest(before.twist) or self._stops_at_once(before, after):
            self.is_robot_elsewhere = True

    def _stops_at_once(self, before: Odometry, after: Odometry) -> bool:
        """Tell whether the robot stops sooner than it can brake."""
        braked = self._max_acceleration * (after.time - before.time)
        speed = math.hypot(before.twist.v_x, before.twist.v_y)
        return is_at_rest(after.twist) and speed > braked + REST_SPEED
