"""
Plan the next unsteered push to a goal: the primitive with the least expected time.

What remains to do after it is in the cost-to-go, so that one push is a plan; the next one is
planned from where this one really ends.
"""

import contextlib
from typing import Any, NamedTuple

from push_model.contact import find_contact
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushTrajectory
from push_navigation.approach_path import plan_approach
from push_navigation.path import NoPathFound, Path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_planner.primitive_push.trajectory import greatest_speed, push_trajectory, touch_speed
from push_planner.problem import check_robot_is_round, PlanningFailed
from push_planner.settings import PlannerSettings
from push_primitives.cost_to_go import CostSettings
from push_primitives.selection import select_push, SelectedPush, SelectionQuery
from push_primitives.store import load_primitives, PushPrimitives
from push_primitives.weights import FrictionBelief

# Distances of robot and goal in a plan that only warms up [m]; chosen: clear of any object.
WARM_UP_DISTANCE = 3.0
# Deviation of the robot's place that is taken after pushes that brought the object no nearer to
# its goal, at least [m]: what it believes has failed; that of the table for unsure robots.
FAILED_DEVIATION = 0.02


class PrimitivePlan(NamedTuple):
    """
    Plan of one unsteered push.

    :param trajectory: its ``PushTrajectory``, of the mean effect.
    :param contact: ``Contact`` where it begins.
    :param approach_path: ``Path`` of the robot to the first contact.
    :param length: driven length from there [m].
    :param expected_time: of everything until the object is at its goal [s].
    :param report: further values by name.
    """

    trajectory: PushTrajectory
    contact: Contact
    approach_path: Path
    length: float
    expected_time: float
    report: dict[str, Any]


def plan_primitive_push(request: PlanRequest, robot: RoundRobot,
                        settings: PlannerSettings | None = None,
                        drive: DriveSettings | None = None) -> PrimitivePlan:
    """
    Plan the next unsteered push on open floor.

    :param request: ``PlanRequest``, with what has been learned so far.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param drive: ``DriveSettings``, or None for the defaults.
    :return: ``PrimitivePlan``.
    :raises PlanningFailed: with the reason.
    """
    check_robot_is_round(robot)
    settings, drive = settings or PlannerSettings(), drive or DriveSettings()
    for name in ('object_pose', 'robot_pose', 'goal'):
        if not Pose(*getattr(request, name)).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(getattr(request, name))}')
    if request.cone_fraction < 1.0:
        request = request._replace(
            robot_deviation=max(request.robot_deviation, FAILED_DEVIATION))
    primitives = _primitives(request, robot, drive)
    paths = _ApproachPaths(request, robot, settings,
                           drive.for_uncertain_robot(request.robot_deviation))
    to_object = request.object_pose.inverse()
    selected = select_push(primitives, SelectionQuery(
        to_object @ request.goal, to_object @ request.robot_pose, _belief(request),
        request.robot_deviation, greatest_speed(robot, settings)), paths.travel_time)
    if selected is None:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no contact place can be reached: {paths.reason}')
    return _plan(request, robot, settings, primitives, selected, path=paths.to(
        Pose(*primitives.table.starts[selected.primitive].tolist())))


def warm_up(obj: PushedObject, robot: RoundRobot, drive: DriveSettings) -> None:
    """
    Plan once, so that the first request does not wait for the compiler and for the table.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param drive: ``DriveSettings``.
    """
    away = Pose(-WARM_UP_DISTANCE, 0.0, 0.0)
    goal = Pose(WARM_UP_DISTANCE, 0.0, 0.0)
    with contextlib.suppress(PlanningFailed):
        plan_primitive_push(PlanRequest(Pose(0.0, 0.0, 0.0), away, goal, obj), robot, drive=drive)


def _plan(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
          primitives: PushPrimitives, selected: SelectedPush, *, path: Path) -> PrimitivePlan:
    table = primitives.table
    trajectory = push_trajectory(
        request.obj, robot, request.object_pose, request.robot_pose.theta, table, selected,
        settings=settings)
    start = Pose(*trajectory.robot_poses[0].tolist())
    contact = find_contact(request.obj, request.object_pose, start, robot.radius).contact
    report = {
        'path_length': selected.length, 'travel_time': selected.travel_time,
        'expected_remaining': selected.remaining_time,
        'tilt': float(table.tilts[selected.primitive]),
        'curvature': float(table.curvatures[selected.primitive])}
    return PrimitivePlan(trajectory, contact, path, selected.length, selected.expected_time,
                         report)


def _primitives(request: PlanRequest, robot: RoundRobot, drive: DriveSettings) -> PushPrimitives:
    """Load what is known of the object's pushes; the controller loads the same."""
    try:
        return load_primitives(request.obj, robot, CostSettings(
            position_tolerance=request.position_tolerance,
            heading_tolerance=request.heading_tolerance,
            robot_speed=drive.limited_to(robot).speed, drive=robot.drive))
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, str(error)) from error


def _belief(request: PlanRequest) -> FrictionBelief:
    try:
        center = friction_center(request.obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    return FrictionBelief(center, request.obj.contact_friction_coefficient,
                          request.center_deviation, request.contact_friction_deviation)


class _ApproachPaths:
    """Paths to the starts of primitives."""

    def __init__(self, request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                 drive: DriveSettings) -> None:
        self._request = request
        self._robot = robot
        self._drive = drive
        self._speed = touch_speed(1.0, settings)
        self._paths: dict[Pose, Path] = {}
        self.reason = ''

    def to(self, start: Pose) -> Path:
        """Return the path to a start, in the object frame, that ``travel_time`` has planned."""
        return self._paths[start]

    def travel_time(self, start: Pose) -> float:
        """Plan a path and return its time [s], infinite where there is none."""
        request = self._request
        try:
            path = plan_approach(self._robot, request.obj, request.object_pose,
                                 request.robot_pose, request.object_pose @ start, self._drive,
                                 end_speed=self._speed)
        except NoPathFound as failure:
            self.reason = failure.reason
            return float('inf')
        self._paths[start] = path
        return travel_time(path, self._robot, self._drive, end_speed=self._speed)
