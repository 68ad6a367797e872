"""
One Newton step of an interior point method on the program of a push, as expressions.

The program is  min f(z)  s.t.  F(z_k) = x_{k+1},  r(z_k) = 0,  g(z) >= 0,  h(x_0) = 0,
e(x_n) = 0, with z = (x, u, w): states x, change of the pushing angle u, yaw rates w at the Radau
points. Multipliers: lambda of F, nu of r, y of g, eta of h, mu_e of e; slacks s = g; barrier
parameter m. A step first eliminates what is local to a collocation step:

    ds = J_g dz + g - s             dy = m / s - y - Sigma ds             Sigma = diag(y / s)
    dw = W (dx, du) + w_0           W, w_0 from r + dr = 0

What is left is linear-quadratic in (dx, du), and solved by the recursion of Riccati from the end,
with P_n ~ e' e / DUAL_REGULARIZATION in place of e = 0, corrected by mu_e in every step:

    P_k, p_k from  min over du of  1/2 (dx, du)' H (dx, du) + h' (dx, du)
                                   + 1/2 dx_{k+1}' P_{k+1} dx_{k+1} + p_{k+1}' dx_{k+1}
    du = K dx + k                   lambda_k = P_k dx_k + p_k

Every function is evaluated for all steps by ``push_dynamics.machine_code``.
"""

from collections.abc import Mapping, Sequence
import functools
from typing import Any, NamedTuple

import casadi as ca
from push_dynamics.machine_code import RowFunction
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.transcription import PushRows, SMOOTHNESS

# Numbers of a step that are judged after each evaluation: sums of violations and of log s, cost,
# largest dual and complementary errors. The first three are summed up over all steps.
MEASURES = ('violation', 'log_slacks', 'cost', 'primal_error', 'dual_error', 'excess')
SUMS = 3
# How much the end may miss the goal per multiplier in one step [m]. Chosen: the multiplier follows
# from step to step, so that it is only the speed of that; small, and large against rounding.
DUAL_REGULARIZATION = 1e-6
# Fraction of the way to the edge that a step goes.
TO_EDGE = 0.99
# Least of the limits on a step that counts: a step is never longer than itself.
MIN_LIMIT = 1e-9


class Bounds(NamedTuple):
    """
    Simple bounds, as numbers or symbols; those that do not bind are large numbers.

    :param free_length: least S [m].
    :param first_low: lowest pushing angle at the start [rad].
    :param first_high: highest one [rad].
    :param low: lowest pushing angle [rad].
    :param high: highest one [rad].
    :param rotation_low: lowest rotation of the object [rad].
    :param rotation_high: highest one [rad].
    """

    free_length: Any
    first_low: Any
    first_high: Any
    low: Any
    high: Any
    rotation_low: Any
    rotation_high: Any


class Tuning(NamedTuple):
    """
    Parameters of a Newton step, as numbers or symbols.

    :param barrier: m, the barrier parameter.
    :param regularization: added to the diagonal of the Hessian.
    """

    barrier: Any
    regularization: Any


class NewtonFunctions(NamedTuple):
    """
    Functions of a Newton step, in the order of their evaluation.

    :param evaluate_first: of the start.
    :param evaluate: of every step.
    :param evaluate_end: of the end.
    :param accumulate: measures of all blocks, taken together one by one.
    :param recur: Riccati recursion over one step; counts pivots that are not positive.
    :param start: step of the start; counts its own pivots, too.
    :param expand: step of every step; keeps the tightest limits of the blocks so far.
    :param expand_end: step of the end; does the same.
    :param step_lengths: fractions of the step, primal and dual, that the tightest limits allow.
    :param advance: a number after a fraction of its step.
    """

    evaluate_first: RowFunction
    evaluate: RowFunction
    evaluate_end: RowFunction
    accumulate: RowFunction
    recur: RowFunction
    start: RowFunction
    expand: RowFunction
    expand_end: RowFunction
    step_lengths: RowFunction
    advance: RowFunction


@functools.lru_cache(maxsize=32)
def newton_functions(dimensions: Dimensions) -> NewtonFunctions:
    """
    Build the functions, or return those that were built before.

    :param dimensions: ``Dimensions``; the number of steps does not count.
    """
    return _Builder(dimensions).build()


class _Inequalities(NamedTuple):
    """Inequalities g >= 0 in some variables, with their multipliers and slacks."""

    rows: Any
    jacobian: Any
    multipliers: Any
    slacks: Any

    @classmethod
    def of(cls, rows: Sequence[Any], variables: Any) -> '_Inequalities':
        column = ca.vertcat(*rows)
        return cls(column, ca.jacobian(column, variables),
                   ca.SX.sym('y', column.numel()), ca.SX.sym('s', column.numel()))

    @property
    def inputs(self) -> dict[str, Any]:
        return {'y': self.multipliers, 's': self.slacks}

    def hessian(self) -> Any:
        """J_g' Sigma J_g."""
        return self.jacobian.T @ ca.diag(self.multipliers / self.slacks) @ self.jacobian

    def gradient(self, barrier: Any) -> Any:
        """-J_g' (m / s - Sigma (g - s))."""
        aim = barrier / self.slacks - self.multipliers / self.slacks * (self.rows - self.slacks)
        return -(self.jacobian.T @ aim)

    def changes(self, ds: Any, barrier: Any) -> tuple[Any, Any]:
        """(dy, inverse of the largest step that keeps slacks and multipliers positive)."""
        dy = barrier / self.slacks - self.multipliers - self.multipliers / self.slacks * ds
        return dy, ca.vertcat(_largest(-ds / self.slacks), _largest(-dy / self.multipliers))

    def measures(self, barrier: Any) -> '_Measures':
        """Measure them: what they add to the measures of a block."""
        gap = self.rows - self.slacks
        return _Measures(ca.sum1(ca.fabs(gap)), ca.sum1(ca.log(self.slacks)), 0.0,
                         _largest(ca.fabs(gap)), 0.0,
                         _largest(self.multipliers * self.slacks))


class _Measures(NamedTuple):
    """See ``MEASURES``."""

    violation: Any
    log_slacks: Any
    cost: Any
    primal_error: Any
    dual_error: Any
    excess: Any

    def plus(self, equalities: Any, cost: Any, stationarity: Any) -> Any:
        """Column of all, with equalities, cost and the gradient of the Lagrangian."""
        return ca.vertcat(self.violation + ca.sum1(ca.fabs(equalities)), self.log_slacks, cost,
                          ca.fmax(self.primal_error, _largest(ca.fabs(equalities))),
                          _largest(ca.fabs(stationarity)), self.excess)


class _Builder:
    """Builds the functions; methods are in the order of the evaluation."""

    def __init__(self, dimensions: Dimensions) -> None:
        rows = PushRows(dimensions)
        self._rows = rows
        self._states = dimensions.state_count
        self._bounds_column = ca.SX.sym('bounds', len(Bounds._fields))
        self._bounds = Bounds(*ca.vertsplit(self._bounds_column))
        self._tuning_column = ca.SX.sym('tuning', len(Tuning._fields))
        self._tuning = Tuning(*ca.vertsplit(self._tuning_column))
        self._inputs = {'common': rows.common.column, 'bounds': self._bounds_column,
                        'tuning': self._tuning_column}
        self._variables = rows.symbols.variables
        self._x = self._variables[:self._states]
        self._points = self._variables.numel() - self._states - 1
        has_range = dimensions.kind == 'rolling'
        of_first = [row for _, row in rows.of_first.inequalities]
        bounds = self._bounds
        of_first += [self._x[0] - bounds.free_length, self._x[2] - bounds.first_low,
                     bounds.first_high - self._x[2]]
        of_step = [row for _, row in rows.of_step.inequalities]
        self._first = _Inequalities.of(of_first, self._x)
        self._step = _Inequalities.of(of_step + self._box(self._x, has_range), self._variables)
        self._end = _Inequalities.of(self._box(rows.end, has_range), rows.end)

    def build(self) -> NewtonFunctions:
        evaluate, expand = self._of_step()
        evaluate_first, start = self._of_first()
        evaluate_end, expand_end = self._of_end()
        return NewtonFunctions(evaluate_first, evaluate, evaluate_end, _accumulate(),
                               self._recursion(), start, expand, expand_end, *_advance())

    def _box(self, x: Any, has_range: bool) -> list[Any]:
        bounds = self._bounds
        rows = [x[2] - bounds.low, bounds.high - x[2]]
        if has_range:
            rows += [x[3] - bounds.rotation_low, bounds.rotation_high - x[3]]
        return rows

    def _of_step(self) -> tuple[RowFunction, RowFunction]:
        """Build evaluation and expansion of a step."""
        states, z = self._states, self._variables
        equalities = ca.vertcat(*self._rows.of_step.equalities)
        end, residuals = -equalities[:states], equalities[states:]
        x_next, following = ca.SX.sym('x_next', states), ca.SX.sym('following', states)
        present, nu = ca.SX.sym('present', states), ca.SX.sym('nu', self._points)
        g, barrier = self._step, self._tuning.barrier
        cost = SMOOTHNESS * self._rows.symbols.change ** 2
        lagrangian = (cost + ca.dot(following, end) + ca.dot(nu, residuals)
                      - ca.dot(g.multipliers, g.rows))
        curvature, slope = ca.hessian(lagrangian, z)
        stationarity = slope - ca.vertcat(present, ca.SX.zeros(1 + self._points))
        hessian = curvature + g.hessian()
        gradient = ca.gradient(cost, z) + g.gradient(barrier)
        # Eliminate w.
        retained = states + 1
        of_end, of_residual = ca.jacobian(end, z), ca.jacobian(residuals, z)
        inverse = ca.inv(of_residual[:, retained:])
        by_retained, offset = -inverse @ of_residual[:, :retained], -inverse @ residuals
        basis = ca.vertcat(ca.SX.eye(retained), by_retained)
        shift = ca.vertcat(ca.SX.zeros(retained), offset)
        slope_there = gradient + hessian @ shift
        record = [ca.tril(basis.T @ hessian @ basis), basis.T @ slope_there, of_end @ basis,
                  end - x_next + of_end @ shift]
        back = -inverse.T
        expansion = [offset, by_retained, back @ slope_there[retained:],
                     back @ (hessian @ basis)[retained:, :], back @ of_end[:, retained:].T,
                     g.jacobian @ shift + g.rows - g.slacks, g.jacobian @ basis]
        self._record = [ca.SX.sym('part', part.sparsity()) for part in record]
        evaluate = _function('evaluate', {
            'z': z, 'x_next': x_next, **g.inputs, 'present': present, 'following': following,
            'nu': nu, 'data': self._rows.symbols.inputs, **self._inputs},
            {'record': _packed(record), 'expansion': _packed(expansion), 'rows': g.rows,
             'measures': g.measures(barrier).plus(ca.vertcat(end - x_next, residuals), cost,
                                                  stationarity)}, is_independent=True)
        return evaluate, self._step_expansion(expansion, following, nu)

    def _step_expansion(self, expansion: Sequence[Any], following: Any, nu: Any) -> RowFunction:
        states, g = self._states, self._step
        parts = [ca.SX.sym('part', part.sparsity()) for part in expansion]
        offset, by_retained, nu_offset, nu_by_retained, nu_by_next = parts[:5]
        slack_offset, slack_by_retained = parts[5:]
        _, _, transition, defect = self._record
        dx, gain, feedforward = (ca.SX.sym('dx', states), ca.SX.sym('gain', 1, states),
                                 ca.SX.sym('feedforward'))
        values, linear = _value_symbols(states)
        retained = ca.vertcat(dx, gain @ dx + feedforward)
        dx_next = transition @ retained + defect
        updated = ca.tril2symm(values) @ dx_next + linear
        ds = slack_offset + slack_by_retained @ retained
        dy, limits = g.changes(ds, self._tuning.barrier)
        before = ca.SX.sym('limits_before', 2)
        nu_updated = nu_offset + nu_by_retained @ retained + nu_by_next @ updated
        return _function('expand', {
            'dx': dx, 'gain': gain, 'feedforward': feedforward, 'record': _packed(self._record),
            'expansion': _packed(parts), 'values_next': values, 'linear_next': linear, **g.inputs,
            'following': following, 'nu': nu, 'tuning': self._tuning_column,
            'limits_before': before},
            {'dx_next': dx_next,
             'dcontrols': ca.vertcat(retained[states], offset + by_retained @ retained),
             'ds': ds, 'dy': dy, 'dfollowing': updated - following, 'dnu': nu_updated - nu,
             'limits': ca.fmax(before, limits)})

    def _recursion(self) -> RowFunction:
        states = self._states
        condensed, gradient, transition, defect = self._record
        values, linear = _value_symbols(states)
        symmetric = ca.tril2symm(values)
        both = (ca.tril2symm(condensed) + transition.T @ symmetric @ transition
                + self._tuning.regularization * ca.SX.eye(states + 1))
        slope = gradient + transition.T @ (linear + symmetric @ defect)
        pivot = both[states, states]
        gain = -both[states, :states] / pivot
        feedforward = -slope[states] / pivot
        updated = both[:states, :states] + both[:states, states] @ gain
        indefinite_pivots = ca.SX.sym('indefinite_next')
        return _function('recur', {
            'record': _packed(self._record), 'values_next': values, 'linear_next': linear,
            'tuning': self._tuning_column, 'indefinite_next': indefinite_pivots},
            {'values': _lower(updated),
             'linear': slope[:states] + both[:states, states] * feedforward,
             'gain': ca.densify(gain), 'feedforward': feedforward,
             'indefinite': indefinite_pivots + _is_indefinite(pivot)})

    def _of_first(self) -> tuple[RowFunction, RowFunction]:
        """Build evaluation and step of the start."""
        states, x, g = self._states, self._x, self._first
        barrier = self._tuning.barrier
        equalities = ca.vertcat(*self._rows.of_first.equalities)
        of_equalities = ca.jacobian(equalities, x)
        eta = ca.SX.sym('eta', equalities.numel())
        lagrangian = ca.dot(eta, equalities) - ca.dot(g.multipliers, g.rows)
        curvature, slope = ca.hessian(lagrangian, x)
        inputs = {'z': self._variables, **g.inputs, 'eta': eta, 'data': self._rows.symbols.inputs,
                  **self._inputs}
        # Stationarity in x_0 is judged with the first step, which gets lambda_0 from here.
        evaluate = _function('evaluate_first', inputs, {
            'present': -slope, 'rows': g.rows,
            'measures': g.measures(barrier).plus(equalities, 0.0, ca.SX.zeros(1))})
        values, linear = _value_symbols(states)
        hessian = ca.tril2symm(values) + curvature + g.hessian()
        gradient = linear + g.gradient(barrier)
        # S and the pushing angle are free, all others follow from the equalities.
        free = [0, 2]
        bound = [i for i in range(states) if i not in free]
        inverse = ca.inv(of_equalities[:, bound])
        basis, shift = ca.SX.zeros(states, 2), ca.SX.zeros(states)
        basis[free, :] = ca.SX.eye(2)
        basis[bound, :] = -inverse @ of_equalities[:, free]
        shift[bound] = -inverse @ equalities
        reduced = basis.T @ hessian @ basis + self._tuning.regularization * ca.SX.eye(2)
        right = basis.T @ (gradient + hessian @ shift)
        determinant = reduced[0, 0] * reduced[1, 1] - reduced[0, 1] ** 2
        dx = shift - basis @ ca.vertcat(
            reduced[1, 1] * right[0] - reduced[0, 1] * right[1],
            reduced[0, 0] * right[1] - reduced[0, 1] * right[0]) / determinant
        eta_new = -inverse.T @ (gradient + hessian @ dx)[bound]
        ds = g.jacobian @ dx + g.rows - g.slacks
        dy, limits = g.changes(ds, barrier)
        indefinite_pivots = ca.SX.sym('indefinite_next')
        start = _function('start', {**inputs, 'values': values, 'linear': linear,
                                    'indefinite_next': indefinite_pivots}, {
            'dx': dx, 'ds': ds, 'dy': dy, 'deta': eta_new - eta, 'limits': limits,
            'indefinite': (indefinite_pivots + _is_indefinite(reduced[0, 0])
                           + _is_indefinite(determinant))})
        return evaluate, start

    def _of_end(self) -> tuple[RowFunction, RowFunction]:
        """Build evaluation and step of the end."""
        x, g, barrier = self._rows.end, self._end, self._tuning.barrier
        equalities = ca.vertcat(*self._rows.of_end.equalities)
        of_equalities = ca.jacobian(equalities, x)
        goal = ca.SX.sym('goal', equalities.numel())
        present = ca.SX.sym('present', self._states)
        lagrangian = x[0] + ca.dot(goal, equalities) - ca.dot(g.multipliers, g.rows)
        curvature, slope = ca.hessian(lagrangian, x)
        values = curvature + g.hessian() + of_equalities.T @ of_equalities / DUAL_REGULARIZATION
        linear = (ca.gradient(x[0], x) + g.gradient(barrier)
                  + of_equalities.T @ (goal + equalities / DUAL_REGULARIZATION))
        inputs = {'x': x, **g.inputs, 'goal': goal, **self._inputs}
        evaluate = _function('evaluate_end', {**inputs, 'present': present}, {
            'values': _lower(values), 'linear': linear, 'rows': g.rows,
            'measures': g.measures(barrier).plus(equalities, x[0], slope - present)})
        dx = ca.SX.sym('dx', self._states)
        ds = g.jacobian @ dx + g.rows - g.slacks
        dy, limits = g.changes(ds, barrier)
        before = ca.SX.sym('limits_before', 2)
        expand = _function('expand_end', {**inputs, 'dx': dx, 'limits_before': before}, {
            'ds': ds, 'dy': dy, 'limits': ca.fmax(before, limits),
            'dgoal': (equalities + of_equalities @ dx) / DUAL_REGULARIZATION})
        return evaluate, expand


@functools.lru_cache(maxsize=1)
def _accumulate() -> RowFunction:
    """Build what adds up the first measures, and keeps the largest of the others."""
    before, present = ca.SX.sym('before', len(MEASURES)), ca.SX.sym('present', len(MEASURES))
    accumulated = ca.vertcat(
        before[:SUMS] + present[:SUMS], ca.fmax(before[SUMS:], present[SUMS:]))
    return _function('accumulate', {'before': before, 'present': present},
                     {'accumulated': accumulated})


@functools.lru_cache(maxsize=1)
def _advance() -> tuple[RowFunction, RowFunction]:
    """Build what keeps slacks and multipliers positive, and takes the step."""
    limits, length = ca.SX.sym('limits', 2), ca.SX.sym('length')
    before, step = ca.SX.sym('before'), ca.SX.sym('step')
    return (
        _function('step_lengths', {'limits': limits}, {
            'lengths': ca.fmin(1.0, TO_EDGE / ca.fmax(limits, MIN_LIMIT))}),
        _function('advance', {'before': before, 'step': step, 'length': length}, {
            'present': before + length * step}, is_independent=True))


def _is_indefinite(pivot: Any) -> Any:
    """Tell whether a pivot is not positive, also where it is no number: 1 or 0."""
    return ca.if_else(pivot > 0.0, 0.0, 1.0)


def _value_symbols(states: int) -> tuple[Any, Any]:
    """(P, its lower triangle, p)."""
    return ca.SX.sym('P', ca.Sparsity.lower(states)), ca.SX.sym('p', states)


def _lower(matrix: Any) -> Any:
    """Lower triangle, zeros included."""
    return ca.project(ca.densify(matrix), ca.Sparsity.lower(matrix.size1()))


def _packed(parts: Sequence[Any]) -> Any:
    """Column of the nonzeros of some matrices."""
    return ca.vertcat(*[part.nz[:] for part in parts])


def _largest(values: Any) -> Any:
    return ca.mmax(values)


def _function(name: str, inputs: Mapping[str, Any], results: Mapping[str, Any],
              is_independent: bool = False) -> RowFunction:
    outputs: Any = ca.cse([ca.densify(result) if result.size2() == 1 else result
                           for result in map(ca.SX, results.values())])
    return RowFunction(ca.Function(name, list(inputs.values()), outputs, list(inputs),
                                   list(results)), is_independent=is_independent)
