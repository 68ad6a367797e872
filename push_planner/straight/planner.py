"""
Plan the next straight push to a goal: the primitive with the least expected time.

What remains to do after it is in the cost-to-go, so that one push is a plan; the next one is
planned from where this one really ends.
"""

import contextlib
from typing import Any, NamedTuple

from push_model.contact import find_contact
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import (
    ANY_HEADING, HEADING_TOLERANCE, PlanFailure, PlanRequest)
from push_model.trajectory import PushStyle, PushTrajectory
from push_navigation.approach.approach_path import plan_approach
from push_navigation.map_clearance import (
    map_clearance, MapContext, PositionUncertainty, Shortfall)
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, Path, PathFailure, sample_path
from push_navigation.path_planner import CLEARANCE_STEPS
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_planner.problem import check_object_stands, check_robot_is_round, PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.straight.trajectory import greatest_speed, push_trajectory, touch_speed
from push_primitives.cost_settings import CostSettings
from push_primitives.selection import select_push, SelectedPush, SelectionQuery
from push_primitives.simplification import simplified_object
from push_primitives.store import load_primitives, PushPrimitives
from push_primitives.weights import FrictionBelief

# Distances of robot and goal in a plan that only warms up [m]; chosen: clear of any object.
WARM_UP_DISTANCE = 3.0
# Deviation of the robot's position that is taken after pushes that brought the object no nearer to
# its goal, at least [m]: what it believes has failed; that of the table for unsure robots.
FAILED_DEVIATION = 0.02


# Paths that a robot would have which knows its position.
UNCERTAIN_PATHS = PathFailure.GOAL_TOO_UNCERTAIN, PathFailure.ROBOT_TOO_UNCERTAIN


class StraightPlan(NamedTuple):
    """
    Plan of one straight push.

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


def plan_straight_push(request: PlanRequest, robot: RoundRobot,
                       settings: PlannerSettings | None = None,
                       drive: DriveSettings | None = None, *,
                       paths: 'ApproachPaths | None' = None) -> StraightPlan:
    """
    Plan the next straight push on open floor.

    :param request: ``PlanRequest``, with what has been learned so far.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param drive: ``DriveSettings``, or None for the defaults.
    :param paths: ``ApproachPaths`` of the robot, as through a map, to which the push does not
        keep; None for those of open floor.
    :raises PlanningFailed: with the reason.
    """
    settings, drive = settings or PlannerSettings(), drive or DriveSettings()
    request = checked_request(request, robot)
    if request.cone_fraction < 1.0 and request.is_heading_free:
        # Pushes from where the robot stood have passed by the goal. With a heading the costs
        # differ more by the side that is pushed: it goes round. The present one needs no rotation.
        request = request._replace(goal=request.goal._replace(theta=request.object_pose.theta),
                                   heading_tolerance=HEADING_TOLERANCE)
    primitives = primitives_for(request, robot, drive)
    paths = paths or ApproachPaths(request, robot, settings, drive)
    to_object = request.object_pose.inverse()
    selected = select_push(primitives, SelectionQuery(
        to_object @ request.goal, to_object @ request.robot_pose, friction_belief(request),
        request.robot_deviation, greatest_speed(robot, settings)), paths.travel_time)
    if selected is None:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no contact place can be reached: {paths.reason}')
    return lay_out(request, robot, settings, primitives, selected, path=paths.to(
        Pose(*primitives.table.starts[selected.primitive].tolist())))


def checked_request(request: PlanRequest, robot: RoundRobot) -> PlanRequest:
    """
    Check what a push is planned for; after failed attempts the robot's position is less certain.

    A fine outline and many supports of the object are simplified.

    :raises PlanningFailed: where the robot is not round, or a point, or a pose not finite.
    """
    check_robot_is_round(robot)
    if robot.radius == 0.0:
        raise PlanningFailed(PlanFailure.ROBOT_NOT_ROUND,
                             'robot.radius: got 0 m: a point does not drive around an object')
    request = request._replace(obj=simplified_object(request.obj))
    check_object_stands(request.obj)
    for name in ('object_pose', 'robot_pose', 'goal'):
        if not Pose(*getattr(request, name)).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(getattr(request, name))}')
    if request.cone_fraction < 1.0:
        return request._replace(robot_deviation=max(request.robot_deviation, FAILED_DEVIATION))
    return request


def warm_up(obj: PushedObject, robot: RoundRobot, drive: DriveSettings) -> None:
    """Plan once, so that the first request does not wait for the compiler and for the table."""
    away = Pose(-WARM_UP_DISTANCE, 0.0, 0.0)
    goal = Pose(WARM_UP_DISTANCE, 0.0, 0.0)
    request = PlanRequest(Pose(0.0, 0.0, 0.0), away, goal, obj,
                          heading_tolerance=HEADING_TOLERANCE if obj.outline else ANY_HEADING)
    with contextlib.suppress(PlanningFailed):
        plan_straight_push(request, robot, drive=drive)


def lay_out(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
            primitives: PushPrimitives, selected: SelectedPush, *, path: Path,
            style: PushStyle = PushStyle.STRAIGHT) -> StraightPlan:
    """
    Make the plan of a push that has been selected.

    :param path: ``Path`` of the robot to the first contact.
    :param style: ``PushStyle`` of the push.
    """
    table = primitives.table
    trajectory = push_trajectory(
        request.obj, robot, request.object_pose, request.robot_pose.theta, table, selected,
        settings=settings, style=style)
    start = Pose(*trajectory.robot_poses[0].tolist())
    contact = find_contact(request.obj, request.object_pose, start, robot.radius).contact
    report = {
        'path_length': selected.length, 'travel_time': selected.travel_time,
        'expected_remaining': selected.remaining_time,
        'tilt': float(table.approach_angles[selected.primitive]),
        'curvature': float(table.curvatures[selected.primitive])}
    return StraightPlan(trajectory, contact, path, selected.length, selected.expected_time,
                        report)


def primitives_for(request: PlanRequest, robot: RoundRobot,
                   drive: DriveSettings) -> PushPrimitives:
    """
    Load what is known of the object's pushes; the controller loads the same.

    :raises PlanningFailed: where no face of the object is long enough, or it has no friction.
    """
    try:
        settings = CostSettings(
            position_tolerance=request.position_tolerance,
            heading_tolerance=request.heading_tolerance,
            robot_speed=drive.limited_to(robot).speed, drive=robot.drive)
        return load_primitives(request.obj, robot, settings, friction_belief(request))
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, str(error)) from error


def friction_belief(request: PlanRequest) -> FrictionBelief:
    """
    Gather what is known of friction.

    :raises PlanningFailed: where the object slides without friction.
    """
    try:
        center = friction_center(request.obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    return FrictionBelief(center, request.obj.contact_friction_coefficient,
                          request.center_deviation, request.contact_friction_deviation)


def position_uncertainty(request: PlanRequest) -> PositionUncertainty:
    """Gather how uncertain the robot's position is."""
    return PositionUncertainty(request.robot_deviation, request.odometry_slope,
                               request.odometry_drift)


class ApproachPaths:
    """
    Paths to the starts of primitives.

    ``reason``: why the last one that could not be planned has no path, ``is_too_uncertain``:
    whether one had none only as the robot does not know its position, and ``count``: of all that
    were planned, or could not be.

    :param request: ``PlanRequest``.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    """

    def __init__(self, request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                 drive: DriveSettings, occupancy_map: OccupancyMap | None = None) -> None:
        self._request = request
        self._robot = robot
        self._drive = drive.for_uncertain_robot(request.robot_deviation)
        self._map = occupancy_map
        self._uncertainty = position_uncertainty(request)
        self._speed = touch_speed(1.0, settings)
        self._paths: dict[Pose, Path] = {}
        self.reason = ''
        self.is_too_uncertain = False
        self.count = 0

    def to(self, start: Pose) -> Path:
        """
        Return the path to a start that ``travel_time`` has planned.

        :param start: robot centre at first contact and direction of motion, object frame.
        """
        return self._paths[start]

    def travel_time(self, start: Pose) -> float:
        """
        Plan a path and return its time [s], infinite where there is none.

        :param start: robot centre at first contact and direction of motion, object frame.
        """
        request = self._request
        self.count += 1
        try:
            path = plan_approach(self._robot, request.obj, request.object_pose,
                                 request.robot_pose, request.object_pose @ start, self._drive,
                                 occupancy_map=self._map, uncertainty=self._uncertainty,
                                 end_speed=self._speed)
        except NoPathFound as failure:
            self.reason = str(failure)
            self.is_too_uncertain |= failure.report.code in UNCERTAIN_PATHS
            return float('inf')
        self._paths[start] = path
        return travel_time(path, self._robot, self._drive, end_speed=self._speed)

    def shortfall(self, start: Pose) -> Shortfall | None:
        """
        Find where the path to a start lacks most room for a robot that is as uncertain as this.

        It is the path that a robot would take which knows its position, with the least clearances.

        :param start: robot centre at first contact and direction of motion, object frame.
        :return: ``Shortfall``; None where also that robot has no path, or it lacks nothing.
        """
        request, occupancy_map = self._request, self._map
        if occupancy_map is None:
            return None
        contact = request.object_pose @ start
        fraction, sigmas = CLEARANCE_STEPS[-1]
        drive = self._drive.with_clearances(fraction)
        try:
            path = plan_approach(self._robot, request.obj, request.object_pose,
                                 request.robot_pose, contact, drive, occupancy_map=occupancy_map,
                                 end_speed=self._speed)
            margins = map_clearance(self._robot, request.robot_pose, contact, drive,
                                    MapContext(occupancy_map, sigmas=sigmas))
        except NoPathFound:
            return None
        uncertain = MapContext(occupancy_map, self._uncertainty, sigmas)
        return margins._replace(context=uncertain).shortfall(
            sample_path(path, self._robot, occupancy_map.resolution))
