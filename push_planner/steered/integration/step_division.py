"""
Division of the steps of a push into parts, fine where the motion changes fast.

Parts for which Newton's method does not converge are divided further.
"""

import functools
import math
from typing import NamedTuple, Optional

import numpy as np
from push_model.geometry import FloatArray, IntArray
from push_planner.problem import PushProblem

# Residual of the moment balance over the supports' friction up to which Newton's method has
# converged [m]. Chosen: one more iteration would leave rounding.
CONVERGED = 1e-6
# Number of parts that a part is divided into where it has not, within how many steps at a time,
# and how often. Measured: where an object turns about one of its supports its yaw rate changes
# within a thousandth of a step; of 397 pushes all converge, after five times at most. Chosen: what
# follows a part that fails says little.
DIVISION = 8
DIVIDED_STEPS = 3
# Ratio of the lengths of successive parts where w settles. Chosen: fine at first, few in all.
GROWTH = 1.6
# First part of the push, and of a step after a jump of the angle, over the settling distance of w.
# Measured: of 100 differential drives at a vertex one was 0.8 mm off when driven in open loop with
# 0.3 at the start, and is 0.03 mm off. Chosen: w settles by a quarter after jumps, as they are
# small.
FIRST_PART_RATIO = 0.1
JUMP_PART_RATIO = 0.3
# Largest change of the pushing angle in a part [rad]. Measured: of 100 differential drives at a
# vertex 4 whose meshes were refined were 0.7 to 3.4 mm off when driven in open loop with 0.5 in a
# part, and are 0.01 mm off.
MAX_CHANGE = 0.1
# Longest part of a coarse rollout [m]. Chosen: as fine as a first correction needs.
COARSE_PART = 0.1
# Parts that memory is kept for, at least. Chosen: as many as most pushes take.
MIN_CAPACITY = 256


def graded_fractions(length: float, first: float, longest: float) -> FloatArray:
    """
    Divide a step into parts that grow from a first one.

    :param length: of the step [m].
    :param first: about the first part [m].
    :param longest: the longest part [m].
    :return: fractions of the step, summing to 1.
    """
    parts = [min(first, longest, length)]
    while parts[-1] < longest and sum(parts) < length:
        parts.append(min(longest, GROWTH * parts[-1]))
    remaining = length - sum(parts)
    if remaining > 0.0:
        count = int(np.ceil(remaining / longest))
        parts += [remaining / count] * count
    return np.array(parts) / sum(parts)


def settling_distance(problem: PushProblem) -> float:
    """
    Distance over which the yaw rate settles after a jump [m].

    ``v^2 (I/m + r^2) / (mu g r L)``: the larger the inertia against friction, the longer.
    """
    vehicle, obj = problem.vehicle, problem.obj
    inertia = obj.inertia + obj.mass * vehicle.arm ** 2
    friction = sum(obj.capacities) * vehicle.arm * vehicle.wheelbase
    return problem.settings.pushing_speed ** 2 * inertia / friction


class _Parts(NamedTuple):
    """
    Parts of n steps, m in all.

    :param steps: number of the step of each part, shape (m,).
    :param parts: fraction of each part, and of what lies before it in its step, shape (m, 2).
    :param nodes: number of the first part of each step, and m, shape (n + 1,).
    """

    steps: IntArray
    parts: FloatArray
    nodes: IntArray


@functools.lru_cache(maxsize=256)
def _equal_parts(counts: tuple[int, ...]) -> _Parts:
    """
    Divide steps into equal parts; most pushes of one length are divided alike.

    :param counts: number of parts of each step.
    """
    nodes = np.zeros(len(counts) + 1, dtype=int)
    np.cumsum(counts, out=nodes[1:])
    steps = np.repeat(np.arange(len(counts)), counts)
    fractions = (1.0 / np.array(counts))[steps]
    return _Parts(steps, np.array([
        fractions, fractions * (np.arange(len(steps)) - nodes[steps])]).T, nodes)


class PartCounts(NamedTuple):
    """
    Division of the steps of a push into parts.

    The steps after whose begin w settles are fine at first: the first one, or, where the pushing
    angle jumps, all.

    :param graded: parts of each of those: their fractions, and those of what lies before them,
        shape (m, 2).
    :param fine: number of the parts of each step.
    :param coarse: the same in a coarse rollout.
    """

    graded: list[FloatArray]
    fine: tuple[int, ...]
    coarse: tuple[int, ...]

    @classmethod
    def of(cls, problem: PushProblem, lengths: FloatArray, changes: FloatArray,
           jumps: bool) -> 'PartCounts':
        """
        Divide steps.

        :param lengths: of the steps, shape (n,) [m].
        :param changes: of the pushing angle in them, about, shape (n,) [rad].
        :param jumps: whether the pushing angle jumps between them.
        """
        # At most half a part lies between two samples.
        longest = 2.0 * problem.settings.sample_spacing
        first = (JUMP_PART_RATIO if jumps else FIRST_PART_RATIO) * settling_distance(problem)
        graded = lengths if jumps else lengths[:1]
        fractions = [graded_fractions(length, first, longest) for length in graded.tolist()]
        return cls([np.array([parts, np.cumsum(parts) - parts]).T for parts in fractions], *(
            (*map(len, fractions), *np.ceil(equal[len(graded):]).astype(int).tolist())
            for equal in (np.maximum(lengths / longest, np.abs(changes) / MAX_CHANGE),
                          lengths / COARSE_PART)))

    @property
    def doublings(self) -> int:
        """Times that the least capacity of a memory is doubled for all parts to fit in."""
        return capacity_doublings(max(sum(self.fine), sum(self.coarse)))


def capacity_doublings(count: int) -> int:
    """
    Count how often ``MIN_CAPACITY`` is doubled for a number of parts to fit in.

    :param count: number of parts.
    """
    return max(0, math.ceil(math.log2(count / MIN_CAPACITY)))


class CapacityExceeded(Exception):
    """There are more parts than a memory has room for."""


class StepDivision:
    """
    Division of n steps into up to a number of parts.

    Attributes: ``count``, the number m of parts; ``steps``, the number of the step of each part;
    ``parts``, its fraction of that, and of what lies before it in it; ``nodes``, the number of the
    first part of each step, and m; ``changes``, that of the state after each of those;
    ``residuals``, what Newton's method leaves in each part.

    :param step_count: n.
    :param capacity: number of parts.
    """

    def __init__(self, step_count: int, capacity: int) -> None:
        """Allocate the memory."""
        self.count = 0
        # What the steps are divided into, where that is known.
        self._equal: Optional[_Parts] = None
        self.steps, self.parts = np.zeros(capacity, dtype=int), np.zeros((capacity, 2))
        self.nodes = np.zeros(step_count + 1, dtype=int)
        self.changes = np.zeros(step_count, dtype=int)
        self.residuals = np.zeros((capacity, 1))

    def divide(self, graded: list[FloatArray], counts: tuple[int, ...]) -> None:
        """
        Divide the steps.

        :param graded: parts of each of the first steps, see ``PartCounts``.
        :param counts: number of parts of each step; those of the others are equal.
        """
        equal = _equal_parts(counts)
        if equal is not self._equal:
            self._set(equal)
            self._equal = equal
        for start, parts in zip(equal.nodes.tolist(), graded):
            self.parts[start:start + len(parts)] = parts

    def _set(self, division: _Parts) -> None:
        count = len(division.steps)
        if count > len(self.steps):
            raise CapacityExceeded
        self.count, self._equal = count, None
        self.steps[:count], self.parts[:count], self.nodes[:] = division
        self.changes[:] = division.nodes[:-1] + 1

    def converged(self) -> bool:
        """Tell whether Newton's method has converged in all parts."""
        return bool(self.residuals[:self.count].max() <= CONVERGED)

    def first_failed(self) -> IntArray:
        """Find the first parts in which Newton's method has not converged."""
        failed = np.flatnonzero(~(self.residuals[:self.count, 0] <= CONVERGED))
        steps = self.steps[failed]
        return failed[steps < steps[0] + DIVIDED_STEPS]

    def refine(self, indices: IntArray) -> None:
        """
        Divide some parts further.

        :param indices: of the parts.
        :raises CapacityExceeded: where that makes too many.
        """
        steps, parts = self.steps[:self.count], self.parts[:self.count]
        counts = np.ones(self.count, dtype=int)
        counts[indices] = DIVISION
        finer = np.repeat(steps, counts)
        fractions = np.repeat(parts[:, 0] / counts, counts)
        within = np.arange(len(finer)) - np.repeat(np.cumsum(counts) - counts, counts)
        before = np.repeat(parts[:, 1], counts) + within * fractions
        self._set(_Parts(finer, np.array([fractions, before]).T,
                         np.searchsorted(finer, np.arange(len(self.nodes)))))
