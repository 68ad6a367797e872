"""Settings of the controller: laws, gains, limits, and standard deviations of the estimator."""

import dataclasses
import math
from typing import get_args, Literal

from push_control.law_names import check_law_name, LAWS, OWN_LAW
from push_model.plan_request import (
    check_heading_tolerance, GoalTolerances, MAX_HEADING_TOLERANCE, MAX_TOLERANCE, MIN_TOLERANCE)
from push_model.quantity import check, MIN_NOISE, quantity
from push_model.signals import ObjectPose, PoseCovariance

ResumeAfterStop = Literal['on_request', 'automatic']


@dataclasses.dataclass(frozen=True)
class ControlSettings:
    """
    Everything of the controller that can be tuned; the defaults suit household objects and floors.

    Lengths along a path are those of the contact or of the flat output z. A random walk with the
    value w per square root of a length has the variance ``w^2 s`` after the path length s.
    """

    control_law: str = quantity(
        'closed form, predictive, the plan without measurements, or a law of your own',
        choices=LAWS, other_words=OWN_LAW, default='feedback')

    # When the robot moves, and when a push is over.
    start_tolerance: float = quantity('largest robot error at the start of a plan', 'm', above=0.0,
                                      high=1.0, default=0.05)
    pose_timeout: float = quantity('maximum age of an object pose: latency plus three periods',
                                   's', above=0.0, high=5.0, is_basic=True, default=0.25)
    odometry_timeout: float = quantity(
        'maximum age of odometry', 's', above=0.0, high=5.0, default=0.25)
    position_tolerance: float = quantity('position error at the end of a push', 'm', MIN_TOLERANCE,
                                         MAX_TOLERANCE, default=0.02)
    heading_tolerance: float = quantity('heading error at the end of a push', 'rad', MIN_TOLERANCE,
                                        MAX_HEADING_TOLERANCE, default=0.05)
    stop_distance: float = quantity('remaining path length at which the robot stops', 'm', 0.0,
                                    0.1, default=0.0005)

    # After a stop that nobody here has commanded.
    resume_after_stop: ResumeAfterStop = quantity(
        'after a standstill: wait for controller/resume or a goal, or resume',
        choices=get_args(ResumeAfterStop), default='on_request')
    max_standstill: float = quantity('longest standstill of a commanded base, or gap in odometry',
                                     's', 0.5, 5.0, default=3.0)

    # Steering laws.
    lateral_gain: float = quantity(
        'curvature per lateral error', '1/m^2', above=0.0, high=100.0, default=16.0)
    heading_gain: float = quantity(
        'curvature per heading error', '1/m', above=0.0, high=50.0, default=7.0)
    lateral_saturation: float = quantity(
        'lateral error at which its feedback saturates', 'm', above=0.0, high=1.0, default=0.1)
    max_curvature_rate: float = quantity('largest curvature change per path length', '1/m^2', 1.0,
                                         1000.0, default=60.0)
    rolling_gain: float = quantity('holonomic base: yaw per path length that rolls the contact',
                                   '1/m', 0.0, 50.0, default=4.0)
    horizon_steps: int = quantity('mpc: steps of the horizon', '', 2, 100, default=20)
    horizon_step: float = quantity('mpc: path length of a step', 'm', above=0.0, high=0.5,
                                   default=0.035)
    cone_weight: float = quantity('mpc: weight of leaving friction cone or contact feature', '',
                                  above=0.0, high=1e6, default=10.0)

    # Friction.
    friction_fraction: float = quantity('fraction of the nominal contact friction relied on', '',
                                        0.05, 1.0, default=0.8)
    feedback_cone_fraction: float = quantity('fraction of the friction cone for feedback', '',
                                             0.05, 1.0, default=0.82)
    replan_cone_fraction: float = quantity('fraction of the friction cone for a new path', '',
                                           0.05, 1.0, default=0.65)

    # Speed of the contact.
    start_speed: float = quantity(
        'contact speed at start and end', 'm/s', above=0.0, high=1.0, default=0.03)
    acceleration: float = quantity(
        'acceleration of the contact', 'm/s^2', above=0.0, high=10.0, default=0.2)
    deceleration: float = quantity('deceleration of the contact towards the goal', 'm/s^2',
                                   above=0.0, high=10.0, default=0.04)

    # New paths, further approaches to the goal, and new plans.
    final_straight: float = quantity(
        'straight final approach of a new path', 'm', 0.0, 5.0, default=0.6)
    replan_period: float = quantity('minimum time between new paths', 's', above=0.0, high=60.0,
                                    default=0.5)
    replan_min_distance: float = quantity(
        'path length before the first new path', 'm', 0.0, 5.0, default=0.3)
    replan_lateral_error: float = quantity('lateral error that triggers a new path', 'm',
                                           above=0.0, high=1.0, default=0.03)
    replan_heading_error: float = quantity('heading error that triggers a new path', 'rad',
                                           above=0.0, high=1.0, default=0.05)
    replan_length_ratio: float = quantity('longest new path over the remaining one', '', 1.0, 10.0,
                                          default=1.2)
    reapproach_distance: float = quantity('remaining path at which a predicted miss is noticed',
                                          'm', 0.0, 5.0, default=0.1)
    reapproach_tolerance_ratio: float = quantity('error over tolerance that counts as a miss', '',
                                                 0.01, 10.0, default=0.6)
    max_reapproaches: int = quantity('maximum number of further approaches', '', 0, 100, default=3)
    max_replan_requests: int = quantity('plans requested after failed pushes', '', 0, 100,
                                        default=3)
    max_path_deviation: float = quantity('object deviation that aborts; 0: five times its size',
                                         'm', 0.0, 10.0, default=0.0)
    max_length_ratio: float = quantity('path over planned path that aborts, plus 15 object sizes',
                                       '', 1.0, 100.0, default=2.0)

    # Monitors of the contact.
    follow_window: float = quantity('path length over which an object must follow', 'm', above=0.0,
                                    high=2.0, default=0.25)
    follow_ratio: float = quantity('contact over robot motion below which it does not follow', '',
                                   0.0, 1.0, default=0.3)
    contact_gap: float = quantity('gap at which contact is lost', 'm', above=0.0, high=0.5,
                                  default=0.012)
    max_approach_distance: float = quantity('largest gap that the robot closes itself', 'm', 0.0,
                                            1.0, default=0.06)
    cusum_threshold: float = quantity('CUSUM value that indicates slip or lost contact', '', 0.5,
                                      100.0, default=5.0)
    odometry_walk: float = quantity('random walk of the odometry', 'm/sqrt(m)', above=0.0,
                                    high=1.0, default=0.006)
    one_sided_distance: float = quantity('path length after which a one-sided contact is given up',
                                         'm', 0.0, 10.0, default=0.5)

    # Estimator: measurements, and what is wrong with the nominal values.
    pose_noise: float = quantity('position std where the pose states none', 'm', MIN_NOISE, 0.5,
                                 is_dynamic=False, is_basic=True, default=0.002)
    heading_noise: float = quantity('heading std where the pose states none', 'rad', MIN_NOISE,
                                    0.3, is_dynamic=False, is_basic=True, default=0.006)
    pose_noise_per_distance: float = quantity(
        'growth of pose_noise with the distance of a relative pose', 'm/m', 0.0, 0.5,
        is_dynamic=False, default=0.0)
    heading_noise_per_distance: float = quantity(
        'growth of heading_noise with the distance of a relative pose', 'rad/m', 0.0, 0.5,
        is_dynamic=False, default=0.0)
    pose_bias: float = quantity('std of the position error that averaging keeps, per axis', 'm',
                                0.0, 0.5, is_dynamic=False, default=0.0)
    heading_bias: float = quantity('std of the heading error that averaging keeps', 'rad', 0.0,
                                   0.5, is_dynamic=False, default=0.0)
    wall_error: float = quantity('std of walls about their cells in the map', 'm', 0.0, 0.5,
                                 default=0.01)
    heading_count: int = quantity('headings that look alike to the tracker; 0: as of the '
                                  'outline; 1: none', '', 0, 360, is_dynamic=False, default=0)
    pose_gate: float = quantity('squared Mahalanobis distance that rejects a pose', '', 1.0,
                                1000.0, default=16.0)
    push_direction_std: float = quantity('std of the push direction at the start', 'rad',
                                         above=0.0, high=1.0, default=0.04)
    push_direction_walk: float = quantity('random walk of the push direction', 'rad/sqrt(m)', 0.0,
                                          1.0, default=0.03)
    position_walk: float = quantity('random walk of the object position', 'm/sqrt(m)', 0.0, 1.0,
                                    default=0.008)
    heading_walk: float = quantity('random walk of the object heading', 'rad/sqrt(m)', 0.0, 1.0,
                                   default=0.02)
    center_std_ratio: float = quantity('std of the centre of friction over contact distance', '',
                                       0.0, 1.0, default=0.11)
    max_center_offset_ratio: float = quantity('largest offset of the centre of friction over '
                                              'contact distance', '', 0.0, 1.0, default=0.45)
    center_walk: float = quantity('random walk of the centre of friction', 'm/sqrt(m)', 0.0, 1.0,
                                  default=0.002)
    jump_threshold: float = quantity(
        'CUSUM value of heading innovations that indicates a jump of the centre of friction', '',
        0.5, 1000.0, default=10.0)
    center_jump_std_ratio: float = quantity('std of such a jump over contact distance', '', 0.0,
                                            1.0, default=0.15)
    center_walk_after_jump: float = quantity('center_walk for the rest of a push with a jump',
                                             'm/sqrt(m)', 0.0, 1.0, default=0.02)
    c_squared_log_std: float = quantity('std of log c^2 of the supports', '', 0.0, 2.0,
                                        default=0.2)
    c_squared_log_walk: float = quantity('random walk of log c^2', '1/sqrt(m)', 0.0, 2.0,
                                         default=0.03)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        check_heading_tolerance('ControlSettings', self.heading_tolerance)
        check_law_name(self.control_law)

    @property
    def tolerances(self) -> GoalTolerances:
        """The ``GoalTolerances`` of a push."""
        return GoalTolerances(self.position_tolerance, self.heading_tolerance)

    @property
    def standstill_limit(self) -> float:
        """Limit of a standstill after which the robot waits [s]; infinite: it never does."""
        return math.inf if self.resume_after_stop == 'automatic' else self.max_standstill

    def assumed_covariance(self, measured: ObjectPose) -> PoseCovariance:
        """
        Choose the covariance of a measured object pose.

        :return: the ``PoseCovariance`` that it states; that of ``pose_noise`` and
            ``heading_noise`` where it states none, which grow with the distance of a relative
            pose.
        """
        if measured.covariance is not None:
            return measured.covariance
        relative = measured.relative
        away = 0.0 if relative is None else math.hypot(relative.x, relative.y)
        return PoseCovariance.from_deviations(
            self.pose_noise + self.pose_noise_per_distance * away,
            self.heading_noise + self.heading_noise_per_distance * away)
