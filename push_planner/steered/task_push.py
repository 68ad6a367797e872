"""Plan the steered push by which a task gets on where no straight push does."""

import dataclasses
import functools

from push_model.geometry import distance, Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.path import NoPathFound, Path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.contact_sites import robot_start, site_problems
from push_planner.steered.feasibility import check_not_at_goal
from push_planner.steered.site_selection import fastest_push
from push_planner.straight.planner import checked_request
from push_planner.task_plan import TaskPlan

# After failed attempts long steered pushes, which miss most, are avoided at first: a push may be
# this much longer [m] than the distance to the goal times the ratio.
CAUTIOUS_LENGTH = 1.0
CAUTIOUS_LENGTH_RATIO = 1.5


def plan_steered_push(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                      drive: DriveSettings) -> TaskPlan:
    """
    Plan the steered push on open floor that brings the object to its goal first.

    The time of the robot's path to the site counts.

    After failed attempts it first keeps to a reduced friction cone and a limited length.

    :raises PlanningFailed: with the reason; ``AT_GOAL`` where no push is needed.
    """
    request = checked_request(request, robot)
    check_not_at_goal(request.object_pose, request.goal, settings, request.tolerances)
    plan = functools.partial(_plan_from_sites, request, robot, drive)
    if request.cone_fraction < 1.0:
        max_length = CAUTIOUS_LENGTH + CAUTIOUS_LENGTH_RATIO * distance(request.object_pose,
                                                                        request.goal)
        try:
            return plan(dataclasses.replace(
                settings, cone_margin=request.cone_fraction * settings.cone_margin,
                max_path_length=min(settings.max_path_length, max_length)))
        except PlanningFailed:
            pass
    return plan(settings)


def _plan_from_sites(request: PlanRequest, robot: RoundRobot, drive: DriveSettings,
                     settings: PlannerSettings) -> TaskPlan:
    """Plan from the sites that the robot reaches."""
    paths: dict[Pose, Path] = {}
    problems: list[PushProblem] = []
    times: list[float] = []
    reason = 'it has none'
    for problem in site_problems(request.obj, robot, request.object_pose, request.goal, settings):
        start = robot_start(problem)
        try:
            path = plan_path(robot, request.obj, request.object_pose, request.robot_pose,
                             _standoff(start, drive), drive)
        except NoPathFound as failure:
            reason = str(failure)
        else:
            problems.append(problem)
            paths[start] = path
            times.append(travel_time(path, robot, drive))
    if not problems:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'the robot reaches no contact site: {reason}')
    plan, _ = fastest_push(problems, times)
    path = paths[robot_start(plan.problem)]
    return TaskPlan(plan.trajectory, plan.problem.contact, path, plan.motion.path_length,
                    travel_time(path, robot, drive) + plan.motion.duration, dict(plan.report))


def _standoff(contact_pose: Pose, drive: DriveSettings) -> Pose:
    """Step back from the contact, along the heading, to where the straight approach starts."""
    return contact_pose @ Pose(-drive.standoff, 0.0, 0.0)
