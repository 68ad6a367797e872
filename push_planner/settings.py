"""Settings of the planner: of single pushes, and of sequences of pushes."""

import dataclasses
import math
from typing import get_args, Literal

from push_model.quantity import check, quantity

SiteSelection = Literal['current', 'best', 'sequence']
MotionModel = Literal['dynamic', 'quasi_static']
RobotYaw = Literal['with_object', 'fixed']
AngleProfile = Literal['linear', 'constant']
AngleLimit = Literal['cone', 'angle', 'none']
TaskMethod = Literal['primitives', 'sequences']


@dataclasses.dataclass(frozen=True)
class PlannerSettings:
    """How a single push is planned."""

    site: SiteSelection = quantity(
        'contact site to push at: current (where the robot stands), best (the fastest site of the '
        'object) or sequence (the sites of the fastest sequence of pushes, planned when the '
        'controller requests it and not at a new goal)',
        choices=get_args(SiteSelection), default='current')
    pushing_speed: float = quantity('speed of the contact point along the push; of an unsteered '
                                    'push at its touch', 'm/s', above=0.0, high=5.0, default=0.15)
    unsteered_speed: float = quantity('greatest speed of the robot in an unsteered push, between '
                                      'touch and end; at least the pushing speed counts', 'm/s',
                                      above=0.0, high=5.0, default=0.3)
    deceleration: float = quantity('deceleration of the contact before the goal, of a steered '
                                   'push; 0: none', 'm/s^2', 0.0, 10.0, default=0.1)
    end_speed: float = quantity('speed of the contact at the goal, and at the start of a soft '
                                'start', 'm/s', above=0.0, high=5.0, default=0.03)
    acceleration: float = quantity('acceleration of the contact after the first touch; 0: touches '
                                   'at full speed', 'm/s^2', 0.0, 10.0, default=0.0)
    motion_model: MotionModel = quantity('with inertia, or friction alone',
                                         choices=get_args(MotionModel), default='dynamic')
    robot_yaw: RobotYaw = quantity('yaw of a holonomic robot: with the object, so that the '
                                   'contact stays in place, or fixed, so that the contact rolls',
                                   choices=get_args(RobotYaw), default='with_object')
    pushing_angles: AngleProfile = quantity(
        'profile of the pushing angle: linear segments without jumps, or constant segments with '
        'jumps', choices=get_args(AngleProfile), default='linear')
    max_angle_rate: float = quantity('highest rate of a linear pushing angle; the acceleration '
                                     'limits of the robot count as well', 'rad/s', above=0.0,
                                     high=200.0, default=5.0)
    angle_limit: AngleLimit = quantity('limit on the pushing: contact force in the planning cone, '
                                       'pushing angle, or none',
                                       choices=get_args(AngleLimit), default='cone')
    max_pushing_angle: float = quantity('largest pushing angle, with angle_limit angle', 'rad',
                                        above=0.0, high=1.3, default=0.3)
    segments: int = quantity('least number of segments of the pushing angle', '', 2, 200,
                             default=24)
    segment_length: float = quantity('longest segment of the pushing angle; longer pushes get '
                                     'more segments', 'm', 0.05, 20.0, default=0.2)
    cone_margin: float = quantity('fraction of the contact friction angle that a plan may use', '',
                                  0.05, 1.0, default=0.65)
    friction_discount: float = quantity('factor on the nominal contact friction coefficient', '',
                                        0.05, 1.0, default=0.8)
    final_straight: float = quantity('straight push at the end of a plan, shortened for near '
                                     'goals; 0: none', 'm', 0.0, 5.0, default=0.4)
    heading_free: bool = quantity('whether the object may reach the goal with any heading', '',
                                  default=False)
    max_path_length: float = quantity('longest push that is accepted', 'm', above=0.0,
                                      high=1000.0, default=20.0)
    contact_tolerance: float = quantity('largest gap or overlap between robot and object at the '
                                        'start', 'm', 0.0, 1.0, default=0.03)
    sample_spacing: float = quantity('largest distance between samples of a plan', 'm', 0.001,
                                     0.2, default=0.015)
    position_tolerance: float = quantity('largest position error of a re-integrated plan', 'm',
                                         1e-6, 0.1, default=0.001)
    heading_tolerance: float = quantity('largest heading error of a re-integrated plan', 'rad',
                                        1e-6, 0.05, default=0.0017)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class TaskSettings:
    """How the pushes of a task are planned."""

    method: TaskMethod = quantity(
        'primitives: unsteered pushes, by a table of their effects, or sequences: of steered '
        'pushes, which the other settings are for',
        choices=get_args(TaskMethod), default='primitives')
    max_pushes: int = quantity('most pushes in a sequence', '', 1, 4, default=4)
    min_straight: float = quantity('least length of the straight end of every push', 'm',
                                   above=0.0, high=5.0, default=0.25)
    min_last_straight: float = quantity('least length of the straight end of the last push', 'm',
                                        above=0.0, high=5.0, default=0.6)
    switch_time: float = quantity('time of settling, touch and retreat, per push', 's', 0.0, 60.0,
                                  default=5.0)
    correction_time: float = quantity('time of the pushes that correct a miss of the last one; '
                                      'weighted with the probability of a miss', 's', 0.0, 600.0,
                                      default=16.0)
    max_rotation: float = quantity('largest rotation of the object by one push of a sequence',
                                   'rad', above=0.0, high=2.0 * math.pi, default=math.pi)
    radius_factor: float = quantity('radius of turns in a sequence over that of the tightest', '',
                                    1.0, 10.0, default=1.05)
    rotation_steps: int = quantity('rotations evaluated for each push but the last, at least', '',
                                   3, 100, default=7)
    max_evaluations: int = quantity('approximate limit on the combinations of sites and rotations '
                                    'evaluated for each number of pushes', '', 1000, 10000000,
                                    default=50000)
    alternatives: int = quantity('number of sequences kept, different in their sites', '', 1, 1000,
                                 default=10)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
