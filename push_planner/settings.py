"""How chains of pushes are searched for."""

import dataclasses
import math

from push_model.quantity import check, quantity


@dataclasses.dataclass(frozen=True)
class PlannerSettings:
    """How plans are made."""

    site: str = quantity('where to push: where the robot stands, at whichever site of the object '
                         'is quickest, or at those of the quickest chain of pushes, which is '
                         'planned where a controller asks for it, not at a new goal',
                         choices=('current', 'best', 'sequence'), default='current')
    pushing_speed: float = quantity('speed of the contact point along the push', 'm/s', above=0.0,
                                    high=5.0, default=0.15)
    deceleration: float = quantity('braking of the contact before the goal; 0: none', 'm/s^2',
                                   0.0, 10.0, default=0.1)
    end_speed: float = quantity('speed of the contact at the goal, and at the start of a soft '
                                'start', 'm/s', above=0.0, high=5.0, default=0.03)
    acceleration: float = quantity('acceleration of the contact after the first touch; 0: touches '
                                   'at full speed', 'm/s^2', 0.0, 10.0, default=0.0)
    motion_model: str = quantity('with inertia, or friction alone',
                                 choices=('dynamic', 'quasi_static'), default='dynamic')
    robot_yaw: str = quantity('how a holonomic robot turns: as the object, so that the contact '
                              'stays in place, or not at all, so that it rolls',
                              choices=('with_object', 'fixed'), default='with_object')
    pushing_angles: str = quantity('course of the pushing angle: linear pieces without jumps, or '
                                   'constant pieces with jumps',
                                   choices=('linear', 'constant'), default='linear')
    max_angle_rate: float = quantity('highest rate of a linear pushing angle; the acceleration '
                                     'limits of the robot count as well', 'rad/s', above=0.0,
                                     high=1000.0, default=5.0)
    angle_limit: str = quantity('what limits the pushing: the contact force in the planning cone, '
                                'the pushing angle, or nothing',
                                choices=('cone', 'angle', 'none'), default='cone')
    max_pushing_angle: float = quantity('largest pushing angle, under angle_limit angle', 'rad',
                                        above=0.0, high=1.3, default=0.3)
    segments: int = quantity('least number of pieces of the pushing angle', '', 2, 200,
                             default=24)
    segment_length: float = quantity('longest piece of the pushing angle; longer pushes get more '
                                     'pieces', 'm', 0.05, 20.0, default=0.3)
    cone_margin: float = quantity('share of the contact friction angle that a plan may use', '',
                                  0.05, 1.0, default=0.65)
    friction_discount: float = quantity('factor on the believed contact friction coefficient', '',
                                        above=0.0, high=1.0, default=0.8)
    final_straight: float = quantity('straight push at the end of a plan, shortened for near goals; 0: '
                                     'none', 'm', 0.0, 5.0, default=0.4)
    heading_free: bool = quantity('whether the object may reach the goal with any heading', '',
                                  default=False)
    max_path_length: float = quantity('longest push that is accepted', 'm', above=0.0,
                                      high=1000.0, default=20.0)
    contact_tolerance: float = quantity('largest gap or overlap between robot and object at the '
                                        'start', 'm', 0.0, 1.0, default=0.03)
    sample_spacing: float = quantity('largest distance between samples of a plan', 'm', 0.001,
                                     0.2, default=0.015)
    position_tolerance: float = quantity('largest position error of a re-integrated plan', 'm',
                                         above=0.0, high=0.1, default=0.001)
    heading_tolerance: float = quantity('largest heading error of a re-integrated plan', 'rad',
                                        above=0.0, high=0.2, default=0.0017)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class TaskSettings:
    """How chains of pushes are searched for."""

    max_pushes: int = quantity('most pushes in a chain', '', 1, 4, default=4)
    min_straight: float = quantity('straight end of every push, at least', 'm', above=0.0,
                                   high=5.0, default=0.25)
    min_last_straight: float = quantity('straight end of the last push, at least', 'm', above=0.0,
                                        high=5.0, default=0.6)
    switch_time: float = quantity('settling, touch and retreat, per push', 's', 0.0, 60.0,
                                  default=5.0)
    correction_time: float = quantity('time of the pushes that mend a miss of the last one; weighed '
                                      'with how likely that is', 's', 0.0, 600.0, default=16.0)
    max_rotation: float = quantity('most that one push of a chain turns the object', 'rad',
                                   above=0.0, high=2.0 * math.pi, default=math.pi)
    radius_factor: float = quantity('radius of turns in a chain over that of the tightest', '', 1.0,
                                    10.0, default=1.05)
    rotation_steps: int = quantity('turns that are tried for each push but the last, at least', '', 3,
                                   100, default=7)
    max_evaluations: int = quantity('combinations of sites and turns that are tried for each number of '
                                    'pushes, at most, about', '', 1000, 10000000, default=50000)
    alternatives: int = quantity('chains that are kept, different in their sites', '', 1, 1000,
                                 default=10)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
