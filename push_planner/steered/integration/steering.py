"""
Steering of a push: feedback along it, and the feed-forward that takes off a miss at its end.

Both come from one linear-quadratic problem in the deviations x = (w, rho, theta, q_x, q_y, phi, S)
of the nodes and S:

    x_{k+1} = A_k x_k + b_k u_k                             A_k, b_k: derivatives of a step
    minimise  sum_k (x_k' Q x_k + r u_k^2) + x_n' Q_f x_n + r_S x_0[S]^2
              + (x_n + m)' Q_n (x_n + m)

with u the deviations of the changes of the pushing angle and m the miss at the end. Without the
miss, backwards:

    P_n = Q_f,     R_k = r + b' P_{k+1} b,     K_k = b' P_{k+1} A / R_k
    P_k = Q + A' P_{k+1} A - (A' P b) K_k

The feedback knows of no goal: it would meet it in the last two steps, at any price. The goal is
met by v_k = u_k + K_k x_k, which is spread over the push. Up to a constant the cost is

    sum_k R_k v_k^2 + R_S x_0[S]^2 + (x_n + m)' Q_n (x_n + m),           R_S = r_S + P_0[S, S]

and in closed loop x_n is linear in all v_k and x_0[S], with costates L of the components of x_n:

    L_n = 1,       L_k = (A_k - b_k K_k)' L_{k+1},         l_k = L_{k+1}' b_k / R_k
    G = sum_k R_k l_k l_k' + L_0[S]' L_0[S] / R_S,         y = (Q_n^-1 + G)^-1 m
    v_k = -l_k' y,                                         x_0[S] = -L_0[S] y / R_S
"""

import functools
from typing import NamedTuple

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction, RowSequence
from push_model.geometry import FloatArray

# Weights Q of the deviations (w, rho, theta, q_x, q_y, phi, S) along the push, and Q_f at its end.
# Chosen: metres and radians alike. Measured: of 1, 10, 100 and 1000 times Q, ten times needs the
# fewest corrections.
WEIGHTS = np.diag([0.0, 0.0, 1.0, 1.0, 1.0, 0.1, 0.0])
FEEDBACK_END_WEIGHTS = 10.0 * WEIGHTS
# Weights of the miss, the diagonal of Q_n, without and with a final straight. Chosen: 1e4 times
# those along the push, as the goal must be met.
END_WEIGHTS = np.array([0.0, 0.0, 1e4, 1e4, 1e4, 0.0, 0.0])
STRAIGHT_END_WEIGHTS = np.array([0.0, 1e4, 1e4, 1e4, 1e4, 1e3, 0.0])
# Costs r of a change of the pushing angle and r_S of one of S. Chosen: deviations decay within a
# wheelbase or two; S is left to the program, as it decides on the time.
CHANGE_COST = 0.03
FREE_LENGTH_COST = 10.0


class SteeringSolution(NamedTuple):
    """
    Solution of the problem but for the miss; see the formulas of the module.

    :param first_values: P_0, shape (7, 7).
    :param gains: K_k, shape (n, 7).
    :param feedforwards: l_k, shape (n, 7).
    :param by_length: L_0[S], response of the end to S, shape (7,).
    :param strength: G but for the part of S, shape (7, 7).
    """

    first_values: FloatArray
    gains: FloatArray
    feedforwards: FloatArray
    by_length: FloatArray
    strength: FloatArray


class SteeringMemory:
    """
    Memory of the problem, and its functions bound to it; n steps.

    Given are ``maps``, (A_k, b_k) of each step, shape (n, 7, 8), the ``miss`` m, the diagonal
    ``end_weights`` of Q_n, the ``changes`` of the pushing angle, shape (n, 1), and the
    ``free_length`` S, shape (1,). Found are the ``values`` P_k, shape (n + 1, 7, 7), and
    ``present``, views of a ``SteeringSolution``.

    Attributes: ``solve``, the ``RowSequence`` that solves the problem but for the miss;
    ``correct``, the one that takes off the miss: it adds v_k - K_k[S] x_0[S] to the changes, as
    all gains respond to the longer path from the first step on, and x_0[S] to S.

    :param count: n.
    """

    def __init__(self, count: int) -> None:
        """Allocate the memory."""
        self.maps, self.values = np.zeros((count, 7, 8)), np.zeros((count + 1, 7, 7))
        self.changes, self.free_length = np.zeros((count, 1)), np.zeros(1)
        self.miss, self.end_weights = np.zeros(7), np.zeros(7)
        gains, feedforwards = np.zeros((count, 7)), np.zeros((count, 7))
        costates, strengths = np.zeros((count + 1, 7, 7)), np.zeros((count + 1, 7, 7))
        self.values[-1], costates[-1] = FEEDBACK_END_WEIGHTS, np.eye(7)
        self.present = SteeringSolution(self.values[0], gains, feedforwards, costates[0, 6],
                                        strengths[0])
        functions = _functions()
        rows = {name: array.reshape(len(array), -1) for name, array in (
            ('maps', self.maps), ('values', self.values), ('costates', costates),
            ('strengths', strengths))}
        # From the last step to the first.
        backwards = {'map': rows['maps'][::-1], 'next_values': rows['values'][:0:-1],
                     'gains': gains[::-1]}
        self.solve = RowSequence(
            functions.riccati.bind({**backwards, 'values': rows['values'][-2::-1]}),
            functions.costates.bind({
                **backwards, 'next_costates': rows['costates'][:0:-1],
                'costates': rows['costates'][-2::-1], 'leads': feedforwards[::-1],
                'next_strength': rows['strengths'][:0:-1],
                'strength': rows['strengths'][-2::-1]}))
        y, longer = np.zeros(7), np.zeros(1)
        self.correct = RowSequence(
            functions.aim.bind({
                'strength': rows['strengths'][0], 'by_length': self.present.by_length,
                'first_values': rows['values'][0], 'weights': self.end_weights,
                'miss': self.miss, 'before': self.free_length, 'y': y, 'longer': longer,
                'free_length': self.free_length}),
            functions.correct.bind({
                'before': self.changes, 'feedforward': feedforwards, 'gains': gains, 'y': y,
                'longer': longer, 'change': self.changes}))

    def load(self, steering: SteeringSolution) -> None:
        """Take a solution of before."""
        for present, value in zip(self.present, steering):
            present[:] = value

    def copy(self) -> SteeringSolution:
        """Copy the solution."""
        return SteeringSolution(*(present.copy() for present in self.present))


class _Functions(NamedTuple):
    """One step of the recursions of P_k and K_k, and of L_k and G; y and x_0[S]; the changes."""

    riccati: RowFunction
    costates: RowFunction
    aim: RowFunction
    correct: RowFunction


@functools.lru_cache(maxsize=1)
def _functions() -> _Functions:
    """Build the formulas of this module for one step; arrays go row by row, casadi by columns."""
    rows, following = ca.SX.sym('map', 8, 7), ca.SX.sym('next_values', 7, 7)
    gains, columns = ca.SX.sym('gains', 7), ca.SX.sym('next_costates', 7, 7)
    transition, b = rows[:7, :].T, rows[7, :].T
    cross = transition.T @ (following @ b)
    cost = CHANGE_COST + b.T @ following @ b
    values = ca.DM(WEIGHTS) + transition.T @ following @ transition - cross @ cross.T / cost
    riccati = ca.Function('riccati', [rows, following], ca.cse([
        # What rounding makes unsymmetric would grow from step to step.
        ca.densify(ca.tril2symm(ca.tril(values))), cross / cost]),
        ['map', 'next_values'], ['values', 'gains'])
    pulls, accumulated = columns @ b, ca.SX.sym('next_strength', 7, 7)
    costates = ca.Function('costates', [rows, following, gains, columns, accumulated], ca.cse([
        ca.densify(columns @ transition - pulls @ gains.T), pulls / cost,
        accumulated + pulls @ pulls.T / cost]),
        ['map', 'next_values', 'gains', 'next_costates', 'next_strength'],
        ['costates', 'leads', 'strength'])
    return _Functions(RowFunction(riccati), RowFunction(costates), _aim(), _correct())


def _aim() -> RowFunction:
    """Build y and x_0[S] of a miss; y = W (1 + W G W)^-1 W m with W^2 = Q_n, as Q_n has zeros."""
    strength, by_length = ca.SX.sym('strength', 7, 7), ca.SX.sym('by_length', 7)
    values, weights, miss = (ca.SX.sym('first_values', 7, 7), ca.SX.sym('weights', 7),
                             ca.SX.sym('miss', 7))
    before, length_cost = ca.SX.sym('before'), FREE_LENGTH_COST + values[6, 6]
    roots = ca.diag(ca.sqrt(weights))
    total = strength + by_length @ by_length.T / length_cost
    y = roots @ ca.solve(ca.SX.eye(7) + roots @ total @ roots, roots @ miss)
    longer = -ca.dot(by_length, y) / length_cost
    inputs = [strength, by_length, values, weights, miss, before]
    return RowFunction(ca.Function(
        'aim', inputs, ca.cse([y, longer, before + longer]),
        ['strength', 'by_length', 'first_values', 'weights', 'miss', 'before'],
        ['y', 'longer', 'free_length']))


def _correct() -> RowFunction:
    """Build the corrected change of a step."""
    before, feedforward = ca.SX.sym('before'), ca.SX.sym('feedforward', 7)
    gains = ca.SX.sym('gains', 7)
    y, longer = ca.SX.sym('y', 7), ca.SX.sym('longer')
    return RowFunction(ca.Function(
        'correct', [before, feedforward, gains, y, longer],
        [before - ca.dot(feedforward, y) - gains[6] * longer],
        ['before', 'feedforward', 'gains', 'y', 'longer'], ['change']), is_independent=True)
