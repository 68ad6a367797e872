"""
Interior point method for the program of a push, in time linear in the number of steps.

Slacks and multipliers of the inequalities stay positive, and the barrier parameter m falls to
nearly 0: primal and dual variables go on by Newton's method (see ``newton_step``), shortened until
a filter accepts the step. The filter holds pairs (violation, cost with barrier), and asks for an
improvement of one of both: A. Waechter and L. T. Biegler, On the implementation of an
interior-point filter line-search algorithm for large-scale nonlinear programming, 2006.

An iterate that solved nearly the same program is gone on from as it is, with its multipliers and
the last barrier parameter: then a step or two of Newton's method are enough.
"""

import collections
from collections.abc import Mapping
import functools
import math
import threading
from typing import NamedTuple, Optional

import numpy as np
from push_dynamics.machine_code import BoundRows, RowSequence
from push_model.geometry import FloatArray
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.newton_step import (
    Bounds, newton_functions, NewtonFunctions, Tuning,
)

# Barrier parameter at first, at first in a second attempt, and at the end [m], and of each step
# over that before. Chosen: the first leads to most solutions soonest, the second to others; the
# last costs a push about a millimetre at most (a hundred random pushes against 1e-8).
FIRST_BARRIER = 1e-2
SECOND_BARRIER = 1e-1
LAST_BARRIER = 1e-5
BARRIER_FACTOR = 0.01
# Largest error of a solution, in the units of the rows. Chosen: the refinement that follows takes
# a hundred times as much.
TOLERANCE = 3e-4
# Errors up to this multiple of the barrier parameter are small enough to lower it.
BARRIER_ACCURACY = 10.0
# Least slack at first: inequalities are kept off their edge.
FIRST_SLACK = 0.1
# Least slack of an iterate that is gone on from, and the largest ratio of its multipliers to those
# on the central path. Measured: 198 pushes under way take 2.6 iterations; with 1e-3 it is 2.9.
RESUMED_SLACK = 1e-4
CENTRALITY = 10.0
MAX_ITERATIONS = 40
# Successive iterates whose violations agree up to a ratio, where the method gives up. Measured: of
# 250 attempts at programs without a solution 94 % end so, after half as many iterations; of 556
# that converged none would have.
STAGNANT_ITERATES = 6
STAGNANT_RATIO = 1.05
MAX_HALVINGS = 6
# Regularization of the Hessian: the first, of each over the one before, and the largest.
FIRST_REGULARIZATION = 1e-4
REGULARIZATION_FACTOR = 10.0
MAX_REGULARIZATION = 1e4
# Least improvement that the filter asks for, of either value.
FILTER_MARGIN = 1e-5


class _Beginning(NamedTuple):
    """
    Beginning of an attempt.

    :param barrier: m.
    :param least_slack: of all inequalities.
    """

    barrier: float
    least_slack: float


# Attempts from a guess.
ATTEMPTS = (_Beginning(FIRST_BARRIER, FIRST_SLACK), _Beginning(SECOND_BARRIER, FIRST_SLACK))


class Iterate(NamedTuple):
    """
    Arrays that the method changes, flat; ``iterate_shapes`` tells their parts.

    :param primal: variables of the program, and slacks.
    :param dual: multipliers of the equalities, and of the inequalities.
    """

    primal: FloatArray
    dual: FloatArray


class IterateShapes(NamedTuple):
    """
    Shapes of the parts of an ``Iterate`` by name, in their order; n steps.

    Primal are the variables ``z`` and the slacks of inequalities at the start (``first``), of the
    steps (``step``) and at the end (``end``). Dual are the multipliers of the dynamics
    (``costates``), of the moment balance (``nu``), of start (``eta``) and goal (``goal``), and of
    the same inequalities.

    :param primal: name -> shape.
    :param dual: name -> shape.
    :param slacks: those of the inequalities alone.
    """

    primal: Mapping[str, tuple[int, ...]]
    dual: Mapping[str, tuple[int, ...]]
    slacks: Mapping[str, tuple[int, ...]]


class InteriorResult(NamedTuple):
    """
    Result of the method.

    :param iterate: the last ``Iterate``, a solution; None where it did not converge.
    :param iterations: number of iterations.
    """

    iterate: Optional[Iterate]
    iterations: int


class _Evaluation(NamedTuple):
    """
    Judgement of an iterate.

    :param violation: sum over all rows.
    :param merit: cost with barrier.
    :param error: largest violation, or component of the gradient of the Lagrangian.
    :param excess: largest product of a slack and its multiplier.
    """

    violation: float
    merit: float
    error: float
    excess: float

    @property
    def is_finite(self) -> bool:
        """Tell whether all steps have numbers; the largest of some is one where only some have."""
        return math.isfinite(self.violation + self.merit + self.error)

    def is_solution(self, barrier: float) -> bool:
        """
        Tell whether it solves the program with a barrier parameter, accurately enough to go on.

        :param barrier: m.
        """
        return (self.error < max(TOLERANCE, BARRIER_ACCURACY * barrier)
                and self.excess < BARRIER_ACCURACY * barrier)


class InteriorPointMethod:
    """
    Solves all programs of the same dimensions, in memory that is allocated once.

    :param dimensions: ``Dimensions``.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Allocate the memory, and bind the functions to it."""
        self._lock = threading.Lock()
        self._memory = _Memory(dimensions)

    def solve(self, common: FloatArray, data: FloatArray, bounds: Bounds,
              guess: FloatArray) -> InteriorResult:
        """
        Solve the program.

        :param common: parameters of the whole push.
        :param data: parameters of the steps, a row each.
        :param guess: variables to start from.
        """
        with self._lock:
            self._memory.set_program(common, data, bounds)
            return self._result(*_solve_from(self._memory, guess))

    def resume(self, common: FloatArray, data: FloatArray, bounds: Bounds,
               iterate: Iterate, has_slacks: bool = True) -> InteriorResult:
        """
        Solve the program from the solution of nearly the same one.

        :param common: parameters of the whole push.
        :param data: parameters of the steps, a row each.
        :param iterate: ``Iterate`` of the former solution.
        :param has_slacks: whether it has slacks; else they follow from the rows.
        """
        with self._lock:
            self._memory.set_program(common, data, bounds)
            self._memory.resume(iterate, has_slacks)
            return self._result(*_iterate(self._memory))

    def _result(self, converged: bool, count: int) -> InteriorResult:
        memory = self._memory
        iterate = Iterate(memory.primal.copy(), memory.dual.copy()) if converged else None
        return InteriorResult(iterate, count)


def _solve_from(memory: '_Memory', guess: FloatArray) -> tuple[bool, int]:
    """Solve from variables, if need be in a second attempt."""
    total = 0
    for beginning in ATTEMPTS:
        memory.start(guess, beginning)
        converged, count = _iterate(memory)
        total += count
        if converged:
            return True, total
    return False, total


def _iterate(memory: '_Memory') -> tuple[bool, int]:
    """Take steps until the conditions hold; tell whether they do, and the number of steps."""
    filter_entries: list[_Evaluation] = []
    present = memory.evaluate()
    violations: collections.deque[float] = collections.deque(maxlen=STAGNANT_ITERATES)
    for count in range(MAX_ITERATIONS):
        violations.append(present.violation)
        if not present.is_finite or _is_stagnant(violations):
            return False, count
        while present.is_solution(memory.tuning[0]):
            if memory.tuning[0] <= LAST_BARRIER:
                return True, count
            memory.tuning[0] = max(LAST_BARRIER, BARRIER_FACTOR * memory.tuning[0])
            filter_entries.clear()
            present = memory.evaluate()
        if not memory.find_step():
            return False, count
        filter_entries.append(present)
        accepted = _search(memory, filter_entries)
        if accepted is None:
            return False, count
        present = accepted
    return False, MAX_ITERATIONS


def _is_stagnant(violations: collections.deque[float]) -> bool:
    """Tell whether constraints stay violated by the same amount: no solution is near."""
    least = min(violations)
    return (len(violations) == STAGNANT_ITERATES and least > TOLERANCE
            and max(violations) < STAGNANT_RATIO * least)


def _search(memory: '_Memory', entries: list[_Evaluation]) -> Optional[_Evaluation]:
    """Shorten the step until the filter accepts it."""
    for halvings in range(MAX_HALVINGS):
        accepted = memory.halve_step() if halvings else memory.take_step()
        if all(accepted.violation <= (1.0 - FILTER_MARGIN) * entry.violation
               or accepted.merit <= entry.merit - FILTER_MARGIN * entry.violation
               for entry in entries):
            return accepted
    return None


class _Views(NamedTuple):
    """
    Parts of an iterate and of a step of it by name, and the rows of the inequalities.

    :param primal: variables and slacks.
    :param primal_step: their changes.
    :param dual: multipliers.
    :param dual_step: their changes.
    :param rows: values of the inequalities.
    """

    primal: dict[str, FloatArray]
    primal_step: dict[str, FloatArray]
    dual: dict[str, FloatArray]
    dual_step: dict[str, FloatArray]
    rows: dict[str, FloatArray]


class _Recursion(NamedTuple):
    """
    Results of the evaluation of n steps, and of the recursion of Riccati over them.

    :param record: of each step for the recursion, shape (n, r).
    :param expansion: of each step for what was eliminated, shape (n, e).
    :param values: P_k, lower triangles, shape (n + 1, v).
    :param linear: p_k, shape (n + 1, states).
    :param gains: K_k, shape (n, states).
    :param feedforwards: k_k, shape (n, 1).
    """

    record: FloatArray
    expansion: FloatArray
    values: FloatArray
    linear: FloatArray
    gains: FloatArray
    feedforwards: FloatArray

    @classmethod
    def allocate(cls, functions: NewtonFunctions, n: int, states: int) -> '_Recursion':
        step, end = functions.evaluate.sizes, functions.evaluate_end.sizes
        return cls(np.zeros((n, step['record'])), np.zeros((n, step['expansion'])),
                   np.zeros((n + 1, end['values'])), np.zeros((n + 1, states)),
                   np.zeros((n, states)), np.zeros((n, 1)))


class _Memory:
    """
    Arrays of the method, and its functions bound to them.

    Flat arrays hold all that a step changes: variables and then slacks, multipliers of equalities
    and then of inequalities.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        n, states = dimensions.step_count, dimensions.state_count
        functions = newton_functions(dimensions._replace(step_count=1))
        step, shapes = functions.evaluate.sizes, iterate_shapes(dimensions)
        self.primal, primal = _allocate(shapes.primal)
        self.primal_step, primal_step = _allocate(shapes.primal)
        self.dual, dual = _allocate(shapes.dual)
        self.dual_step, dual_step = _allocate(shapes.dual)
        self._rows, rows = _allocate(shapes.slacks)
        self._slacks = slice((n + 1) * dimensions.step_size, None)
        self._multipliers = slice(-_size(shapes.slacks), None)
        self.common, self.data = np.zeros(step['common']), np.zeros((n, step['data']))
        self.bounds, self.tuning = np.zeros(len(Bounds._fields)), np.zeros(len(Tuning._fields))
        # Of all steps, the start, and the end.
        self._measures, self._accumulated = (np.zeros((n + 2 + more, step['measures']))
                                             for more in (0, 1))
        # Of the start, all steps, and the end.
        self._limits = np.zeros((n + 2, 2))
        # Of all steps from the end, and then the start: row 0 is that of the end, without any.
        self._indefinite_pivots = np.zeros((n + 2, 1))
        accumulate = functions.accumulate.bind({
            'before': self._accumulated[:-1], 'present': self._measures,
            'accumulated': self._accumulated[1:]})
        views = _Views(primal, primal_step, dual, dual_step, rows)
        recursion = _Recursion.allocate(functions, n, states)
        evaluate_first, start = self._bind_start(functions, views, recursion)
        evaluate, expand, recur = self._bind_steps(functions, views, recursion)
        evaluate_end, expand_end = self._bind_end(functions, views, recursion)
        self._before, self._dual_before = np.zeros_like(self.primal), np.zeros_like(self.dual)
        lengths = np.zeros(2)
        self._length = lengths[:1]
        advance = _advance(functions, self._before, self.primal_step, lengths[:1], self.primal)
        advance_dual = _advance(functions, self._dual_before, self.dual_step, lengths[1:],
                                self.dual)
        step_lengths = functions.step_lengths.bind({'limits': self._limits[-1],
                                                    'lengths': lengths})
        self._evaluate = RowSequence(evaluate_first, evaluate, evaluate_end, accumulate)
        self._find_step = RowSequence(recur, start)
        self._repeat_step = RowSequence(advance, self._evaluate)
        self._take_step = RowSequence(expand, expand_end, step_lengths, advance_dual,
                                      self._repeat_step)

    @property
    def _inputs(self) -> dict[str, FloatArray]:
        return {'common': self.common, 'bounds': self.bounds, 'tuning': self.tuning}

    def _bind_start(self, functions: NewtonFunctions, views: _Views,
                    recursion: _Recursion) -> tuple[BoundRows, BoundRows]:
        """Bind the evaluation and the step of the start."""
        primal, primal_step, dual, dual_step, rows = views
        n, states = recursion.gains.shape
        inputs = {'z': primal['z'][0], 'y': dual['first'], 's': primal['first'],
                  'eta': dual['eta'], 'data': self.data[0], **self._inputs}
        return (
            functions.evaluate_first.bind({
                **inputs, 'present': dual['costates'][0], 'rows': rows['first'],
                'measures': self._measures[n]}),
            functions.start.bind({
                **inputs, 'values': recursion.values[0], 'linear': recursion.linear[0],
                'dx': primal_step['z'][0, :states], 'ds': primal_step['first'],
                'dy': dual_step['first'], 'deta': dual_step['eta'], 'limits': self._limits[0],
                'indefinite_next': self._indefinite_pivots[n],
                'indefinite': self._indefinite_pivots[n + 1]}))

    def _bind_steps(self, functions: NewtonFunctions, views: _Views, recursion: _Recursion
                    ) -> tuple[BoundRows, BoundRows, BoundRows]:
        """Bind the evaluation, the step and the recursion of all steps."""
        primal, primal_step, dual, dual_step, rows = views
        record, expansion, values, linear, gains, feedforwards = recursion
        n, states = gains.shape
        z, dz, costates = primal['z'], primal_step['z'], dual['costates']
        inputs = {'y': dual['step'], 's': primal['step'], 'following': costates[1:],
                  'nu': dual['nu'], 'record': record, 'expansion': expansion}
        return (
            functions.evaluate.bind({
                **inputs, **self._inputs, 'z': z[:n], 'x_next': z[1:, :states], 'data': self.data,
                'present': costates[:-1], 'rows': rows['step'], 'measures': self._measures[:n]}),
            functions.expand.bind({
                **inputs, 'tuning': self.tuning, 'dx': dz[:n, :states], 'gain': gains,
                'feedforward': feedforwards, 'values_next': values[1:], 'linear_next': linear[1:],
                'dx_next': dz[1:, :states], 'dcontrols': dz[:n, states:],
                'ds': primal_step['step'], 'dy': dual_step['step'],
                'dfollowing': dual_step['costates'][1:], 'dnu': dual_step['nu'],
                'limits_before': self._limits[:n], 'limits': self._limits[1:n + 1]}),
            functions.recur.bind({
                'record': record[::-1], 'values_next': values[:0:-1],
                'linear_next': linear[:0:-1], 'tuning': self.tuning, 'values': values[-2::-1],
                'linear': linear[-2::-1], 'gain': gains[::-1], 'feedforward': feedforwards[::-1],
                'indefinite_next': self._indefinite_pivots[:n],
                'indefinite': self._indefinite_pivots[1:n + 1]}))

    def _bind_end(self, functions: NewtonFunctions, views: _Views,
                  recursion: _Recursion) -> tuple[BoundRows, BoundRows]:
        """Bind the evaluation and the step of the end."""
        primal, primal_step, dual, dual_step, rows = views
        n, states = recursion.gains.shape
        inputs = {'x': primal['z'][n, :states], 'y': dual['end'], 's': primal['end'],
                  'goal': dual['goal'], **self._inputs}
        return (
            functions.evaluate_end.bind({
                **inputs, 'present': dual['costates'][n], 'values': recursion.values[n],
                'linear': recursion.linear[n], 'rows': rows['end'],
                'measures': self._measures[n + 1]}),
            functions.expand_end.bind({
                **inputs, 'dx': primal_step['z'][n, :states], 'ds': primal_step['end'],
                'dy': dual_step['end'], 'dgoal': dual_step['goal'],
                'limits_before': self._limits[n], 'limits': self._limits[n + 1]}))

    def set_program(self, common: FloatArray, data: FloatArray, bounds: Bounds) -> None:
        """Take the parameters of a program."""
        self.common[:] = common
        self.data[:] = data
        self.bounds[:] = bounds

    def resume(self, iterate: Iterate, has_slacks: bool) -> None:
        """Start from the solution of nearly the same program, next to its central path."""
        self.primal[:], self.dual[:] = iterate
        self.tuning[:] = LAST_BARRIER, 0.0
        slacks, multipliers = self.primal[self._slacks], self.dual[self._multipliers]
        if not has_slacks:
            self._evaluate()
            slacks[:] = self._rows
        np.maximum(slacks, RESUMED_SLACK, out=slacks)
        central = LAST_BARRIER / slacks
        np.maximum(multipliers, central / CENTRALITY, out=multipliers)
        np.minimum(multipliers, CENTRALITY * central, out=multipliers)

    def start(self, guess: FloatArray, beginning: _Beginning) -> None:
        """Start from variables: slacks off the edge, multipliers on the central path."""
        barrier, least_slack = beginning
        self.primal[:] = 1.0
        self.primal[:len(guess)] = guess
        self.dual[:] = 0.0
        self.tuning[:] = barrier, 0.0
        self.evaluate()
        self.primal[self._slacks] = np.maximum(self._rows, least_slack)
        self.dual[self._multipliers] = barrier / self.primal[self._slacks]

    def evaluate(self) -> _Evaluation:
        """Evaluate all rows and their derivatives, and take their measures."""
        self._evaluate()
        return self._evaluation()

    def _evaluation(self) -> _Evaluation:
        violation, log_slacks, cost, primal, dual, excess = self._accumulated[-1].tolist()
        merit = cost - self.tuning[0] * log_slacks
        return _Evaluation(violation, merit, max(primal, dual), excess)

    def find_step(self) -> bool:
        """Find the Newton step; False where no regularization makes the Hessian positive."""
        regularization = 0.0
        while regularization <= MAX_REGULARIZATION:
            self.tuning[1] = regularization
            self._find_step()
            if self._indefinite_pivots[-1, 0] == 0.0:
                return True
            regularization = max(FIRST_REGULARIZATION, REGULARIZATION_FACTOR * regularization)
        return False

    def take_step(self) -> _Evaluation:
        """Take as much of the step as keeps slacks and multipliers positive."""
        self._before[:], self._dual_before[:] = self.primal, self.dual
        self._take_step()
        return self._evaluation()

    def halve_step(self) -> _Evaluation:
        """Take half as much of the step of the variables and slacks as before."""
        self._length *= 0.5
        self._repeat_step()
        return self._evaluation()


def _advance(functions: NewtonFunctions, before: FloatArray, step: FloatArray,
             length: FloatArray, present: FloatArray) -> BoundRows:
    """Bind a step of all numbers of flat arrays."""
    return functions.advance.bind({
        'before': before[:, None], 'step': step[:, None], 'length': length,
        'present': present[:, None]})


@functools.lru_cache(maxsize=64)
def iterate_shapes(dimensions: Dimensions) -> IterateShapes:
    """List the parts of iterates."""
    n, states = dimensions.step_count, dimensions.state_count
    functions = newton_functions(dimensions._replace(step_count=1))
    first, step, end = (function.sizes for function in (
        functions.evaluate_first, functions.evaluate, functions.evaluate_end))
    slacks = {'first': (first['s'],), 'step': (n, step['s']), 'end': (end['s'],)}
    return IterateShapes(
        {'z': (n + 1, dimensions.step_size), **slacks},
        {'costates': (n + 1, states), 'nu': (n, step['nu']), 'eta': (first['eta'],),
         'goal': (end['goal'],), **slacks}, slacks)


def parts_of(flat: FloatArray, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, FloatArray]:
    """
    Divide a flat array.

    :param flat: the array.
    :param shapes: name -> shape of each part, in their order.
    :return: name -> view of the part.
    """
    views: dict[str, FloatArray] = {}
    start = 0
    for name, shape in shapes.items():
        end = start + math.prod(shape)
        views[name] = flat[start:end].reshape(shape)
        start = end
    return views


def _allocate(shapes: Mapping[str, tuple[int, ...]]) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Make one flat array of zeros, and views of its parts."""
    flat = np.zeros(_size(shapes))
    return flat, parts_of(flat, shapes)


def _size(shapes: Mapping[str, tuple[int, ...]]) -> int:
    return sum(map(math.prod, shapes.values()))
