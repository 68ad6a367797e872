"""
Detection of slip and of loss of contact, from where the robot is measured beside the object.

Every measured pose of the object gives the offset of the robot's centre from where rolling
contact would have it: backwards along the normal (a gap), and along the tangent (slip). Slow
changes of it are drift of odometry, at first the placement of the robot; quick ones are slip or
loss of contact. A CUSUM test tells them apart, and a filter with two hypotheses attributes the
offset to either.
"""

import enum
import math
from typing import NamedTuple

from push_control.settings import ControlSettings
from push_control.steered.estimation.contact_site import ContactOffset, RollingContact
from push_control.steered.estimation.cusum import CusumTest
from push_model.events import EventReport, PushEvent

# Path length over which a contact that has slid counts as sliding on [m]. Chosen.
SLIDING_DISTANCE = 0.1
# Smoothing factor of the gap, per pose. Chosen: averages over about three poses.
GAP_SMOOTHING = 0.4
# Fraction of the gap at loss below which contact is established again. Chosen: hysteresis.
CONTACT_HYSTERESIS = 0.3
# Drift along the tangent over that along the normal: a wrong heading takes the place sideways, as
# fast over a long turn as slow slip would.
TANGENTIAL_WALK_RATIO = 1.4
# Standard deviation of the slip to come, over the noise when slip is detected, and per path
# length while it lasts. Chosen.
SLIP_STD_RATIO = 4.0
SLIP_STD_PER_DISTANCE = 0.5


class Covariance(NamedTuple):
    """
    Covariance matrix of slip and drift, ``[[slip, cross], [cross, drift]]`` [m^2].

    :param slip: variance of the slip.
    :param cross: covariance of slip and drift.
    :param drift: variance of the drift.
    """

    slip: float
    cross: float
    drift: float


class Attribution(NamedTuple):
    """
    An offset, divided between its causes.

    :param slip: of the contact [m].
    :param drift: of the robot's dead-reckoned place [m].
    """

    slip: float
    drift: float


class TwoHypothesisFilter:
    """
    Kalman filter that attributes a measured offset to slip of the contact or to drift of odometry.

    The offset is ``z = slip + drift + noise``, so with the covariance P of (slip, drift) and the
    variance R of the noise, the innovation has the variance ``S = P_ss + 2 P_sd + P_dd + R``, the
    gains are ``(P_ss + P_sd, P_dd + P_sd) / S``, and ``P -= gain gain^T S``.
    """

    def __init__(self, slip_std: float, noise_std: float, drift_walk: float):
        """
        Start without an offset.

        :param slip_std: standard deviation of the first slip: how the robot was placed [m].
        :param noise_std: of a measured offset [m].
        :param drift_walk: random walk of the drift per path length [m/sqrt(m)].
        """
        self.covariance = Covariance(slip_std ** 2, 0.0, (0.5 * noise_std) ** 2)
        self._noise_variance = noise_std ** 2
        self._walk_variance = drift_walk ** 2

    def predict(self, distance: float) -> float:
        """
        Let odometry drift over a path.

        :param distance: path length of the contact [m].
        :return: standard deviation of the offset after it [m].
        """
        drift = self.covariance.drift + distance * self._walk_variance
        self.covariance = self.covariance._replace(drift=drift)
        return math.sqrt(self._innovation_variance)

    def expect_slip(self, std: float) -> None:
        """
        Be prepared for slip.

        :param std: its standard deviation [m].
        """
        slip = self.covariance.slip + std ** 2
        self.covariance = self.covariance._replace(slip=slip)

    def attribute(self, offset: float) -> Attribution:
        """
        Divide a measured offset between slip and drift.

        :param offset: what is measured beyond what was attributed before [m].
        :return: ``Attribution``; less than the offset in all, as that is noisy.
        """
        total = self._innovation_variance
        slip, cross, drift = self.covariance
        by_slip, by_drift = slip + cross, drift + cross
        self.covariance = Covariance(slip - by_slip * by_slip / total,
                                     cross - by_slip * by_drift / total,
                                     drift - by_drift * by_drift / total)
        return Attribution(by_slip / total * offset, by_drift / total * offset)

    @property
    def _innovation_variance(self) -> float:
        slip, cross, drift = self.covariance
        return slip + 2.0 * cross + drift + self._noise_variance


class ContactState(enum.Enum):
    """Tell whether robot and object are in contact, and whether that slides."""

    TOUCHING = 'touching'
    SLIDING = 'sliding'
    LOST = 'lost'


class ContactUpdate(NamedTuple):
    """
    Update of the contact by a measured offset.

    :param slip: how far the contact has slid, along t [m].
    :param drift: ``ContactOffset`` that is none: the error of the robot's dead-reckoned place.
    """

    slip: float
    drift: ContactOffset


class GapMonitor:
    """
    Detects loss of contact, along the normal.

    ``gap``: smoothed gap [m], negative on overlap. ``losses``: how often contact was lost.
    """

    def __init__(self, settings: ControlSettings, noise_std: float):
        """
        Start in contact.

        :param noise_std: standard deviation of a measured gap [m].
        """
        self._limit = settings.contact_gap
        self._filter = TwoHypothesisFilter(0.0, noise_std, settings.odometry_walk)
        self._test = CusumTest(settings.cusum_threshold)
        self.gap = 0.0
        self.is_lost = False
        self.losses = 0

    def update(self, gap: float, distance: float) -> float:
        """
        Add a measured gap.

        :param gap: along the normal [m].
        :param distance: path length of the contact since the last one [m].
        :return: drift of the robot's dead-reckoned place along the normal [m].
        """
        score = gap / self._filter.predict(distance)
        self.gap += GAP_SMOOTHING * (gap - self.gap)
        if self.is_lost:
            self.is_lost = not self.gap < CONTACT_HYSTERESIS * self._limit
        elif self._test.update(score) > 0 and self.gap > self._limit:
            self.is_lost = True
            self.losses += 1
        # A wide gap is no drift, whether or not it has been detected by now.
        if self.is_lost or gap > self._limit:
            return 0.0
        return self._filter.attribute(gap).drift


class SlipMonitor:
    """
    Detects slip, along the tangent.

    ``is_sliding``: whether the contact slides. ``slips``: how often it began to.
    """

    def __init__(self, settings: ControlSettings, robot_radius: float, noise_std: float):
        """
        Start with a contact that rolls.

        :param robot_radius: R_p [m].
        :param noise_std: standard deviation of a measured slip [m].
        """
        self._noise_std = noise_std
        self._filter = TwoHypothesisFilter(settings.push_direction_std * robot_radius, noise_std,
                                           TANGENTIAL_WALK_RATIO * settings.odometry_walk)
        self._test = CusumTest(settings.cusum_threshold)
        self._sliding_until = -math.inf
        self.is_sliding = False
        self.slips = 0

    def predict(self, distance: float) -> float:
        """
        Let odometry drift over a path.

        :param distance: path length of the contact [m].
        :return: standard deviation of a measured slip after it [m].
        """
        return self._filter.predict(distance)

    def expect_slip(self, std: float) -> None:
        """
        Be prepared for slip.

        :param std: its standard deviation [m].
        """
        self._filter.expect_slip(std)

    def suspend(self) -> None:
        """Ignore a measurement: nothing can be told about slip."""
        self.is_sliding = False

    def update(self, slip: float, score: float, distance: float,
               travelled_distance: float) -> Attribution:
        """
        Add a measured slip.

        :param slip: along the tangent [m].
        :param score: the same over its standard deviation.
        :param distance: path length of the contact since the last one [m].
        :param travelled_distance: path length of the contact in all [m].
        """
        if self._test.update(score):
            if travelled_distance > self._sliding_until:
                self.slips += 1
            self._sliding_until = travelled_distance + SLIDING_DISTANCE
            self._filter.expect_slip(SLIP_STD_RATIO * self._noise_std)
        self.is_sliding = travelled_distance <= self._sliding_until
        if self.is_sliding:
            self._filter.expect_slip(SLIP_STD_PER_DISTANCE * distance)
        return self._filter.attribute(slip)


class ContactDetector:
    """
    Tells from every measured pose whether the robot touches, and how far its contact has slid.

    A robot inside the object is one whose wheels spin: then nothing can be told about slip.
    """

    def __init__(self, settings: ControlSettings, robot_radius: float, site: RollingContact):
        """
        Start in contact.

        :param robot_radius: R_p [m].
        :param site: the ``RollingContact`` at the start.
        """
        noise_std = math.hypot(settings.pose_noise,
                               settings.heading_noise * math.hypot(*site.point))
        self._settings = settings
        self._gap = GapMonitor(settings, noise_std)
        self._slip = SlipMonitor(settings, robot_radius, noise_std)
        self._travelled_distance = 0.0
        self._approached_distance = 0.0

    @property
    def state(self) -> ContactState:
        """The present ``ContactState``."""
        if self._gap.is_lost:
            return ContactState.LOST
        return ContactState.SLIDING if self._slip.is_sliding else ContactState.TOUCHING

    @property
    def slips(self) -> int:
        """Number of times at which the contact began to slide."""
        return self._slip.slips

    @property
    def contact_losses(self) -> int:
        """Number of losses of contact."""
        return self._gap.losses

    @property
    def notice(self) -> EventReport | None:
        """Notice of an event, or None."""
        if self.state is ContactState.LOST:
            return PushEvent.CLOSING_GAP.report()
        if self.state is ContactState.SLIDING:
            return PushEvent.CONTACT_SLIDES.report()
        return None

    def update(self, offset: ContactOffset, travelled_distance: float) -> ContactUpdate:
        """
        Add where the robot was when a pose was measured.

        :param offset: ``ContactOffset`` from where rolling contact has it.
        :param travelled_distance: path length of the contact until then [m].
        """
        distance = travelled_distance - self._travelled_distance
        self._travelled_distance = travelled_distance
        was_lost = self._gap.is_lost
        normal_drift = self._gap.update(offset.gap, distance)
        if self._gap.is_lost and not was_lost:
            self._approached_distance = 0.0
        if was_lost and not self._gap.is_lost:
            # Where it touches again is known as well as whether it touches.
            self._slip.expect_slip(self._settings.contact_gap)
        score = offset.slip / self._slip.predict(distance)
        if self._gap.is_lost or self._gap.gap < -self._settings.contact_gap:
            self._slip.suspend()
            return ContactUpdate(0.0, ContactOffset(normal_drift, 0.0))
        slip_update = self._slip.update(offset.slip, score, distance, travelled_distance)
        return ContactUpdate(slip_update.slip, ContactOffset(normal_drift, slip_update.drift))

    def approach_fault(self, distance: float) -> EventReport | None:
        """
        Count an approach to an object out of contact, and tell whether it has gone too far.

        :param distance: that the robot is about to approach by [m].
        :return: ``EventReport``, or None while it may go on.
        """
        self._approached_distance += distance
        gap = self._gap.gap
        if max(gap, self._approached_distance) <= self._settings.max_approach_distance:
            return None
        return PushEvent.GAP_TOO_WIDE.report(gap=1e3 * gap)
