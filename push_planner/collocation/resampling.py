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
from push_planner.collocation.collocation import radau
from push_planner.collocation.dimensions import Dimensions, POINTS
from push_planner.collocation.interior_point import Iterate, iterate_shapes, parts_of
from push_planner.collocation.mesh import Mesh

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


def resample(iterate: Iterate, former: Meshed, present: Meshed, done: float,
             frame: Pose) -> Iterate:
    """
    Carry an iterate over to the rest of the push, without slacks: they follow from the rows.

    :param iterate: the ``Iterate``.
    :param former: its mesh.
    :param present: mesh of the rest; its dimensions differ in the number of steps alone.
    :param done: path length before the rest, on the former mesh [m].
    :param frame: present start in the frame of the former one; its angle is not wrapped.
    """
    shapes, present_shapes = iterate_shapes(former.dimensions), iterate_shapes(present.dimensions)
    primal, dual = parts_of(iterate.primal, shapes.primal), parts_of(iterate.dual, shapes.dual)
    found = Iterate(*(np.ones(sum(map(math.prod, of.values())))
                      for of in (present_shapes.primal, present_shapes.dual)))
    new_primal = parts_of(found.primal, present_shapes.primal)
    new_dual = parts_of(found.dual, present_shapes.dual)
    lengths, new_lengths = former.lengths(), present.lengths()
    ends, new_ends = np.zeros(len(lengths) + 1), np.zeros(len(new_lengths) + 1)
    np.cumsum(lengths, out=ends[1:])
    np.cumsum(new_lengths, out=new_ends[1:])
    scale = (ends[-1] - done) / new_ends[-1]
    new_ends = done + scale * new_ends
    at_nodes = _places(ends, new_ends)
    step = _places(ends, 0.5 * (new_ends[1:] + new_ends[:-1])).interval
    density = (scale * new_lengths / lengths[step])[:, None]
    new_primal['z'][:] = _variables(primal['z'], former.dimensions, at_nodes, frame)
    new_primal['z'][:, 0] = present.free_length
    points = radau(POINTS).points
    old_points = ends[:-1, None] + lengths[:, None] * points
    new_points = new_ends[:-1, None] + scale * new_lengths[:, None] * points
    controls = former.dimensions.state_count + 1
    new_primal['z'][:-1, controls:] = np.interp(new_points, old_points.ravel(),
                                                primal['z'][:-1, controls:].ravel())
    new_dual['costates'][:] = _costates(dual['costates'], at_nodes, frame.theta,
                                        former.free_length / present.free_length)
    new_dual['nu'][:] = density * dual['nu'][step]
    new_dual['eta'][:] = 0.0
    new_dual['goal'][:] = dual['goal']
    new_dual['goal'][:2] = _rotated(dual['goal'][None, :2], -frame.theta)[0]
    new_dual['step'][:] = density * dual['step'][step]
    new_dual['first'][:], new_dual['end'][:] = dual['first'], dual['end']
    return found


class _Places(NamedTuple):
    """Places between knots: number of the interval, and weight of its end, shape (m, 1)."""

    interval: IntArray
    weight: FloatArray

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Interpolate rows of values at the knots."""
        before = values[self.interval]
        return before + self.weight * (values[self.interval + 1] - before)


def _places(knots: FloatArray, s: FloatArray) -> _Places:
    interval = np.minimum(np.maximum(knots.searchsorted(s) - 1, 0), len(knots) - 2)
    begin = knots[interval]
    return _Places(interval, ((s - begin) / (knots[interval + 1] - begin))[:, None])


def _variables(z: FloatArray, dimensions: Dimensions, at_nodes: _Places,
               frame: Pose) -> FloatArray:
    """Resample the states, and the changes of the pushing angle between them."""
    states = dimensions.state_count
    found = np.zeros((len(at_nodes.interval), z.shape[1]))
    found[:, :states] = at_nodes.interpolate(z[:, :states])
    found[:, THETA] -= frame.theta
    found[:, POSITION] = _rotated(found[:, POSITION] - np.array([frame.x, frame.y]), -frame.theta)
    if states > PHI:
        found[:, PHI] -= found[0, PHI]
    found[:-1, states] = found[1:, RHO] - found[:-1, RHO]
    return found


def _costates(costates: FloatArray, at_nodes: _Places, angle: float, ratio: float) -> FloatArray:
    """Resample the multipliers of the dynamics."""
    found = at_nodes.interpolate(costates)
    found[:, 0] = 1.0 - ratio * (1.0 - found[:, 0])
    found[:, POSITION] = _rotated(found[:, POSITION], -angle)
    return found


def _rotated(vectors: FloatArray, angle: float) -> FloatArray:
    """Rotate vectors of shape (n, 2) by an angle."""
    c, s = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])
