"""Gains, limits and beliefs of the controller."""

import dataclasses

from push_model.quantity import check, quantity

LAWS = ('feedback', 'mpc', 'open_loop')


@dataclasses.dataclass(frozen=True)
class ControlSettings:
    """Everything that may be tuned; the defaults suit household objects and floors."""

    control_law: str = quantity('feedback: closed form; mpc: predictive; open_loop: play the '
                                'plan without looking', choices=LAWS, default='feedback')

    start_tolerance: float = quantity('how far the robot may stand from the start of a plan; '
                                      'a turn of a differential drive counts at its rim', 'm',
                                      above=0.0, high=1.0, default=0.05)
    pose_timeout: float = quantity('age at which an object pose is stale; more than latency plus '
                                   'three periods rides out two lost poses in a row', 's',
                                   above=0.0, high=5.0, default=0.25)
    odometry_timeout: float = quantity('age at which odometry is stale', 's', above=0.0, high=5.0,
                                       default=0.25)
    position_tolerance: float = quantity('position error with which a push may end', 'm',
                                         above=0.0, high=1.0, default=0.02)
    heading_tolerance: float = quantity('heading error with which a push may end', 'rad',
                                        above=0.0, high=1.0, default=0.05)
    stop_distance: float = quantity('way left at which the robot is stopped', 'm', 0.0, 0.1,
                                    default=0.0005)

    lateral_gain: float = quantity('curvature per lateral error', '1/m^2', 0.0, 100.0,
                                   default=16.0)
    heading_gain: float = quantity('curvature per heading error', '1/m', 0.0, 50.0, default=7.0)
    lateral_saturation: float = quantity('lateral error beyond which the law does not pull '
                                         'harder', 'm', above=0.0, high=1.0, default=0.1)
    max_curvature_rate: float = quantity('largest change of curvature per way', '1/m^2', above=0.0,
                                         high=1000.0, default=60.0)
    rolling_gain: float = quantity('holonomic base: yaw per way that rolls the contact to where '
                                   'its normal runs through the friction centre', '1/m', 0.0,
                                   50.0, default=4.0)

    horizon_steps: int = quantity('mpc: number of steps that it looks ahead', '', 2, 100,
                                  default=20)
    horizon_step: float = quantity('mpc: way of each step', 'm', above=0.0, high=0.5,
                                   default=0.035)
    cone_weight: float = quantity('mpc: weight of leaving the friction cone or the place of the '
                                  'contact', '', above=0.0, high=1e6, default=10.0)

    friction_fraction: float = quantity('share of the believed contact friction that is counted on',
                                        '', above=0.0, high=1.0, default=0.8)
    feedback_cone_fraction: float = quantity('share of the friction cone that feedback may use', '',
                                             above=0.0, high=1.0, default=0.82)
    replan_cone_fraction: float = quantity('share of the friction cone that a new path may use', '',
                                           above=0.0, high=1.0, default=0.65)
    final_straight: float = quantity('straight way before the goal on a new path', 'm', 0.0, 5.0,
                                     default=0.6)

    start_speed: float = quantity('contact speed at start and end', 'm/s', above=0.0, high=1.0,
                                  default=0.03)
    acceleration: float = quantity('rise of the contact speed', 'm/s^2', above=0.0, high=10.0,
                                   default=0.2)
    deceleration: float = quantity('fall of the contact speed towards the goal', 'm/s^2',
                                   above=0.0, high=10.0, default=0.04)

    replan_period: float = quantity('least time between new paths', 's', above=0.0, high=60.0,
                                    default=0.5)
    replan_min_distance: float = quantity('way before the first new path', 'm', 0.0, 5.0, default=0.3)
    replan_lateral_error: float = quantity('lateral error that asks for a new path', 'm', above=0.0,
                                           high=1.0, default=0.03)
    replan_heading_error: float = quantity('heading error that asks for a new path', 'rad', above=0.0,
                                           high=1.0, default=0.05)
    replan_length_ratio: float = quantity('length of a new path over the way left that is accepted', '',
                                          1.0, 10.0, default=1.2)
    reapproach_distance: float = quantity('way left at which a push that is off is approached '
                                          'anew', 'm', 0.0, 5.0, default=0.1)
    reapproach_tolerance_ratio: float = quantity('share of the tolerances that counts as off there', '',
                                                 above=0.0, high=10.0, default=0.6)
    max_reapproaches: int = quantity('number of further approaches', '', 0, 100, default=3)
    max_replan_requests: int = quantity('number of plans that are asked for when a push has gone astray',
                                        '', 0, 100, default=3)
    max_length_ratio: float = quantity('travelled over planned way at which the push is given up', '', 1.0,
                                       100.0, default=2.0)
    follow_window: float = quantity('way over which an object that does not follow is lost', 'm',
                                    above=0.0, high=2.0, default=0.25)
    follow_ratio: float = quantity('motion of the contact over that of the robot below which the '
                                   'object does not follow', '', 0.0, 1.0, default=0.3)
    contact_gap: float = quantity('gap at which robot and object no longer touch', 'm', above=0.0,
                                  high=0.5, default=0.012)
    max_approach_distance: float = quantity('gap that the robot closes by itself', 'm', 0.0, 1.0,
                                            default=0.06)
    cusum_threshold: float = quantity('sum of deviations, beyond noise, that tells slip or loss of '
                                      'contact', '', above=0.0, high=100.0, default=5.0)
    odometry_walk: float = quantity('random walk of the robot beside its odometry per way',
                                    'm/sqrt(m)', above=0.0, high=1.0, default=0.006)
    one_sided_distance: float = quantity('way after which a contact that can only turn the object one '
                                         'way is given up', 'm', 0.0, 10.0, default=0.5)

    pose_noise: float = quantity('standard deviation of a measured object position', 'm',
                                 above=0.0, high=0.5, default=0.002)
    heading_noise: float = quantity('standard deviation of a measured object heading', 'rad',
                                    above=0.0, high=0.5, default=0.006)
    pose_gate: float = quantity('squared distance at which a pose is rejected', '', above=0.0,
                                high=1000.0, default=16.0)
    push_direction_std: float = quantity('standard deviation of the push direction at the start',
                                         'rad', above=0.0, high=1.0, default=0.04)
    push_direction_walk: float = quantity('random walk of the push direction per way',
                                          'rad/sqrt(m)', 0.0, 1.0, default=0.03)
    position_walk: float = quantity('random walk of the position per way', 'm/sqrt(m)', 0.0, 1.0,
                                    default=0.008)
    heading_walk: float = quantity('random walk of the heading per way', 'rad/sqrt(m)', 0.0, 1.0,
                                   default=0.02)
    center_std_ratio: float = quantity('standard deviation of the friction centre over its distance '
                                       'to the contact', '', 0.0, 1.0, default=0.11)
    max_center_offset_ratio: float = quantity('largest offset of the friction centre, likewise', '', 0.0,
                                              1.0, default=0.45)
    center_walk: float = quantity('random walk of the friction centre per way', 'm/sqrt(m)', 0.0,
                                  1.0, default=0.002)

    c_squared_log_std: float = quantity("standard deviation of the logarithm of the supports' c^2", '',
                                        0.0, 2.0, default=0.2)
    c_squared_log_walk: float = quantity('random walk of that logarithm per way', '1/sqrt(m)', 0.0, 2.0,
                                         default=0.03)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
