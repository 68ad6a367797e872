"""The planner's own solver against another one, on the same programs."""

from helpers.push_problems import DIFFERENTIAL, face_problem, HOLONOMIC, vertex_problem
import numpy as np
from push_model.geometry import Pose
from push_planner.collocation.formulation import formulate
from push_planner.collocation.interior_point import MAX_ITERATIONS
from push_planner.collocation.nlp_solver import NlpSolver
from push_planner.collocation.push_solver import push_solver
from push_planner.initial_guess.dubins_routes import routes, tightest_turns
import pytest

GOAL = Pose(1.9, 0.7, -0.2)


@pytest.mark.parametrize('problem', [
    face_problem(GOAL), face_problem(GOAL, pushing_speed=1.0, final_straight=0.0),
    face_problem(Pose(1.5, 0.05, 0.05), robot_yaw='fixed', final_straight=0.0),
    vertex_problem(GOAL, HOLONOMIC), vertex_problem(GOAL, DIFFERENTIAL)],
    ids=lambda problem: problem.kind)
def test_it_finds_the_optimum_that_fatrop_finds(problem):
    """The same length within 2 mm, and the rows kept as well."""
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    found = push_solver(formulation.dimensions).solve(formulation, guess).solution
    other = NlpSolver(formulation.dimensions).solve(formulation.parameters(), formulation.bounds,
                                                    guess).solution
    assert found.free_length == pytest.approx(other.free_length, abs=2e-3)
    np.testing.assert_allclose(found.nodes[:, 2:5], other.nodes[:, 2:5], atol=2e-2)


def test_what_has_no_solution_is_not_solved():
    """A goal beside the box cannot be reached within a path as short as the first route's."""
    problem = face_problem(Pose(0.0, 0.3, 0.0))
    route = routes(problem, tightest_turns(problem))[0]
    formulation, guess = formulate(problem, route)
    narrow = formulation._replace(bounds=formulation.bounds._replace(angle=1e-3))
    result = push_solver(formulation.dimensions).solve(narrow, guess)
    assert result.solution is None and result.failure is not None


def test_it_gives_up_where_constraints_stay_violated():
    """A goal aside within pushing angles that do not steer so far: long before the limit."""
    problem = face_problem(Pose(1.5, 0.6, 0.2))
    formulation, guess = formulate(problem, routes(problem, tightest_turns(problem))[0])
    narrow = formulation._replace(bounds=formulation.bounds._replace(angle=0.05))
    result = push_solver(formulation.dimensions).solve(narrow, guess)
    assert result.solution is None
    assert result.iterations < MAX_ITERATIONS
