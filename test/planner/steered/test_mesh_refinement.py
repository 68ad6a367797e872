"""Local refinement of the mesh: what it gains, and what it leaves alone."""

import dataclasses

from helpers.push_problems import face_problem, vertex_problem
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_planner.problem import PushProblem
from push_planner.steered.collocation.formulation import formulate
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.steered.mesh_refinement import (
    HALVED_SEGMENTS, MAX_REFINEMENTS, MeshSolution, refine_mesh)
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
import pytest

NO_RAMPS = {'final_straight': 0.0, 'deceleration': 0.0}
# A slow push that steers to one side, around, and to the other; fast ones that take little room.
SWITCHED = face_problem(Pose(0.0931, 1.6104, 2.7807), pushing_speed=0.05, **NO_RAMPS)
FAST = face_problem(Pose(0.0955, -1.2272, -2.9366), pushing_speed=1.0, **NO_RAMPS)
FAST_AND_WIDE = face_problem(Pose(2.5, 1.0, 1.5), pushing_speed=0.8, **NO_RAMPS)


def unlimited(problem: PushProblem) -> PushProblem:
    """Return the problem for a robot that only the cone limits."""
    robot = dataclasses.replace(problem.robot, max_speed=5.0, max_yaw_rate=50.0,
                                max_acceleration=100.0)
    return dataclasses.replace(problem, robot=robot)


def solve(problem: PushProblem, is_fine: bool = False) -> MeshSolution:
    """Solve the program of the shortest route that has a solution."""
    turns = tightest_turns(problem)
    assert turns is not None
    for route in routes(problem, turns):
        formulation, guess = formulate(problem, route, is_fine)
        result = push_solver(formulation.dimensions).solve(formulation, guess)
        if result.solution is not None:
            return MeshSolution(formulation, result)
    raise AssertionError('no route has a solution')


def length(solved: MeshSolution) -> float:
    """Length of the push [m]."""
    assert solved.result.solution is not None
    return solved.result.solution.free_length


@pytest.mark.parametrize('problem', [SWITCHED, FAST, FAST_AND_WIDE],
                         ids=['switched', 'fast', 'fast-and-wide'])
def test_a_refined_push_is_shorter_and_as_good_as_one_on_a_mesh_that_is_fine_all_over(
        problem: PushProblem) -> None:
    """To 0.3 %, with fewer segments than twice as many."""
    problem = unlimited(problem)
    coarse, fine = solve(problem), solve(problem, is_fine=True)
    refined = refine_mesh(problem, coarse)
    assert length(refined) < length(coarse)
    assert length(refined) < 1.003 * length(fine)
    added = (refined.formulation.dimensions.step_count
             - coarse.formulation.dimensions.step_count)
    assert added in HALVED_SEGMENTS * np.arange(1, MAX_REFINEMENTS + 1)


def test_a_slow_push_without_a_switch_keeps_its_mesh() -> None:
    """Its angle changes gently in all segments."""
    problem = unlimited(face_problem(Pose(2.0, 0.3, 0.3), pushing_speed=0.1, **NO_RAMPS))
    coarse = solve(problem)
    assert refine_mesh(problem, coarse) is coarse


def test_constant_angles_keep_their_mesh() -> None:
    """The number of their segments is a setting."""
    problem = dataclasses.replace(SWITCHED, settings=dataclasses.replace(
        SWITCHED.settings, pushing_angles='constant'))
    coarse = solve(problem)
    assert refine_mesh(problem, coarse) is coarse


def test_a_switch_of_a_plan_is_finer_than_the_segments_before() -> None:
    """The plan ends at its goal also when it is driven, and reports the segments that it has."""
    problem = unlimited(SWITCHED)
    plan = plan_push(problem)
    lengths = np.diff(plan.segment_ends, prepend=0.0)
    assert lengths.min() < 0.3 * lengths.max()
    assert plan.report['segments'] == len(lengths)
    assert verify(plan).position_error < 1e-4


def test_a_drive_that_steers_at_once_on_a_fine_mesh_ends_at_its_goal() -> None:
    """Where its angle changes by 0.5 rad in 2 cm, the integration is finer as well."""
    robot = RoundRobot(0.17, 'differential', max_speed=5.0, max_yaw_rate=50.0,
                       max_acceleration=100.0, max_yaw_acceleration=1000.0)
    problem = vertex_problem(Pose(2.52009, 2.55110, -2.36063), robot, start=Pose(0.0, 0.0, 0.0),
                             pushing_speed=0.1, **NO_RAMPS)
    plan = plan_push(problem)
    lengths = np.diff(plan.segment_ends, prepend=0.0)
    assert lengths.min() < 0.3 * lengths.max()
    assert verify(plan).position_error < 1e-4
