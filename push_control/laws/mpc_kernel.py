"""
The predictive law's quadratic program, around a guess of U (Gauss-Newton), and where it is easy.

With residuals r and slopes J around the guess, the cost is ``0.5 |r + J' x|^2`` and that of the
slack; x are the changes of U. Where ``x = -(J J')^-1 J r`` keeps all constraints it is the
solution, as the slack, which costs, is 0: so it is in most steps.
"""

from typing import Any, NamedTuple

from push_control.estimation.filter_kernel import factorize, solve_lower, solve_upper
from push_control.laws.mpc_problem import HorizonParameters, MAX_SLACK, UNBOUNDED
from push_dynamics.compiled import compiled

LOWEST, HIGHEST, FIRST_LOWEST, FIRST_HIGHEST, MAX_CHANGE = (
    HorizonParameters._fields.index(name)
    for name in ('lowest', 'highest', 'first_lowest', 'first_highest', 'max_change'))


class QuadraticProgram(NamedTuple):
    """
    Terms of ``quadratic_solver``, matrices by columns: of ``a``, one row for each of x.

    :param h: shape (N + 1, N + 1).
    :param g: shape (N + 1,).
    :param a: soft constraints from above and from below, and changes of the curvature, which are
        hard, shape (N + 1, 5 N - 1).
    :param lba: shape (5 N - 1,).
    :param uba: shape (5 N - 1,).
    :param lbx: shape (N + 1,).
    :param ubx: shape (N + 1,).
    """

    h: Any
    g: Any
    a: Any
    lba: Any
    uba: Any
    lbx: Any
    ubx: Any


@compiled
def shift_plan(plan: Any, shift: float, low: float, high: float, guess: Any) -> None:
    """
    Go on with a plan after some distance; its last curvature holds beyond its end.

    :param plan: curvatures at each step of the horizon [1/m], shape (N,).
    :param shift: the distance, in steps.
    :param low: least curvature [1/m].
    :param high: greatest curvature [1/m].
    :param guess: the curvatures that are left, within these limits, is written, shape (N,).
    """
    last = len(plan) - 1
    for k in range(last + 1):
        index = min(k + int(shift), last)
        ratio = shift - int(shift)
        value = plan[index] + ratio * (plan[min(index + 1, last)] - plan[index])
        guess[k] = min(high, max(low, value))


@compiled
def write_cost(residuals: Any, slopes: Any, slack_weight: float, h: Any, g: Any) -> None:
    """
    Write the cost of the quadratic program.

    :param residuals: of ``Linearization``.
    :param slopes: of ``Linearization``.
    :param slack_weight: weight of the slack, linear and quadratic.
    :param h: of ``QuadraticProgram``, is written.
    :param g: of ``QuadraticProgram``, is written.
    """
    count = len(slopes)
    for i in range(count):
        for j in range(i + 1):
            h[i, j] = dot(slopes[i], slopes[j])
            h[j, i] = h[i, j]
        g[i] = dot(slopes[i], residuals)
    h[count, count] = g[count] = slack_weight


@compiled
def write_constraints(scalars: Any, guess: Any, soft: Any, soft_slopes: Any, a: Any,
                      bounds: Any) -> None:
    """
    Write the constraints of the quadratic program.

    :param scalars: ``HorizonParameters``.
    :param guess: curvatures U around which the problem is linearised [1/m], shape (N,).
    :param soft: of ``Linearization``.
    :param soft_slopes: of ``Linearization``.
    :param a: of ``QuadraticProgram``, is written where it is not always the same.
    :param bounds: lower and upper ones, of A x and behind them of x, are written, shape (2, 6 N).
    """
    count, soft_count = len(guess), soft.shape[1]
    lower, upper = bounds[0], bounds[1]
    for k in range(soft_count):
        for i in range(count):
            a[i, k] = a[i, soft_count + k] = soft_slopes[i, k]
        lower[k], upper[k] = -UNBOUNDED, soft[2, k] - soft[0, k]
        lower[soft_count + k], upper[soft_count + k] = soft[1, k] - soft[0, k], UNBOUNDED
    for i in range(count - 1):
        change, row = guess[i + 1] - guess[i], 2 * soft_count + i
        lower[row], upper[row] = -scalars[MAX_CHANGE] - change, scalars[MAX_CHANGE] - change
    first = 2 * soft_count + count - 1
    for i in range(count):
        low, high = scalars[LOWEST], scalars[HIGHEST]
        if i == 0:
            low, high = scalars[FIRST_LOWEST], scalars[FIRST_HIGHEST]
        lower[first + i], upper[first + i] = low - guess[i], high - guess[i]
    lower[first + count], upper[first + count] = 0.0, MAX_SLACK


@compiled
def solve_unconstrained(guess: Any, h: Any, g: Any, factor: Any, curvatures: Any) -> None:
    """
    Minimise the cost alone.

    :param guess: curvatures U around which the problem is linearised [1/m], shape (N,).
    :param h: of ``QuadraticProgram``.
    :param g: of ``QuadraticProgram``.
    :param factor: for the Cholesky factor of h, shape (N, N).
    :param curvatures: U, is written, shape (N,).
    """
    count = len(guess)
    for i in range(count):
        for j in range(i + 1):
            factor[i, j] = h[i, j]
        curvatures[i] = -g[i]
    factorize(factor, count)
    solve_lower(factor, curvatures, count)
    solve_upper(factor, curvatures, count)
    for i in range(count):
        curvatures[i] += guess[i]


@compiled
def keeps_constraints(scalars: Any, guess: Any, soft: Any, soft_slopes: Any,
                      curvatures: Any) -> bool:
    """
    Tell whether no constraint of the quadratic program binds.

    :param scalars: ``HorizonParameters``.
    :param guess: curvatures U around which the problem is linearised [1/m], shape (N,).
    :param soft: of ``Linearization``.
    :param soft_slopes: of ``Linearization``.
    :param curvatures: U [1/m], shape (N,).
    """
    low, high = scalars[FIRST_LOWEST], scalars[FIRST_HIGHEST]
    for i in range(len(curvatures)):
        if not low <= curvatures[i] <= high:
            return False
        if i > 0 and not abs(curvatures[i] - curvatures[i - 1]) <= scalars[MAX_CHANGE]:
            return False
        low, high = scalars[LOWEST], scalars[HIGHEST]
    for k in range(soft.shape[1]):
        value = soft[0, k]
        for i in range(len(curvatures)):
            value += soft_slopes[i, k] * (curvatures[i] - guess[i])
        if not soft[1, k] <= value <= soft[2, k]:
            return False
    return True


@compiled
def dot(a: Any, b: Any) -> float:
    """
    Multiply two vectors.

    :param a: shape (n,).
    :param b: shape (n,).
    """
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total
