"""Monitors that end a steered push: jackknifing, pushes without effect."""

from collections import deque
import math
from typing import NamedTuple

from push_control.settings import ControlSettings
from push_control.steered.estimation.contact_site import RollingContact
from push_control.steered.path.path import CurvatureLimits
from push_dynamics.compiled import compiled, wrap_angles
from push_model.events import EventReport, PushEvent
from push_model.geometry import Coordinates

# Largest angle between contact normal and push [rad]. Chosen: far outside any friction cone, so
# that only a contact that has folded up reaches it.
MAX_PUSH_ANGLE = 1.2
# Angle beyond the edge of a vertex that the estimate of the normal may err by [rad]. Chosen.
VERTEX_OVERSHOOT = 0.15
# Curvature that still counts as a straight push [1/m]. Chosen: a radius of ten metres.
STRAIGHT_CURVATURE = 0.1
# How a contact has turned, and what that means.
STEERABLE = 0
OFF_VERTEX = 1
OUT_OF_CONTACT = 2
JACKKNIFE_EVENTS = (None, PushEvent.TURNED_OFF_VERTEX, PushEvent.PUSH_OUT_OF_CONTACT)


@compiled
def jackknife_mode(site: RollingContact, normal: float, push_angle: float) -> int:
    """
    Tell whether the contact has turned beyond recovery.

    :param normal: estimated angle of the normal in the object frame [rad].
    :param push_angle: from the normal to the commanded contact velocity [rad].
    :return: ``STEERABLE``, ``OFF_VERTEX`` or ``OUT_OF_CONTACT``.
    """
    low, high = site.normal_limits
    if not low - VERTEX_OVERSHOOT < normal < high + VERTEX_OVERSHOOT:
        return OFF_VERTEX
    return OUT_OF_CONTACT if abs(wrap_angles(push_angle)) > MAX_PUSH_ANGLE else STEERABLE


def jackknife_fault(mode: int) -> EventReport | None:
    """
    Tell how the contact has turned beyond recovery.

    :param mode: as of ``jackknife_mode``.
    :return: ``EventReport``, or None while it can be steered.
    """
    event = JACKKNIFE_EVENTS[mode]
    return None if event is None else event.report()


class _Sample(NamedTuple):
    """Sample of the contact after some path length of the robot."""

    travelled_distance: float
    contact: Coordinates


class FollowMonitor:
    """
    Compares the path length of the robot with the measured displacement of the contact.

    Over any ``follow_window`` of the robot's path, an object that is pushed moves by at least
    ``follow_ratio`` of it.
    """

    def __init__(self, settings: ControlSettings):
        """Start without samples."""
        self._window = settings.follow_window
        self._ratio = settings.follow_ratio
        self._samples: deque[_Sample] = deque()

    def is_lost(self, travelled_distance: float, contact: Coordinates) -> bool:
        """
        Add a sample, and tell whether the object has stopped following.

        :param travelled_distance: path length of the robot's contact point since the start [m].
        :param contact: measured place of the contact in the world (x, y) [m].
        :return: whether it has.
        """
        samples = self._samples
        samples.append(_Sample(travelled_distance, contact))
        while (len(samples) > 1
               and travelled_distance - samples[1].travelled_distance >= self._window):
            samples.popleft()
        oldest = samples[0]
        distance = travelled_distance - oldest.travelled_distance
        moved = math.hypot(contact[0] - oldest.contact[0], contact[1] - oldest.contact[1])
        return distance >= self._window and moved < self._ratio * distance


class OneSidedMonitor:
    """Detects a contact that can rotate the object to one side only, for too long."""

    def __init__(self, settings: ControlSettings):
        """Start with a contact that can rotate it to both sides."""
        self._max_distance = settings.one_sided_distance
        self._last_two_sided = 0.0

    def fault(self, limits: CurvatureLimits, travelled_distance: float) -> EventReport | None:
        """
        Tell whether the push is of no use.

        :param limits: ``CurvatureLimits`` at present.
        :param travelled_distance: path length of the contact since the start [m].
        :return: ``EventReport``, or None while it is of use.
        """
        if limits.low - STRAIGHT_CURVATURE <= 0.0 <= limits.high + STRAIGHT_CURVATURE:
            self._last_two_sided = travelled_distance
        if travelled_distance - self._last_two_sided <= self._max_distance:
            return None
        return PushEvent.ONE_SIDED_STEERING.report()
