"""
First guesses: the pushed object as a vehicle that follows a Dubins path of its flat point z.

The contact steers by ``chi = psi - atan(L kappa)``; along the way of z the contact goes
``sqrt(1 + (L kappa)^2)`` times as far.
"""

import math
from typing import NamedTuple

import numpy as np

from push_model.dubins import DubinsPath, words
from push_model.geometry import Pose
from push_planner.iterate import RUN_IN_STEPS, Solution
from push_planner.stage import NODE, POINTS, radau

FASTEST_TIGHT = 0.5
SHORTER = (1.0, 0.5, 0.25, 0.1, 0.0)
DETOUR = 1.2
EXCESS = 0.05
SHORTEST_RUN_IN = 0.02


class Route(NamedTuple):
    """
    A way for the flat point, with what it costs.

    :param path: ``DubinsPath`` of z, in the world, up to the run-in.
    :param run_in: straight way after it [m].
    :param cost: way of the contact, run-in included [m].
    """

    path: DubinsPath
    run_in: float
    cost: float


def curvature_limits(problem):
    """
    Curvatures of z that can be held within the planning cone, by the vehicle view.

    A differential drive: ``(D -+ beta) / (r + R_p)``, since its normal follows the turn; a held
    normal: ``(-zeta -+ beta) r / c^2``.

    :param problem: the ``PushProblem``.
    :return: (lowest, highest) curvature [1/m]; negative is to the right.
    """
    vehicle, beta = problem.vehicle, problem.planning_angle
    if problem.robot.drive == 'differential':
        reach = vehicle.arm + problem.robot.radius
        middle = problem.heading_offset
    else:
        reach, middle = vehicle.mean_square / vehicle.arm, -problem.normal_offset
    return (middle - beta) / reach, (middle + beta) / reach


def routes(problem):
    """
    Rank the ways to the goal.

    Ways that turn alike lead to the same optimum; of those, one is kept per run-in, the longest
    run-in first that does not force a detour. Turns are ranked by their cheapest way.

    :param problem: the ``PushProblem``.
    :return: list of ``Route``.
    """
    alike = {}
    for share in SHORTER:
        run_in = max(share * problem.settings.run_in, SHORTEST_RUN_IN)
        seen = set()
        for route in _routes(problem, run_in):
            turn = sum(a * b for a, b in zip(route.path.lengths, route.path.curvatures))
            turns = round((turn + problem.start.theta - problem.goal.theta) / (2.0 * math.pi))
            if turns not in seen:
                seen.add(turns)
                alike.setdefault(turns, []).append(route)
    ranked = []
    for group in sorted(alike.values(), key=lambda group: min(route.cost for route in group)):
        best = min(route.cost for route in group)
        ranked += [route for route in group if route.cost <= DETOUR * best]
    return ranked


def guess(problem, route, segments):
    """
    Turn a route into an iterate of the programme.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :param segments: N.
    :return: ``Solution``.
    """
    vehicle = problem.vehicle
    ways, places = _contact_ways(route, vehicle.wheelbase)
    way = ways[-1]
    ends = np.concatenate([np.linspace(0.0, way, segments + 1)[1:],
                           way + route.run_in * np.arange(1, RUN_IN_STEPS + 1) / RUN_IN_STEPS])
    begins = np.concatenate([[0.0], ends[:-1]])
    nodes = np.empty((len(ends), len(NODE)))
    rates = np.empty((len(ends), POINTS))
    angles = np.empty(len(ends))
    gamma = problem.normal
    for i, (begin, end) in enumerate(zip(begins, ends)):
        pose, curvature = _at(route, 0.5 * (begin + end), ways, places)
        direction = pose.theta - math.atan(vehicle.wheelbase * curvature)
        if problem.robot.drive == 'differential':
            angles[i], change = _follow(problem, direction, gamma - problem.heading_offset,
                                        end - begin)
            gamma += change
        else:
            angles[i] = direction - pose.theta - problem.normal_offset
        points = begin + (end - begin) * radau()[0]
        for j, point in enumerate(points):
            pose, curvature = _at(route, point, ways, places)
            rates[i, j] = curvature / math.sqrt(1.0 + (vehicle.wheelbase * curvature) ** 2)
        theta = pose.theta - vehicle.angle
        if problem.robot.drive == 'holonomic':
            gamma = pose.theta + problem.normal_offset
        z_x, z_y = Pose(0.0, 0.0, theta).rotate(vehicle.flat_point)
        nodes[i] = pose.x - z_x, pose.y - z_y, theta, rates[i, -1], gamma
    return Solution(way, EXCESS, angles[:segments], nodes, rates)


def _routes(problem, run_in):
    vehicle = problem.vehicle
    lowest, highest = curvature_limits(problem)
    fast = problem.settings.pushing_speed > FASTEST_TIGHT
    # Inertia takes a share of the cone where the normal is held and turns are tight.
    gentle = 0.7 if fast and problem.robot.drive == 'holonomic' else 1.0
    z_start = problem.start @ Pose(*vehicle.flat_point, vehicle.angle)
    z_goal = problem.goal @ Pose(*vehicle.flat_point, vehicle.angle) @ Pose(-run_in, 0.0, 0.0)
    found = []
    for path in words(z_start, z_goal, 1.0 / (gentle * highest), -1.0 / (gentle * lowest)):
        cost = run_in + sum(length * math.sqrt(1.0 + (vehicle.wheelbase * curvature) ** 2)
                            for length, curvature in zip(path.lengths, path.curvatures))
        found.append(Route(path, run_in, cost))
    return sorted(found, key=lambda route: route.cost)


def _contact_ways(route, wheelbase):
    ways, places = [0.0], [0.0]
    for length, curvature in zip(route.path.lengths, route.path.curvatures):
        places.append(places[-1] + length)
        ways.append(ways[-1] + length * math.sqrt(1.0 + (wheelbase * curvature) ** 2))
    return ways, places


def _at(route, way, ways, places):
    if way > ways[-1]:
        return route.path.at(places[-1] + way - ways[-1])
    return route.path.at(np.interp(way, ways, places))


def _follow(problem, direction, heading, length):
    """Let a differential drive's heading settle on the direction of the push."""
    reach = problem.robot.radius * math.cos(problem.heading_offset)
    change = (direction - heading) * (1.0 - math.exp(-length / reach))
    steer = max(-0.9, min(0.9, change * reach / length))
    return math.asin(steer) - problem.heading_offset, change
