"""The nonlinear program's algebra: its integration, its start, its optimum."""

import math
from typing import NamedTuple

from helpers.push_problems import DIFFERENTIAL, face_problem, HOLONOMIC, vertex_problem
import numpy as np
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_planner.steered.collocation.collocation import contact_impulse, Node, radau
from push_planner.steered.collocation.dimensions import Constraint
from push_planner.steered.collocation.formulation import formulate
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.steered.integration.rollout_functions import part_function
from push_planner.steered.integration.step_division import graded_fractions, settling_distance
import pytest

GOAL = Pose(1.5, 0.5, 0.0)
ROBOTS = pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=lambda r: r.drive)


class Driven(NamedTuple):
    """Node after a step, samples of the nodes, forces at the samples, and that at the start."""

    end: np.ndarray
    samples: np.ndarray
    forces: np.ndarray
    first_force: np.ndarray


def drive(problem, change, length, count, smoothing=1e-3, jumps=False, angle=0.12):
    """Drive one step from rest in equal parts."""
    parameters = problem.push_parameters
    x, y = problem.contact_point
    rest = Node(0.0, angle, 0.0, x, y)
    begin = rest._replace(w=float(contact_impulse(problem.kind, parameters, rest).w_jump))
    states = np.zeros((count + 1, 8))
    states[0, :6] = begin
    v_squared = problem.settings.pushing_speed ** 2
    steps = np.array([[*begin, *np.zeros(6), change, length, v_squared, 0.0, smoothing]])
    parts = np.column_stack([np.full(count, 1.0 / count), np.arange(count) / count])
    samples, unused = np.zeros((count, 18)), np.zeros((count, 6))
    forces, first_forces = np.zeros((count, 6)), np.zeros((count, 2))
    part_function(problem.kind, parameters.supports, jumps).bind({
        'state': states[:-1], 'step': steps, 'part': parts, 'restarts': np.zeros(1),
        'column': parameters.column(), 'next_state': states[1:], 'start': unused,
        'samples': samples, 'forces': forces, 'first_force': first_forces,
        'residual': np.zeros((count, 1))}, np.zeros(count, dtype=int))()
    return Driven(states[-1, :6], samples.reshape(-1, 6), forces.reshape(-1, 2), first_forces[0])


@pytest.mark.parametrize('points', [2, 3])
def test_radau_integrates_polynomials_exactly(points):
    """To the points for degree K - 1, to the end for 2 K - 2."""
    c, matrix, inverse = radau(points)
    np.testing.assert_allclose(matrix @ inverse, np.eye(points), atol=1e-13)
    for degree in range(points):
        np.testing.assert_allclose(matrix @ c ** degree, c ** (degree + 1) / (degree + 1),
                                   atol=1e-14)
        high = degree + points - 1
        assert matrix[-1] @ c ** high == pytest.approx(1.0 / (high + 1))


@ROBOTS
@pytest.mark.parametrize('change', [0.0, 0.15])
def test_fine_integration_converges_fast(robot, change):
    """At least with the fourth power of the part, through the settling after the first touch."""
    problem = vertex_problem(GOAL, robot, pushing_speed=0.4)
    exact = drive(problem, change, 0.48, 192).end
    errors = [np.abs(drive(problem, change, 0.48, count).end - exact).max() for count in (12, 24)]
    assert errors[0] < 1e-4
    assert errors[1] < errors[0] / 16.0


@ROBOTS
@pytest.mark.parametrize('change', [0.0, 0.3, -0.3])
def test_the_force_at_the_begin_is_the_limit_of_that_soon_after(robot, change):
    """Half as far from it, it is half as far off."""
    problem = vertex_problem(GOAL, robot)
    soon, sooner = (drive(problem, change, 0.1, count) for count in (2000, 4000))
    off, half_as_far = (np.abs(run.forces[0] - run.first_force).max() for run in (soon, sooner))
    assert off < 0.02 * np.hypot(*soon.first_force)
    assert half_as_far == pytest.approx(0.5 * off, rel=0.05, abs=1e-9)


def test_two_jumps_are_one():
    """Impulses add up: a jump at once, or in two with no path between, is the same."""
    problem = vertex_problem(GOAL, HOLONOMIC, pushing_speed=0.4)
    node = Node(0.3, 0.1, 0.2, *problem.contact_point)

    def w_jump(begin, change):
        return float(contact_impulse('held', problem.push_parameters, begin, change).w_jump)

    in_two = w_jump(node, 0.1) + w_jump(node._replace(rho=0.2), 0.15)
    assert in_two == pytest.approx(w_jump(node, 0.25))


def test_settling_distance_is_that_of_the_integration():
    """After the first touch w nears its steady value by a factor e per settling distance."""
    problem = vertex_problem(GOAL, HOLONOMIC, pushing_speed=0.05)
    samples = drive(problem, 0.0, 0.01, 300, 1e-4, angle=1e-3).samples
    w, s = samples[2::3, 0], np.linspace(0.0, 0.01, 301)[1:]
    begin = float(contact_impulse('held', problem.push_parameters, Node(
        0.0, 1e-3, 0.0, *problem.contact_point)).w_jump)
    # Beyond the settling w grows slowly: the push is unstable.
    left = np.interp(settling_distance(problem), s, w) - w[-1]
    assert left / (begin - w[-1]) == pytest.approx(math.exp(-1.0), abs=0.05)


@pytest.mark.parametrize('length, first, longest', [(0.3, 0.001, 0.015), (0.01, 0.02, 0.015),
                                                    (0.0004, 0.001, 0.015), (1.0, 0.1, 0.1)])
def test_fractions_fill_the_step(length, first, longest):
    """They sum to 1, grow, and none is longer than allowed."""
    parts = graded_fractions(length, first, longest) * length
    assert parts.sum() == pytest.approx(length)
    assert (parts > 0.0).all() and parts.max() <= longest * (1.0 + 1e-12)
    assert parts[0] <= first * (1.0 + 1e-12)


@pytest.mark.parametrize('problem', [vertex_problem(Pose(2.0, 0.5, -0.5), DIFFERENTIAL),
                                     vertex_problem(GOAL, HOLONOMIC)],
                         ids=lambda problem: problem.kind)
def test_the_guess_nearly_follows_the_optimum(problem):
    """Its followed point and rotation move as the solved push does, to 0.2 m and 0.2 rad."""
    route = routes(problem, tightest_turns(problem))[0]
    formulation, guess = formulate(problem, route)
    solution = push_solver(formulation.dimensions).solve(formulation, guess).solution
    assert solution.free_length == pytest.approx(guess.free_length, rel=0.1)
    np.testing.assert_allclose(guess.nodes[:, 2:5], solution.nodes[:, 2:5], atol=0.2)
    np.testing.assert_allclose(guess.nodes[0, 2:], solution.nodes[0, 2:], atol=1e-3)


def test_the_relaxed_program_has_the_same_optimum():
    """Without any excess, where there is a push."""
    problem = face_problem(Pose(1.5, 0.4, 0.5))
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    solver = push_solver(formulation.dimensions)
    one = solver.solve(formulation, guess)
    other = solver.solve_relaxed(formulation, guess)
    assert one.failure is None and other.failure is None
    assert other.solution.free_length == pytest.approx(one.solution.free_length, abs=5e-4)


def test_the_relaxed_program_names_the_limit_that_is_exceeded():
    """A contact at the top speed of the robot, which drives on the outside of the turn."""
    problem = face_problem(Pose(1.5, 0.3, -0.6), pushing_speed=HOLONOMIC.max_speed)
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    found = push_solver(formulation.dimensions).solve_relaxed(formulation, guess)
    assert found.solution is None and found.failure is PlanFailure.LIMIT_EXCEEDED
    assert found.verdict.startswith(Constraint.SPEED.value + ' would be exceeded by')
