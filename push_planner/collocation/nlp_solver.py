"""The programme and its solvers: fatrop, and ipopt on a relaxed one where that fails."""

import functools
import threading
from typing import NamedTuple

import casadi as ca
import numpy as np
from push_planner.collocation.dimensions import POINTS, ROWS_OF
from push_planner.collocation.transcription import PENALTY, SMOOTHING, Transcription


class Buffered:
    """
    A casadi function of dense values.

    Arrays are transposed against casadi's matrices: one row per column of those.

    :param function: the ``casadi.Function``.
    """

    def __init__(self, function):
        """Take the memory that the function reads and writes."""
        self.function = function
        self._buffer, self._evaluate = function.buffer()
        self._lock = threading.Lock()
        self._given = [np.zeros(function.size_in(i)[::-1]) for i in range(function.n_in())]
        self._found = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, array in enumerate(self._given):
            self._buffer.set_arg(i, memoryview(array))
        for i, array in enumerate(self._found):
            self._buffer.set_res(i, memoryview(array))

    def __call__(self, *given):
        """
        Evaluate.

        :param given: arrays or numbers; those of fewer rows are repeated.
        :return: list of arrays.
        """
        return self.with_stats(*given)[0]

    def with_stats(self, *given):
        """Evaluate; return the arrays and what casadi says of the call."""
        with self._lock:
            for array, value in zip(self._given, given):
                array[...] = value
            self._evaluate()
            return [array.copy() for array in self._found], self._buffer.stats()


NEGLIGIBLE = 1e-5
SHORTEST_WAY = 1e-3
UNSETTLED = 'the search did not settle'
QUIET = {'print_time': False, 'error_on_fail': False}
FATROP = {'fatrop': {'print_level': 0, 'tol': 3e-4, 'mu_init': 3e-5, 'bound_push': 0.1,
                     'max_iter': 40}}
IPOPT = {'ipopt': {'print_level': 0, 'sb': 'yes', 'max_iter': 80, 'tol': 1e-4, 'mu_init': 1e-2,
                   'acceptable_iter': 0, 'linear_solver': 'mumps'}}


class Solution(NamedTuple):
    """
    Iterate of the programme, in the object's start frame.

    :param way: S [m].
    :param nodes: (w, rho, theta, q_x, q_y, phi) at the nodes, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param rates: w at the Radau points, shape (n, K) [1/m].
    """

    way: float
    nodes: np.ndarray
    changes: np.ndarray
    rates: np.ndarray

    def column(self, shape):
        """
        Return the unknowns as one vector.

        :param shape: ``Dimensions`` of the programme.
        """
        n, states = shape.steps, shape.states
        table = np.zeros((n + 1, shape.width))
        table[:, 0] = self.way
        table[:, 1:states] = self.nodes[:, :states - 1]
        table[:n, states] = self.changes
        table[:n, states + 1:] = self.rates
        return table.ravel()[:shape.width * n + states]

    @classmethod
    def of(cls, column, shape):
        """
        Take the unknowns from a vector.

        :param column: the vector.
        :param shape: ``Dimensions`` of the programme.
        """
        n, states = shape.steps, shape.states
        table = np.append(column, np.zeros(1 + POINTS)).reshape(n + 1, shape.width)
        nodes = np.zeros((n + 1, 6))
        nodes[:, :states - 1] = table[:, 1:states]
        if shape.kind == 'held':
            nodes[:, 5] = nodes[:, 2]
        return cls(float(table[0, 0]), nodes, table[:n, states].copy(),
                   table[:n, states + 1:].copy())


class VariableBounds(NamedTuple):
    """
    Bounds on unknowns.

    :param angle: largest pushing angle [rad].
    :param first: (lowest, highest) pushing angle at the start [rad].
    :param turns: (lowest, highest) turn of the object [rad].
    :param places: (lowest, highest) followed point at the nodes, each of shape (n + 1, 2) [m].
    """

    angle: float
    first: tuple
    turns: tuple
    places: tuple = (-np.inf, np.inf)


class NlpSolver:
    """
    The programme of a shape.

    :param shape: ``Dimensions``.
    :param solver: casadi's name of the solver.
    :param options: for it.
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    """

    def __init__(self, shape, solver='fatrop', options=FATROP, smoothing=SMOOTHING):
        """Build the programme."""
        self.shape = shape
        self._equations = e = Transcription(shape, smoothing)
        self._upper = np.where(e.equality, 0.0, np.inf)
        options = {**QUIET, **options}
        if solver == 'fatrop':
            options.update(structure_detection='auto', equality=e.equality.tolist(),
                           cache=e.nlp.derivatives())
        else:
            options['expand'] = True
        self._solver = Buffered(ca.nlpsol('push', solver, {
            'x': e.nlp.x, 'p': e.nlp.p, 'f': e.nlp.cost, 'g': e.nlp.rows}, options))

    def solve(self, parameters, box, guess):
        """
        Solve the programme.

        :param parameters: numbers of ``BlockStructuredNlp.p``.
        :param box: ``VariableBounds``.
        :param guess: ``Solution`` to start from.
        :return: (``Solution`` or None, number of iterations).
        """
        low, high = self._bounds(box)
        (found, *_), stats = self._solver.with_stats(guess.column(self.shape), parameters, low,
                                                     high, 0.0, self._upper)
        count = int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return None, count
        return Solution.of(found.ravel(), self.shape), count

    def diagnose(self, parameters, box, guess):
        """
        Solve with bounds that give way at a price, more slowly and more surely.

        :param parameters: numbers of ``BlockStructuredNlp.p``.
        :param box: ``VariableBounds``.
        :param guess: ``Solution`` to start from.
        :return: (``Solution`` or None, what stands in the way, number of iterations).
        """
        column = np.append(guess.column(self.shape), 0.05)
        low, high = self._bounds(box)
        answer = self._relaxed(x0=column, p=parameters, lbx=np.append(low, 0.0),
                               ubx=np.append(high, np.inf), lbg=0.0, ubg=self._upper)
        stats = self._relaxed.stats()
        found, count = np.array(answer['x']).ravel(), int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return None, UNSETTLED, count
        if found[-1] > NEGLIGIBLE:
            prices = np.abs(np.array(answer['lam_g']).ravel())
            prices[self._equations.equality] = 0.0
            name = ROWS_OF[self._equations.names[int(prices.argmax())]]
            return None, f'{name} would be exceeded by {found[-1]:.2g}', count
        return Solution.of(found[:-1], self.shape), '', count

    @functools.cached_property
    def _relaxed(self):
        e = self._equations
        excess, nlp = ca.MX.sym('excess'), e.nlp
        return ca.nlpsol('relaxed', 'ipopt', {
            'x': ca.vertcat(nlp.x, excess), 'p': nlp.p,
            'f': nlp.cost + PENALTY * excess,
            'g': nlp.rows + ca.DM(np.where(e.equality, 0.0, 1.0)) * excess},
            {**QUIET, **IPOPT, 'expand': True})

    def _bounds(self, box):
        shape = self.shape
        low = np.full((shape.steps + 1, shape.width), -np.inf)
        high = -low
        low[0, 0] = SHORTEST_WAY
        low[:, 2], high[:, 2] = -box.angle, box.angle
        low[0, 2], high[0, 2] = box.first
        low[:, 3], high[:, 3] = box.turns
        low[:, 4:6], high[:, 4:6] = box.places
        size = shape.width * shape.steps + shape.states
        return low.ravel()[:size], high.ravel()[:size]


@functools.lru_cache(maxsize=32)
def nlp_solver(shape):
    """
    Build a programme, or take it from earlier.

    :param shape: ``Dimensions``.
    :return: ``NlpSolver``.
    """
    return NlpSolver(shape)
