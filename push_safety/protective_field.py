"""
Protective field: what a scan shows near the robot, in neither map nor object, slows and stops it.

Something within a distance of the hull, on any side, limits the speed: whoever walks up to the
robot then meets one that hardly moves. Something on the way of the robot, nearer than a second
distance, stops it, until a person lets it go on, or, where that is set, until the way has been
clear for a while.
"""

import math
from typing import NamedTuple

import numpy as np
from push_localization.scan_points import UnexplainedPoints
from push_localization.settings import PlaceSettings
from push_model.events import Cause, Report
from push_model.geometry import FloatArray
from push_model.signals import Odometry

# Points that are something, and how near to each other they are [m]; chosen: one beam in a hundred
# ends anywhere, and 180 beams meet a person 0.4 m wide three times within 3 m.
MIN_POINTS, CLUSTER_RADIUS = 3, 0.25
# Depth inside the hull from which on a point is of the robot itself [m]; chosen.
MAX_DEPTH = 0.05
# Distance beside the hull that belongs to its way [m]; chosen: what poses and paths err by.
SIDE_MARGIN = 0.1
# Speed from which the robot has a direction of motion [m/s]; chosen: above the noise of odometry.
MIN_SPEED = 0.02
# Time for which the robot stays slow once nothing is near [s], time after which the way counts as
# clear [s], and age of a scan from which on it tells nothing [s]; chosen: five scans each.
SLOW_TIME, CLEAR_TIME, MAX_AGE = 0.5, 0.5, 0.5


class ProtectiveCause(Cause):
    """Why the robot stands."""

    OBSTRUCTED = ('a scan shows something in the way, in neither map nor object; the robot goes '
                  'on once that has been clear for {restart_time:g} s')
    OBSTRUCTED_UNTIL_RESUME = (
        'a scan has shown something in the way, in neither map nor object: call '
        'controller/resume or send another goal once that is clear')
    NO_SCAN_YET = 'no scan has come yet that can be compared with the map'
    NO_SCAN = 'no scan has come for {age:.1f} s that can be compared with the map'

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stands until somebody lets it go on, clear or not."""
        return self is ProtectiveCause.OBSTRUCTED_UNTIL_RESUME


NO_SCAN_YET = ProtectiveCause.NO_SCAN_YET.report()


class Protection(NamedTuple):
    """
    What a protective field asks for.

    :param speed_limit: greatest speed [m/s]; infinite for none.
    :param report: ``Report`` of why the robot has to stand, or None.
    """

    speed_limit: float = math.inf
    report: Report[ProtectiveCause] | None = None


class ProtectiveField:
    """Slows and stops one robot."""

    def __init__(self, settings: PlaceSettings, radius: float) -> None:
        """
        Start with nothing near.

        :param settings: ``PlaceSettings``, whose ``slow_distance`` is above 0.
        :param radius: of the robot [m].
        """
        self._settings = settings
        self._radius = radius
        self._scan_time = -math.inf
        # When something was last near, and last in the way [s], and where the robot went, as a
        # unit vector in its axes.
        self._near_at = self._blocked_at = -math.inf
        self._direction = np.zeros(2)
        # Whether the last scan showed something in the way: one alone may have stray beams.
        self._was_blocked = False

    def decide(self, seen: UnexplainedPoints | None, odometry: Odometry) -> Protection:
        """
        Decide on the speed.

        :param seen: ``UnexplainedPoints`` of the newest scan; None before the first, without which
            the robot stands.
        :param odometry: the newest ``Odometry``.
        """
        if seen is None:
            return Protection(report=NO_SCAN_YET)
        settings, time = self._settings, odometry.time
        velocity = np.array(odometry.twist[:2])
        speed = float(np.hypot(*velocity))
        if speed > MIN_SPEED:
            self._direction = velocity / speed
        if seen.time > self._scan_time:
            self._scan_time = seen.time
            self._observe(seen.points, time)
        is_slow = time - self._near_at <= SLOW_TIME
        limit = settings.slow_speed if is_slow else math.inf
        age = time - self._scan_time
        if age > MAX_AGE:
            return Protection(limit, ProtectiveCause.NO_SCAN.report(age=age))
        since = time - self._blocked_at
        if settings.restart_time == 0.0 and since <= CLEAR_TIME:
            return Protection(limit, ProtectiveCause.OBSTRUCTED_UNTIL_RESUME.report())
        if since <= settings.restart_time:
            return Protection(limit, ProtectiveCause.OBSTRUCTED.report(
                restart_time=settings.restart_time))
        return Protection(limit)

    def _observe(self, points: FloatArray, time: float) -> None:
        points = clustered(points[np.hypot(*points.T) > self._radius - MAX_DEPTH])
        distances = np.hypot(*points.T) - self._radius
        if (distances < self._settings.slow_distance).any():
            self._near_at = time
        lateral = points @ np.array([-self._direction[1], self._direction[0]])
        is_ahead = ((points @ self._direction > 0.0)
                    & (np.abs(lateral) < self._radius + SIDE_MARGIN)
                    & (distances < self._settings.stop_distance))
        is_blocked = bool(is_ahead.any())
        if is_blocked and self._was_blocked:
            self._blocked_at = time
        self._was_blocked = is_blocked


def clustered(points: FloatArray) -> FloatArray:
    """
    Select the points that have others beside them: the ends of stray beams have none.

    :param points: (x, y), shape (n, 2) [m].
    """
    gaps = np.hypot(*(points[:, None] - points).T)
    return points[(gaps < CLUSTER_RADIUS).sum(axis=0) >= MIN_POINTS]
