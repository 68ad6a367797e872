"""
Places of the robot that something measures in the map, beside drifting odometry.

A place is late by some tenths of a second. Odometry since then brings it to the present. Its
errors last: ``push_localization.fusion`` tells how much it counts.
"""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.odometry_history import OdometryHistory
from push_model.signals import Odometry, PlaceStatus, PoseCovariance, RobotPlace

# Time after which a place says no more where the robot is [s]; chosen: ten scans, or half a metre
# of another localization.
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
        pose = place.pose @ (before.inverse() @ odometry.pose)
        jacobian = np.eye(3)
        jacobian[:2, 2] = place.pose.y - pose.y, pose.x - place.pose.x
        covariance = jacobian @ place.covariance.matrix @ jacobian.T
        return place._replace(time=odometry.time, pose=Pose(*pose),
                              covariance=PoseCovariance.from_matrix(covariance))

    def is_placed(self, time: float) -> bool:
        """
        Tell whether places come that say where the robot is.

        :param time: now [s].
        """
        return self._has_status(time, PlaceStatus.TRACKED, PlaceStatus.REGAINED)

    def is_lost(self, time: float) -> bool:
        """
        Tell whether what measures places has lost the robot.

        :param time: now [s].
        """
        return self._has_status(time, PlaceStatus.LOST)

    def _has_status(self, time: float, *statuses: PlaceStatus) -> bool:
        newest = self._newest
        age = math.inf if newest is None else time - newest.time
        return newest is not None and age <= MAX_AGE and newest.status in statuses
