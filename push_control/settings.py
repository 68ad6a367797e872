"""Settings of the controller: laws, gains, limits, and standard deviations of the estimator."""

import dataclasses
from typing import get_args, Literal

from push_model.plan_request import LARGEST_TOLERANCE, LEAST_TOLERANCE
from push_model.quantity import check, LEAST_NOISE, quantity
from push_model.signals import ObjectPose, PoseCovariance

ControlLaw = Literal['feedback', 'mpc', 'open_loop']
LAWS: tuple[ControlLaw, ...] = get_args(ControlLaw)


@dataclasses.dataclass(frozen=True)
class ControlSettings:
    """
    Everything of the controller that can be tuned; the defaults suit household objects and floors.

    Lengths along a path are those of the contact or of the flat output z. A random walk with the
    value w per square root of a length has the variance ``w^2 s`` after the path length s.
    """

    control_law: ControlLaw = quantity(
        'feedback: closed form; mpc: predictive; open_loop: plays the plan without measurements',
        choices=LAWS, default='feedback')

    # When the robot moves, and when a push is over.
    start_tolerance: float = quantity(
        'largest distance of the robot from the start of a plan; a rotation of a differential '
        'drive counts at its rim', 'm', above=0.0, high=1.0, default=0.05)
    pose_timeout: float = quantity(
        'maximum age of an object pose; latency plus three periods tolerates two consecutive '
        'losses', 's', above=0.0, high=5.0, default=0.25)
    odometry_timeout: float = quantity(
        'maximum age of odometry', 's', above=0.0, high=5.0, default=0.25)
    position_tolerance: float = quantity(
        'position error with which a push may end', 'm', LEAST_TOLERANCE, LARGEST_TOLERANCE,
        default=0.02)
    heading_tolerance: float = quantity(
        'heading error with which a push may end', 'rad', LEAST_TOLERANCE, LARGEST_TOLERANCE,
        default=0.05)
    stop_distance: float = quantity(
        'remaining path length at which the robot is stopped', 'm', 0.0, 0.1, default=0.0005)

    # Steering laws.
    lateral_gain: float = quantity(
        'curvature per lateral error', '1/m^2', 0.0, 100.0, default=16.0)
    heading_gain: float = quantity(
        'curvature per heading error', '1/m', 0.0, 50.0, default=7.0)
    lateral_saturation: float = quantity(
        'lateral error at which its feedback saturates', 'm', above=0.0, high=1.0, default=0.1)
    max_curvature_rate: float = quantity(
        'largest change of curvature per path length', '1/m^2', 1.0, 1000.0,
        default=60.0)
    rolling_gain: float = quantity(
        'holonomic base: yaw per path length that rolls the contact to where its normal runs '
        'through the centre of friction', '1/m', 0.0, 50.0, default=4.0)
    horizon_steps: int = quantity(
        'mpc: number of steps of the horizon', '', 2, 100, default=20)
    horizon_step: float = quantity(
        'mpc: path length of each step', 'm', above=0.0, high=0.5, default=0.035)
    cone_weight: float = quantity(
        'mpc: weight of leaving the friction cone, or the feature of the outline in contact', '',
        above=0.0, high=1e6, default=10.0)

    # Friction.
    friction_fraction: float = quantity(
        'fraction of the nominal contact friction that is relied on', '', 0.05, 1.0,
        default=0.8)
    feedback_cone_fraction: float = quantity(
        'fraction of the friction cone that feedback may use', '', 0.05, 1.0,
        default=0.82)
    replan_cone_fraction: float = quantity(
        'fraction of the friction cone that a new path may use', '', 0.05, 1.0,
        default=0.65)

    # Speed of the contact.
    start_speed: float = quantity(
        'contact speed at start and end', 'm/s', above=0.0, high=1.0, default=0.03)
    acceleration: float = quantity(
        'acceleration of the contact', 'm/s^2', above=0.0, high=10.0, default=0.2)
    deceleration: float = quantity(
        'deceleration of the contact towards the goal', 'm/s^2', above=0.0, high=10.0,
        default=0.04)

    # New paths, further approaches to the goal, and new plans.
    final_straight: float = quantity(
        'straight final approach of a new path', 'm', 0.0, 5.0, default=0.6)
    replan_period: float = quantity(
        'least time between new paths', 's', above=0.0, high=60.0, default=0.5)
    replan_min_distance: float = quantity(
        'path length before the first new path', 'm', 0.0, 5.0, default=0.3)
    replan_lateral_error: float = quantity(
        'lateral error that calls for a new path', 'm', above=0.0, high=1.0, default=0.03)
    replan_heading_error: float = quantity(
        'heading error that calls for a new path', 'rad', above=0.0, high=1.0, default=0.05)
    replan_length_ratio: float = quantity(
        'largest accepted length of a new path over the remaining one', '', 1.0, 10.0,
        default=1.2)
    reapproach_distance: float = quantity(
        'remaining path length at which a push that will miss the goal approaches it again', 'm',
        0.0, 5.0, default=0.1)
    reapproach_tolerance_ratio: float = quantity(
        'errors over the tolerances that count as a miss there', '', 0.01, 10.0,
        default=0.6)
    max_reapproaches: int = quantity(
        'number of further approaches', '', 0, 100, default=3)
    max_replan_requests: int = quantity(
        'number of plans that are requested after a push has failed', '', 0, 100, default=3)
    max_path_deviation: float = quantity(
        'distance of the object from the path that it is pushed along, sideways, at which a push '
        'is aborted; 0: four times its size', 'm', 0.0, 10.0, default=0.0)
    max_length_ratio: float = quantity(
        'travelled over planned path length at which the push is aborted', '', 1.0, 100.0,
        default=2.0)

    # Monitors of the contact.
    follow_window: float = quantity(
        'path length over which an object that does not follow counts as lost', 'm', above=0.0,
        high=2.0, default=0.25)
    follow_ratio: float = quantity(
        'motion of the contact over that of the robot below which the object does not follow', '',
        0.0, 1.0, default=0.3)
    contact_gap: float = quantity(
        'gap at which robot and object are no longer in contact', 'm', above=0.0, high=0.5,
        default=0.012)
    max_approach_distance: float = quantity(
        'largest gap that the robot closes by itself', 'm', 0.0, 1.0, default=0.06)
    cusum_threshold: float = quantity(
        'cumulative sum of normalised deviations that indicates slip or loss of contact', '',
        0.5, 100.0, default=5.0)
    odometry_walk: float = quantity(
        'random walk of the robot relative to its odometry, per path length', 'm/sqrt(m)',
        above=0.0, high=1.0, default=0.006)
    one_sided_distance: float = quantity(
        'path length after which a contact that can rotate the object to one side only is given '
        'up', 'm', 0.0, 10.0, default=0.5)

    # Estimator: measurements, and what is wrong with the nominal values.
    pose_noise: float = quantity(
        'standard deviation of a measured object position that states none', 'm',
        LEAST_NOISE, 0.5, default=0.002)
    heading_noise: float = quantity(
        'standard deviation of a measured object heading that states none', 'rad',
        LEAST_NOISE, 0.3, default=0.006)
    pose_bias: float = quantity(
        'standard deviation, along each axis, of the error of a measured object position that '
        'averaging does not reduce, as it stays while the object is seen from the same side', 'm',
        0.0, 0.5, default=0.0)
    heading_bias: float = quantity(
        'standard deviation of the error of a measured object heading that averaging does not '
        'reduce, as it stays while the object is seen from the same side', 'rad', 0.0, 0.5,
        default=0.0)
    heading_count: int = quantity(
        'number of headings in which the object looks the same to its tracker: a flip from one to '
        'another is taken back; 0: as the outline has it, 1: none is', '', 0, 360, default=0)
    pose_gate: float = quantity(
        'squared Mahalanobis distance at which a pose is rejected', '', 1.0, 1000.0,
        default=16.0)
    push_direction_std: float = quantity(
        'standard deviation of the push direction at the start', 'rad', above=0.0, high=1.0,
        default=0.04)
    push_direction_walk: float = quantity(
        'random walk of the push direction per path length', 'rad/sqrt(m)', 0.0, 1.0,
        default=0.03)
    position_walk: float = quantity(
        'random walk of the object position per path length', 'm/sqrt(m)', 0.0, 1.0,
        default=0.008)
    heading_walk: float = quantity(
        'random walk of the object heading per path length', 'rad/sqrt(m)', 0.0, 1.0,
        default=0.02)
    center_std_ratio: float = quantity(
        'standard deviation of the centre of friction over its distance from the contact', '', 0.0,
        1.0, default=0.11)
    max_center_offset_ratio: float = quantity(
        'largest offset of the centre of friction from its nominal place over the distance of '
        'that place from the contact', '', 0.0, 1.0, default=0.45)
    center_walk: float = quantity(
        'random walk of the centre of friction per path length', 'm/sqrt(m)', 0.0, 1.0,
        default=0.002)
    c_squared_log_std: float = quantity(
        "standard deviation of the logarithm of the supports' c^2", '', 0.0, 2.0, default=0.2)
    c_squared_log_walk: float = quantity(
        "random walk of the logarithm of the supports' c^2 per path length", '1/sqrt(m)', 0.0,
        2.0, default=0.03)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    def believed_covariance(self, measured: ObjectPose) -> PoseCovariance:
        """
        Choose the covariance of a measured object pose.

        :param measured: ``ObjectPose``.
        :return: the ``PoseCovariance`` that it states; that of ``pose_noise`` and
            ``heading_noise`` where it states none.
        """
        if measured.covariance is not None:
            return measured.covariance
        return PoseCovariance.from_deviations(self.pose_noise, self.heading_noise)
