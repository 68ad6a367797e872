"""
Rollout: a push integrated finely along its steps, in closed loop around a reference.

In open loop a push runs away from its path by ``exp(s / L)``, with L the wheelbase. So each change
of the pushing angle is corrected for the deviation of the node at its start,

    change = change_ref - K (node - node_ref)

and the corrected changes are those of a push in open loop again. Every step is divided into parts
(see ``step_division``), which are integrated one after the other (see ``rollout_functions``).
"""

import functools
import math
import threading
from typing import NamedTuple

import numpy as np
from push_dynamics.machine_code import BoundRows, RowFunction, RowSequence
from push_model.geometry import FloatArray, IntArray
from push_planner.steered.collocation.dimensions import Dimensions, StepData
from push_planner.steered.collocation.formulation import Formulation
from push_planner.steered.integration.rollout_functions import (
    Checks, NODE_SIZE, part_function, POINTS, step_functions, STEP_SIZE, StepFunctions,
)
from push_planner.steered.integration.step_division import (
    capacity_doublings, MIN_CAPACITY, PartCounts, StepDivision,
)

MAX_DIVISIONS = 6
# Difference for derivatives [m, rad, 1/m]. Chosen: about the square root of the rounding of
# float64 gives the best forward differences, and Newton's method leaves some more noise.
DIFFERENCE = 1e-6
# Numbers of the samples after jumps where there is none but the first touch.
FIRST_SAMPLE = np.array([0])


class Rollout(NamedTuple):
    """
    A push integrated finely; m samples over n steps.

    :param nodes: ``Node`` at the start of each step, and at the end, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param s: path length of the contact from the start to each sample, shape (m,) [m].
    :param v_squared: V at each sample, shape (m,) [m^2/s^2].
    :param samples: ``Node`` at each sample, shape (m, 6).
    :param forces: (F_n, F_t) at each sample, shape (m, 2) [N].
    :param step_forces: the same at the start of each step, shape (n, 2) [N].
    :param starts: numbers of the samples at the start, and after jumps between steps.
    """

    nodes: FloatArray
    changes: FloatArray
    s: FloatArray
    v_squared: FloatArray
    samples: FloatArray
    forces: FloatArray
    step_forces: FloatArray
    starts: IntArray


class _PartMemory:
    """
    Memory of up to a number of parts of some steps.

    :param function: of ``part_function``.
    :param capacity: number of parts.
    :param step_count: number of steps.
    :param column: memory of the parameters.
    """

    def __init__(self, function: RowFunction, capacity: int, step_count: int,
                 column: FloatArray) -> None:
        self._function = function
        self.states = np.zeros((capacity + 1, NODE_SIZE + 2))
        self.steps = np.zeros((step_count, STEP_SIZE))
        self.restarts, self.column = np.zeros(1), column
        self.starts = np.zeros((capacity, NODE_SIZE))
        # One sample before those of the parts: the start of the push.
        self.all_samples = np.zeros((1 + capacity * POINTS, NODE_SIZE))
        self.all_forces = np.zeros((1 + capacity * POINTS, 2))
        self.samples = self.all_samples[1:].reshape(capacity, -1)
        self.forces = self.all_forces[1:].reshape(capacity, -1)
        self.first_forces = np.zeros((capacity, 2))

    def bind(self, division: StepDivision) -> BoundRows:
        """
        Bind the integration of parts.

        :param division: ``StepDivision`` of the steps.
        """
        return self._function.bind({
            'state': self.states[:-1], 'step': self.steps, 'part': division.parts,
            'restarts': self.restarts, 'column': self.column, 'next_state': self.states[1:],
            'start': self.starts, 'samples': self.samples, 'forces': self.forces,
            'first_force': self.first_forces, 'residual': division.residuals}, division.steps)


class RolloutMemory:
    """
    Memory of rollouts of a push of n steps in up to a number of parts, its functions bound to it.

    Given are the reference ``nodes`` at the start of each step, shape (n + 1, 6), the ``changes``
    of the pushing angle, shape (n, 1), the gains K and K[S], shape (n, 7), and the ``free_length``
    S, shape (1,). A rollout leaves its own nodes and changes in their place.

    Attributes, besides: ``data``, rows of ``StepData``; ``first_state``, node at the start of the
    push, shape (6,); ``follow_coarsely``, a rollout in fewer parts, with too few samples for a
    ``Rollout``, and ``follow``, one with all samples.

    :param dimensions: ``Dimensions``.
    :param doublings: of ``MIN_CAPACITY``, the largest number of parts.
    :param column: memory of the parameters.
    :param gains: memory of the gains.
    :param changes: memory of the changes.
    :param free_length: memory of S.
    """

    def __init__(self, dimensions: Dimensions, doublings: int, column: FloatArray,
                 gains: FloatArray, changes: FloatArray, free_length: FloatArray) -> None:
        """Allocate the memory."""
        n, capacity = dimensions.step_count, MIN_CAPACITY << doublings
        self._jumps = dimensions.jumps
        self._part_function = part_function(dimensions.kind, dimensions.supports,
                                            dimensions.jumps)
        self._parts = parts = _PartMemory(self._part_function, capacity, n, column)
        self.nodes, self.data = np.zeros((n + 1, NODE_SIZE)), np.zeros((n, len(StepData._fields)))
        self.changes, self.free_length = changes, free_length
        self.first_state = parts.states[0, :NODE_SIZE]
        # V at the starts of the steps and dV/ds, also where they play no part.
        self._speeds = np.zeros((n, 2))
        # Path lengths at the starts of the steps, and at the end.
        self._ends = np.zeros((n + 1, 1))
        self._s, self._v_squared = (np.zeros(1 + capacity * POINTS) for _ in range(2))
        self._checks = np.zeros((capacity + 1, len(Checks._fields)))
        self._checks[0] = Checks(0.0, 0.0, math.inf, math.inf)
        self._ratio_bounds = np.zeros((capacity, 1))
        self._fine, self._coarse = StepDivision(n, capacity), StepDivision(n, capacity)
        functions = step_functions()
        prepare = functions.prepare.bind({
            'node': self.nodes[:-1], 'gains': gains, 'change': changes, 'data': self.data,
            'speeds': self._speeds, 'free_length': free_length, 'start': self._ends[:-1],
            'step': parts.steps, 'end': self._ends[1:]})
        self._sample = functions.sampling.bind({
            'step': parts.steps, 'speeds': self._speeds, 'start': self._ends[:-1],
            'part': self._fine.parts, 'samples': parts.samples, 'forces': parts.forces,
            'first_force': parts.first_forces, 'before': self._checks[:-1],
            's': self._s[1:].reshape(capacity, -1),
            'v_squared': self._v_squared[1:].reshape(capacity, -1),
            'accumulated': self._checks[1:], 'ratio_bound': self._ratio_bounds}, self._fine.steps)
        self._integrate_coarse, self._integrate_fine = (
            parts.bind(division) for division in (self._coarse, self._fine))
        self.follow_coarsely = RowSequence(prepare, self._integrate_coarse,
                                           *self._pick(functions, self._coarse))
        self.follow = RowSequence(prepare, self._integrate_fine,
                                  *self._pick(functions, self._fine), self._sample)

    def _pick(self, functions: StepFunctions, division: StepDivision) -> list[BoundRows]:
        """Bind what takes nodes and changes from the states between the parts."""
        states = self._parts.states
        return [functions.pick_node.bind({'state': states, 'picked': self.nodes}, division.nodes),
                functions.pick_change.bind({'state': states, 'picked': self.changes},
                                           division.changes)]

    def load(self, formulation: Formulation, counts: PartCounts) -> None:
        """Take the steps of a push, and divide them."""
        mesh = formulation.mesh
        self.data[:] = formulation.steps
        self._speeds[:, 0], self._speeds[:, 1] = mesh.v_squared, mesh.v_squared_slopes
        self._fine.divide(counts.graded, counts.fine)
        self._coarse.divide(counts.graded, counts.coarse)
        self._count()

    def _count(self) -> None:
        """Let the functions know the number of parts."""
        self._integrate_fine.count[0] = self._sample.count[0] = self._fine.count
        self._integrate_coarse.count[0] = self._coarse.count

    @property
    def fine_converged(self) -> bool:
        """Tell whether Newton's method has converged in all parts of the last fine rollout."""
        return self._fine.converged()

    @property
    def coarse_converged(self) -> bool:
        """The same of the last coarse rollout."""
        return self._coarse.converged()

    def follow_divided(self, coarse: bool = False) -> None:
        """
        Follow a reference, and divide the parts for which Newton's method fails.

        Nodes are nan where it fails in all divisions.

        :param coarse: whether in fewer parts, with too few samples for a ``Rollout``.
        :raises CapacityExceeded: where that takes too many parts.
        """
        division, follow = ((self._coarse, self.follow_coarsely) if coarse else
                            (self._fine, self.follow))
        nodes, changes = self.nodes.copy(), self.changes.copy()
        follow()
        for _ in range(MAX_DIVISIONS):
            if division.converged():
                return
            division.refine(division.first_failed())
            self._count()
            self.nodes[:], self.changes[:] = nodes, changes
            follow()
        if not division.converged():
            self.nodes[1:] = math.nan

    def checks(self) -> Checks:
        """Return what is checked of the last rollout."""
        return Checks(*self._checks[self._fine.count].tolist())

    def resolve_forces(self, largest_ratio: float) -> bool:
        """
        Divide the parts in which the force may be steeper than a limit between the samples.

        :param largest_ratio: limit on |F_t| / F_n.
        :return: whether there are any.
        :raises CapacityExceeded: where that makes too many.
        """
        steep = np.flatnonzero(self._ratio_bounds[:self._fine.count] > largest_ratio)
        if len(steep):
            self._fine.refine(steep)
            self._count()
        return len(steep) > 0

    def linearize(self, may_steer: FloatArray) -> FloatArray:
        """
        Differentiate all steps by differences, about the last rollout.

        :param may_steer: 1 where the pushing angle may change, shape (n,).
        :return: derivatives of the end of each step and S by its start, S and change, shape
            (n, 7, 8).
        """
        # All steps as they are, and then with a difference in each of the 8 arguments.
        variants = NODE_SIZE + 3
        size, count = self._coarse.count, len(self.data)
        memory = _variant_memory(self._part_function, capacity_doublings(variants * size),
                                 variants * count, threading.get_ident())
        memory.load(self._coarse, variants, self._parts)
        steps = memory.parts.steps
        for i in range(variants):
            shift = DIFFERENCE * np.eye(1, variants - 1, i - 1)[0]
            of_variant = steps[i * count:(i + 1) * count]
            of_variant[:] = self._parts.steps
            of_variant[:, :NODE_SIZE] = self.nodes[:-1] + shift[:NODE_SIZE]
            of_variant[:, 2 * NODE_SIZE] = (self.changes[:, 0]
                                            + shift[NODE_SIZE + 1] * may_steer)
            of_variant[:, 2 * NODE_SIZE + 1] += shift[NODE_SIZE] * self.data[:, 1]
        memory.integrate()
        ends = memory.parts.states[1:variants * size + 1].reshape(variants, size, -1)
        ends = ends[:, self._coarse.nodes[1:] - 1, :NODE_SIZE]
        maps = np.zeros((count, NODE_SIZE + 1, NODE_SIZE + 2))
        maps[:, NODE_SIZE, NODE_SIZE] = 1.0
        maps[:, :NODE_SIZE] = ((ends[1:] - ends[0]) / DIFFERENCE).transpose(1, 2, 0)
        return maps

    def collect(self) -> Rollout:
        """Put the samples of the last rollout together, which was one with all samples."""
        end, parts, first = 1 + POINTS * self._fine.count, self._parts, self._fine.nodes[:-1]
        step_forces = parts.first_forces[first]
        parts.all_samples[0], parts.all_forces[0] = parts.starts[0], step_forces[0]
        self._v_squared[0] = self._speeds[0, 0]
        rollout = Rollout(self.nodes.copy(), self.changes[:, 0].copy(), self._s[:end].copy(),
                          self._v_squared[:end].copy(), parts.all_samples[:end].copy(),
                          parts.all_forces[:end].copy(), step_forces, FIRST_SAMPLE)
        return self._with_jumps(rollout) if self._jumps else rollout

    def _with_jumps(self, rollout: Rollout) -> Rollout:
        """Insert samples after the jumps; else the end of a step is the start of the next."""
        jumps = np.flatnonzero(rollout.changes[1:]) + 1
        first = self._fine.nodes[jumps]
        at = 1 + POINTS * first
        return rollout._replace(
            s=np.insert(rollout.s, at, self._ends[jumps, 0]),
            v_squared=np.insert(rollout.v_squared, at, self._speeds[jumps, 0]),
            samples=np.insert(rollout.samples, at, self._parts.starts[first], axis=0),
            forces=np.insert(rollout.forces, at, rollout.step_forces[jumps], axis=0),
            starts=np.append(FIRST_SAMPLE, at + np.arange(len(at))))


class _VariantMemory:
    """
    Memory of the parts of many steps at once, each from its own reference.

    :param function: of ``part_function``.
    :param capacity: number of parts.
    :param step_count: number of steps.
    """

    def __init__(self, function: RowFunction, capacity: int, step_count: int) -> None:
        self.parts = _PartMemory(function, capacity, step_count,
                                 np.zeros(function.sizes['column']))
        self._division = StepDivision(step_count, capacity)
        self.parts.restarts[0] = 1.0
        self.integrate = self.parts.bind(self._division)

    def load(self, division: StepDivision, times: int, parts: _PartMemory) -> None:
        """Divide the same steps some times, one after the other."""
        size, count = division.count, times * division.count
        shift = np.repeat(np.arange(times) * len(parts.steps), size)
        self._division.steps[:count] = np.tile(division.steps[:size], times) + shift
        self._division.parts[:count] = np.tile(division.parts[:size], (times, 1))
        self.parts.column[:] = parts.column
        self.integrate.count[0] = count


@functools.lru_cache(maxsize=32)
def _variant_memory(function: RowFunction, doublings: int, step_count: int,
                    thread: int) -> _VariantMemory:
    """
    Allocate memory, or return that of before: binding it takes longer than a rollout.

    :param function: of ``part_function``.
    :param doublings: of ``MIN_CAPACITY``.
    :param step_count: number of steps.
    :param thread: that works on it: each has a memory of its own.
    """
    return _VariantMemory(function, MIN_CAPACITY << doublings, step_count)
