"""Refinement: its backward and forward pass on a small linear-quadratic problem, and in use."""

import dataclasses
import math

from helpers.push_problems import DIFFERENTIAL, face_problem, HOLONOMIC, vertex_problem
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_planner.problem import PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.collocation.formulation import formulate, Formulation
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.collocation.solution import Solution
from push_planner.steered.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.steered.integration.refinement import goal_miss, refine, RefinedPush, SMALL_MISS
from push_planner.steered.integration.rollout import RolloutMemory
from push_planner.steered.integration.steering import (
    CHANGE_COST, FEEDBACK_END_WEIGHTS, FREE_LENGTH_COST, SteeringMemory, STRAIGHT_END_WEIGHTS,
    WEIGHTS)
from push_planner.steered.integration.step_division import PartCounts
import pytest

STEPS = 5


@pytest.fixture(name='maps')
def make_maps():
    """Draw the maps (A_k, b_k) of a linear system; S goes on as it is."""
    rng = np.random.default_rng(11)
    maps = np.zeros((STEPS, 7, 8))
    maps[:, :6, :6] = np.eye(6) + 0.3 * rng.normal(size=(STEPS, 6, 6))
    maps[:, :6, 6:] = rng.normal(size=(STEPS, 6, 2))
    maps[:, 6, 6] = 1.0
    return maps


def trajectory(maps, free_length, changes):
    """Run the linear system from a deviation of S alone; shape (n + 1, 7)."""
    states = [np.array([0.0] * 6 + [free_length])]
    for step, change in zip(maps, changes):
        states.append(step @ np.append(states[-1], change))
    return np.array(states)


def cost(maps, unknowns, miss):
    """Sum up what the feed-forward minimises."""
    free_length, changes = unknowns[0], unknowns[1:]
    states = trajectory(maps, free_length, changes)
    along = sum(state @ WEIGHTS @ state for state in states[:-1])
    end = states[-1] + miss
    return (along + CHANGE_COST * changes @ changes + FREE_LENGTH_COST * free_length ** 2
            + states[-1] @ FEEDBACK_END_WEIGHTS @ states[-1] + STRAIGHT_END_WEIGHTS @ end ** 2)


def solved(maps: FloatArray) -> SteeringMemory:
    """Solve the problem of some steps but for the miss."""
    steering = SteeringMemory(len(maps))
    steering.maps[:], steering.end_weights[:] = maps, STRAIGHT_END_WEIGHTS
    steering.solve()
    return steering


def test_the_feed_forward_finds_the_optimum_of_the_quadratic(maps):
    """A step to any side from what it finds costs more, by the same to either side."""
    miss = np.array([0.0, 0.01, -0.02, 0.03, -0.01, 0.02, 0.0])
    steering = solved(maps)
    steering.miss[:] = miss
    steering.correct()
    # In closed loop: the gains act on the deviations that the correction itself brings about.
    states = [np.append(np.zeros(6), steering.free_length)]
    changes = []
    for k, step in enumerate(maps):
        deviation = states[-1].copy()
        # The feed-forward has the response to S in it already.
        deviation[6] = 0.0
        changes.append(steering.changes[k, 0] - steering.present.gains[k] @ deviation)
        states.append(step @ np.append(states[-1], changes[-1]))
    found = np.append(steering.free_length, changes)
    least = cost(maps, found, miss)
    for direction in np.eye(STEPS + 1):
        one, other = (cost(maps, found + sign * 1e-3 * direction, miss) for sign in (-1.0, 1.0))
        assert one > least and other > least
        assert one - least == pytest.approx(other - least, rel=1e-6)


def test_no_miss_needs_no_correction(maps):
    steering = solved(maps)
    steering.correct()
    assert not steering.free_length.any() and not steering.changes.any()


def test_values_are_symmetric_and_not_negative(maps):
    for value in solved(maps).values:
        np.testing.assert_allclose(value, value.T, rtol=1e-6, atol=1e-6)
        assert np.linalg.eigvalsh(0.5 * (value + value.T)).min() > -1e-6


@pytest.fixture(name='push', scope='module')
def make_push():
    """Solve the program of a push, and refine it: (problem, formulation, solution, refined)."""
    problem = face_problem(Pose(1.5, 0.4, 0.5))
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    solution = push_solver(formulation.dimensions).solve(formulation, guess).solution
    return problem, formulation, solution, refine(problem, formulation, solution)


def test_the_feedback_is_as_strong_along_the_push_as_at_its_end(push):
    """The goal is met by the feed-forward, from far away, and not by the last changes."""
    *_, refined = push
    gains = np.abs(refined.steering.gains[:, 2:5]).max(axis=1)
    assert gains.max() < 2.0 * np.median(gains)


def test_a_refined_push_ends_at_its_goal(push):
    """Within 20 um of the goal, where the program's own steps are millimetres off."""
    _, formulation, solution, refined = push
    miss = goal_miss(formulation, refined.rollout.nodes[-1])
    assert np.abs(miss[2:5]).max() < SMALL_MISS
    assert refined.free_length == pytest.approx(solution.free_length, abs=0.02)
    samples = refined.rollout.samples
    assert refined.rollout.s[-1] == pytest.approx(
        formulation.mesh.step_lengths(refined.free_length).sum())
    np.testing.assert_allclose(samples[-1], refined.rollout.nodes[-1], atol=1e-12)


def test_checks_are_of_all_samples(push):
    """As numpy finds them in the samples that the rollout keeps."""
    *_, refined = push
    rollout, checks = refined.rollout, refined.checks
    assert checks.is_sound
    normal, tangential = np.concatenate([rollout.forces, rollout.step_forces]).T
    assert checks.force_ratio == pytest.approx(np.abs(tangential / normal).max(), rel=1e-9)
    assert checks.least_v_squared == pytest.approx(rollout.v_squared.min())
    assert 0.0 < checks.least_length < rollout.s[-1]
    end = push[0].relative_goal
    assert refined.end_error.position_error < SMALL_MISS
    assert refined.end_error.heading_error == pytest.approx(
        abs(rollout.nodes[-1, 2] - end.theta), abs=1e-12)


def test_samples_are_those_of_the_push_that_is_kept():
    """Also where the correction after it, of a bin that turns about a support, makes it worse."""
    friction = (0.507, 0.281, 0.434)
    bin_ = PushedObject(2.315, supports=tuple(
        Support(0.1827 * math.cos(angle), 0.1827 * math.sin(angle), mu)
        for angle, mu in zip((0.0, 2.1, 4.2), friction)), radius=0.22835)
    problem = PushProblem(
        bin_, RoundRobot(0.17, 'holonomic'), Contact('round', 0, -1.648), Pose(0.0, 0.0, 0.0),
        math.pi - 1.648, math.pi - 1.648, Pose(0.01646, -0.69748, -2.48488),
        PlannerSettings(pushing_speed=0.25, final_straight=0.0, deceleration=0.0))
    refined = []
    for route in routes(problem, tightest_turns(problem)):
        formulation, guess = formulate(problem, route)
        result = push_solver(formulation.dimensions).solve(formulation, guess)
        refined.append(result.solution and refine(problem, formulation, result.solution))
    kept = [push.rollout for push in refined if push]
    assert len(kept) > 3
    for rollout in kept:
        np.testing.assert_allclose(rollout.samples[-1], rollout.nodes[-1], atol=1e-12)


def whip() -> tuple[PushProblem, Formulation, Solution]:
    """Solve a push whose last steps turn the object sharply, about one of its supports."""
    corners = ((-0.34129, -0.20137), (0.34129, -0.20137), (0.34129, 0.20137), (-0.34129, 0.20137))
    box = PushedObject(2.7128, supports=tuple(Support(x, y, mu) for (x, y), mu in zip(
        corners, (0.29913, 0.37949, 0.47730, 0.45410))), outline=corners)
    heading = math.atan2(0.24, 0.374)
    robot = RoundRobot(0.1, 'differential', max_speed=5.0, max_yaw_rate=50.0,
                       max_acceleration=100.0, max_yaw_acceleration=1000.0)
    problem = PushProblem(
        box, robot, Contact('vertex', 0), Pose(0.0, 0.0, 0.0), heading, heading,
        Pose(0.17337, -1.40254, 0.60840),
        PlannerSettings(pushing_speed=0.1, final_straight=0.0, deceleration=0.0,
                        max_path_length=100.0))
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    solution = push_solver(formulation.dimensions).solve(formulation, guess).solution
    assert solution is not None
    return problem, formulation, solution


def test_a_force_that_peaks_between_samples_is_found() -> None:
    """
    It is as large as with samples that are ten times as near.

    The box turns about one of its supports for a centimetre, where the drive steers back.
    """
    corners = ((-0.322049, -0.397349), (0.322049, -0.397349), (0.322049, 0.397349),
               (-0.322049, 0.397349))
    box = PushedObject(8.452449, supports=tuple(Support(x, y, mu) for (x, y), mu in zip(
        corners, (0.581553, 0.413615, 0.331497, 0.686383))), outline=corners)
    robot = RoundRobot(0.17, 'differential', max_speed=5.0, max_yaw_rate=50.0,
                       max_acceleration=100.0, max_yaw_acceleration=1000.0)
    settings = PlannerSettings(pushing_speed=0.25, final_straight=0.0, deceleration=0.0)
    problem = PushProblem(box, robot, Contact('vertex', 0), Pose(0.0, 0.0, 0.0), 1.035318,
                          1.035318, Pose(-2.494232, 1.769459, -0.886947), settings)
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    solution = push_solver(formulation.dimensions).solve(formulation, guess).solution
    assert solution is not None
    coarse, fine = (
        refine(dataclasses.replace(problem, settings=dataclasses.replace(
            settings, sample_spacing=spacing)), formulation, solution)
        for spacing in (0.015, 0.0015))
    assert coarse is not None and fine is not None
    assert coarse.checks.force_ratio > box.contact_friction_coefficient
    assert coarse.checks.force_ratio == pytest.approx(fine.checks.force_ratio, rel=0.01)


def test_a_push_that_ends_in_a_sharp_turn_is_refined() -> None:
    """
    It meets the goal, and its contact force stays within the cone of friction.

    Coarse parts and very fine ones lead there as well: where Newton's method fails, they are
    divided.
    """
    problem, formulation, solution = whip()
    refined = refine(problem, formulation, solution)
    assert refined is not None
    nodes = refined.rollout.nodes
    assert np.abs(goal_miss(formulation, nodes[-1])[2:5]).max() < SMALL_MISS
    assert refined.checks.force_ratio < problem.obj.contact_friction_coefficient
    for spacing, coarse in ((0.015, True), (0.0015, False)):
        again = followed(problem, formulation, refined, spacing, coarse)
        np.testing.assert_allclose(again, nodes, atol=1e-3)


def followed(problem: PushProblem, formulation: Formulation, refined: RefinedPush, spacing: float,
             coarse: bool) -> FloatArray:
    """Follow a refined push in parts of other lengths; return the nodes."""
    dimensions, rollout = formulation.dimensions, refined.rollout
    settings = dataclasses.replace(problem.settings, sample_spacing=spacing)
    counts = PartCounts.of(dataclasses.replace(problem, settings=settings),
                           formulation.mesh.step_lengths(refined.free_length), rollout.changes,
                           dimensions.jumps)
    # Room for the parts of those that fail.
    memory = RolloutMemory(
        dimensions, counts.doublings + 1, problem.push_parameters.column(),
        refined.steering.gains, rollout.changes[:, None], np.array([refined.free_length]))
    memory.load(formulation, counts)
    memory.nodes[:], memory.first_state[:] = rollout.nodes, rollout.nodes[0]
    memory.follow_divided(coarse)
    return memory.nodes


@pytest.mark.parametrize('robot', [HOLONOMIC, DIFFERENTIAL], ids=lambda robot: robot.drive)
def test_what_misses_a_straight_end_is_a_deviation_of_the_last_node(robot):
    """Taken off, the end is straight at the goal: also the pushing angle, once all rotate back."""
    problem = vertex_problem(Pose(2.2, 1.0, 0.4), robot)
    formulation, _ = formulate(problem, routes(problem, tightest_turns(problem))[0])
    assert formulation.dimensions.straight_end
    last = np.array([0.0, 0.03, problem.relative_goal.theta + 0.02, 2.0, 1.3, 0.05])
    if robot is HOLONOMIC:
        last[5] = last[2]
    miss = goal_miss(formulation, last)[:6]
    assert abs(miss[1]) > 0.01 and abs(miss[2]) > 0.01
    if robot is HOLONOMIC:
        miss[5] = miss[2]
    left = goal_miss(formulation, last - miss)
    # All but the position, which is a deviation of the first order in the rotation.
    np.testing.assert_allclose(left[[0, 1, 2, 5]], 0.0, atol=1e-12)
    np.testing.assert_allclose(left[3:5], 0.0, atol=1e-3)
