"""
Where to begin: the pushed object as a vehicle that follows a Dubins path of its flat point z.

Turns are steady ones: of a contact that is held, by the supports themselves and with inertia; of
a differential drive, whose normal follows the turn, by the vehicle view.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.dubins import dubins_paths, DubinsPath
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
    :param final_straight: straight way after it [m].
    :param path_length: way of the contact, run-in included [m].
    :param max_deviation: how far from it along either axis a plan may be [m].
    """

    path: DubinsPath
    turns: tuple
    final_straight: float
    path_length: float
    max_deviation: float = math.inf

    @property
    def rotation(self):
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
        beta = problem.planning_cone_angle if settings.angle_limit == 'cone' else WIDEST
        return tuple(_vehicle_turn(vehicle, (problem.heading_offset + side * beta) / reach)
                     for side in (1.0, -1.0))
    slope, widest = math.inf, WIDEST
    if settings.angle_limit == 'cone':
        slope = math.tan(problem.planning_cone_angle)
    elif settings.angle_limit == 'angle':
        widest = settings.max_pushing_angle
    dynamic = settings.motion_model == 'dynamic'
    key = TurnKey(tuple(problem.push_parameters.column()), offset,
                  settings.pushing_speed ** 2 if dynamic else 0.0)
    found = steady_turns(key).limits(slope, widest, offset)
    if found is None or not (found[0].curvature > 0.0 > found[1].curvature):
        return None
    if dynamic and settings.pushing_speed > FASTEST_TIGHT:
        return tuple(SteadyTurn(GENTLE * turn.steering_angle, GENTLE * turn.w) for turn in found)
    return found


def _vehicle_turn(vehicle, curvature):
    steering_angle = -math.atan(vehicle.wheelbase * curvature)
    return SteadyTurn(steering_angle, curvature * math.cos(steering_angle))


def routes(problem, turns):
    """
    Rank the ways to the goal, cheapest first.

    Run-ins are shortened where the full one forces a detour.

    :param problem: the ``PushProblem``.
    :param turns: ``SteadyTurn`` (to the left, to the right).
    :return: list of ``Route``.
    """
    full = problem.settings.final_straight
    shortest = min(SHORTEST_RUN_IN, full)
    found, least = _routes(problem, turns, full), _routes(problem, turns, shortest)
    if found[0].path_length > DETOUR * least[0].path_length:
        found = least + [route for share in SHORTER if share * full > shortest
                         for route in _routes(problem, turns, share * full)]
        best = min(route.path_length for route in found)
        near = [route for route in found if route.path_length <= DETOUR * best]
        longest = max(route.final_straight for route in near)
        near.sort(key=lambda route: (route.final_straight < longest, route.path_length))
        rest = [route for route in found if route.path_length > DETOUR * best]
        return near + sorted(rest, key=lambda route: route.path_length)
    return found + [route for route in least if full > shortest]


def route_along(problem, pieces, max_deviation):
    """
    Make a route of given pieces; the last is straight, and its end the run-in.

    :param problem: the ``PushProblem``; it can steer both ways.
    :param pieces: (length [m], signed curvature [1/m]) of each.
    :param max_deviation: how far from it along either axis a plan may be [m].
    :return: ``Route``.
    """
    view, final_straight = problem.vehicle, problem.settings.final_straight
    pieces = [*pieces[:-1], (pieces[-1][0] - final_straight, 0.0)]
    pieces = [piece for piece in pieces if piece[0] > 0.0]
    sharpest, turns = tightest_turns(problem), []
    for _, curvature in pieces:
        turn = sharpest[0 if curvature > 0.0 else 1]
        steering_angle = math.atan(math.tan(turn.steering_angle) * curvature / turn.curvature)
        turns.append(SteadyTurn(steering_angle, curvature * math.cos(steering_angle)))
    lengths, curvatures = zip(*pieces)
    word = ''.join('S' if c == 0.0 else 'L' if c > 0.0 else 'R' for c in curvatures)
    path = DubinsPath(Pose(*view.flat_output, view.angle), word, lengths, curvatures)
    path_length = final_straight + sum(length / math.cos(turn.steering_angle) for length, turn in zip(lengths, turns))
    return Route(path, tuple(turns), final_straight, path_length, max_deviation)


def _routes(problem, turns, final_straight):
    vehicle = problem.vehicle
    flat = Pose(*vehicle.flat_output, vehicle.angle)
    goal = problem.relative_goal @ flat
    left, right = turns
    kinds = {1.0: left, 0.0: SteadyTurn(0.0, 0.0), -1.0: right}
    found = []
    for heading in _headings(problem, goal):
        end = goal._replace(theta=heading) @ Pose(-final_straight, 0.0, 0.0)
        for path in dubins_paths(flat, end, 1.0 / left.curvature, -1.0 / right.curvature):
            pieces = tuple(kinds[math.copysign(1.0, c) if c else 0.0] for c in path.curvatures)
            path_length = final_straight + sum(length / math.cos(turn.steering_angle)
                                               for length, turn in zip(path.lengths, pieces))
            found.append(Route(path, pieces, final_straight, path_length))
    return sorted(found, key=lambda route: route.path_length)


def _headings(problem, goal):
    if not problem.settings.heading_free:
        return [goal.theta]
    # Any heading will do: the direction of the goal, and some to either side.
    bearing = math.atan2(goal.y, goal.x)
    return [bearing + turn for turn in np.linspace(-math.pi, math.pi, 16, endpoint=False)]
