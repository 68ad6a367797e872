"""The solver of pushes: optimal, symmetric, and with an answer to every program."""

import math

from helpers.objects import box
from helpers.push_problems import (
    DIAGONAL, DIFFERENTIAL, face_problem, HOLONOMIC, MIRRORED_VERTEX, round_problem,
    vertex_problem)
from helpers.whole_program import first_program, WholeProgram
import numpy as np
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_planner.problem import PlannerSettings, PushProblem
from push_planner.steered.collocation.dimensions import BoundaryValues, Limits
from push_planner.steered.collocation.interior_point import (
    ATTEMPTS, BARRIER_ACCURACY, LAST_BARRIER, MAX_ITERATIONS, TOLERANCE)
from push_planner.steered.collocation.push_solver import push_solver
import pytest

GOAL, MIRRORED_GOAL = Pose(1.9, 0.7, -0.2), Pose(1.9, -0.7, 0.2)
ROLLED, MIRRORED_ROLLED = Pose(1.5, 0.05, 0.05), Pose(1.5, -0.05, -0.05)


def vertex_from_the_right(goal, robot):
    """Push the other vertex of the box, the mirror image of ``vertex_problem``."""
    return PushProblem(box(), robot, MIRRORED_VERTEX, Pose(0.0, 0.0, DIAGONAL), 0.0, 0.0, goal,
                       PlannerSettings())


# Name -> (problem, its mirror image).
PROBLEMS = {
    'held face': (face_problem(GOAL), face_problem(MIRRORED_GOAL)),
    'fast': (face_problem(GOAL, pushing_speed=1.0, final_straight=0.0),
             face_problem(MIRRORED_GOAL, pushing_speed=1.0, final_straight=0.0)),
    'rolling': (face_problem(ROLLED, robot_yaw='fixed', final_straight=0.0),
                face_problem(MIRRORED_ROLLED, robot_yaw='fixed', final_straight=0.0)),
    'jumps': (face_problem(GOAL, pushing_angles='constant'),
              face_problem(MIRRORED_GOAL, pushing_angles='constant')),
    'round': (round_problem(GOAL), round_problem(MIRRORED_GOAL)),
    'held vertex': (vertex_problem(GOAL, HOLONOMIC),
                    vertex_from_the_right(MIRRORED_GOAL, HOLONOMIC)),
    'differential': (vertex_problem(GOAL, DIFFERENTIAL),
                     vertex_from_the_right(MIRRORED_GOAL, DIFFERENTIAL))}
PUSHES = pytest.mark.parametrize('problem', [one for one, _ in PROBLEMS.values()], ids=PROBLEMS)
MIRRORED = pytest.mark.parametrize('problem, image', PROBLEMS.values(), ids=PROBLEMS)


def solve(formulation, guess):
    """Solve a program from a guess."""
    return push_solver(formulation.dimensions).solve(formulation, guess)


@pytest.mark.slow
@PUSHES
def test_it_finds_the_optimum_that_ipopt_finds(problem):
    """The same length within 2 mm, at most as far above it as the barrier costs."""
    formulation, guess = first_program(problem)
    solution = solve(formulation, guess).solution
    x, _ = WholeProgram(formulation.dimensions).ipopt(formulation, guess)
    optimum = type(solution).of_column(x, formulation.dimensions)
    assert solution.free_length == pytest.approx(optimum.free_length, abs=2e-3)
    np.testing.assert_allclose(solution.nodes[:, 2:5], optimum.nodes[:, 2:5], atol=2e-2)


@pytest.mark.slow
@PUSHES
def test_its_solution_fulfils_the_conditions_of_optimality(problem):
    """As casadi evaluates them: rows, stationarity, complementarity, multipliers' signs."""
    formulation, guess = first_program(problem)
    iterate = solve(formulation, guess).iterate
    whole = WholeProgram(formulation.dimensions)
    duals = whole.multipliers(iterate.dual)
    values = whole.evaluate(formulation, iterate.primal[:formulation.dimensions.variable_count],
                            duals)
    assert np.abs(values.equalities).max() < TOLERANCE
    assert values.inequalities.min() > -TOLERANCE
    stationarity = (values.gradient + values.equality_slopes.T @ duals.equalities
                    - values.inequality_slopes.T @ duals.inequalities)
    assert np.abs(stationarity).max() < TOLERANCE
    assert duals.inequalities.min() > 0.0
    excess = duals.inequalities * whole.slacks(iterate.primal)
    assert excess.max() < BARRIER_ACCURACY * LAST_BARRIER


@MIRRORED
def test_a_mirrored_push_has_the_mirrored_solution(problem, image):
    """In as many iterations: w, angles and what is aside have the opposite sign."""
    one, other = (solve(*first_program(side)) for side in (problem, image))
    assert one.iterations == other.iterations
    assert one.solution.free_length == pytest.approx(other.solution.free_length, abs=1e-8)
    signs = np.array([-1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    np.testing.assert_allclose(one.solution.nodes, signs * other.solution.nodes, atol=1e-6)
    np.testing.assert_allclose(one.solution.changes, -other.solution.changes, atol=1e-6)
    np.testing.assert_allclose(one.solution.rates, -other.solution.rates, atol=1e-6)


def test_the_mass_does_not_matter():
    """All forces grow with it."""
    light, heavy = (first_program(vertex_problem(GOAL, HOLONOMIC, obj=box(mass=mass)))
                    for mass in (2.0, 30.0))
    one, other = solve(*light).solution, solve(*heavy).solution
    np.testing.assert_allclose(one.nodes, other.nodes, atol=1e-5)
    assert one.free_length == pytest.approx(other.free_length, abs=1e-6)


def test_a_goal_straight_ahead_is_pushed_to_straight():
    """The guess is the solution; at it no angle matters to the first order."""
    formulation, guess = first_program(face_problem(Pose(1.0, 0.0, 0.0)))
    solution = solve(formulation, guess).solution
    np.testing.assert_allclose(solution.nodes[:, [0, 1, 2, 4]], 0.0, atol=1e-6)
    assert solution.free_length + formulation.mesh.fixed_length == pytest.approx(1.0, abs=1e-3)


def test_straight_pushes_leave_no_room_for_the_angle():
    """The interior of the program is a thousandth of a radian wide."""
    formulation, guess = first_program(face_problem(Pose(1.0, 0.0, 0.0)))
    bounds = formulation.bounds._replace(angle=1e-3, first_angle=(-1e-3, 1e-3))
    solution = solve(formulation._replace(bounds=bounds), guess).solution
    assert solution.free_length + formulation.mesh.fixed_length == pytest.approx(1.0, abs=1e-3)


@PUSHES
def test_a_bound_that_only_touches_the_optimum_changes_nothing(problem):
    """It is active with a multiplier of zero: the angle at the start may not be larger."""
    formulation, guess = first_program(problem)
    free = solve(formulation, guess).solution
    angle = float(free.nodes[0, 1])
    low, high = formulation.bounds.first_angle
    first = (angle, high) if angle < 0.0 else (low, angle)
    touched = formulation._replace(bounds=formulation.bounds._replace(first_angle=first))
    solution = solve(touched, guess).solution
    assert solution.free_length == pytest.approx(free.free_length, abs=2e-3)


def test_redundant_rows_that_bind_share_their_multiplier():
    """The bound on the first angle repeats that on all of them, once and as two equal rows."""
    problem = face_problem(GOAL, angle_limit='angle', max_pushing_angle=0.1)
    formulation, guess = first_program(problem)
    wide = formulation._replace(
        bounds=formulation.bounds._replace(first_angle=(-1.0, 1.0)))
    twice, once = solve(formulation, guess), solve(wide, guess)
    assert abs(once.solution.nodes[0, 1]) == pytest.approx(0.1, abs=2e-3)
    assert twice.solution.free_length == pytest.approx(once.solution.free_length, abs=1e-3)


def changed(formulation, part, **fields):
    """Replace some ``Limits`` or ``BoundaryValues`` of a program."""
    common = formulation.common.copy()
    boundary = len(common) - len(BoundaryValues._fields)
    first = boundary if part is BoundaryValues else boundary - len(Limits._fields)
    for name, value in fields.items():
        common[first + part._fields.index(name)] = value
    return formulation._replace(common=common)


def with_angle(formulation, angle):
    """Limit all pushing angles."""
    return formulation._replace(bounds=formulation.bounds._replace(
        angle=angle, first_angle=(-angle, angle)))


IMPOSSIBLE = {
    'angles that do not steer so far': lambda it: with_angle(it, 0.02),
    'next to no angle': lambda it: with_angle(it, 1e-3),
    'no room between bounds': lambda it: with_angle(it, 0.0),
    'bounds that exclude each other': lambda it: with_angle(it, -0.1),
    'a narrow cone': lambda it: changed(it, Limits, cone_slope=1e-3),
    'a cone that excludes all forces': lambda it: changed(it, Limits, cone_slope=-0.5),
    'a robot that stands': lambda it: changed(it, Limits, speed=0.0),
    'a goal aside': lambda it: changed(it, BoundaryValues, x=0.0, y=1.0),
    'a goal behind': lambda it: changed(it, BoundaryValues, x=-2.0, y=0.0),
    'a goal far off': lambda it: changed(it, BoundaryValues, x=1e6),
    'a goal that is no number': lambda it: changed(it, BoundaryValues, x=math.nan),
    'an infinite goal': lambda it: changed(it, BoundaryValues, y=math.inf),
    'a speed that is no number': lambda it: changed(it, Limits, speed=math.nan)}


@pytest.mark.parametrize('spoil', IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_what_has_no_solution_is_said_to_have_none(spoil):
    """After a bounded number of iterations; and the next program is solved as before."""
    formulation, guess = first_program(face_problem(Pose(1.5, 0.6, 0.2)))
    before = solve(formulation, guess)
    result = solve(spoil(formulation), guess)
    assert result.solution is None and result.iterate is None
    assert result.failure is PlanFailure.NOT_CONVERGED and result.verdict
    assert result.iterations <= len(ATTEMPTS) * MAX_ITERATIONS
    after = solve(formulation, guess)
    np.testing.assert_array_equal(after.iterate.primal, before.iterate.primal)


def test_it_gives_up_where_constraints_stay_violated():
    """A goal aside within pushing angles that do not steer so far: long before the limit."""
    formulation, guess = first_program(face_problem(Pose(1.5, 0.6, 0.2)))
    result = solve(with_angle(formulation, 0.05), guess)
    assert result.solution is None
    assert result.iterations < MAX_ITERATIONS


@pytest.mark.parametrize('value', [math.nan, math.inf, 1e200])
def test_a_guess_that_is_no_number_is_not_gone_on_from(value):
    formulation, guess = first_program(face_problem(GOAL))
    nodes = guess.nodes.copy()
    nodes[3, 2] = value
    result = solve(formulation, guess._replace(nodes=nodes))
    assert result.solution is None and result.failure is PlanFailure.NOT_CONVERGED


@pytest.mark.slow
def test_every_program_is_solved_or_refused():
    """Random goals and limits, many of them out of reach: rows kept, or no solution at all."""
    rng = np.random.default_rng(11)
    formulation, guess = first_program(face_problem(Pose(1.5, 0.3, 0.2)))
    whole = WholeProgram(formulation.dimensions)
    count = formulation.dimensions.variable_count
    solved = refused = 0
    for _ in range(150):
        goal = rng.normal((1.5, 0.2, 0.1), (1.0, 0.5, 0.5))
        program = changed(formulation, BoundaryValues, x=goal[0], y=goal[1], theta=goal[2])
        program = changed(with_angle(program, rng.uniform(0.01, 1.0)), Limits,
                          cone_slope=rng.uniform(0.05, 0.8), yaw_rate=rng.uniform(0.05, 2.0))
        result = solve(program, guess)
        assert result.iterations <= len(ATTEMPTS) * MAX_ITERATIONS
        if result.solution is None:
            refused += 1
            assert result.failure is PlanFailure.NOT_CONVERGED
            continue
        solved += 1
        values = whole.evaluate(program, result.iterate.primal[:count],
                                whole.multipliers(result.iterate.dual))
        assert np.abs(values.equalities).max() < TOLERANCE
        assert values.inequalities.min() > -TOLERANCE
    assert solved > 20 and refused > 20


@PUSHES
def test_a_solved_program_is_gone_on_from_without_a_step(problem):
    formulation, guess = first_program(problem)
    result = solve(formulation, guess)
    again = push_solver(formulation.dimensions).resume(formulation, result.iterate)
    assert again.iterations == 0
    np.testing.assert_allclose(again.solution.nodes, result.solution.nodes, atol=1e-12)


@PUSHES
@pytest.mark.parametrize('has_slacks', [True, False])
def test_going_on_leads_where_solving_from_nothing_does(problem, has_slacks):
    """The goal moves by a centimetre and a degree: the same push, in fewer iterations."""
    formulation, guess = first_program(problem)
    before = solve(formulation, guess)
    boundary = formulation.boundary
    moved = changed(formulation, BoundaryValues, x=boundary.x + 0.007, y=boundary.y - 0.007)
    resumed = push_solver(formulation.dimensions).resume(moved, before.iterate, has_slacks)
    fresh = solve(moved, guess)
    assert resumed.iterations < fresh.iterations
    assert resumed.solution.free_length == pytest.approx(fresh.solution.free_length, abs=2e-3)
    np.testing.assert_allclose(resumed.solution.nodes[:, 2:5], fresh.solution.nodes[:, 2:5],
                               atol=2e-2)
