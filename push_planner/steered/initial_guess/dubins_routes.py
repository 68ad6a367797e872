"""
Dubins routes: paths of the flat output to the goal, in the tightest turns allowed.

Turns are steady ones, on the supports themselves and with inertia: of a contact that is held, or
of a fast differential drive, whose normal follows the turn. Those of a slow one are of the object
seen as a vehicle: as it settles, it turns for a while more sharply than it can go on to.
"""

from collections.abc import Sequence
import math
from typing import Optional

import numpy as np
from push_model import dubins
from push_model.dubins import dubins_paths
from push_model.geometry import distance, Pose
from push_planner.problem import PushProblem
from push_planner.steered.initial_guess.first_guess import Route
from push_planner.steered.initial_guess.steady_turns import (
    ContactLimits, SteadyTurn, turn_limits, TurnKey)

# Pushing speed up to which routes use the tightest turns [m/s], and the fraction of them beyond.
# Chosen: a fast push has to build up its turn, and needs a reserve for it.
MAX_TIGHT_SPEED = 0.5
FAST_TURN_FRACTION = 0.85
# Fractions of the final straight that are tried where the full one forces a detour, and the least
# length of it [m].
SHORTER_STRAIGHTS = (0.5, 0.25, 0.1)
MIN_FINAL_STRAIGHT = 0.02
# Ratio of path lengths beyond which one counts as a detour. Chosen: a straighter end is worth a
# fifth of the path.
DETOUR_RATIO = 1.2
# Largest pushing angle of turns where the cone does not limit them [rad]. Chosen: 63 degrees,
# where the object turns about one of its supports.
MAX_TURN_ANGLE = 1.1
# Headings at the goal that are tried where any will do. Chosen: 22.5 degrees apart; the solver
# finds the optimum in between.
FREE_HEADINGS = 16

TurnPair = tuple[SteadyTurn, SteadyTurn]


def tightest_turns(problem: PushProblem) -> Optional[TurnPair]:
    """
    Find the tightest steady turns.

    :return: ``SteadyTurn`` (to the left, to the right); None where straight ahead is outside the
        limits itself.
    """
    settings = problem.settings
    if problem.kind == 'differential' and not is_fast(problem):
        return _differential_turns(problem)
    dynamic = settings.motion_model == 'dynamic'
    turns = _steady_turns(problem, settings.pushing_speed ** 2 if dynamic else 0.0)
    if turns is not None and has_reserve(problem):
        return _scaled(turns, FAST_TURN_FRACTION)
    return turns


def is_fast(problem: PushProblem) -> bool:
    """Tell whether inertia counts for so much that a push may leave the homotopy of its route."""
    settings = problem.settings
    return settings.motion_model == 'dynamic' and settings.pushing_speed > MAX_TIGHT_SPEED


def has_reserve(problem: PushProblem) -> bool:
    """Tell whether the turns of routes have a reserve of curvature."""
    return is_fast(problem) and problem.kind != 'differential'


def routes(problem: PushProblem, turns: TurnPair) -> list[Route]:
    """
    Rank the routes to the goal, shortest first; where any heading will do, one of each word.

    Final straights are shortened where the full one forces a detour.

    :param turns: ``SteadyTurn`` (to the left, to the right).
    """
    full = problem.settings.final_straight
    shortest = min(MIN_FINAL_STRAIGHT, full)
    candidates = _routes(problem, turns, full)
    if full == shortest:
        return candidates
    with_shortest = _routes(problem, turns, shortest)
    if candidates[0].path_length > DETOUR_RATIO * with_shortest[0].path_length:
        candidates = [route for fraction in SHORTER_STRAIGHTS if fraction * full > shortest
                      for route in _routes(problem, turns, fraction * full)]
    candidates += with_shortest
    # Of all that are no detour, those with the longest final straight come first.
    limit = DETOUR_RATIO * min(route.path_length for route in candidates)
    near = [route for route in candidates if route.path_length <= limit]
    longest = max(route.final_straight for route in near)
    near.sort(key=lambda route: (route.final_straight < longest, route.path_length))
    far = [route for route in candidates if route.path_length > limit]
    return near + sorted(far, key=lambda route: route.path_length)


def choose_various(ranked: Sequence[Route], count: int) -> list[Route]:
    """
    Choose routes: the first of each homotopy class, and then the first of the others.

    Where goals are near, routes with all lengths of the final straight may be of one class, and
    lead to no push.

    :param ranked: the routes.
    :param count: number of routes that are chosen at most.
    :return: list of ``Route``, ranked as before.
    """
    if len(ranked) <= count:
        return list(ranked)
    first: dict[tuple[str, int, int], int] = {}
    for index, route in enumerate(ranked):
        first.setdefault(_homotopy(route), index)
    leading = list(first.values())
    others = [index for index in range(len(ranked)) if index not in leading]
    return [ranked[index] for index in sorted((leading + others)[:count])]


def shortest_length(problem: PushProblem, turns: TurnPair, final_straight: float) -> float:
    """
    Path length of the contact on the shortest route with a final straight [m].

    :param turns: ``SteadyTurn`` (to the left, to the right).
    :param final_straight: its length [m].
    """
    start, goal = _flat_outputs(problem)
    left, right = turns
    costs = {'S': 1.0, 'L': 1.0 / math.cos(left.steering_angle),
             'R': 1.0 / math.cos(right.steering_angle)}
    return final_straight + min(
        dubins.shortest_length(start, end, 1.0 / left.curvature, -1.0 / right.curvature, costs)
        for end in _ends(problem, goal, final_straight))


def straight_length(problem: PushProblem) -> float:
    """Find a length that no push falls below, straight to the goal [m]."""
    start, goal = _flat_outputs(problem)
    return distance(start, goal)


def contact_length(lengths: Sequence[float], turns: Sequence[SteadyTurn]) -> float:
    """
    Path length of the contact on segments of the flat output's path [m].

    :param lengths: of the segments [m].
    :param turns: ``SteadyTurn`` on each.
    """
    return sum(length / math.cos(turn.steering_angle) for length, turn in zip(lengths, turns))


def _steady_turns(problem: PushProblem, v_squared: float) -> Optional[TurnPair]:
    """Find the tightest steady turns at a squared speed V [m^2/s^2]."""
    settings, parameters = problem.settings, problem.push_parameters
    slope, max_angle, lever = math.inf, MAX_TURN_ANGLE, 0.0
    if settings.angle_limit == 'cone':
        slope = math.tan(problem.planning_cone_angle)
    elif settings.angle_limit == 'angle':
        max_angle = settings.max_pushing_angle
    if problem.kind == 'differential':
        lever = problem.robot.radius * math.cos(problem.heading_offset)
    key = TurnKey(parameters.supports, tuple(parameters.column()), problem.normal_offset,
                  v_squared)
    turns = turn_limits(key, ContactLimits(slope, max_angle, lever, problem.heading_offset))
    if turns is None or not (turns[0].curvature > 0.0 > turns[1].curvature):
        return None
    return turns


def _differential_turns(problem: PushProblem) -> TurnPair:
    """
    Find the turns at the edges of the cone, the robot's heading settled on the push.

    They are those of the object seen as a vehicle, without inertia.
    """
    vehicle = problem.vehicle
    lever = vehicle.arm + problem.robot.radius
    beta = MAX_TURN_ANGLE
    if problem.settings.angle_limit == 'cone':
        beta = problem.planning_cone_angle
    left = _vehicle_turn(vehicle.wheelbase, (problem.heading_offset + beta) / lever)
    right = _vehicle_turn(vehicle.wheelbase, (problem.heading_offset - beta) / lever)
    return left, right


def _vehicle_turn(wheelbase: float, curvature: float) -> SteadyTurn:
    steering_angle = -math.atan(wheelbase * curvature)
    return SteadyTurn(steering_angle, curvature * math.cos(steering_angle))


def _scaled(turns: TurnPair, factor: float) -> TurnPair:
    left, right = (SteadyTurn(factor * turn.steering_angle, factor * turn.w) for turn in turns)
    return left, right


def _routes(problem: PushProblem, turns: TurnPair, final_straight: float) -> list[Route]:
    """Routes with a final straight, shortest first."""
    candidates = _routes_in(problem, turns, final_straight)
    if is_fast(problem):
        candidates += _tighter_routes(problem, turns, final_straight, candidates)
    candidates.sort(key=lambda route: route.path_length)
    if problem.settings.heading_free:
        # From other headings the program leads to where it does from the best one of a word.
        # Measured: of 380 pushes one takes 0.1 % more time so.
        best = {route.name: route for route in reversed(candidates)}
        return [route for route in candidates if route is best[route.name]]
    return candidates


def _tighter_routes(problem: PushProblem, turns: TurnPair, final_straight: float,
                    candidates: Sequence[Route]) -> list[Route]:
    """
    Routes in tighter turns that are shorter than those found.

    A push may turn once to either side although no such path exists in the turns before, which
    then makes detours by whole circles. A contact that is held has a reserve; a differential drive
    turns for a while as sharply as without inertia.
    """
    if problem.kind == 'differential':
        tighter = _differential_turns(problem)
    else:
        tighter = _scaled(turns, 1.0 / FAST_TURN_FRACTION)
    shortest = min(route.path_length for route in candidates)
    known = {_homotopy(route) for route in candidates}
    return [route for route in _routes_in(problem, tighter, final_straight)
            if route.path_length < shortest and _homotopy(route) not in known]


def _homotopy(route: Route) -> tuple[str, int, int]:
    """
    Word and numbers of whole turns, which pushes with the same optimum mostly share.

    Turns to the left count from those to the right, and then all together.
    """
    turns = sum(length * abs(c) for length, c in zip(route.path.lengths, route.path.curvatures))
    return route.name, round(route.rotation / math.tau), round(turns / math.tau)


def _routes_in(problem: PushProblem, turns: TurnPair, final_straight: float) -> list[Route]:
    """Routes in turns to either side."""
    start, goal = _flat_outputs(problem)
    left, right = turns
    turn_of = {1.0: left, 0.0: SteadyTurn(0.0, 0.0), -1.0: right}
    candidates: list[Route] = []
    for end in _ends(problem, goal, final_straight):
        for path in dubins_paths(start, end, 1.0 / left.curvature, -1.0 / right.curvature):
            steady = tuple(turn_of[math.copysign(1.0, c) if c else 0.0] for c in path.curvatures)
            path_length = final_straight + contact_length(path.lengths, steady)
            candidates.append(Route(path, steady, final_straight, path_length))
    return candidates


def _flat_outputs(problem: PushProblem) -> tuple[Pose, Pose]:
    """Flat output and direction of the push, at the start and at the goal."""
    vehicle = problem.vehicle
    start = Pose(*vehicle.flat_output, vehicle.angle)
    return start, problem.relative_goal @ start


def _ends(problem: PushProblem, goal: Pose, final_straight: float) -> list[Pose]:
    """Flat output where the final straight begins, by the headings at the goal."""
    return [goal._replace(theta=heading) @ Pose(-final_straight, 0.0, 0.0)
            for heading in _goal_headings(problem, goal)]


def _goal_headings(problem: PushProblem, goal: Pose) -> list[float]:
    if not problem.settings.heading_free:
        return [goal.theta]
    bearing = math.atan2(goal.y, goal.x)
    return [bearing + angle
            for angle in np.linspace(-math.pi, math.pi, FREE_HEADINGS, endpoint=False)]
