"""When a task is done, when to try again, and when to give up."""

import dataclasses

from push_model.quantity import check, quantity


@dataclasses.dataclass(frozen=True)
class SupervisionSettings:
    """What the supervisor of a task asks for and bears with."""

    position_tolerance: float = quantity('distance from the goal with which a task is done', 'm',
                                         above=0.0, high=1.0, default=0.01)
    heading_tolerance: float = quantity('heading error with which a task is done', 'rad',
                                        above=0.0, high=1.0, default=0.0175)
    confidence_sigmas: float = quantity('standard errors of the measured pose that are kept off the '
                                        'tolerances', '', 0.0, 10.0, default=2.0)
    min_averaging_time: float = quantity('time over which poses at rest are averaged at least', 's',
                                         above=0.0, high=10.0, default=0.5)
    max_averaging_time: float = quantity('time over which they are averaged while it is not certain '
                                         'that the task is done', 's', above=0.0, high=60.0, default=2.0)
    motion_gate_sigmas: float = quantity('standard deviations from the average that tell that the object '
                                         'has moved', '', above=0.0, high=100.0, default=5.0)

    max_attempts: int = quantity('pushes and recoveries without getting nearer before it gives up', '',
                                 1, 100, default=12)
    improvement_ratio: float = quantity('share of the least error so far that counts as nearer', '',
                                        above=0.0, high=1.0, default=0.9)
    plan_timeout: float = quantity('time to wait for a plan', 's', above=0.0, high=600.0,
                                   default=20.0)
    stall_timeout: float = quantity('time without motion on a way after which it is given up', 's',
                                    above=0.0, high=60.0, default=4.0)

    moved_distance: float = quantity('move of the object, not pushed, after which a plan no '
                                     'longer holds', 'm', above=0.0, high=1.0, default=0.05)
    moved_angle: float = quantity('turn of the object, likewise', 'rad', above=0.0, high=1.0,
                                  default=0.1)
    max_path_deviation: float = quantity('distance of the object from the path of its plan at which a push '
                                         'ends', 'm', above=0.0, high=10.0, default=0.2)
    pre_push_tolerance: float = quantity('error with which the robot may stand before the last '
                                         'straight way to the object', 'm', above=0.0, high=0.5,
                                         default=0.01)
    odometry_scale: float = quantity('standard deviation of the relative error of the distance '
                                     'that odometry tells', '', 0.0, 0.5, default=0.02)
    odometry_drift: float = quantity('standard deviation of the heading error of odometry per '
                                     'distance', 'rad/m', 0.0, 1.0, default=0.02)
    odometry_walk: float = quantity('random walk of the robot beside its odometry per way',
                                    'm/sqrt(m)', 0.0, 1.0, default=0.003)
    odometry_heading_walk: float = quantity('random walk of its heading, likewise', 'rad/sqrt(m)',
                                            0.0, 1.0, default=0.01)
    probe_distance: float = quantity('way beyond the expected place on which it feels for the object', 'm',
                                     above=0.0, high=1.0, default=0.1)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
