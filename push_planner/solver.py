"""From problem to plan."""

import math

import numpy as np

from push_model.contact import normal_range
from push_model.dynamics import SMOOTHING
from push_model.geometry import wrap_angle
from push_planner.iterate import Bounds, Ends
from push_planner.plan import Plan
from push_planner.problem import PlanningFailed
from push_planner.refinement import refine
from push_planner.refusals import refuse_impossible
from push_planner.sampling import report_of, switches_of, trajectory_of
from push_planner.stage import Constants
from push_planner.transcription import programme
from push_planner.warm_start import guess, routes

ROUTES = 12
VERTEX_RESERVE = 0.02
SEGMENT_STEP = 8


def plan(problem):
    """
    Find the quickest push to the goal that keeps to the planning cone.

    :param problem: the ``PushProblem``.
    :return: ``Plan``, re-integrated to the goal.
    :raises PlanningFailed: with the reason, where there is none or none was found.
    """
    refuse_impossible(problem)
    ranked, longest = routes(problem), problem.settings.max_path_length
    if ranked[0].cost > longest:
        raise PlanningFailed(
            f'the shortest way to the goal is a push of {ranked[0].cost:.1f} m, at most '
            f'{longest:g} m is accepted; another contact may be nearer',
            {'path_length': ranked[0].cost})
    attempts = []
    for route in [route for route in ranked if route.cost <= longest][:ROUTES]:
        found, attempt = _try(problem, route)
        attempts.append(attempt)
        if found is not None:
            found.report['attempts'] = attempts
            return found
    raise PlanningFailed('no push within the friction cone and the limits of the robot was found '
                         f'on {len(attempts)} ways that were tried, the first {attempts[0]}',
                         {'attempts': attempts})


def _try(problem, route):
    settings = problem.settings
    segments = max(settings.segments,
                   SEGMENT_STEP * math.ceil(route.cost / settings.segment_length / SEGMENT_STEP))
    solver = programme(problem.robot.drive, len(problem.obj.supports), segments)
    ends = _ends(problem, route)
    solution, verdict, iterations = solver.solve(Constants.of(problem), _bounds(problem), ends,
                                                 guess(problem, route, segments))
    name = f'{route.path.word} of {route.cost:.2f} m'
    if solution is None:
        return None, f'{name}: {verdict}'
    driven = refine(problem, solution, ends, SMOOTHING / settings.pushing_speed)
    switches = switches_of(problem, driven)
    found = Plan(problem, trajectory_of(problem, driven),
                 tuple(float(angle) for angle, _, _ in driven),
                 tuple(np.cumsum([length for _, length, _ in driven]).tolist()),
                 switches, report_of(problem, driven, switches))
    found.report.update(word=route.path.word, segments=segments, run_in=route.run_in,
                        iterations=iterations)
    check = found.verify()
    found.report.update(check._asdict())
    fault = _fault(check, settings)
    return (None, f'{name}: {fault}') if fault else (found, f'{name}: solved')


def _fault(check, settings):
    if not check.position_error <= settings.position_tolerance:
        return f're-integration misses the goal by {1e3 * check.position_error:.2f} mm'
    if not check.heading_error <= settings.heading_tolerance:
        return f're-integration misses the goal by {math.degrees(check.heading_error):.2f} deg'
    if not check.friction_usage <= 1.0:
        return f'the contact force leaves the friction cone by a factor {check.friction_usage:.2f}'
    return ''


def _ends(problem, route):
    vehicle, drive = problem.vehicle, problem.robot.drive
    reached = route.path.at(route.path.length)[0].theta - vehicle.angle
    theta = reached + wrap_angle(problem.goal.theta - reached)
    offset = problem.heading_offset if drive == 'differential' else problem.normal_offset
    # The normal's angle is unwrapped from the push direction at the start.
    start_normal = problem.push_direction + problem.normal_offset
    return Ends((*problem.start, start_normal), (problem.goal.x, problem.goal.y, theta,
                                                 theta + vehicle.angle + offset),
                route.run_in, -offset)


def _bounds(problem):
    settings, robot = problem.settings, problem.robot
    low, high = -math.inf, math.inf
    if robot.drive == 'differential':
        angle = problem.vehicle.angle
        low, high = (angle + wrap_angle(limit - angle)
                     for limit in normal_range(problem.obj, problem.contact))
        low, high = low + VERTEX_RESERVE, high - VERTEX_RESERVE
    return Bounds(math.tan(problem.planning_angle), robot.max_speed / settings.pushing_speed,
                  robot.max_yaw_rate / settings.pushing_speed, max(low, -1e6), min(high, 1e6))
