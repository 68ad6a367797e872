"""Initial guess: the motion along a route of arcs and straights."""

import math

from helpers.push_problems import face_problem, vertex_problem
import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_planner.steered.initial_guess.dubins_routes import (
    choose_various, routes, shortest_length,
)
from push_planner.steered.planner import plan_push, steering_limits
import pytest
from studies.analysis.steering import steering_range

PROBLEM = face_problem(Pose(1.5, 0.9, 1.2), final_straight=0.3)
ROUTES = routes(PROBLEM, steering_limits(PROBLEM))
# At 1 m/s no push to this goal is as short as the straight way.
NEAR_AND_FAST = face_problem(
    Pose(0.494, -0.023, -0.126), RoundRobot(0.17, 'holonomic', max_speed=5.0, max_yaw_rate=50.0,
                                            max_acceleration=100.0),
    pushing_speed=1.0, deceleration=0.0)
POINTS = np.array([1.0 / 3.0, 1.0])


def guess(route, count=40):
    return route.guess(PROBLEM, np.full(count, route.path_length / count), POINTS)


@pytest.mark.parametrize('route', ROUTES, ids=lambda route: route.name)
def test_the_flat_output_follows_the_path(route):
    """At the nodes, where the contact covers 1 / cos(alpha) times the length of the path."""
    nodes = guess(route).nodes
    vehicle, contact = PROBLEM.vehicle, PROBLEM.contact_point
    factors = [1.0 / math.cos(turn.steering_angle) for turn in route.turns] + [1.0]
    lengths = [*route.path.lengths, route.final_straight]
    contact_ends = np.append(0.0, np.cumsum(np.multiply(lengths, factors)))
    path_ends = np.append(0.0, np.cumsum(lengths))
    for s, (_, _, theta, q_x, q_y, _) in zip(np.linspace(0.0, route.path_length, 41), nodes):
        expected, _ = route.path.at(float(np.interp(s, contact_ends, path_ends)))
        origin = Pose(q_x, q_y, theta) @ Pose(-contact[0], -contact[1], 0.0)
        flat_output = Pose(*origin.transform(vehicle.flat_output), theta + vehicle.angle)
        np.testing.assert_allclose(flat_output[:2], expected[:2], atol=1e-9)
        assert wrap_angle(flat_output.theta - expected.theta) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('goal', [
    Pose(1.5, 0.9, 1.2), Pose(-0.8, 0.3, -2.0), Pose(0.2, -0.4, 3.0)])
def test_with_any_heading_at_the_goal_each_word_is_tried_once(goal: Pose) -> None:
    """At its best heading, the shortest word first."""
    problem = face_problem(goal, heading_free=True, final_straight=0.0)
    turns = steering_limits(problem)
    found = routes(problem, turns)
    words = [route.name for route in found]
    assert len(words) == len(set(words)) >= 4
    lengths = [route.path_length for route in found]
    assert lengths == sorted(lengths)
    assert lengths[0] == pytest.approx(shortest_length(problem, turns, 0.0), abs=1e-9)


def test_steering_is_that_of_the_turns_averaged_over_a_step():
    """Constant inside a turn, and in the middle between two turns at the border of both."""
    route = ROUTES[0]
    factors = [1.0 / math.cos(turn.steering_angle) for turn in route.turns]
    ends = np.cumsum(np.multiply(route.path.lengths, factors))
    nodes, rates = guess(route, 200)
    s = np.linspace(0.0, route.path_length, 201)
    width = route.path_length / 200
    for begin, end, turn in zip(np.append(0.0, ends), ends, route.turns):
        inside = (s > begin + width) & (s < end - width)
        assert inside.any()
        np.testing.assert_allclose(nodes[inside, 0], turn.w, atol=1e-9)
    jumps = np.interp(s, *_steps(ends, [turn.w for turn in route.turns], width))
    np.testing.assert_allclose(nodes[1:-1, 0], jumps[1:-1], atol=1e-9)
    np.testing.assert_allclose(rates[:-1, 1], nodes[1:-1, 0], atol=1e-9)


def _steps(ends, values, width):
    """Points of a polyline that goes from value to value over the width, at each end."""
    values = [*values, 0.0]
    at = [point for end in ends for point in (end - 0.5 * width, end + 0.5 * width)]
    return at, [value for pair in zip(values, values[1:]) for value in pair]


@pytest.mark.parametrize('count', [3, 12, 40])
def test_routes_are_chosen_for_variety(count: int) -> None:
    """As many words as there are are tried, in their order, and none twice before all others."""
    ranked = routes(NEAR_AND_FAST, steering_limits(NEAR_AND_FAST))
    chosen = choose_various(ranked, count)
    assert len(ranked) > 12 and len(chosen) == min(count, len(ranked))
    places = [ranked.index(route) for route in chosen]
    assert places == sorted(set(places))
    words = {route.name for route in ranked}
    assert len({route.name for route in chosen}) == min(count, len(words))


def test_a_near_goal_of_a_fast_push_is_reached_by_a_whole_turn() -> None:
    """A dozen shorter routes, with straight ends of all lengths, lead to no push."""
    found = plan_push(NEAR_AND_FAST)
    assert abs(found.trajectory.object_poses[-1, 2] - NEAR_AND_FAST.goal.theta) > math.pi
    assert found.report['position_error'] < 1e-4


@pytest.mark.parametrize('heading', [0.0, 0.1])
@pytest.mark.parametrize('speed', [0.6, 1.0])
def test_turns_of_a_fast_differential_drive_are_as_sharp_as_the_contact_bears(
        speed: float, heading: float) -> None:
    """As the root of an independent search over steady pushes of object and robot."""
    robot = RoundRobot(0.17, 'differential', max_speed=5.0, max_yaw_rate=50.0)
    problem = vertex_problem(Pose(1.0, 1.0, 1.0), robot, heading=heading, pushing_speed=speed,
                             cone_margin=1.0, friction_discount=1.0)
    found = steering_range(problem.obj, problem.contact, robot, speed, problem.heading_offset)
    assert found is not None
    curvatures = [turn.curvature for turn in steering_limits(problem)]
    # The turns are interpolated in a table.
    assert sorted(curvatures) == pytest.approx(
        sorted(push.curvature for push in found), rel=0.02)
