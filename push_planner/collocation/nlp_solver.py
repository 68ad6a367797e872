"""
Solvers of the nonlinear program of a push.

Fatrop solves the program. Where it fails, ipopt solves a relaxed one, whose inequalities may all
be violated by a common excess e >= 0 at a price, ``g_i(x) + e >= 0``: slower and more robust, and
an excess that remains at the optimum tells which limit cannot be kept.
"""

import functools
import threading
from typing import Any, NamedTuple, Optional, Union

import casadi as ca
import numpy as np
from push_model.geometry import FloatArray
from push_model.plan_request import PlanFailure
from push_planner.collocation.dimensions import Dimensions
from push_planner.collocation.interior_point import Iterate
from push_planner.collocation.transcription import SMOOTHING, Transcription

# Price of the excess in the relaxed program [m]. Chosen: dear against paths of some metres, so
# that limits are violated only where no push keeps them.
EXCESS_PRICE = 100.0
# Excess that the relaxed program starts from, and up to which it counts as none. Chosen: a
# noticeable violation; and the tolerance of the solver.
FIRST_EXCESS = 0.05
NEGLIGIBLE_EXCESS = 1e-5
# Least free length S of a push [m]. Chosen: steps of no length would divide by zero.
MIN_FREE_LENGTH = 1e-3
QUIET = {'print_time': False, 'error_on_fail': False}
# Chosen: the accuracy that the refinement after it needs, and a small barrier from the start, as
# the initial guess is near the optimum.
FATROP = {'fatrop': {'print_level': 0, 'tol': 3e-4, 'mu_init': 3e-5, 'bound_push': 0.1,
                     'max_iter': 40}}
IPOPT = {'ipopt': {'print_level': 0, 'sb': 'yes', 'max_iter': 80, 'tol': 1e-4, 'mu_init': 1e-2,
                   'acceptable_iter': 0, 'linear_solver': 'mumps'}}


class BufferedFunction:
    """
    A casadi function of dense values, evaluated in memory that is allocated once.

    Arrays are transposed against casadi's matrices, which are stored by columns: one row for each
    column of those.

    :param function: the ``casadi.Function``.
    """

    def __init__(self, function: Any) -> None:
        """Allocate what the function reads and writes."""
        self._buffer, self._evaluate = function.buffer()
        self._lock = threading.Lock()
        self._inputs = [np.zeros(function.size_in(i)[::-1]) for i in range(function.n_in())]
        self._outputs = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, array in enumerate(self._inputs):
            self._buffer.set_arg(i, array.data)
        for i, array in enumerate(self._outputs):
            self._buffer.set_res(i, array.data)

    def __call__(self, *inputs: Union[float, FloatArray]) -> list[FloatArray]:
        """
        Evaluate the function.

        :param inputs: arrays or numbers; those of fewer rows are repeated.
        """
        return self.with_stats(*inputs)[0]

    def with_stats(self, *inputs: Union[float, FloatArray]) -> tuple[list[FloatArray],
                                                                     dict[str, Any]]:
        """
        Evaluate the function.

        :param inputs: as of a call.
        :return: (arrays, statistics of casadi).
        """
        with self._lock:
            for array, value in zip(self._inputs, inputs):
                array[...] = value
            self._evaluate()
            return [array.copy() for array in self._outputs], self._buffer.stats()


class Solution(NamedTuple):
    """
    Iterate of the program, in the object's start frame.

    :param free_length: S [m].
    :param nodes: (w, rho, theta, q_x, q_y, phi) at the nodes, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param rates: w at the Radau points, shape (n, K) [1/m].
    """

    free_length: float
    nodes: FloatArray
    changes: FloatArray
    rates: FloatArray

    def column(self, dimensions: Dimensions) -> FloatArray:
        """
        Return the variables of the program as one vector.

        :param dimensions: ``Dimensions`` of the program.
        """
        n = dimensions.step_count
        states = dimensions.state_count
        table = np.zeros((n + 1, dimensions.step_size))
        table[:, 0] = self.free_length
        table[:, 1:states] = self.nodes[:, :states - 1]
        table[:n, states] = self.changes
        table[:n, states + 1:] = self.rates
        return table.ravel()[:dimensions.variable_count]

    @classmethod
    def of_column(cls, column: FloatArray, dimensions: Dimensions) -> 'Solution':
        """
        Take the variables of the program from a vector.

        :param column: the vector.
        :param dimensions: ``Dimensions`` of the program.
        """
        n = dimensions.step_count
        states = dimensions.state_count
        table = np.zeros((n + 1, dimensions.step_size))
        # The end has no controls.
        table.ravel()[:len(column)] = column
        nodes = np.zeros((n + 1, 6))
        nodes[:, :states - 1] = table[:, 1:states]
        if dimensions.kind == 'held':
            nodes[:, 5] = nodes[:, 2]
        return cls(float(table[0, 0]), nodes, table[:n, states].copy(),
                   table[:n, states + 1:].copy())


class VariableBounds(NamedTuple):
    """
    Bounds on the variables of the program.

    :param angle: largest pushing angle [rad].
    :param first_angle: (lowest, highest) pushing angle at the start [rad].
    :param rotation: (lowest, highest) rotation of the object [rad].
    """

    angle: float
    first_angle: tuple[float, float]
    rotation: tuple[float, float]


class SolveResult(NamedTuple):
    """
    Result of solving the program.

    :param solution: ``Solution``; None where there is none.
    :param iterations: number of iterations.
    :param failure: ``PlanFailure``; None with a solution.
    :param verdict: the failure in words.
    :param iterate: ``Iterate`` to resume from; None without a solution, and of other methods than
        the interior point method of the planner.
    """

    solution: Optional[Solution]
    iterations: int
    failure: Optional[PlanFailure] = None
    verdict: str = ''
    iterate: Optional[Iterate] = None


class NlpSolver:
    """
    Solver of all programs of the same dimensions.

    :param dimensions: ``Dimensions``.
    :param solver: casadi's name of the solver.
    :param options: of the solver.
    :param smoothing: sliding speed below which the supports' friction becomes viscous, per pushing
        speed.
    """

    def __init__(self, dimensions: Dimensions, solver: str = 'fatrop',
                 options: dict[str, Any] = FATROP, smoothing: float = SMOOTHING) -> None:
        """Build the program."""
        self._dimensions = dimensions
        self._transcription = transcription = Transcription(dimensions, smoothing)
        self._upper = np.where(transcription.equality, 0.0, np.inf)
        options = {**QUIET, **options}
        nlp = transcription.nlp
        if solver == 'fatrop':
            options.update(structure_detection='auto', equality=transcription.equality.tolist(),
                           cache=nlp.derivatives())
        else:
            options['expand'] = True
        self._solver = BufferedFunction(ca.nlpsol('push', solver, {
            'x': nlp.x, 'p': nlp.p, 'f': nlp.cost, 'g': nlp.rows}, options))

    def solve(self, parameters: FloatArray, bounds: VariableBounds,
              guess: Solution) -> SolveResult:
        """
        Solve the program.

        :param parameters: of the program, see ``BlockStructuredNlp``.
        :param bounds: ``VariableBounds``.
        :param guess: ``Solution`` to start from.
        """
        low, high = self._bounds(bounds)
        (found, *_), stats = self._solver.with_stats(guess.column(self._dimensions), parameters,
                                                     low, high, 0.0, self._upper)
        count = int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return SolveResult(None, count, PlanFailure.NOT_CONVERGED, 'not solved')
        return SolveResult(Solution.of_column(found.ravel(), self._dimensions), count)

    def solve_relaxed(self, parameters: FloatArray, bounds: VariableBounds,
                      guess: Solution) -> SolveResult:
        """
        Solve the relaxed program, more slowly and more robustly.

        :param parameters: of the program, see ``BlockStructuredNlp``.
        :param bounds: ``VariableBounds``.
        :param guess: ``Solution`` to start from.
        """
        column = np.append(guess.column(self._dimensions), FIRST_EXCESS)
        low, high = self._bounds(bounds)
        answer = self._relaxed(x0=column, p=parameters, lbx=np.append(low, 0.0),
                               ubx=np.append(high, np.inf), lbg=0.0, ubg=self._upper)
        stats = self._relaxed.stats()
        found = np.array(answer['x']).ravel()
        count = int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return SolveResult(None, count, PlanFailure.NOT_CONVERGED,
                               'the search did not converge')
        excess = found[-1]
        if excess > NEGLIGIBLE_EXCESS:
            limit = self._dearest_limit(np.array(answer['lam_g']).ravel())
            return SolveResult(None, count, PlanFailure.LIMIT_EXCEEDED,
                               f'{limit} would be exceeded by {excess:.2g}')
        return SolveResult(Solution.of_column(found[:-1], self._dimensions), count)

    def _dearest_limit(self, multipliers: FloatArray) -> str:
        """Name the inequality with the largest multiplier."""
        prices = np.abs(multipliers)
        prices[self._transcription.equality] = 0.0
        constraint = self._transcription.constraints[int(prices.argmax())]
        return constraint.value if constraint else ''

    @functools.cached_property
    def _relaxed(self) -> Any:
        excess = ca.MX.sym('excess')
        nlp = self._transcription.nlp
        inequality = ca.DM(np.where(self._transcription.equality, 0.0, 1.0))
        return ca.nlpsol('relaxed', 'ipopt', {
            'x': ca.vertcat(nlp.x, excess), 'p': nlp.p, 'f': nlp.cost + EXCESS_PRICE * excess,
            'g': nlp.rows + inequality * excess}, {**QUIET, **IPOPT, 'expand': True})

    def _bounds(self, bounds: VariableBounds) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values of the variables; columns are S, w, rho, theta, q_x, q_y."""
        dimensions = self._dimensions
        low = np.full((dimensions.step_count + 1, dimensions.step_size), -np.inf)
        high = -low
        low[0, 0] = MIN_FREE_LENGTH
        low[:, 2], high[:, 2] = -bounds.angle, bounds.angle
        low[0, 2], high[0, 2] = bounds.first_angle
        low[:, 3], high[:, 3] = bounds.rotation
        return (low.ravel()[:dimensions.variable_count],
                high.ravel()[:dimensions.variable_count])


@functools.lru_cache(maxsize=32)
def nlp_solver(dimensions: Dimensions) -> NlpSolver:
    """
    Build a solver, or return the one that was built before: building takes longer than solving.

    :param dimensions: ``Dimensions``.
    """
    return NlpSolver(dimensions)
