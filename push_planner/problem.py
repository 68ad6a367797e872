"""Push problems: what the planner is asked for, as values that check themselves."""

import dataclasses
import functools
import math
from typing import Any, Mapping, NamedTuple, Optional

from push_model.contact import (
    contact_point, curvature_radius, find_contact, rolling_constants, RollingConstants)
from push_model.dynamics import ObjectTerms
from push_model.friction import check_tipping, tipping_height
from push_model.geometry import Coordinates, Pose, wrap_angle
from push_model.optional import is_casadi_installed
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.quasi_static import pushed_friction_center, Vehicle, vehicle
from push_planner.refusal_marks import NO_MARKS, RefusalMarks
from push_planner.settings import PlannerSettings
from push_planner.steered.push_parameters import PushKind, PushParameters


# Of the last objects and contacts: of one object some problems are planned, as its goal moves.
_vehicle = functools.lru_cache(maxsize=256)(vehicle)
_object_terms = functools.lru_cache(maxsize=256)(ObjectTerms.of)


class PlanningFailed(Exception):
    """
    There is no plan.

    :param code: ``push_model.plan_request.PlanFailure``, for control flow.
    :param reason: the same in one sentence with its numbers, for people.
    :param report: further results by name; those of the marks come with them.
    :param marks: ``RefusalMarks``, what a picture shows of it.
    """

    def __init__(self, code: PlanFailure, reason: str,
                 report: Optional[Mapping[str, Any]] = None,
                 marks: RefusalMarks = NO_MARKS) -> None:
        """Keep code, reason, report and marks."""
        super().__init__(reason)
        self.code = code
        self.reason = reason
        self.report = {**marks.report(), **(report or {})}
        self.marks = marks

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle with all arguments; an exception of itself pickles its message alone."""
        return type(self), (self.code, self.reason, self.report, self.marks)


def check_solver() -> None:
    """
    Refuse a steered push where it cannot be planned.

    :raises PlanningFailed: with ``NO_SOLVER``.
    """
    if not is_casadi_installed():
        raise PlanningFailed(PlanFailure.NO_SOLVER,
                             f'{PlanFailure.NO_SOLVER.value}: pip install casadi')


class InitialMotion(NamedTuple):
    """
    Motion of a push that is under way, to plan on from it.

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

    :param obj: the nominal ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param contact: where the robot touches the object.
    :param start: ``Pose`` of the object in the world, at rest unless ``motion`` says otherwise.
    :param normal: gamma, angle of the contact normal in the world at the start [rad].
    :param heading: phi, heading of the robot in the world at the start [rad].
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
    def kind(self) -> PushKind:
        """Motion of the contact with the robot."""
        if self.robot.drive == 'differential':
            return 'differential'
        # The normal of a point robot is that of the face: it rotates with the object in any case.
        rotates = self.settings.robot_yaw == 'with_object' or self.robot.radius == 0.0
        return 'held' if rotates else 'rolling'

    @functools.cached_property
    def push_parameters(self) -> PushParameters:
        """Parameters of the equations of the push."""
        base_x, base_y = self.contact_point
        effective_radius = face_radius = disc_radius = 0.0
        # Where contact and object rotate as one, R_e plays no part.
        if self.kind == 'rolling':
            effective_radius = self.rolling.effective_radius
            if self.contact.kind == 'face':
                face_radius = self.robot.radius
            elif self.contact.kind == 'round':
                base_x, base_y = 0.0, 0.0
                disc_radius = self.obj.radius
        return PushParameters(_object_terms(self.obj), base_x, base_y, self.start_normal,
                              self.rolling.normal_ratio, effective_radius, face_radius,
                              disc_radius, self.robot.radius, self.heading_offset)

    @functools.cached_property
    def contact_point(self) -> tuple[float, float]:
        """Contact point C in the object frame at the start, (x, y) [m]."""
        return contact_point(self.obj, self.contact)

    @functools.cached_property
    def friction_center(self) -> tuple[float, float]:
        """Centre of friction F under the push, in the object frame, (x, y) [m]."""
        return pushed_friction_center(self.obj, self.contact_point)

    @functools.cached_property
    def relative_goal(self) -> Pose:
        """Goal in the object's start frame."""
        return self.start.inverse() @ self.goal

    @property
    def start_normal(self) -> float:
        """Angle of the normal in the object frame at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.start.theta)

    @functools.cached_property
    def vehicle(self) -> Vehicle:
        """The object seen as a vehicle that is pushed at the contact."""
        return _vehicle(self.obj, self.contact_point)

    @functools.cached_property
    def rolling(self) -> RollingConstants:
        """Constants (lam, R_e [m]) of the rolling contact."""
        return rolling_constants(self.robot.radius, curvature_radius(self.obj, self.contact))

    @property
    def center_direction(self) -> float:
        """World angle psi from the contact to the centre of friction at the start [rad]."""
        return self.start.theta + self.vehicle.angle

    @property
    def normal_offset(self) -> float:
        """Angle zeta = gamma - psi at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.center_direction)

    @property
    def heading_offset(self) -> float:
        """Angle D = gamma - phi at the start, in [-pi, pi] [rad]."""
        return wrap_angle(self.normal - self.heading)

    @property
    def friction_angle(self) -> float:
        """Half-angle of the nominal friction cone, ``atan(mu_c)`` [rad]."""
        return math.atan(self.obj.contact_friction_coefficient)

    @property
    def planning_cone_angle(self) -> float:
        """Half-angle of the cone that the plan keeps to, discount and margin included [rad]."""
        friction = self.settings.friction_discount * self.obj.contact_friction_coefficient
        return self.settings.cone_margin * math.atan(friction)


def problem_from_placement(obj: PushedObject, robot: RoundRobot, object_pose: Coordinates,
                           robot_pose: Coordinates, goal: Coordinates,
                           settings: Optional[PlannerSettings] = None) -> PushProblem:
    """
    Make the problem of pushing from where robot and object stand.

    A gap or an overlap within ``contact_tolerance`` counts as contact.

    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param goal: ``Pose`` of the object in the world at the end.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :raises PlanningFailed: where a pose is not finite or the robot is not at the object.
    """
    settings = settings or PlannerSettings()
    check_finite({'object pose': object_pose, 'robot pose': robot_pose, 'goal': goal})
    check_robot_is_round(robot)
    contact, normal, gap = find_contact(obj, object_pose, robot_pose[:2], robot.radius)
    if abs(gap) > settings.contact_tolerance:
        where = 'away from' if gap > 0.0 else 'inside'
        raise PlanningFailed(PlanFailure.NOT_IN_CONTACT,
                             f'the robot is not at the object: it is {abs(gap):.3f} m {where} it, '
                             f'at most {settings.contact_tolerance:g} m is accepted',
                             {'gap': gap})
    return PushProblem(obj, robot, contact, Pose(*map(float, object_pose)), float(normal),
                       float(robot_pose[2]), Pose(*map(float, goal)), settings)


def check_finite(poses: Mapping[str, Coordinates]) -> None:
    """
    Refuse poses that are not finite.

    :param poses: name -> (x, y, theta).
    :raises PlanningFailed: naming the first that is not finite.
    """
    for name, pose in poses.items():
        if not Pose(*pose).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(pose)}')


def check_robot_is_round(robot: RoundRobot) -> None:
    """
    Refuse a robot that is not round.

    :raises PlanningFailed: where its radius is infinite.
    """
    if math.isinf(robot.radius):
        raise PlanningFailed(PlanFailure.ROBOT_NOT_ROUND,
                             f'the robot has a radius of {robot.radius:g} m: plans are made for '
                             'round robots and points, not for flat pushers')


def check_object_stands(obj: PushedObject) -> None:
    """
    Refuse an object that tips when it is pushed at its contact height.

    :raises PlanningFailed: with the height at which it tips, as ``contact_height`` [m].
    """
    try:
        check_tipping(obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.TIPS, str(error),
                             {'contact_height': tipping_height(obj)}) from error
