"""Site selection: the contact site of an object from which a push is fastest."""

from collections.abc import Sequence
import math
from typing import NamedTuple, Optional

from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_planner.initial_guess.dubins_routes import FAST_TURN_FRACTION, is_fast, routes
from push_planner.plan import Plan
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.single_push.bounds import displacement_bound
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_feasibility
from push_planner.single_push.planner import plan_push, steering_limits

# Ratio of a plan's path to its route that is never fallen below. Measured: plans cut the corners
# of steady turns, by 7 % at most in 120 random pushes of a differential drive, by 1 % with a
# contact that is held.
ROUTE_SLACK = 0.9
# Programs that are solved for each site at first. Chosen: the first or second route leads to a
# push, if any does; a site without one is told apart ten times sooner than by all its routes.
FIRST_SOLVES = 2
# Sites that are given all routes, and the relaxed program, where no site has a push at first.
# Chosen: the most promising ones, which also tell best what stands in the way.
THOROUGH_SITES = 1


class SiteCandidate(NamedTuple):
    """
    Result of pushing at one site.

    :param contact: the ``Contact``.
    :param robot_pose: ``Pose`` of the robot in the world at the start.
    :param duration: of the push [s]; None without a plan.
    :param path_length: of the contact [m]; None without a plan.
    :param reason: why there is no plan, empty where there is one.
    """

    contact: Contact
    robot_pose: Pose
    duration: Optional[float]
    path_length: Optional[float]
    reason: str

    def __str__(self) -> str:
        """Describe it in one line."""
        x, y, heading = self.robot_pose
        text = self.reason or f'{self.duration:.1f} s, {self.path_length:.2f} m'
        number = '' if self.contact.kind == 'round' else f' {self.contact.index}'
        return (f'{self.contact.kind}{number} from ({x:.3f} m, {y:.3f} m, '
                f'{math.degrees(heading):.1f} deg): {text}')


class SiteChoice(NamedTuple):
    """
    The fastest push, and what else was considered.

    :param plan: the ``Plan``.
    :param candidates: ``SiteCandidate`` of every site, the fastest first; empty where sites were
        not compared.
    """

    plan: Plan
    candidates: tuple[SiteCandidate, ...]


class SitesTried(NamedTuple):
    """
    Sites that were tried.

    :param best: the fastest ``Plan``; None where there is none.
    :param candidates: ``SiteCandidate`` of every site, the fastest first.
    """

    best: Optional[Plan]
    candidates: tuple[SiteCandidate, ...]


class BoundedSite(NamedTuple):
    """
    A site with a lower bound on its time.

    :param problem: the ``PushProblem``.
    :param bound: least time of the push [s]; infinite where it is refused.
    :param reason: why it is refused, else empty.
    """

    problem: PushProblem
    bound: float
    reason: str


def choose_site(obj: PushedObject, robot: RoundRobot, start: Pose, goal: Pose,
                settings: Optional[PlannerSettings] = None,
                current: Optional[PushProblem] = None) -> SiteChoice:
    """
    Find the site from which the goal is reached in the shortest time.

    Sites are solved in the order of a lower bound on their time; one whose bound tells that it is
    not the fastest is not solved. Each is tried briefly; only where none has a push are the most
    promising ones tried thoroughly. The robot's path to the site does not count.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world at the end.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param current: ``PushProblem`` of a further site, such as the one where the robot stands.
    :raises PlanningFailed: where all are refused; ``sites`` of the report lists them.
    """
    problems = site_problems(obj, robot, start, goal, settings or PlannerSettings())
    if current is not None:
        problems.insert(0, current)
    sites = sorted((bound_site(problem) for problem in problems), key=lambda site: site.bound)
    found = _try_sites(sites, FIRST_SOLVES)
    if found.best is None:
        promising = [site for site in sites if not site.reason][:THOROUGH_SITES]
        thorough = _try_sites(promising, math.inf)
        tried = {id(site.problem.contact) for site in promising}
        found = SitesTried(thorough.best, thorough.candidates + tuple(
            candidate for candidate in found.candidates if id(candidate.contact) not in tried))
    if found.best is None:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no feasible contact site; best candidate: {found.candidates[0]}',
                             {'sites': found.candidates})
    return SiteChoice(found.best, found.candidates)


def _try_sites(sites: Sequence[BoundedSite], max_solves: float) -> SitesTried:
    """Plan from sites in the order of their bounds; ``max_solves`` is of each."""
    best: Optional[Plan] = None
    solved: list[tuple[float, SiteCandidate]] = []
    refused: list[SiteCandidate] = []
    for site in sites:
        reason = site.reason or _reason_to_skip(site, best)
        if not reason:
            try:
                found = plan_push(site.problem, max_solves=max_solves)
            except PlanningFailed as failure:
                reason = failure.reason
            else:
                duration = found.trajectory.duration
                solved.append((duration, _solved_candidate(site.problem, found)))
                if best is None or duration < best.trajectory.duration:
                    best = found
        if reason:
            refused.append(SiteCandidate(site.problem.contact, robot_start(site.problem), None,
                                         None, reason))
    solved.sort(key=lambda one: one[0])
    return SitesTried(best, tuple([candidate for _, candidate in solved] + refused))


def bound_site(problem: PushProblem) -> BoundedSite:
    """
    Bound the time of a push from below, without solving it.

    :param problem: the ``PushProblem``.
    """
    try:
        check_feasibility(problem)
        turns = steering_limits(problem)
    except PlanningFailed as failure:
        return BoundedSite(problem, math.inf, failure.reason)
    # Plans may use the reserve of curvature that the routes of fast pushes leave.
    slack = ROUTE_SLACK * (FAST_TURN_FRACTION if is_fast(problem) else 1.0)
    shortest = min(route.path_length for route in routes(problem, turns))
    bound = max(displacement_bound(problem), slack * shortest / problem.settings.pushing_speed)
    return BoundedSite(problem, bound, '')


def _reason_to_skip(site: BoundedSite, best: Optional[Plan]) -> str:
    if best is not None and site.bound >= best.trajectory.duration:
        return f'not faster than {site.bound:.1f} s'
    return ''


def _solved_candidate(problem: PushProblem, plan: Plan) -> SiteCandidate:
    return SiteCandidate(problem.contact, robot_start(problem), plan.trajectory.duration,
                         plan.report['path_length'], '')
