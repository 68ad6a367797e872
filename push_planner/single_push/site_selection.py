"""Where to push: the quickest of all sites of an object."""

import math
from typing import NamedTuple, Optional

from push_model.geometry import Pose
from push_model.parameters import Contact
from push_model.plan_request import PlanFailure
from push_planner.initial_guess.dubins_routes import FASTEST_TIGHT, GENTLE, routes, tightest_turns
from push_planner.plan import Plan
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.single_push.bounds import displacement_bound
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_feasibility
from push_planner.single_push.planner import plan_push

# Plans cut the corners of steady turns: by 7 % at most in 120 random pushes of a differential
# drive, by 1 % with a contact that is held.
ROUTE_SLACK = 0.9


class SiteCandidate(NamedTuple):
    """
    What comes of pushing at one site.

    :param contact: the ``Contact``.
    :param robot_pose: ``Pose`` of the robot in the world at the start.
    :param duration: of the push [s]; None without a plan.
    :param path_length: way of the contact [m]; None without a plan.
    :param reason: why there is no plan, empty where there is one.
    """

    contact: Contact
    robot_pose: Pose
    duration: Optional[float]
    path_length: Optional[float]
    reason: str

    def __str__(self):
        """Say it in one line."""
        x, y, heading = self.robot_pose
        text = self.reason or f'{self.duration:.1f} s, {self.path_length:.2f} m'
        number = '' if self.contact.kind == 'round' else f' {self.contact.index}'
        return (f'{self.contact.kind}{number} from ({x:.3f} m, {y:.3f} m, '
                f'{math.degrees(heading):.1f} deg): {text}')


class SiteChoice(NamedTuple):
    """
    The quickest push, and what else was considered.

    :param plan: the ``Plan``.
    :param candidates: ``SiteCandidate`` of every site, the quickest first.
    """

    plan: Plan
    candidates: tuple


class BoundedSite(NamedTuple):
    """
    A site with a lower bound on its time.

    :param problem: the ``PushProblem``.
    :param bound: time of the push at least [s]; infinite where it is refused.
    :param reason: why it is refused, else empty.
    """

    problem: PushProblem
    bound: float
    reason: str


def choose_site(obj, robot, start, goal, settings=None, here=None):
    """
    Find the site from which the goal is reached in the shortest time.

    A site is not solved where a lower bound on its time tells that it is not the quickest. The
    way to the site does not count.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param here: ``PushProblem`` of a further site, such as the one where the robot stands.
    :return: ``SiteChoice``.
    :raises PlanningFailed: where all are refused; ``sites`` of the report is the table.
    """
    problems = site_problems(obj, robot, start, goal, settings or PlannerSettings())
    weighed = sorted((bound_site(problem) for problem in ([here] if here else []) + problems),
                     key=lambda site: site.bound)
    best, solved, rest = None, [], []
    for problem, bound, reason in weighed:
        if best is not None and bound >= best.trajectory.duration:
            reason = reason or f'not quicker than {bound:.1f} s'
        if not reason:
            try:
                found = plan_push(problem)
            except PlanningFailed as failure:
                reason = failure.reason
            else:
                solved.append(_option(problem, '', found))
                if best is None or found.trajectory.duration < best.trajectory.duration:
                    best = found
        if reason:
            rest.append(_option(problem, reason))
    candidates = tuple(sorted(solved, key=lambda option: option.duration) + rest)
    if best is None:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no site will do, the least bad is {candidates[0]}',
                             {'sites': candidates})
    return SiteChoice(best, candidates)


def bound_site(problem):
    """
    Bound the time of a push from below, without solving it.

    :param problem: the ``PushProblem``.
    :return: ``BoundedSite``.
    """
    try:
        check_feasibility(problem)
        turns = tightest_turns(problem)
        if turns is None:
            plan_push(problem)
    except PlanningFailed as failure:
        return BoundedSite(problem, math.inf, failure.reason)
    settings = problem.settings
    fast = settings.motion_model == 'dynamic' and settings.pushing_speed > FASTEST_TIGHT
    share = ROUTE_SLACK * (GENTLE if fast else 1.0)
    shortest = min(route.path_length for route in routes(problem, turns))
    bound = max(displacement_bound(problem), share * shortest / settings.pushing_speed)
    return BoundedSite(problem, bound, '')


def _option(problem, reason, found=None):
    duration = length = None
    if found is not None:
        duration, length = found.trajectory.duration, found.report['path_length']
    return SiteCandidate(problem.contact, robot_start(problem), duration, length, reason)
