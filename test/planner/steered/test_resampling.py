"""Resampling of a solution: the same function of the path length on another mesh and frame."""

from helpers.push_problems import face_problem
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.collocation.interior_point import iterate_shapes, parts_of
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.collocation.resampling import Meshed, resample
from push_planner.steered.planner import plan_push
import pytest

NOWHERE = Pose(0.0, 0.0, 0.0)


@pytest.fixture(scope='module', name='solved')
def make_solved():
    return plan_push(face_problem(Pose(1.5, 0.4, 0.5))).motion


def meshed(solved):
    formulation = solved.formulation
    return Meshed(formulation.dimensions, formulation.mesh, solved.refined.solution.free_length)


def test_on_its_own_mesh_all_stays_as_it_is(solved):
    """But the slacks, which follow from the rows."""
    mesh = meshed(solved)
    found = resample(solved.iterate, mesh, mesh, 0.0, NOWHERE)
    shapes = iterate_shapes(mesh.dimensions)
    one, other = (parts_of(iterate.primal, shapes.primal)['z'][:, :6]
                  for iterate in (solved.iterate, found))
    np.testing.assert_allclose(other, one, atol=1e-9)
    one, other = (parts_of(iterate.dual, shapes.dual) for iterate in (solved.iterate, found))
    for name in ('costates', 'nu', 'goal', 'step', 'end'):
        np.testing.assert_allclose(other[name], one[name], atol=1e-9)


def test_a_solution_is_resumed_in_next_to_no_steps(solved):
    """The method knows that it is one."""
    solver = push_solver(solved.formulation.dimensions)
    found = solver.resume(solved.formulation, solved.iterate)
    assert found.iterations <= 1
    assert found.solution.free_length == pytest.approx(solved.refined.solution.free_length,
                                                       abs=1e-5)


def test_a_frame_there_and_back_changes_nothing(solved):
    """Positions, headings and their costates rotate back."""
    mesh, frame = meshed(solved), Pose(0.3, -0.2, 0.7)
    there = resample(solved.iterate, mesh, mesh, 0.0, frame)
    back = resample(there, mesh, mesh, 0.0, frame.inverse())
    plain = resample(solved.iterate, mesh, mesh, 0.0, NOWHERE)
    np.testing.assert_allclose(back.primal, plain.primal, atol=1e-9)
    np.testing.assert_allclose(back.dual, plain.dual, atol=1e-9)
    assert np.abs(there.dual - plain.dual).max() > 0.01
