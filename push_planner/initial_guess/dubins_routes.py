"""
Where to begin: the pushed object as a vehicle that follows a Dubins path of its flat point z.

Turns are steady ones: of a contact that is held, by the supports themselves and with inertia; of
a differential drive, whose normal follows the turn, by the vehicle view.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.dubins import DubinsPath, words
from push_model.geometry import Pose
from push_planner.initial_guess.first_guess import guess
from push_planner.initial_guess.steady_turns import steady_turns, SteadyTurn, TurnKey

FASTEST_TIGHT = 0.5
GENTLE = 0.85
SHORTER = (0.5, 0.25, 0.1)
DETOUR = 1.2
SHORTEST_RUN_IN = 0.02
WIDEST = 1.1


class Route(NamedTuple):
    """
    A way for the flat point, in the object's start frame, with what it costs.

    :param path: ``DubinsPath`` of z, up to the run-in.
    :param turns: ``SteadyTurn`` on each piece of it.
    :param run_in: straight way after it [m].
    :param cost: way of the contact, run-in included [m].
    :param aside: how far from it along either axis a plan may be [m].
    """

    path: DubinsPath
    turns: tuple
    run_in: float
    cost: float
    aside: float = math.inf

    @property
    def turned(self):
        """Angle by which the object turns [rad]."""
        return sum(a * b for a, b in zip(self.path.lengths, self.path.curvatures))

    @property
    def name(self):
        """Letters of its pieces."""
        return self.path.word

    def guess(self, problem, lengths, points):
        """
        Follow it; arguments and result as of ``push_planner.initial_guess.first_guess.guess``.

        :param problem: the ``PushProblem``.
        :param lengths: of the steps [m].
        :param points: places of the Radau points in a step.
        """
        return guess(problem, self, lengths, points)


def tightest_turns(problem):
    """
    Find the tightest steady turns.

    :param problem: the ``PushProblem``.
    :return: ``SteadyTurn`` (to the left, to the right), or None where straight ahead is out of
        bounds itself.
    """
    settings, vehicle = problem.settings, problem.vehicle
    offset = problem.normal_offset
    if problem.kind == 'differential':
        reach = vehicle.arm + problem.robot.radius
        beta = problem.planning_angle if settings.angle_limit == 'cone' else WIDEST
        return tuple(_vehicle_turn(vehicle, (problem.heading_offset + side * beta) / reach)
                     for side in (1.0, -1.0))
    slope, widest = math.inf, WIDEST
    if settings.angle_limit == 'cone':
        slope = math.tan(problem.planning_angle)
    elif settings.angle_limit == 'angle':
        widest = settings.max_pushing_angle
    dynamic = settings.motion_model == 'dynamic'
    key = TurnKey(tuple(problem.constants.column()), offset,
                  settings.pushing_speed ** 2 if dynamic else 0.0)
    found = steady_turns(key).limits(slope, widest, offset)
    if found is None or not (found[0].curvature > 0.0 > found[1].curvature):
        return None
    if dynamic and settings.pushing_speed > FASTEST_TIGHT:
        return tuple(SteadyTurn(GENTLE * turn.steer, GENTLE * turn.w) for turn in found)
    return found


def _vehicle_turn(vehicle, curvature):
    steer = -math.atan(vehicle.wheelbase * curvature)
    return SteadyTurn(steer, curvature * math.cos(steer))


def routes(problem, turns):
    """
    Rank the ways to the goal, cheapest first.

    Run-ins are shortened where the full one forces a detour.

    :param problem: the ``PushProblem``.
    :param turns: ``SteadyTurn`` (to the left, to the right).
    :return: list of ``Route``.
    """
    full = problem.settings.run_in
    shortest = min(SHORTEST_RUN_IN, full)
    found, least = _routes(problem, turns, full), _routes(problem, turns, shortest)
    if found[0].cost > DETOUR * least[0].cost:
        found = least + [route for share in SHORTER if share * full > shortest
                         for route in _routes(problem, turns, share * full)]
        best = min(route.cost for route in found)
        near = [route for route in found if route.cost <= DETOUR * best]
        longest = max(route.run_in for route in near)
        near.sort(key=lambda route: (route.run_in < longest, route.cost))
        rest = [route for route in found if route.cost > DETOUR * best]
        return near + sorted(rest, key=lambda route: route.cost)
    return found + [route for route in least if full > shortest]


def route_along(problem, pieces, aside):
    """
    Make a route of given pieces; the last is straight, and its end the run-in.

    :param problem: the ``PushProblem``; it can steer both ways.
    :param pieces: (length [m], signed curvature [1/m]) of each.
    :param aside: how far from it along either axis a plan may be [m].
    :return: ``Route``.
    """
    view, run_in = problem.vehicle, problem.settings.run_in
    pieces = [*pieces[:-1], (pieces[-1][0] - run_in, 0.0)]
    pieces = [piece for piece in pieces if piece[0] > 0.0]
    sharpest, turns = tightest_turns(problem), []
    for _, curvature in pieces:
        turn = sharpest[0 if curvature > 0.0 else 1]
        steer = math.atan(math.tan(turn.steer) * curvature / turn.curvature)
        turns.append(SteadyTurn(steer, curvature * math.cos(steer)))
    lengths, curvatures = zip(*pieces)
    word = ''.join('S' if c == 0.0 else 'L' if c > 0.0 else 'R' for c in curvatures)
    path = DubinsPath(Pose(*view.flat_point, view.angle), word, lengths, curvatures)
    cost = run_in + sum(length / math.cos(turn.steer) for length, turn in zip(lengths, turns))
    return Route(path, tuple(turns), run_in, cost, aside)


def _routes(problem, turns, run_in):
    vehicle = problem.vehicle
    flat = Pose(*vehicle.flat_point, vehicle.angle)
    goal = problem.relative_goal @ flat
    left, right = turns
    kinds = {1.0: left, 0.0: SteadyTurn(0.0, 0.0), -1.0: right}
    found = []
    for heading in _headings(problem, goal):
        end = goal._replace(theta=heading) @ Pose(-run_in, 0.0, 0.0)
        for path in words(flat, end, 1.0 / left.curvature, -1.0 / right.curvature):
            pieces = tuple(kinds[math.copysign(1.0, c) if c else 0.0] for c in path.curvatures)
            cost = run_in + sum(length / math.cos(turn.steer)
                                for length, turn in zip(path.lengths, pieces))
            found.append(Route(path, pieces, run_in, cost))
    return sorted(found, key=lambda route: route.cost)


def _headings(problem, goal):
    if not problem.settings.heading_free:
        return [goal.theta]
    # Any heading will do: the direction of the goal, and some to either side.
    bearing = math.atan2(goal.y, goal.x)
    return [bearing + turn for turn in np.linspace(-math.pi, math.pi, 16, endpoint=False)]
