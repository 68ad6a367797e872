"""Settings of the supervisor: when a task is done, and when an attempt has failed."""

import dataclasses
import math
from typing import get_args

from push_control.settings import ControlSettings
from push_model.parameters import PushedObject
from push_model.plan_request import (
    ANY_HEADING, check_heading_tolerance, HEADING_TOLERANCE, MAX_HEADING_TOLERANCE,
    MAX_TOLERANCE, MIN_TOLERANCE, POSITION_TOLERANCE,
)
from push_model.quantity import check, quantity
from push_model.signals import Odometry, OdometryReference, PoseCovariance

# What remains of the bias of object poses after they were seen from some sides, over what it was;
# measured: a third to a half in tasks with a bias that depends on the side, times 1.3.
REMAINING_BIAS = 0.5
# Standard errors that are asked for at most where poses are biased; measured: with two, tasks with
# tags whose bias depends on the view are done, with three some look for a certainty that no view
# gives.
BIASED_SIGMAS = 2.0
# The same where the object is seen now and then or after a steered push, and once it is averaged
# for as long as that pays; chosen: at the limit the tolerances then hold in 995 of 1000 such
# decisions, and in 99 of 100; with 2 and 1.6 one task of sixty was called done a hundredth of
# a degree beyond them.
GLIMPSED_SIGMAS, LIKELY_SIGMAS = 2.6, 2.3
# Part of the tolerances that pushes aim at, at least; chosen: less takes many taps.
MIN_AIM = 0.5
# Part of the tolerances that the confidence interval of an average may take up where its noise
# asks for longer averaging; chosen: a smaller part takes more time than another push.
INTERVAL_PART = 0.5
# Poses that are averaged soon, and the part that the interval of their average may take up until
# pushes aim at what it leaves of the tolerances. Chosen: two seconds at 20 Hz; and more than the
# usual noise of 2 mm and 0.3 degrees takes up of as strict tolerances, where tasks need no margin.
QUICK_POSES = 40
QUICK_PART = 0.6


@dataclasses.dataclass(frozen=True)
class SupervisionSettings:
    """Tolerances, time-outs and attempt limits of the supervisor."""

    position_tolerance: float = quantity(
        'distance from the goal at which a task is done', 'm', MIN_TOLERANCE, MAX_TOLERANCE,
        is_basic=True, default=POSITION_TOLERANCE)
    heading_tolerance: float = quantity(
        'heading error at which a task is done; 2 pi for any heading', 'rad', MIN_TOLERANCE,
        MAX_HEADING_TOLERANCE, is_basic=True, default=HEADING_TOLERANCE)
    disc_heading_free: bool = quantity(
        'whether a round object may have any heading at its goal, unless the goal states a '
        'tolerance of heading', is_basic=True, default=True)
    confidence_sigmas: float = quantity('standard errors that must fit into the tolerances', '',
                                        0.0, 10.0, default=3.0)
    min_averaging_time: float = quantity('time over which poses at rest are averaged', 's',
                                         above=0.0, high=10.0, default=0.35)
    max_averaging_time: float = quantity('longest averaging while the goal test is undecided', 's',
                                         above=0.0, high=60.0, is_dynamic=False, default=2.0)
    averaging_time_limit: float = quantity('longest averaging where pose noise asks for it', 's',
                                           above=0.0, high=600.0, is_dynamic=False, default=30.0)
    motion_gate_sigmas: float = quantity('deviation from the average that means motion', '', 1.0,
                                         100.0, is_dynamic=False, default=5.0)

    max_attempts: int = quantity('pushes and recoveries without progress before an abort', '', 1,
                                 100, default=12)
    improvement_ratio: float = quantity('error over the smallest one that counts as progress', '',
                                        0.05, 1.0, default=0.9)
    plan_timeout: float = quantity('wait for a plan before another request or giving up', 's', 0.1,
                                   600.0, default=20.0)
    stall_timeout: float = quantity('time without motion that counts as stalled', 's', above=0.0,
                                    high=60.0, default=4.0)

    max_goal_distance: float = quantity('distance from the goal that is taken for a mistake', 'm',
                                        above=0.0, infinite=True, default=30.0)
    moved_distance: float = quantity('displacement of the object that invalidates its plan', 'm',
                                     above=0.0, high=1.0, default=0.05)
    moved_angle: float = quantity('rotation of the object that invalidates its plan', 'rad',
                                  above=0.0, high=1.0, default=0.1)
    max_path_deviation: float = quantity('object deviation from its plan that aborts a push', 'm',
                                         above=0.0, high=10.0, default=0.2)
    pre_push_tolerance: float = quantity('robot error at the pre-push pose; rotation counts at '
                                         'the rim', 'm', MIN_TOLERANCE, 0.5, default=0.01)
    probe_distance: float = quantity('search for the contact beyond where it is expected', 'm',
                                     above=0.0, high=1.0, default=0.1)

    view_angle: float = quantity('greatest bearing of the object with poses; pi: all round', 'rad',
                                 above=0.0, high=math.pi, is_dynamic=False, default=math.pi)
    view_nearest: float = quantity('least gap to the object with poses; 0: in contact, too', 'm',
                                   0.0, 10.0, is_dynamic=False, default=0.0)
    view_farthest: float = quantity('greatest distance of the object with poses', 'm', above=0.0,
                                    infinite=True, is_dynamic=False, default=math.inf)

    odometry_reference: OdometryReference = quantity(
        'drifting: its covariance is ignored; absolute: it is used',
        choices=get_args(OdometryReference), is_dynamic=False, default='drifting')
    odometry_scale: float = quantity('std of the relative distance error', '', 0.0, 0.5,
                                     is_dynamic=False, default=0.02)
    odometry_drift: float = quantity('std of the heading error per distance', 'rad/m', 0.0, 1.0,
                                     is_dynamic=False, default=0.02)
    odometry_walk: float = quantity('random walk of the position', 'm/sqrt(m)', 0.0, 1.0,
                                    is_dynamic=False, default=0.003)
    odometry_heading_walk: float = quantity('random walk of the heading', 'rad/sqrt(m)', 0.0, 0.3,
                                            is_dynamic=False, default=0.01)

    center_walk: float = quantity('random walk of the centre of friction between tasks',
                                  'm/sqrt(s)', 0.0, 0.01, is_dynamic=False, default=5e-5)
    contact_friction_walk: float = quantity('random walk of the contact friction between tasks',
                                            '1/sqrt(s)', 0.0, 0.1, is_dynamic=False, default=5e-4)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        check_heading_tolerance('SupervisionSettings', self.heading_tolerance)

    def for_object(self, obj: PushedObject) -> 'SupervisionSettings':
        """
        Return the settings that hold for an object: a round one may have any heading.

        :param obj: the ``PushedObject``.
        """
        if obj.outline or not self.disc_heading_free:
            return self
        return dataclasses.replace(self, heading_tolerance=ANY_HEADING)

    @property
    def has_limited_view(self) -> bool:
        """Tell whether there are places from which the object is not seen."""
        return (self.view_angle < math.pi or self.view_nearest > 0.0
                or self.view_farthest < math.inf)

    @property
    def required_sigmas(self) -> float:
        """Standard errors that must fit into the tolerances of an object without bias."""
        sigmas = self.confidence_sigmas
        return min(GLIMPSED_SIGMAS, sigmas) if self.has_limited_view else sigmas

    def is_precise(self, position_error: float, heading_error: float) -> bool:
        """
        Tell whether an average is known well enough to judge whether a task is done.

        :param position_error: standard error of the position along each axis [m].
        :param heading_error: standard error of the heading [rad].
        """
        precise_position, precise_heading = self.precise_errors
        return position_error <= precise_position and heading_error <= precise_heading

    @property
    def precise_errors(self) -> tuple[float, float]:
        """Standard errors of position [m] and heading [rad] of an average that is precise."""
        if self.required_sigmas == 0.0:
            return math.inf, math.inf
        part = INTERVAL_PART / self.required_sigmas
        return part * self.position_tolerance, part * self.heading_tolerance

    def assumed_covariance(self, odometry: Odometry) -> PoseCovariance | None:
        """
        Return the covariance with which odometry measures the pose of the robot in the world.

        :return: the ``PoseCovariance`` that it states; None where it states none, or where its
            pose drifts: then the pose measures motion only, with the errors of these settings.
        """
        return odometry.covariance if self.odometry_reference == 'absolute' else None


def aimed_tolerances(control: ControlSettings,
                     supervision: SupervisionSettings) -> tuple[float, float]:
    """
    Reduce the tolerances of a task by what bias and noise of object poses leave uncertain.

    :param control: ``ControlSettings``, for bias and noise.
    :return: tolerances of position [m] and heading [rad] for pushes to aim at.
    """
    sigmas = supervision.confidence_sigmas
    return (_aimed(supervision.position_tolerance, control.pose_bias, control.pose_noise, sigmas),
            _aimed(supervision.heading_tolerance, control.heading_bias, control.heading_noise,
                   sigmas))


def _aimed(tolerance: float, bias: float, noise: float, sigmas: float) -> float:
    """Reduce a tolerance, of position [m] or heading [rad]."""
    margin = min(BIASED_SIGMAS, sigmas) * REMAINING_BIAS * bias
    if sigmas * noise > QUICK_PART * math.sqrt(QUICK_POSES) * tolerance:
        margin = max(margin, INTERVAL_PART * tolerance)
    return max(MIN_TOLERANCE, MIN_AIM * tolerance, tolerance - margin)
