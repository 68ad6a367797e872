"""What must stop the robot: measurements too old or broken, an object that does not follow."""

from collections import deque
import math

from push_control.events import EventReport, PushEvent

STEEPEST_PUSH = 1.2
NORMAL_SLACK = 0.15
ALMOST_STRAIGHT = 0.1


def measurement_fault(observation, last_pose_time, settings) -> EventReport | None:
    """
    Say why the measurements cannot be used.

    :param observation: ``Observation``.
    :param last_pose_time: time of the last finite object pose [s], or None.
    :param settings: ``ControlSettings``.
    :return: ``EventReport``, or None.
    """
    odometry, measured = observation.odometry, observation.object_pose
    if not is_finite_odometry(odometry):
        return PushEvent.ODOMETRY_NOT_FINITE.report()
    if measured is None:
        return PushEvent.NO_OBJECT_POSE.report()
    if not (measured.pose.is_finite() and math.isfinite(measured.time)):
        return PushEvent.OBJECT_POSE_NOT_FINITE.report()
    age = observation.time - last_pose_time
    if age > settings.pose_timeout:
        return PushEvent.OBJECT_POSE_STALE.report(age=age, limit=settings.pose_timeout)
    age = observation.time - odometry.time
    if age > settings.odometry_timeout:
        return PushEvent.ODOMETRY_STALE.report(age=age, limit=settings.odometry_timeout)
    return None


def is_finite_odometry(odometry):
    """
    Tell whether every number of an odometry is finite.

    :param odometry: ``Odometry``.
    """
    return all(math.isfinite(value)
               for value in (odometry.time, *odometry.pose, *odometry.twist))


def jackknifed(site, normal, angle):
    """
    Say how the contact has turned beyond recovery.

    :param site: the contact ``ContactSite``.
    :param normal: estimated angle of the normal in the object frame [rad].
    :param angle: from the normal to the wanted contact velocity [rad].
    :return: ``EventReport``, or None.
    """
    low, high = site.normal_limits
    if not low - NORMAL_SLACK < normal < high + NORMAL_SLACK:
        return PushEvent.TURNED_OFF_VERTEX.report()
    if abs(math.remainder(angle, 2.0 * math.pi)) > STEEPEST_PUSH:
        return PushEvent.PUSH_OUT_OF_CONTACT.report()
    return None


class FollowMonitor:
    """Compares the way of the robot with the measured way of the contact."""

    def __init__(self, settings):
        """
        Begin with nothing seen.

        :param settings: ``ControlSettings``.
        """
        self._window, self._ratio = settings.follow_window, settings.follow_ratio
        self._seen = deque()

    def lost(self, travelled_distance, contact):
        """
        Tell whether the object has stopped following.

        :param travelled_distance: way of the robot's contact point since the start [m].
        :param contact: measured place of the contact in the world (x, y) [m].
        """
        self._seen.append((travelled_distance, contact))
        while len(self._seen) > 1 and travelled_distance - self._seen[1][0] >= self._window:
            self._seen.popleft()
        before, place = self._seen[0]
        way = travelled_distance - before
        moved = math.hypot(contact[0] - place[0], contact[1] - place[1])
        return way >= self._window and moved < self._ratio * way


class OneSidedMonitor:
    """Finds a contact that can only turn the object one way."""

    def __init__(self, settings):
        """
        Begin with a contact that can turn it both ways.

        :param settings: ``ControlSettings``.
        """
        self._longest, self._straight = settings.one_sided_distance, 0.0

    def trouble(self, limits, travelled_distance):
        """
        Say why the push is of no use.

        :param limits: ``CurvatureLimits``.
        :param travelled_distance: way of the contact since the start [m].
        :return: ``EventReport``, or None.
        """
        if limits.low - ALMOST_STRAIGHT <= 0.0 <= limits.high + ALMOST_STRAIGHT:
            self._straight = travelled_distance
        if travelled_distance - self._straight <= self._longest:
            return None
        return PushEvent.ONE_SIDED_STEERING.report()
