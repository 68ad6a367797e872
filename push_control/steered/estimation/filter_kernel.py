"""
Compiled steps of the estimator: motion by odometry, and the correction by a pose.

With F the derivative of a step by the state, H the rows of (x, y, theta), v the innovation and S
its covariance, L L' = S:

    ``P+ = F P F' + Q ds``        ``v' S^-1 v = |L^-1 v|^2``
    ``K = P H' S^-1``             ``x += K v``,  ``P -= K H P``

Arrays are written in place, and nothing is allocated.
"""

import math
from typing import Any

import numpy as np
from push_control.steered.estimation.contact_site import contact_site, rolled_contact, SITE_SIZE
from push_control.steered.estimation.limit_surface_table import TABLE_SIZE
from push_control.steered.estimation.push_motion import (
    contact_velocity, linearize_step, MotionModel, MotionState, object_rates, propagated_state,
)
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray

# Numbers of a ``MotionState``, and how many of them a pose measures.
SIZE = 7
MEASURED = 3
# Columns of odometry: begin and end [s], mean velocity in the robot's axes.
START, END, VELOCITY = 0, 1, 2
ODOMETRY_COLUMNS = 5
# Columns of motions: velocity, duration [s], path length of the contact [m], heading [rad].
DURATION, DISTANCE, HEADING = 3, 4, 5
MOTION_COLUMNS = 6

# Memory of the filter, an array of numbers: compiled functions are given it in 0.1 us. Contact:
# ``RollingContact.values``, and 1 where it is lost.
SITE = 0
LOST = SITE + SITE_SIZE
# Memory: ``LimitSurfaceTable.values`` of the contact [m^2].
C_SQUARED = LOST + 1
# Memory: time of the last odometry [s], and its velocity, robot's axes.
LAST = C_SQUARED + TABLE_SIZE
# Memory: ``MotionState`` at the time of the last pose used, and at that of the last odometry.
STATE = LAST + 4
LATEST = STATE + SIZE
# Memory: Q, variances of the random walk of the state per path length.
WALK = LATEST + SIZE
# Memory: nominal centre of friction (x, y), and how far it may be from there [m].
CENTER = WALK + SIZE
MEMORY_SIZE = CENTER + 3
# Matrices, shape (4, 7, 7): P, and those that a function needs for itself.
COVARIANCE = 0
SCRATCH = 1
MATRIX_COUNT = 4


@compiled
def motion_model(memory: Any) -> MotionModel:
    """
    Read the contact.

    :param memory: of the filter, shape (``MEMORY_SIZE``,).
    """
    return MotionModel(contact_site(memory), memory[LOST] > 0.0, memory[C_SQUARED:LAST])


@compiled
def push_state(values: Any) -> MotionState:
    """
    Read a state.

    :param values: shape (7,).
    """
    return MotionState(values[0], values[1], values[2], values[3], values[4], values[5],
                       values[6])


@compiled
def carry(memory: Any, twist: Any, duration: float, values: Any) -> None:
    """
    Carry a state over one step.

    :param memory: of the filter.
    :param twist: mean motion over the step, robot's axes.
    :param duration: of the step [s].
    :param values: of the state, shape (7,), is written.
    """
    model, state = motion_model(memory), push_state(values)
    after = propagated_state(model, state, object_rates(model, state, twist), twist, duration)
    for i in range(SIZE):
        values[i] = after[i]


@compiled
def replay(memory: Any, odometry: Any, count: int, start: float) -> None:
    """
    Carry the state to the last odometry, as ``latest``.

    :param memory: of the filter.
    :param odometry: motions of the robot, one a row, shape (n, 5).
    :param count: number of motions that are kept.
    :param start: time of the state [s].
    """
    for i in range(SIZE):
        memory[LATEST + i] = memory[STATE + i]
    for k in range(count):
        row = odometry[k]
        duration = min(memory[LAST], row[END]) - max(start, row[START])
        if duration > 0.0:
            carry(memory, row[VELOCITY:], duration, memory[LATEST:WALK])


@compiled
def add_motion(memory: Any, row: Any, start: float, measured: Any) -> float:
    """
    Keep a motion of the robot, and carry ``latest`` on by it.

    :param memory: of the filter; ``latest`` is at the time of the last odometry.
    :param row: of the motions of the robot, is written, shape (5,).
    :param start: time of the state [s].
    :param measured: time [s] and velocity, robot's axes, of an odometry that is later than the
        last one, shape (4,).
    :return: path length of the contact since the last odometry [m].
    """
    last, state = memory[LAST:STATE], push_state(memory[LATEST:WALK])
    time, twist = measured[0], measured[1:]
    contact = motion_model(memory).contact
    normal = rolled_contact(contact, state.phi - state.theta).normal
    heading_offset = state.theta + normal - state.phi
    v_x, v_y = contact_velocity(0.0, heading_offset, contact.robot_radius, twist)
    distance = math.sqrt(v_x * v_x + v_y * v_y) * (time - last[0])
    row[START], row[END] = last[0], time
    for i in range(3):
        row[VELOCITY + i] = 0.5 * (last[1 + i] + twist[i])
    duration = time - max(start, last[0])
    if duration > 0.0:
        carry(memory, row[VELOCITY:], duration, memory[LATEST:WALK])
    last[0] = time
    for i in range(3):
        last[1 + i] = twist[i]
    return distance


@compiled
def predict(memory: Any, interval: float, twist: Any, duration: float, states: Any) -> bool:
    """
    Carry ``latest`` to a time, and on from there.

    :param memory: of the filter.
    :param interval: from the time of ``latest`` until now [s].
    :param twist: mean velocity expected from now on, robot's axes.
    :param duration: for how long [s].
    :param states: numbers of the ``MotionState`` now and then, are written, shape (14,).
    :return: whether all of them are finite.
    """
    now, then = states[:SIZE], states[SIZE:]
    for i in range(SIZE):
        now[i] = memory[LATEST + i]
    if interval > 0.0:
        carry(memory, memory[LAST + 1:STATE], interval, now)
    total = 0.0
    for i in range(SIZE):
        then[i] = now[i]
    if duration > 0.0:
        carry(memory, twist, duration, then)
    # A sum is finite only where all its terms are.
    for i in range(SIZE):
        total += then[i]
    return math.isfinite(total)


@compiled
def advance(memory: Any, matrices: Any, odometry: Any, start: float, end: float,
            motions: Any) -> int:
    """
    Carry state and covariance on, and list the motions of the robot meanwhile.

    :param memory: of the filter; the state is written.
    :param matrices: of the filter; the covariance is written.
    :param odometry: motions of the robot that are kept, shape (n, 5).
    :param start: time of the state [s].
    :param end: time to which it is carried [s].
    :param motions: those that the filter has processed, are written, shape (more than n, 6).
    :return: number of motions listed.
    """
    listed = 0
    for k in range(len(odometry)):
        row = odometry[k]
        duration = min(end, row[END]) - max(start, row[START])
        if duration > 0.0:
            advance_step(memory, matrices, row[VELOCITY:], duration, motions[listed])
            listed += 1
    beyond = end - max(start, memory[LAST])
    if beyond > 0.0:
        advance_step(memory, matrices, memory[LAST + 1:STATE], beyond, motions[listed])
        listed += 1
    return listed


@compiled
def advance_step(memory: Any, matrices: Any, twist: Any, duration: float,
                 motion: Any) -> None:
    """
    Carry state and covariance over one step.

    :param memory: of the filter; the state is written.
    :param matrices: of the filter; the covariance is written.
    :param twist: mean motion over the step, robot's axes.
    :param duration: of the step [s].
    :param motion: row of the motions that the filter has processed, is written, shape (6,).
    """
    model, state = motion_model(memory), push_state(memory[STATE:LATEST])
    rates = object_rates(model, state, twist)
    covariance, transition = matrices[COVARIANCE], matrices[SCRATCH]
    product = matrices[SCRATCH + 1]
    distance = linearize_step(state, rates, duration, transition)
    multiply(transition, covariance, product)
    multiply(product, transition.T, covariance)
    after = propagated_state(model, state, rates, twist, duration)
    for i in range(SIZE):
        covariance[i, i] += distance * memory[WALK + i]
        memory[STATE + i] = after[i]
    for i in range(3):
        motion[i] = twist[i]
    motion[DURATION], motion[DISTANCE], motion[HEADING] = duration, distance, state.phi


@compiled
def correct(memory: Any, matrices: Any, measured: Any, gate: float) -> bool:
    """
    Correct state and covariance by a pose, unless it lies outside the gate.

    :param memory: of the filter; the state is written.
    :param matrices: of the filter; the covariance is written.
    :param measured: v, measured pose minus that of the state, and R, the numbers of the
        ``PoseCovariance`` of the pose, shape (9,).
    :param gate: largest squared Mahalanobis distance of v.
    :return: whether it lies within the gate.
    """
    innovation, covariance = measured[:MEASURED], matrices[COVARIANCE]
    factor, scaled = matrices[SCRATCH], matrices[SCRATCH + 1, 0]
    expect_innovation(covariance, measured[MEASURED:], factor)
    for i in range(MEASURED):
        scaled[i] = innovation[i]
    solve_lower(factor, scaled, MEASURED)
    if scaled[0] ** 2 + scaled[1] ** 2 + scaled[2] ** 2 > gate:
        return False
    state = memory[STATE:LATEST]
    apply_gains(state, matrices, innovation)
    hold_center(state, memory[CENTER:MEMORY_SIZE])
    return True


@compiled
def expect_innovation(covariance: Any, noise: Any, factor: Any) -> None:
    """
    Factorize the covariance of an innovation.

    :param covariance: P, shape (7, 7).
    :param noise: R, the upper triangle by rows, shape (6,).
    :param factor: L in the lower triangle of its first three rows, is written.
    """
    k = 0
    for j in range(MEASURED):
        for i in range(j, MEASURED):
            factor[i, j] = covariance[i, j] + noise[k]
            k += 1
    factorize(factor, MEASURED)


@compiled
def apply_gains(state: Any, matrices: Any, innovation: Any) -> None:
    """
    Correct state and covariance.

    :param state: numbers of the ``MotionState``, shape (7,), is written.
    :param matrices: of the filter, L the first one in its scratch; the covariance is written.
    :param innovation: v, shape (3,).
    """
    covariance, factor = matrices[COVARIANCE], matrices[SCRATCH]
    gain, before = matrices[SCRATCH + 1, 0], matrices[SCRATCH + 2]
    for i in range(SIZE):
        for j in range(SIZE):
            before[i, j] = covariance[i, j]
    for i in range(SIZE):
        for j in range(MEASURED):
            gain[j] = before[i, j]
        solve_lower(factor, gain, MEASURED)
        solve_upper(factor, gain, MEASURED)
        for j in range(MEASURED):
            state[i] += gain[j] * innovation[j]
            for k in range(SIZE):
                covariance[i, k] -= gain[j] * before[j, k]
    for i in range(SIZE):
        for j in range(i):
            covariance[i, j] = 0.5 * (covariance[i, j] + covariance[j, i])
            covariance[j, i] = covariance[i, j]


@compiled
def hold_center(state: Any, center: Any) -> None:
    """
    Keep the centre of friction near its nominal place.

    :param state: shape (7,), is written.
    :param center: nominal centre of friction (x, y), and how far it may be from there, shape (3,).
    """
    off_x, off_y = state[4] - center[0], state[5] - center[1]
    off = math.sqrt(off_x * off_x + off_y * off_y)
    if off > center[2]:
        state[4] = center[0] + off_x * center[2] / off
        state[5] = center[1] + off_y * center[2] / off


@compiled
def factorize(matrix: Any, size: int) -> None:
    """
    Replace the lower triangle of a positive definite matrix by that of its Cholesky factor.

    :param matrix: its first rows and columns are meant, is written.
    :param size: their number.
    """
    for j in range(size):
        for k in range(j + 1):
            total = matrix[j, k]
            for m in range(k):
                total -= matrix[j, m] * matrix[k, m]
            matrix[j, k] = math.sqrt(total) if j == k else total / matrix[k, k]


@compiled
def solve_lower(factor: Any, values: Any, size: int) -> None:
    """
    Solve ``L x = b`` in place.

    :param factor: L.
    :param values: b, is replaced by x.
    :param size: number of rows.
    """
    for j in range(size):
        for m in range(j):
            values[j] -= factor[j, m] * values[m]
        values[j] /= factor[j, j]


@compiled
def solve_upper(factor: Any, values: Any, size: int) -> None:
    """
    Solve ``L' x = b`` in place.

    :param factor: L.
    :param values: b, is replaced by x.
    :param size: number of rows.
    """
    for j in range(size - 1, -1, -1):
        for m in range(j + 1, size):
            values[j] -= factor[m, j] * values[m]
        values[j] /= factor[j, j]


@compiled
def multiply(a: Any, b: Any, product: Any) -> None:
    """
    Multiply matrices, ``A B``.

    :param a: shape (7, 7).
    :param b: shape (7, 7).
    :param product: shape (7, 7), is written.
    """
    for i in range(SIZE):
        for j in range(SIZE):
            total = 0.0
            for k in range(SIZE):
                total += a[i, k] * b[k, j]
            product[i, j] = total


def load_machine_code(memory: FloatArray) -> None:
    """
    Call everything once, so that nothing is compiled or loaded while the robot moves.

    :param memory: of the filter, is not changed.
    """
    memory, time = memory.copy(), float(memory[LAST])
    matrices = np.zeros((MATRIX_COUNT, SIZE, SIZE))
    odometry, motions = np.zeros((1, ODOMETRY_COLUMNS)), np.zeros((1, MOTION_COLUMNS))
    replay(memory, odometry, 0, time)
    add_motion(memory, odometry[0], time, memory[LAST:STATE].copy())
    predict(memory, 0.0, np.zeros(3), 0.0, np.zeros(2 * SIZE))
    advance(memory, matrices, odometry[:0], time, time, motions)
    correct(memory, matrices, np.array((0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0)), 0.0)
