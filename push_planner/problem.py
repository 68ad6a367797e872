"""What is asked of the planner: values that check themselves."""

import dataclasses
import math

from push_model.contact import contact_point, curvature_radius, find_contact, rolling_constants
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.quantity import check, quantity
from push_model.quasi_static import vehicle


class PlanningFailed(Exception):
    """
    No plan, and why.

    :param reason: one sentence.
    :param report: what was found on the way, a dict of names to values.
    """

    def __init__(self, reason, report=None):
        """Keep the reason and the report."""
        super().__init__(reason)
        self.reason = reason
        self.report = dict(report or {})


@dataclasses.dataclass(frozen=True)
class PlannerSettings:
    """How plans are made."""

    pushing_speed: float = quantity('speed of the contact point along the push', 'm/s', above=0.0,
                                    high=5.0, default=0.15)
    segments: int = quantity('least number of segments of constant pushing angle', '', 4, 200,
                             default=24)
    segment_length: float = quantity('longest segment of constant pushing angle; longer pushes '
                                     'get more segments', 'm', 0.05, 2.0, default=0.3)
    cone_margin: float = quantity('share of the contact friction angle that a plan may use', '',
                                  0.05, 1.0, default=0.65)
    friction_discount: float = quantity('factor on the believed contact friction coefficient', '',
                                        above=0.0, high=1.0, default=0.8)
    run_in: float = quantity('straight push at the end of a plan, shortened for near goals', 'm',
                             0.0, 5.0, default=0.4)
    max_path_length: float = quantity('longest push that is accepted', 'm', above=0.0,
                                      high=1000.0, default=20.0)
    contact_tolerance: float = quantity('largest gap or overlap between robot and object at the '
                                        'start', 'm', 0.0, 1.0, default=0.03)
    sample_spacing: float = quantity('largest distance between samples of a plan', 'm', 0.001,
                                     0.2, default=0.015)
    position_tolerance: float = quantity('largest position error of a re-integrated plan', 'm',
                                         above=0.0, high=0.1, default=0.002)
    heading_tolerance: float = quantity('largest heading error of a re-integrated plan', 'rad',
                                        above=0.0, high=0.2, default=0.0035)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class PushProblem:
    """
    Push an object from its pose to a goal pose, through one contact that never slides.

    :param obj: the ``PushedObject`` as believed.
    :param robot: the ``RoundRobot``.
    :param contact: where the robot touches.
    :param start: ``Pose`` of the object in the world, at rest.
    :param normal: gamma, world angle of the contact normal at the start [rad].
    :param heading: phi, world heading of the robot at the start [rad].
    :param goal: ``Pose`` of the object in the world.
    :param settings: ``PlannerSettings``.
    """

    obj: PushedObject
    robot: RoundRobot
    contact: Contact
    start: Pose
    normal: float
    heading: float
    goal: Pose
    settings: PlannerSettings = PlannerSettings()

    @property
    def contact_point(self):
        """Contact point C in the object frame at the start, (x, y) [m]."""
        return contact_point(self.obj, self.contact)

    @property
    def vehicle(self):
        """View of the object as a vehicle, ``push_model.quasi_static.Vehicle``."""
        return vehicle(self.obj, self.contact_point)

    @property
    def rolling(self):
        """Constants (lam, R_e [m]) of the rolling contact."""
        return rolling_constants(self.robot.radius, curvature_radius(self.obj, self.contact))

    @property
    def push_direction(self):
        """World angle psi from the contact to the friction centre at the start [rad]."""
        return self.start.theta + self.vehicle.angle

    @property
    def normal_offset(self):
        """Angle zeta = gamma - psi at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.push_direction)

    @property
    def heading_offset(self):
        """D = gamma - phi at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.heading)

    @property
    def friction_angle(self):
        """Half-angle of the friction cone as believed, ``atan(mu_c)`` [rad]."""
        return math.atan(self.obj.contact_friction_coefficient)

    @property
    def planning_angle(self):
        """Half-angle of the cone that the plan keeps to, discount and margin included [rad]."""
        friction = self.settings.friction_discount * self.obj.contact_friction_coefficient
        return self.settings.cone_margin * math.atan(friction)


def problem_from_placement(obj, robot, object_pose, robot_pose, goal, settings=None):
    """
    Make the problem of pushing from where robot and object stand.

    A gap or an overlap within the tolerance counts as touching.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :return: ``PushProblem``.
    :raises PlanningFailed: where a pose is not finite or the robot is not at the object.
    """
    settings = settings or PlannerSettings()
    poses = {'object pose': object_pose, 'robot pose': robot_pose, 'goal': goal}
    for name, pose in poses.items():
        if not Pose(*pose).is_finite():
            raise PlanningFailed(f'the {name} is not finite: {tuple(pose)}')
    if not 0.0 < robot.radius < math.inf:
        raise PlanningFailed(f'the robot has a radius of {robot.radius:g} m: plans are made for '
                             'round robots, neither points nor fences')
    contact, normal, gap = find_contact(obj, object_pose, robot_pose[:2], robot.radius)
    if abs(gap) > settings.contact_tolerance:
        kind = 'away from' if gap > 0.0 else 'inside'
        raise PlanningFailed(f'the robot is not at the object: it is {abs(gap):.3f} m {kind} it, '
                             f'at most {settings.contact_tolerance:g} m is accepted',
                             {'gap': gap})
    return PushProblem(obj, robot, contact, Pose(*map(float, object_pose)), float(normal),
                       float(robot_pose[2]), Pose(*map(float, goal)), settings)
