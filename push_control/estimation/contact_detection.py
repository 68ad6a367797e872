"""Watches from geometry whether the robot still touches the object, and where."""

import math
from typing import NamedTuple

from push_control.estimation.contact_site import ContactOffset
from push_control.events import EventReport, PushEvent

STEP_LIMIT = 3.0
SLACK = 0.75
CALM_WAY = 0.1
GAP_SHARE = 0.4
# A wrong heading takes the place sideways, as fast over a long turn as slow slip would.
ASIDE_SHARE = 1.4


class CusumTest:
    """Page's test: sums up what exceeds noise, so that a small lasting change counts."""

    def __init__(self, threshold):
        """
        Begin with nothing summed up.

        :param threshold: sum at which it goes off.
        """
        self._threshold = threshold
        self._above = self._below = 0.0

    def update(self, score):
        """
        Take in an error, in standard deviations; one wild error alone does not raise it.

        :param score: the error over its standard deviation.
        :return: 1 or -1 for the side on which it goes off, and starts anew; else 0.
        """
        score = min(STEP_LIMIT, max(-STEP_LIMIT, score))
        self._above = max(0.0, self._above + score - SLACK)
        self._below = max(0.0, self._below - score - SLACK)
        sums = self._above, self._below
        if max(sums) <= self._threshold:
            return 0
        self._above = self._below = 0.0
        return 1 if sums[0] > self._threshold else -1


class _Split:
    """Splits an offset into a move of the contact and the drift of odometry."""

    def __init__(self, spread, noise, walk):
        self._moved, self._cross, self._drift = spread ** 2, 0.0, (0.5 * noise) ** 2
        self._noise, self._walk = noise ** 2, walk ** 2

    def deviation(self, way):
        """Return the standard deviation of the offset after a way."""
        self._drift += way * self._walk
        return math.sqrt(self._total)

    def split(self, offset):
        """Return the parts of an offset that are to be believed: move, drift."""
        total = self._total
        moved, drift = self._moved + self._cross, self._drift + self._cross
        self._moved -= moved * moved / total
        self._drift -= drift * drift / total
        self._cross -= moved * drift / total
        return moved / total * offset, drift / total * offset

    def expect(self, spread):
        """Reckon with a move."""
        self._moved += spread ** 2

    @property
    def _total(self):
        return self._moved + 2.0 * self._cross + self._drift + self._noise


class ContactUpdate(NamedTuple):
    """
    What a look at the contact tells.

    :param slid: how far the contact has slid, along t [m].
    :param drift: ``ContactOffset`` that is none: error of the robot's place.
    """

    slid: float
    drift: ContactOffset


class ContactDetector:
    """
    Finds from every measured pose whether the robot touches, and how far its contact has slid.

    Slow changes are drift of odometry, at first the placement; quick ones are slip or loss. A
    robot inside the object is one whose wheels spin: then nothing can be said about slip.
    """

    def __init__(self, settings, robot_radius, site):
        """
        Begin in contact.

        :param settings: ``ControlSettings``.
        :param robot_radius: R_p [m].
        :param site: the contact ``ContactSite`` at the start.
        """
        self._settings = settings
        self._noise = noise = math.hypot(settings.pose_noise,
                                         settings.heading_noise * math.hypot(*site.point))
        self._aside = _Split(settings.push_direction_std * robot_radius, noise,
                             ASIDE_SHARE * settings.odometry_walk)
        self._back = _Split(0.0, noise, settings.odometry_walk)
        self._slip, self._loss = CusumTest(settings.cusum_threshold), CusumTest(settings.cusum_threshold)
        self._travelled, self._approached, self._calm_at = 0.0, 0.0, -math.inf
        self.slips = self.contact_losses = 0
        self.gap, self.lost, self.slipping = 0.0, False, False

    def look(self, seen, travelled_distance):
        """
        Take in where the robot was when a pose was measured.

        :param seen: ``ContactOffset`` from where rolling contact has it.
        :param travelled_distance: way of the contact until then [m].
        :return: ``ContactUpdate``.
        """
        way, self._travelled = travelled_distance - self._travelled, travelled_distance
        back = self._watch_gap(seen.gap, way)
        score = seen.slid / self._aside.deviation(way)
        if self.lost or self.gap < -self._settings.contact_gap:
            self.slipping = False
            return ContactUpdate(0.0, ContactOffset(back, 0.0))
        if self._slip.update(score):
            self.slips += travelled_distance > self._calm_at
            self._calm_at = travelled_distance + CALM_WAY
            self._aside.expect(4.0 * self._noise)
        self.slipping = travelled_distance <= self._calm_at
        if self.slipping:
            self._aside.expect(0.5 * way)
        slid, aside = self._aside.split(seen.slid)
        return ContactUpdate(slid, ContactOffset(back, aside))

    @property
    def notice(self) -> EventReport | None:
        """What is out of the ordinary, or None."""
        if self.lost:
            return PushEvent.CLOSING_GAP.report()
        return PushEvent.CONTACT_SLIDES.report() if self.slipping else None

    def out_of_reach(self, way) -> EventReport | None:
        """
        Say why the object cannot be approached any further.

        :param way: that the robot is about to go towards it [m].
        :return: ``EventReport``, or None.
        """
        self._approached += way
        if max(self.gap, self._approached) <= self._settings.max_approach_distance:
            return None
        return PushEvent.GAP_TOO_WIDE.report(gap=1e3 * self.gap)

    def _watch_gap(self, seen, way):
        limit = self._settings.contact_gap
        score = seen / self._back.deviation(way)
        self.gap += GAP_SHARE * (seen - self.gap)
        if self.lost:
            if self.gap < 0.3 * limit:
                self.lost = False
                self._aside.expect(limit)
        elif self._loss.update(score) > 0 and self.gap > limit:
            self.lost, self._approached = True, 0.0
            self.contact_losses += 1
        return 0.0 if self.lost or seen > limit else self._back.split(seen)[1]
