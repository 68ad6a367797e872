"""Settings of the supervisor: when a task is done, and when an attempt has failed."""

import dataclasses
from typing import get_args

from push_control.settings import ControlSettings
from push_model.plan_request import (
    HEADING_TOLERANCE, LARGEST_TOLERANCE, LEAST_TOLERANCE, POSITION_TOLERANCE,
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
# Part of the tolerances that pushes aim at, at least; chosen: less takes many taps.
LEAST_AIM = 0.5


@dataclasses.dataclass(frozen=True)
class SupervisionSettings:
    """Tolerances, time-outs and attempt limits of the supervisor."""

    position_tolerance: float = quantity(
        'distance from the goal at which a task is done', 'm', LEAST_TOLERANCE, LARGEST_TOLERANCE,
        default=POSITION_TOLERANCE)
    heading_tolerance: float = quantity(
        'heading error at which a task is done', 'rad', LEAST_TOLERANCE, LARGEST_TOLERANCE,
        default=HEADING_TOLERANCE)
    confidence_sigmas: float = quantity(
        'standard errors of the averaged object pose by which it must be within the tolerances; '
        'at most 2 where poses are biased', '', 0.0, 10.0, default=3.0)
    min_averaging_time: float = quantity(
        'time over which poses of the object at rest are averaged', 's', above=0.0, high=10.0,
        default=0.35)
    max_averaging_time: float = quantity(
        'longest time over which they are averaged while it is uncertain whether the task is done',
        's', above=0.0, high=60.0, default=2.0)
    motion_gate_sigmas: float = quantity(
        'standard deviations from the average at which a pose means that the object has moved', '',
        1.0, 100.0, default=5.0)

    max_attempts: int = quantity(
        'pushes and recoveries without progress after which the task is aborted', '', 1, 100,
        default=12)
    improvement_ratio: float = quantity(
        'part of the least error so far below which an error counts as progress', '', 0.05,
        1.0, default=0.9)
    plan_timeout: float = quantity(
        'time to wait for a plan until another one is requested, on the wall; in lockstep that of '
        'the measurements', 's', 0.1, 600.0, default=20.0)
    stall_timeout: float = quantity(
        'time without motion after which a robot on its path is stalled', 's', above=0.0,
        high=60.0, default=4.0)

    moved_distance: float = quantity(
        'distance by which the object may move between pushes before its plan is invalid', 'm',
        above=0.0, high=1.0, default=0.05)
    moved_angle: float = quantity(
        'angle by which the object may rotate between pushes before its plan is invalid', 'rad',
        above=0.0, high=1.0, default=0.1)
    max_path_deviation: float = quantity(
        'distance of the object from its planned path at which a push is aborted', 'm', above=0.0,
        high=10.0, default=0.2)
    pre_push_tolerance: float = quantity(
        'position error of the robot at the pre-push pose; rotation counts at its rim', 'm',
        LEAST_TOLERANCE, 0.5, default=0.01)
    probe_distance: float = quantity(
        'distance beyond the expected contact within which the robot probes for the object', 'm',
        above=0.0, high=1.0, default=0.1)

    odometry_reference: OdometryReference = quantity(
        "pose of odometry: drifting (from the robot's own motion; a covariance that it states is "
        'not believed) or absolute (from motion capture or a map; its covariance is believed)',
        choices=get_args(OdometryReference), default='drifting')
    odometry_scale: float = quantity(
        'standard deviation of the relative error of distances measured by odometry', '', 0.0, 0.5,
        default=0.02)
    odometry_drift: float = quantity(
        'standard deviation of the heading error of odometry per distance', 'rad/m', 0.0, 1.0,
        default=0.02)
    odometry_walk: float = quantity(
        'random walk of the position relative to odometry', 'm/sqrt(m)', 0.0, 1.0, default=0.003)
    odometry_heading_walk: float = quantity(
        'random walk of the heading relative to odometry', 'rad/sqrt(m)', 0.0, 0.3, default=0.01)

    center_walk: float = quantity(
        'random walk of the centre of friction, by which what was learned of it gets uncertain '
        'from one task to the next', 'm/sqrt(s)', 0.0, 0.01, default=5e-5)
    contact_friction_walk: float = quantity(
        'random walk of the contact friction, by which what was learned of it gets uncertain from '
        'one task to the next', '1/sqrt(s)', 0.0, 0.1, default=5e-4)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    def believed_covariance(self, odometry: Odometry) -> PoseCovariance | None:
        """
        Return the covariance with which odometry measures the pose of the robot in the world.

        :param odometry: ``Odometry``.
        :return: the ``PoseCovariance`` that it states; None where it states none, or where its
            pose drifts: then the pose measures motion only, with the errors of these settings.
        """
        return odometry.covariance if self.odometry_reference == 'absolute' else None


def aimed_tolerances(control: ControlSettings,
                     supervision: SupervisionSettings) -> tuple[float, float]:
    """
    Reduce the tolerances of a task by what the bias of object poses leaves uncertain.

    :param control: ``ControlSettings``, for the bias.
    :param supervision: ``SupervisionSettings``.
    :return: tolerances of position [m] and heading [rad] for pushes to aim at.
    """
    margin = min(BIASED_SIGMAS, supervision.confidence_sigmas) * REMAINING_BIAS
    position, heading = supervision.position_tolerance, supervision.heading_tolerance
    return (max(LEAST_TOLERANCE, LEAST_AIM * position, position - margin * control.pose_bias),
            max(LEAST_TOLERANCE, LEAST_AIM * heading, heading - margin * control.heading_bias))
