"""What is asked of the planner: values that check themselves."""

import dataclasses
import functools
import math
from typing import Any, Mapping, NamedTuple, Optional

from push_model.contact import contact_point, curvature_radius, find_contact, rolling_constants
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.quasi_static import vehicle
from push_planner.push_parameters import PushParameters
from push_planner.settings import PlannerSettings


class PlanningFailed(Exception):
    """
    There is no plan.

    :param code: ``push_model.plan_request.PlanFailure``, for control flow.
    :param reason: the same in one sentence with its numbers, for people.
    :param report: further results by name.
    """

    def __init__(self, code: PlanFailure, reason: str,
                 report: Optional[Mapping[str, Any]] = None) -> None:
        """Keep code, reason and report."""
        super().__init__(reason)
        self.code = code
        self.reason = reason
        self.report = dict(report or {})

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle with all arguments; an exception of itself pickles its message alone."""
        return type(self), (self.code, self.reason, self.report)


class InitialMotion(NamedTuple):
    """
    How a push goes on at present, to plan on from it.

    :param speed: of the contact [m/s]; 0: nothing moves yet.
    :param yaw_rate: of the object [rad/s].
    :param pushing_angle: rho [rad].
    """

    speed: float = 0.0
    yaw_rate: float = 0.0
    pushing_angle: float = 0.0


@dataclasses.dataclass(frozen=True)
class PushProblem:
    """
    Push an object from its pose to a goal pose, through one contact that never slides.

    :param obj: the ``PushedObject`` as believed.
    :param robot: the ``RoundRobot``.
    :param contact: where the robot touches.
    :param start: ``Pose`` of the object in the world, at rest unless ``motion`` says otherwise.
    :param normal: gamma, world angle of the contact normal at the start [rad].
    :param heading: phi, world heading of the robot at the start [rad].
    :param goal: ``Pose`` of the object in the world.
    :param settings: ``PlannerSettings``.
    :param motion: ``InitialMotion``, where a push is under way already.
    """

    obj: PushedObject
    robot: RoundRobot
    contact: Contact
    start: Pose
    normal: float
    heading: float
    goal: Pose
    settings: PlannerSettings = PlannerSettings()
    motion: InitialMotion = InitialMotion()

    @property
    def kind(self):
        """How the contact goes with the robot, one of ``push_planner.push_parameters.PUSH_KINDS``."""
        if self.robot.drive == 'differential':
            return 'differential'
        # The normal of a point robot is that of the face: it turns with the object in any case.
        turns = self.settings.robot_yaw == 'with_object' or self.robot.radius == 0.0
        return 'held' if turns else 'rolling'

    @functools.cached_property
    def push_parameters(self):
        """What the equations need of it, ``push_planner.push_parameters.PushParameters``."""
        return PushParameters.of(self)

    @functools.cached_property
    def contact_point(self):
        """Contact point C in the object frame at the start, (x, y) [m]."""
        return contact_point(self.obj, self.contact)

    @functools.cached_property
    def friction_center(self):
        """Friction centre F in the object frame, (x, y) [m]."""
        return friction_center(self.obj)

    @functools.cached_property
    def relative_goal(self):
        """Goal in the object's start frame, ``Pose``."""
        return self.start.inverse() @ self.goal

    @property
    def start_normal(self):
        """Normal in the object frame at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.start.theta)

    @functools.cached_property
    def vehicle(self):
        """View of the object as a vehicle, ``push_model.quasi_static.Vehicle``."""
        return vehicle(self.obj, self.contact_point)

    @functools.cached_property
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
    def planning_cone_angle(self):
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
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(pose)}')
    check_robot_is_round(robot)
    contact, normal, gap = find_contact(obj, object_pose, robot_pose[:2], robot.radius)
    if abs(gap) > settings.contact_tolerance:
        kind = 'away from' if gap > 0.0 else 'inside'
        raise PlanningFailed(PlanFailure.NOT_IN_CONTACT,
                             f'the robot is not at the object: it is {abs(gap):.3f} m {kind} it, '
                             f'at most {settings.contact_tolerance:g} m is accepted',
                             {'gap': gap})
    return PushProblem(obj, robot, contact, Pose(*map(float, object_pose)), float(normal),
                       float(robot_pose[2]), Pose(*map(float, goal)), settings)


def check_robot_is_round(robot):
    """
    Refuse a robot that is not round.

    :param robot: the ``RoundRobot``.
    :raises PlanningFailed: where its radius is infinite.
    """
    if math.isinf(robot.radius):
        raise PlanningFailed(PlanFailure.ROBOT_NOT_ROUND,
                             f'the robot has a radius of {robot.radius:g} m: plans are made for '
                             'round robots and points, not for fences')
