"""
Site selection: the contact site of an object from which a push is fastest.

Sites wait in a queue: at first with a lower bound on the time of their push, then, as soon as a
program has been solved, with its time. The first in the queue goes on, so that sites whose bound
is above the best push are never solved, and hardly any but the best is refined.
"""

from collections.abc import Sequence
import heapq
import math
from typing import NamedTuple, Optional

from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.bounds import displacement_bound
from push_planner.steered.contact_sites import robot_start, site_problems
from push_planner.steered.initial_guess.dubins_routes import FAST_TURN_FRACTION, is_fast
from push_planner.steered.plan import Plan
from push_planner.steered.planner import RouteSearch

# Ratio of a plan's path to its route that is never fallen below. Measured: plans cut the corners
# of steady turns, by 7 % at most in 120 random pushes of a differential drive, by 1 % with a
# contact that is held.
ROUTE_SLACK = 0.9
# Ratio by which a plan may be faster than its program. Measured: 6e-5 at most in 80 pushes; a mesh
# of twice the segments, where the first does not lead to a plan, may find more.
REFINED_SLACK = 0.998
# Programs that are solved for each site at first. Chosen: one of the first routes leads to a push,
# if any does: mostly the first or second, or the next one with a shorter straight end. A site
# without a push is told apart sooner than by all its routes.
FIRST_SOLVES = 4
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
        index = '' if self.contact.kind == 'round' else f' {self.contact.index}'
        return (f'{self.contact.kind}{index} from ({x:.3f} m, {y:.3f} m, '
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
    :param bound: least time until the push ends [s]; infinite where it is refused.
    :param search: ``RouteSearch``; None where it is refused.
    :param reason: why it is refused, else empty.
    :param delay: time until the push starts [s].
    """

    problem: PushProblem
    bound: float
    search: Optional[RouteSearch]
    reason: str
    delay: float = 0.0


def choose_site(obj: PushedObject, robot: RoundRobot, start: Pose, goal: Pose,
                settings: Optional[PlannerSettings] = None,
                current: Optional[PushProblem] = None) -> SiteChoice:
    """
    Find the site from which the goal is reached in the shortest time.

    Each site is tried briefly; only where none has a push are the most promising ones tried
    thoroughly. The robot's path to the site does not count.

    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world at the end.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param current: ``PushProblem`` of a further site, such as the one where the robot stands.
    :raises PlanningFailed: where all are refused; ``sites`` of the report lists them.
    """
    problems = site_problems(obj, robot, start, goal, settings or PlannerSettings())
    if current is not None:
        problems.insert(0, current)
    return fastest_push(problems)


def fastest_push(problems: Sequence[PushProblem],
                 delays: Sequence[float] | None = None) -> SiteChoice:
    """
    Plan the push that ends first of those that several sites offer, as ``choose_site``.

    :param problems: ``PushProblem`` of each site, at least one.
    :param delays: time until each push starts [s]; None where all start at once.
    :raises PlanningFailed: where all are refused; ``sites`` of the report lists them.
    """
    delays = delays or [0.0] * len(problems)
    sites = sorted((bound_site(problem, delay, FIRST_SOLVES)
                    for problem, delay in zip(problems, delays)), key=lambda site: site.bound)
    tried = _try_sites(sites)
    if tried.best is None:
        promising = [site for site in sites if site.search is not None][:THOROUGH_SITES]
        thorough = _try_sites([bound_site(site.problem, site.delay) for site in promising])
        promising_contacts = {id(site.problem.contact) for site in promising}
        tried = SitesTried(thorough.best, thorough.candidates + tuple(
            candidate for candidate in tried.candidates
            if id(candidate.contact) not in promising_contacts))
    if tried.best is None:
        raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE,
                             f'no feasible contact site; best candidate: {tried.candidates[0]}',
                             {'sites': tried.candidates})
    return SiteChoice(tried.best, tried.candidates)


def _try_sites(sites: Sequence[BoundedSite]) -> SitesTried:
    """Go on with the site of the least time, be it a bound or that of a program."""
    best: Optional[Plan] = None
    best_time = math.inf
    solved: list[SiteCandidate] = []
    others: list[SiteCandidate] = []
    # Least time, number of the site, whether its program is solved.
    queue = [(site.bound, index, False) for index, site in enumerate(sites)]
    while queue:
        least, index, is_solved = heapq.heappop(queue)
        site = sites[index]
        try:
            if site.search is None:
                raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, site.reason)
            if least >= best_time:
                others.append(_refused(site, f'not faster than {least:.1f} s'))
            elif not is_solved:
                least = site.delay + REFINED_SLACK * site.search.solve()
                heapq.heappush(queue, (least, index, True))
            else:
                plan = site.search.plan()
                solved.append(_solved(site, plan))
                time = site.delay + plan.motion.duration
                if time < best_time:
                    best, best_time = plan, time
        except PlanningFailed as failure:
            others.append(_refused(site, failure.reason))
    solved.sort(key=lambda one: one.duration or 0.0)
    return SitesTried(best, tuple(solved + others))


def bound_site(problem: PushProblem, delay: float = 0.0,
               max_solves: float = math.inf) -> BoundedSite:
    """
    Bound the time until the end of a push from below, without solving it.

    :param delay: time until it starts [s].
    :param max_solves: number of programs that are solved for it at most.
    """
    try:
        search = RouteSearch(problem, max_solves)
    except PlanningFailed as failure:
        return BoundedSite(problem, math.inf, None, failure.reason, delay)
    # Plans may use the reserve of curvature that the routes of fast pushes leave.
    slack = ROUTE_SLACK * (FAST_TURN_FRACTION if is_fast(problem) else 1.0)
    bound = max(displacement_bound(problem),
                slack * search.shortest_route() / problem.settings.pushing_speed)
    return BoundedSite(problem, delay + bound, search, '', delay)


def _refused(site: BoundedSite, reason: str) -> SiteCandidate:
    return SiteCandidate(site.problem.contact, robot_start(site.problem), None, None, reason)


def _solved(site: BoundedSite, plan: Plan) -> SiteCandidate:
    return SiteCandidate(site.problem.contact, robot_start(site.problem), plan.motion.duration,
                         plan.motion.path_length, '')
