"""Settings of the planner."""

import dataclasses
from typing import get_args, Literal

from push_model.quantity import check, quantity

SiteSelection = Literal['current', 'best']
MotionModel = Literal['dynamic', 'quasi_static']
RobotYaw = Literal['with_object', 'fixed']
AngleProfile = Literal['linear', 'constant']
AngleLimit = Literal['cone', 'angle', 'none']


@dataclasses.dataclass(frozen=True)
class PlannerSettings:
    """Settings of the planner of pushes."""

    site: SiteSelection = quantity('contact site of a single push: where the robot stands, or '
                                   'the fastest', choices=get_args(SiteSelection),
                                   default='current')
    pushing_speed: float = quantity('contact speed; of a straight push at its touch', 'm/s',
                                    above=0.0, high=5.0, is_basic=True, default=0.15)
    straight_speed: float = quantity('highest robot speed after the touch of a straight push',
                                     'm/s', above=0.0, high=5.0, default=0.3)
    deceleration: float = quantity('deceleration before the goal; 0: none', 'm/s^2', 0.0, 10.0,
                                   default=0.1)
    end_speed: float = quantity('contact speed at the goal, and at a soft start', 'm/s', above=0.0,
                                high=5.0, default=0.03)
    acceleration: float = quantity('acceleration after the touch; 0: full speed at once', 'm/s^2',
                                   0.0, 10.0, default=0.0)
    motion_model: MotionModel = quantity('with inertia, or friction alone',
                                         choices=get_args(MotionModel), default='dynamic')
    robot_yaw: RobotYaw = quantity('yaw of a holonomic robot: turns with the object, or the '
                                   'contact rolls', choices=get_args(RobotYaw),
                                   default='with_object')
    pushing_angles: AngleProfile = quantity('linear or piecewise constant pushing angle',
                                            choices=get_args(AngleProfile), default='linear')
    max_angle_rate: float = quantity('highest rate of a linear pushing angle', 'rad/s', above=0.0,
                                     high=200.0, default=5.0)
    angle_limit: AngleLimit = quantity('limits contact force (cone), pushing angle (angle) or '
                                       'nothing', choices=get_args(AngleLimit), default='cone')
    max_pushing_angle: float = quantity('largest angle, for angle_limit angle', 'rad', above=0.0,
                                        high=1.3, default=0.3)
    segments: int = quantity('minimum number of segments of the pushing angle', '', 2, 200,
                             default=24)
    segment_length: float = quantity('longest segment; longer pushes get more', 'm', 0.05, 20.0,
                                     default=0.2)
    cone_margin: float = quantity('fraction of the contact friction angle for plans', '', 0.05,
                                  1.0, default=0.65)
    friction_discount: float = quantity('factor on the nominal contact friction', '', 0.05, 1.0,
                                        default=0.8)
    final_straight: float = quantity('straight end of a plan, shorter for near goals', 'm', 0.0,
                                     5.0, default=0.4)
    heading_free: bool = quantity('accept any heading at the goal', '', default=False)
    max_path_length: float = quantity('longest accepted push', 'm', above=0.0, high=1000.0,
                                      default=20.0)
    contact_tolerance: float = quantity('largest gap or overlap at the start', 'm', 0.0, 1.0,
                                        default=0.03)
    sample_spacing: float = quantity('largest distance between samples', 'm', 0.001, 0.2,
                                     default=0.015)
    position_tolerance: float = quantity('largest position error of the re-integrated plan', 'm',
                                         1e-6, 0.1, default=0.001)
    heading_tolerance: float = quantity('largest heading error of the re-integrated plan', 'rad',
                                        1e-6, 0.05, default=0.0017)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
