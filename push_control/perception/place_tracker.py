"""
Places of the robot that something measures in the map, beside drifting odometry.

A place is late by some tenths of a second. Odometry since then brings it to the present. Its
errors last: ``push_localization.fusion`` tells how much it counts.
"""

import math

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.odometry_history import OdometryHistory
from push_model.signals import Odometry, PlaceStatus, PoseCovariance, RobotPlace

# Length of path and turn after which a place says no more where the robot is [m], [rad]; chosen:
# twice what AMCL lets pass between two poses. While the robot stands its last one holds.
MAX_LENGTH, MAX_TURN = 0.5, 0.5
# Time after which what measures places is no longer known to be lost [s]; chosen: ten scans.
MAX_AGE = 1.0


class PlaceTracker:
    """
    Keeps the newest place, and brings places to the present.

    ``has_place``: whether there was any.
    """

    def __init__(self) -> None:
        """Start without odometry and places."""
        self._history = OdometryHistory()
        self._newest: RobotPlace | None = None
        # Length of path and turn of the robot since that.
        self._length = self._turn = 0.0
        self._last: Pose | None = None

    @property
    def has_place(self) -> bool:
        """Tell whether there was any place yet."""
        return self._newest is not None

    def add_odometry(self, odometry: Odometry, has_jumped: bool) -> None:
        """
        Take in odometry.

        :param odometry: finite ``Odometry``.
        :param has_jumped: whether its pose has, so that steps across that say nothing.
        """
        if has_jumped:
            self._history = OdometryHistory()
        elif self._last is not None:
            step = self._last.inverse() @ odometry.pose
            self._length += math.hypot(step.x, step.y)
            self._turn += abs(wrap_angle(step.theta))
        self._last = odometry.pose
        self._history.append(odometry)

    def at_present(self, place: RobotPlace, odometry: Odometry) -> RobotPlace | None:
        """
        Bring a new place to the time of the newest odometry.

        :param place: ``RobotPlace``.
        :param odometry: the newest ``Odometry``.
        :return: the place now; None where it is not new, or there is no odometry of its time.
        """
        if self._newest is not None and place.time <= self._newest.time:
            return None
        self._newest = place
        before = self._history.pose_at(place.time)
        if before is None:
            return None
        since = before.inverse() @ odometry.pose
        self._length, self._turn = math.hypot(since.x, since.y), abs(wrap_angle(since.theta))
        pose = place.pose @ since
        jacobian = np.eye(3)
        jacobian[:2, 2] = place.pose.y - pose.y, pose.x - place.pose.x
        covariance = jacobian @ place.covariance.matrix @ jacobian.T
        return place._replace(time=odometry.time, pose=Pose(*pose),
                              covariance=PoseCovariance.from_matrix(covariance))

    @property
    def is_placed(self) -> bool:
        """Tell whether the newest place says where the robot is."""
        newest = self._newest
        return (newest is not None and newest.status is not PlaceStatus.LOST
                and self._length <= MAX_LENGTH and self._turn <= MAX_TURN)

    def is_lost(self, time: float) -> bool:
        """
        Tell whether what measures places has lost the robot.

        :param time: now [s].
        """
        newest = self._newest
        return (newest is not None and newest.status is PlaceStatus.LOST
                and time - newest.time <= MAX_AGE)
