"""
Resampling of a solution: from the mesh of a push to another mesh for the rest of it.

Variables are functions of the path length s, and so are costates. Multipliers of what holds at the
points of a step are densities over s times the length of the step. With the frame moved by (x, y)
and rotated by T, positions and their costates rotate by -T. The costate of the free length S is

    lambda_S(s) = 1 - (1 / S) integral of g from s to the end

with g independent of S, so that ``1 - lambda_S`` grows by the ratio of the free lengths.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, IntArray, Pose
from push_planner.steered.collocation.collocation import radau
from push_planner.steered.collocation.dimensions import Dimensions, POINTS
from push_planner.steered.collocation.interior_point import Iterate, iterate_shapes, parts_of
from push_planner.steered.collocation.mesh import Mesh

# Columns of the states: S, w, rho, theta, q_x, q_y and phi.
RHO, THETA, POSITION, PHI = 2, 3, slice(4, 6), 6


class Meshed(NamedTuple):
    """
    Mesh of a program.

    :param dimensions: ``Dimensions``.
    :param mesh: ``Mesh``.
    :param free_length: S [m].
    """

    dimensions: Dimensions
    mesh: Mesh
    free_length: float

    def lengths(self) -> FloatArray:
        """Lengths of the steps [m]."""
        return self.mesh.step_lengths(self.free_length)


def resample(iterate: Iterate, previous: Meshed, present: Meshed, done: float,
             frame: Pose) -> Iterate:
    """
    Carry an iterate over to the rest of the push, without slacks: they follow from the rows.

    :param previous: its mesh.
    :param present: mesh of the rest; its dimensions differ in the number of steps alone.
    :param done: path length before the rest, on the former mesh [m].
    :param frame: present start in the frame of the former one; its angle is not wrapped.
    """
    shapes = iterate_shapes(previous.dimensions)
    present_shapes = iterate_shapes(present.dimensions)
    primal, dual = parts_of(iterate.primal, shapes.primal), parts_of(iterate.dual, shapes.dual)
    resampled = Iterate(*(np.ones(sum(map(math.prod, of.values())))
                          for of in (present_shapes.primal, present_shapes.dual)))
    new_primal = parts_of(resampled.primal, present_shapes.primal)
    new_dual = parts_of(resampled.dual, present_shapes.dual)
    lengths, new_lengths = previous.lengths(), present.lengths()
    ends, new_ends = np.zeros(len(lengths) + 1), np.zeros(len(new_lengths) + 1)
    np.cumsum(lengths, out=ends[1:])
    np.cumsum(new_lengths, out=new_ends[1:])
    scale = (ends[-1] - done) / new_ends[-1]
    new_ends = done + scale * new_ends
    at_nodes = _mesh_positions(ends, new_ends)
    step = _mesh_positions(ends, 0.5 * (new_ends[1:] + new_ends[:-1])).interval
    density = (scale * new_lengths / lengths[step])[:, None]
    new_primal['z'][:] = _variables(primal['z'], previous.dimensions, at_nodes, frame)
    new_primal['z'][:, 0] = present.free_length
    points = radau(POINTS).points
    old_points = ends[:-1, None] + lengths[:, None] * points
    new_points = new_ends[:-1, None] + scale * new_lengths[:, None] * points
    controls = previous.dimensions.state_count + 1
    new_primal['z'][:-1, controls:] = np.interp(new_points, old_points.ravel(),
                                                primal['z'][:-1, controls:].ravel())
    new_dual['costates'][:] = _costates(dual['costates'], at_nodes, frame.theta,
                                        previous.free_length / present.free_length)
    new_dual['nu'][:] = density * dual['nu'][step]
    new_dual['eta'][:] = 0.0
    new_dual['goal'][:] = dual['goal']
    new_dual['goal'][:2] = _rotated(dual['goal'][None, :2], -frame.theta)[0]
    new_dual['step'][:] = density * dual['step'][step]
    new_dual['first'][:], new_dual['end'][:] = dual['first'], dual['end']
    return resampled


class _MeshPositions(NamedTuple):
    """Places between knots: number of the interval, and weight of its end, shape (m, 1)."""

    interval: IntArray
    weight: FloatArray

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Interpolate rows of values at the knots."""
        before = values[self.interval]
        return before + self.weight * (values[self.interval + 1] - before)


def _mesh_positions(knots: FloatArray, s: FloatArray) -> _MeshPositions:
    interval = np.minimum(np.maximum(knots.searchsorted(s) - 1, 0), len(knots) - 2)
    start = knots[interval]
    return _MeshPositions(interval, ((s - start) / (knots[interval + 1] - start))[:, None])


def _variables(z: FloatArray, dimensions: Dimensions, at_nodes: _MeshPositions,
               frame: Pose) -> FloatArray:
    """Resample the states, and the changes of the pushing angle between them."""
    states = dimensions.state_count
    resampled = np.zeros((len(at_nodes.interval), z.shape[1]))
    resampled[:, :states] = at_nodes.interpolate(z[:, :states])
    resampled[:, THETA] -= frame.theta
    resampled[:, POSITION] = _rotated(resampled[:, POSITION] - np.array([frame.x, frame.y]),
                                      -frame.theta)
    if states > PHI:
        resampled[:, PHI] -= resampled[0, PHI]
    resampled[:-1, states] = resampled[1:, RHO] - resampled[:-1, RHO]
    return resampled


def _costates(costates: FloatArray, at_nodes: _MeshPositions, angle: float,
              ratio: float) -> FloatArray:
    """Resample the multipliers of the dynamics."""
    resampled = at_nodes.interpolate(costates)
    resampled[:, 0] = 1.0 - ratio * (1.0 - resampled[:, 0])
    resampled[:, POSITION] = _rotated(resampled[:, POSITION], -angle)
    return resampled


def _rotated(vectors: FloatArray, angle: float) -> FloatArray:
    """Rotate vectors of shape (n, 2) by an angle."""
    c, s = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])
