"""
The predictive law's quadratic program around a guess of U, solved along its horizon.

With deviations x from the states of the guess, 0 at first, and u from the guess itself, the
program is ``min sum (0.5 x' Q x + q' x + 0.5 ds u^2 + r u) + w (s + 0.5 s^2)``, where
``x+ = A x + B u``, subject to ``a' (x, u, s) <= b``. The slack s is that of the soft constraints.
Without constraints the Riccati recursion solves it; P begins as the cost to go at the end:

    ``h = ds + B' P B``,  ``K = -B' P A / h``,  ``P <- Q + A' P A - h K' K``
    ``p <- q + A' p + K' (r + B' p)``,  ``u = K x - (r + B' p) / h``

With ``-a`` in place of q and r it gives ``H^-1 a``, H being the Hessian by U. So the dual
active-set method of Goldfarb and Idnani (1983) takes some operations for each step of the horizon
and each constraint that binds, and neither H nor a matrix of the ``a`` is formed. It begins with
the constraints that bound the last time, which mostly bind again.

A trajectory is a row of numbers: U, zeta at the N + 1 ends of the steps, and s.
"""

import math
from typing import Any

from push_control.laws.mpc_problem import HorizonParameters, SCALAR_COUNT, StepSlopes
from push_dynamics.compiled import compiled

(FORCE_SLOPE, CONE_ANGLE, ZETA_LOW, ZETA_HIGH, LOWEST, HIGHEST, FIRST_LOWEST, FIRST_HIGHEST,
 MAX_CHANGE) = (HorizonParameters._fields.index(name) for name in (
     'force_slope', 'cone_angle', 'zeta_low', 'zeta_high', 'lowest', 'highest', 'first_lowest',
     'first_highest', 'max_change'))
(LATERAL_BY_HEADING, LATERAL_BY_CURVATURE, HEADING_BY_CURVATURE, ZETA_BY_ZETA, ZETA_BY_CURVATURE,
 CURVATURE_BY_CURVATURE, LATERAL_BY_COMMAND, HEADING_BY_COMMAND, ZETA_BY_COMMAND,
 CURVATURE_BY_COMMAND) = range(len(StepSlopes._fields))
# Columns of the steps, behind ``StepSlopes``: K by (e_y, e_psi, kappa), 1 / h, and slopes of what
# is minimised: r, and q behind the step.
GAIN = len(StepSlopes._fields)
INVERSE = GAIN + 3
BY_COMMAND = GAIN + 4
BY_STATE = GAIN + 5
STEP_COLUMNS = GAIN + 9
# Kinds of constraints: the contact force in its cone and the normal on its feature, which are
# soft, the command in its limits, and its change from the step before. There are N of each, from
# above and as many from below; the last number is that of ``s >= 0``.
FORCE = 0
FEATURE = 1
COMMAND = 2
CHANGE = 3
KINDS = 4
SLACK = 2 * KINDS
# Columns of a constraint that binds, behind the trajectory ``H^-1 a``: its number, its multiplier,
# what that falls by as the one of a new constraint rises by 1, and from there on products with
# ``H^-1 a`` of all constraints up to it and a row of their Cholesky factor.
NUMBER = 0
MULTIPLIER = 1
RATE = 2
PRODUCT = 3
# Largest violation that counts as none [rad, 1/m]; chosen: far below any noise.
FEASIBLE = 1e-9
# Part of ``a' H^-1 a`` that constraints that bind must leave for a to be independent of them;
# chosen: far above rounding.
INDEPENDENT = 1e-10
# Largest number of constraints that are added; chosen: mostly one or two are, from none at first
# about as many as bind.
ITERATION_LIMIT = 100


def active_shape(steps: int) -> tuple[int, int]:
    """
    Shape of the array of constraints that bind: as many as there are unknowns, and a new one.

    :param steps: number of steps N.
    """
    rows = steps + 2
    return rows, 2 * steps + 2 + PRODUCT + 2 * rows


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
def solve_program(p: Any, weights: Any, states: Any, steps: Any, active: Any,
                  solution: Any) -> float:
    """
    Solve the quadratic program.

    :param p: parameters, laid out as ``parameter_offsets`` tells.
    :param weights: of e_y^2, e_psi^2 and u^2 in each step, and w of the slack, shape (4,).
    :param states: those of the guess, shape (N + 1, 4).
    :param steps: ``StepSlopes``, and columns that are written, shape (N, ``STEP_COLUMNS``).
    :param active: one row for each constraint that bound the last time, and then now, see
        ``active_shape``.
    :param solution: trajectory of the optimum, and the number of constraints that bind, which is
        that of the last time at first, is written, shape (2 N + 3,).
    :return: largest violation of a constraint that is left, 0 where it is negligible; no number
        where the problem has one that is none.
    """
    size = len(solution) - 1
    last = int(solution[size])
    # A sum is finite only where all its terms are.
    total = 0.0
    for k in range(len(p)):
        total += p[k]
    if not math.isfinite(total):
        return math.nan
    write_gains(p, weights, steps)
    write_slopes(p, weights, states, steps)
    write_optimum(steps, solution)
    for k in range(len(steps)):
        solution[k] += p[len(p) - len(steps) + k]
        solution[len(steps) + 1 + k] += states[k + 1, 2]
    solution[len(steps)] = states[0, 2]
    # The slack of least cost, w (s + 0.5 s^2).
    solution[size - 1] = -1.0
    solution[size], violation = 0.0, math.inf
    for index in range(last + ITERATION_LIMIT):
        # First those that bound the last time, the rows of which have not been written again.
        if index < last:
            number = int(active[index, size + NUMBER])
            violation = violation_of(p, number, solution, len(steps))
        else:
            number, violation = most_violated(p, solution, len(steps))
        if violation > FEASIBLE:
            write_row(p, weights, steps, active, int(solution[size]), number)
            if not add_constraint(active, violation, solution):
                break
        elif index >= last:
            return 0.0
    return violation


@compiled
def write_gains(p: Any, weights: Any, steps: Any) -> None:
    """
    Write the gains of the Riccati recursion.

    :param p: parameters.
    :param weights: as of ``solve_program``.
    :param steps: ``StepSlopes``; the gains are written.
    """
    root = p[SCALAR_COUNT:SCALAR_COUNT + 9]
    # P by (e_y, e_psi, kappa) is R' R, of an upper triangle; zeta costs nothing.
    p_00, p_01, p_02 = root[0] * root[0], root[0] * root[3], root[0] * root[6]
    p_11, p_12 = root[3] * root[3] + root[4] * root[4], root[3] * root[6] + root[4] * root[7]
    p_22 = root[6] * root[6] + root[7] * root[7] + root[8] * root[8]
    for k in range(len(steps) - 1, -1, -1):
        row = steps[k]
        a_01, a_02, a_12, a_22 = (row[LATERAL_BY_HEADING], row[LATERAL_BY_CURVATURE],
                                  row[HEADING_BY_CURVATURE], row[CURVATURE_BY_CURVATURE])
        b_0, b_1, b_2 = row[LATERAL_BY_COMMAND], row[HEADING_BY_COMMAND], row[CURVATURE_BY_COMMAND]
        # P B and P A, column by column.
        m_0 = p_00 * b_0 + p_01 * b_1 + p_02 * b_2
        m_1 = p_01 * b_0 + p_11 * b_1 + p_12 * b_2
        m_2 = p_02 * b_0 + p_12 * b_1 + p_22 * b_2
        t_01, t_11 = a_01 * p_00 + p_01, a_01 * p_01 + p_11
        t_02 = a_02 * p_00 + a_12 * p_01 + a_22 * p_02
        t_12 = a_02 * p_01 + a_12 * p_11 + a_22 * p_12
        t_22 = a_02 * p_02 + a_12 * p_12 + a_22 * p_22
        inverse = 1.0 / (weights[2] + b_0 * m_0 + b_1 * m_1 + b_2 * m_2)
        g_0, g_1, g_2 = m_0, a_01 * m_0 + m_1, a_02 * m_0 + a_12 * m_1 + a_22 * m_2
        row[GAIN], row[GAIN + 1], row[GAIN + 2] = -g_0 * inverse, -g_1 * inverse, -g_2 * inverse
        row[INVERSE] = inverse
        p_00 = weights[0] + p_00 - g_0 * g_0 * inverse
        p_01 = t_01 - g_0 * g_1 * inverse
        p_11 = weights[1] + a_01 * t_01 + t_11 - g_1 * g_1 * inverse
        p_12 = a_01 * t_02 + t_12 - g_1 * g_2 * inverse
        p_22 = a_02 * t_02 + a_12 * t_12 + a_22 * t_22 - g_2 * g_2 * inverse
        p_02 = t_02 - g_0 * g_2 * inverse


@compiled
def write_slopes(p: Any, weights: Any, states: Any, steps: Any) -> None:
    """
    Write the slopes of the cost, r of each step, and q by the state behind it.

    :param p: parameters.
    :param weights: as of ``solve_program``.
    :param states: those of the guess.
    :param steps: slopes are written.
    """
    count = len(steps)
    guess = len(p) - count
    for k in range(count):
        row = steps[k]
        row[BY_COMMAND] = weights[2] * (p[guess + k] - p[guess - count + k])
        row[BY_STATE] = weights[0] * states[k + 1, 0]
        row[BY_STATE + 1] = weights[1] * states[k + 1, 1]
        row[BY_STATE + 2] = row[BY_STATE + 3] = 0.0
    root, last, row = p[SCALAR_COUNT:SCALAR_COUNT + 9], states[count], steps[count - 1]
    curvature = last[3] - p[guess - 1]
    r_0 = root[0] * last[0] + root[3] * last[1] + root[6] * curvature
    r_1, r_2 = root[4] * last[1] + root[7] * curvature, root[8] * curvature
    row[BY_STATE], row[BY_STATE + 1] = root[0] * r_0, root[3] * r_0 + root[4] * r_1
    row[BY_STATE + 3] = root[6] * r_0 + root[7] * r_1 + root[8] * r_2


@compiled
def write_optimum(steps: Any, trajectory: Any) -> None:
    """
    Minimise the cost without constraints: ``-H^-1`` times its slopes.

    :param steps: ``StepSlopes``, gains and slopes.
    :param trajectory: of the optimum, as deviations, is written but for the slack.
    """
    count = len(steps)
    p_0 = p_1 = p_2 = p_3 = 0.0
    for k in range(count - 1, -1, -1):
        row = steps[k]
        p_0, p_1 = p_0 + row[BY_STATE], p_1 + row[BY_STATE + 1]
        p_2, p_3 = p_2 + row[BY_STATE + 2], p_3 + row[BY_STATE + 3]
        slope = (row[BY_COMMAND] + row[LATERAL_BY_COMMAND] * p_0 + row[HEADING_BY_COMMAND] * p_1
                 + row[ZETA_BY_COMMAND] * p_2 + row[CURVATURE_BY_COMMAND] * p_3)
        trajectory[k] = -slope * row[INVERSE]
        p_3 = (row[LATERAL_BY_CURVATURE] * p_0 + row[HEADING_BY_CURVATURE] * p_1
               + row[ZETA_BY_CURVATURE] * p_2 + row[CURVATURE_BY_CURVATURE] * p_3
               + row[GAIN + 2] * slope)
        p_2 *= row[ZETA_BY_ZETA]
        p_1 += row[LATERAL_BY_HEADING] * p_0 + row[GAIN + 1] * slope
        p_0 += row[GAIN] * slope
    lateral = heading = zeta = curvature = 0.0
    trajectory[count] = 0.0
    for k in range(count):
        row = steps[k]
        u = (trajectory[k] + row[GAIN] * lateral + row[GAIN + 1] * heading
             + row[GAIN + 2] * curvature)
        lateral += (row[LATERAL_BY_HEADING] * heading + row[LATERAL_BY_CURVATURE] * curvature
                    + row[LATERAL_BY_COMMAND] * u)
        heading += row[HEADING_BY_CURVATURE] * curvature + row[HEADING_BY_COMMAND] * u
        zeta = (row[ZETA_BY_ZETA] * zeta + row[ZETA_BY_CURVATURE] * curvature
                + row[ZETA_BY_COMMAND] * u)
        curvature = row[CURVATURE_BY_CURVATURE] * curvature + row[CURVATURE_BY_COMMAND] * u
        trajectory[k], trajectory[count + 1 + k] = u, zeta


@compiled
def write_row(p: Any, weights: Any, steps: Any, active: Any, index: int, number: int) -> None:
    """
    Write the row of a constraint: ``H^-1 a``, and its products with ``a`` of those before it.

    :param p: parameters.
    :param weights: as of ``solve_program``.
    :param steps: ``StepSlopes`` and gains; slopes are written.
    :param active: its row is written.
    :param index: of the row.
    :param number: of the constraint.
    """
    count = len(steps)
    size = 2 * count + 2
    side, kind, k = decode(number, count)
    for j in range(count):
        for i in range(BY_COMMAND, STEP_COLUMNS):
            steps[j, i] = 0.0
    if kind == FORCE:
        steps[k, BY_COMMAND] = -side * p[FORCE_SLOPE]
        # Zeta at the beginning of the horizon is what it is.
        if k > 0:
            steps[k - 1, BY_STATE + 2] = -side
    elif kind == FEATURE:
        steps[k, BY_STATE + 2] = -side
    elif kind != SLACK:
        steps[k, BY_COMMAND] = -side
        if kind == CHANGE:
            steps[k - 1, BY_COMMAND] = side
    write_optimum(steps, active[index])
    active[index, size - 1] = -1.0 / weights[3] if is_soft(kind) else 0.0
    active[index, size + NUMBER] = number
    for j in range(index + 1):
        active[index, size + PRODUCT + j] = along(p, number, active[j], count)


@compiled
def add_constraint(active: Any, violation: float, solution: Any) -> bool:
    """
    Go to where another constraint holds; those that stop to bind on the way are removed.

    :param active: rows of the constraints that bind, and behind them that of the new one.
    :param violation: of the new constraint.
    :param solution: its trajectory is written, and the number of constraints that bind.
    :return: False where nothing fulfils all of them.
    """
    size = len(solution) - 1
    count = int(solution[size])
    factor = size + PRODUCT + len(active)
    multiplier = 0.0
    while True:
        curvature = factorize_row(active, count, size)
        # Row ``count`` is that of the new one: nothing blocks the way to where it holds.
        length, blocking = violation / curvature if curvature > 0.0 else math.inf, count
        for j in range(count - 1, -1, -1):
            # Rates solve G rate = products, of which the row of the factor is half the way.
            rate = active[count, factor + j]
            for i in range(j + 1, count):
                rate -= active[i, factor + j] * active[i, size + RATE]
            rate /= active[j, factor + j]
            active[j, size + RATE] = rate
            if active[j, size + MULTIPLIER] < length * rate:
                length, blocking = active[j, size + MULTIPLIER] / rate, j
        if length == math.inf:
            solution[size] = 0.0
            return False
        multiplier += length
        violation -= length * curvature
        # The new one has the rate -1: its multiplier rises.
        active[count, size + RATE], active[count, size + MULTIPLIER] = -1.0, multiplier
        for j in range(count):
            active[j, size + MULTIPLIER] -= length * active[j, size + RATE]
        for j in range(count + 1 if curvature > 0.0 else 0):
            part = length * active[j, size + RATE]
            for i in range(size):
                solution[i] += part * active[j, i]
        if blocking == count:
            solution[size] = count + 1
            return True
        remove_row(active, blocking, count + 1, size)
        count -= 1


@compiled
def decode(number: int, count: int) -> tuple[float, int, int]:
    """
    Tell what a number of a constraint means.

    :param number: of the constraint.
    :param count: number of steps N.
    :return: 1 from above or -1 from below, kind, and step.
    """
    kind = number // count
    if kind == SLACK:
        return 1.0, SLACK, 0
    return (1.0, kind, number % count) if kind < KINDS else (-1.0, kind - KINDS, number % count)


@compiled
def is_soft(kind: int) -> bool:
    """
    Tell whether ``a`` has -1 for the slack.

    :param kind: of the constraint.
    """
    return kind <= FEATURE or kind == SLACK


@compiled
def value_of(p: Any, kind: int, k: int, trajectory: Any, count: int) -> float:
    """
    Evaluate what a constraint is about.

    :param p: parameters.
    :param kind: of the constraint.
    :param k: its step.
    :param trajectory: begins with one, shape (more than 2 N + 1,).
    :param count: number of steps N.
    :return: force angle or zeta [rad], curvature or its change [1/m].
    """
    if kind == FORCE:
        return trajectory[count + k] + p[FORCE_SLOPE] * trajectory[k]
    if kind == FEATURE:
        return trajectory[count + k + 1]
    if kind == COMMAND:
        return trajectory[k]
    return trajectory[k] - trajectory[k - 1] if k > 0 else 0.0


@compiled
def limits_of(p: Any, kind: int, k: int) -> tuple[float, float]:
    """
    Read between what that must lie.

    :param p: parameters.
    :param kind: of the constraint.
    :param k: its step.
    """
    if kind == FORCE:
        return -p[CONE_ANGLE], p[CONE_ANGLE]
    if kind == FEATURE:
        return p[ZETA_LOW], p[ZETA_HIGH]
    if kind == CHANGE:
        return -p[MAX_CHANGE], p[MAX_CHANGE]
    return (p[FIRST_LOWEST], p[FIRST_HIGHEST]) if k == 0 else (p[LOWEST], p[HIGHEST])


@compiled
def along(p: Any, number: int, trajectory: Any, count: int) -> float:
    """
    Multiply the ``a`` of a constraint with a trajectory.

    :param p: parameters.
    :param number: of the constraint.
    :param trajectory: begins with one, shape (more than 2 N + 1,).
    :param count: number of steps N.
    """
    side, kind, k = decode(number, count)
    slack = trajectory[2 * count + 1] if is_soft(kind) else 0.0
    return -slack if kind == SLACK else side * value_of(p, kind, k, trajectory, count) - slack


@compiled
def violation_of(p: Any, number: int, trajectory: Any, count: int) -> float:
    """
    Evaluate ``a' (x, u, s) - b``.

    :param p: parameters.
    :param number: of the constraint.
    :param trajectory: begins with one, shape (more than 2 N + 1,).
    :param count: number of steps N.
    """
    side, kind, k = decode(number, count)
    low, high = limits_of(p, kind, k)
    bound = 0.0 if kind == SLACK else high if side > 0.0 else -low
    return along(p, number, trajectory, count) - bound


@compiled
def most_violated(p: Any, trajectory: Any, count: int) -> tuple[int, float]:
    """
    Find the constraint that is violated most.

    :param p: parameters.
    :param trajectory: begins with one, shape (more than 2 N + 1,).
    :param count: number of steps N.
    :return: its number, and its violation.
    """
    slack = trajectory[2 * count + 1]
    number, violation = SLACK * count, -slack
    for kind in range(KINDS):
        allowed = slack if is_soft(kind) else 0.0
        for k in range(count):
            value = value_of(p, kind, k, trajectory, count)
            low, high = limits_of(p, kind, k)
            if value - high - allowed > violation:
                number, violation = kind * count + k, value - high - allowed
            if low - value - allowed > violation:
                number, violation = (KINDS + kind) * count + k, low - value - allowed
    return number, violation


@compiled
def factorize_row(active: Any, index: int, size: int) -> float:
    """
    Continue the Cholesky factor L of the products by a row.

    :param active: rows of the constraints, is written.
    :param index: of the row; L of those before it is there.
    :param size: of a trajectory.
    :return: square of the new diagonal element, 0 where the constraint depends on the others.
    """
    products, factor = size + PRODUCT, size + PRODUCT + len(active)
    row = active[index]
    left = row[products + index]
    for i in range(index):
        total = row[products + i]
        for j in range(i):
            total -= row[factor + j] * active[i, factor + j]
        row[factor + i] = total / active[i, factor + i]
        left -= row[factor + i] * row[factor + i]
    # As many constraints as there are unknowns leave nothing of another one but rounding.
    if left <= INDEPENDENT * row[products + index] or index == len(active) - 1:
        return 0.0
    row[factor + index] = math.sqrt(left)
    return left


@compiled
def remove_row(active: Any, index: int, count: int, size: int) -> None:
    """
    Remove a constraint that no longer binds.

    :param active: rows of the constraints, is written; of the last row there is no factor then.
    :param index: of its row.
    :param count: number of rows.
    :param size: of a trajectory.
    """
    products = size + PRODUCT
    for j in range(index, count - 1):
        for i in range(size + PRODUCT):
            active[j, i] = active[j + 1, i]
        for i in range(j + 1):
            active[j, products + i] = active[j + 1, products + (i if i < index else i + 1)]
        factorize_row(active, j, size)
