"""
Compiled steps of the estimator: motion by odometry, and the correction by a pose.

With F the derivative of a step by the state, H the rows of (x, y, theta), v the innovation and S
its covariance, L L' = S:

    ``P+ = F P F' + Q ds``        ``v' S^-1 v = |L^-1 v|^2``
    ``K = P H' S^-1``             ``x += K v``,  ``P -= K H P``

Arrays are written in place, and nothing is allocated.
"""

import math
from typing import Any, NamedTuple

from push_control.estimation.contact_site import rolled_contact, RollingContact
from push_control.estimation.push_motion import (
    contact_velocity, linearize_step, MotionModel, object_rates, propagated_state, PushState,
)
from push_dynamics.compiled import compiled
from push_model.signals import PoseCovariance, STOP

# Numbers of a ``PushState``, and how many of them a pose measures.
SIZE = 7
MEASURED = 3
# Columns of odometry: begin and end [s], mean velocity in the robot's axes.
BEGIN, END, VELOCITY = 0, 1, 2
ODOMETRY_COLUMNS = 5
# Columns of motions: velocity, duration [s], path length of the contact [m], heading [rad].
DURATION, DISTANCE, HEADING = 3, 4, 5
MOTION_COLUMNS = 6
# In ``FilterMemory.contact``, beyond the numbers of a ``RollingContact``: 1 where it is lost.
LOST = 7
CONTACT_SIZE = 8


class FilterMemory(NamedTuple):
    """
    All that the filter knows, in arrays.

    :param contact: numbers of the ``RollingContact``, and 1 where contact is lost, shape (8,).
    :param c_squared: ``LimitSurfaceTable.values``.
    :param odometry: motions that are kept, one a row, shape (n, 5).
    :param last: time of the last odometry, and its velocity, shape (4,).
    :param state: ``PushState`` at the time of the last pose used, shape (7,).
    :param latest: the same at the time of the last odometry, shape (7,).
    :param covariance: P, shape (7, 7).
    :param walk: Q, variances of the random walk of the state per path length, shape (7,).
    :param center: nominal centre of friction (x, y), and how far it may be from there, shape (3,).
    :param motions: those that the filter has processed in one call, shape (n, 6).
    :param scratch: shape (3, 7, 7).
    """

    contact: Any
    c_squared: Any
    odometry: Any
    last: Any
    state: Any
    latest: Any
    covariance: Any
    walk: Any
    center: Any
    motions: Any
    scratch: Any


@compiled
def motion_model(memory: FilterMemory) -> MotionModel:
    """
    Read the contact.

    :param memory: ``FilterMemory``.
    :return: ``MotionModel``.
    """
    n = memory.contact
    contact = RollingContact(n[0], n[1], n[2], (n[3], n[4]), n[5], n[6])
    return MotionModel(contact, n[LOST] > 0.0, memory.c_squared)


@compiled
def push_state(numbers: Any) -> PushState:
    """
    Read a state.

    :param numbers: shape (7,).
    :return: ``PushState``.
    """
    return PushState(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5],
                     numbers[6])


@compiled
def carry(memory: FilterMemory, twist: Any, duration: float, numbers: Any) -> None:
    """
    Carry a state over one step.

    :param memory: ``FilterMemory``.
    :param twist: mean motion over the step, robot's axes.
    :param duration: of the step [s].
    :param numbers: of the state, shape (7,), is written.
    """
    model, state = motion_model(memory), push_state(numbers)
    after = propagated_state(model, state, object_rates(model, state, twist), twist, duration)
    for i in range(SIZE):
        numbers[i] = after[i]


@compiled
def replay(memory: FilterMemory, count: int, start: float) -> None:
    """
    Carry the state to the last odometry, as ``latest``.

    :param memory: ``FilterMemory``.
    :param count: number of motions that are kept.
    :param start: time of the state [s].
    """
    for i in range(SIZE):
        memory.latest[i] = memory.state[i]
    for k in range(count):
        row = memory.odometry[k]
        duration = min(memory.last[0], row[END]) - max(start, row[BEGIN])
        if duration > 0.0:
            carry(memory, row[VELOCITY:], duration, memory.latest)


@compiled
def add_motion(memory: FilterMemory, count: int, start: float, time: float, twist: Any) -> float:
    """
    Keep a motion of the robot, and carry ``latest`` on by it.

    :param memory: ``FilterMemory``; ``latest`` is at the time of the last odometry.
    :param count: number of motions that are kept, less than there is room for.
    :param start: time of the state [s].
    :param time: of the odometry, later than the last one [s].
    :param twist: its velocity, robot's axes.
    :return: path length of the contact since the last odometry [m].
    """
    last, state = memory.last, push_state(memory.latest)
    contact = motion_model(memory).contact
    normal = rolled_contact(contact, state.phi - state.theta).normal
    heading_offset = state.theta + normal - state.phi
    v_x, v_y = contact_velocity(0.0, heading_offset, contact.robot_radius, twist)
    distance = math.sqrt(v_x * v_x + v_y * v_y) * (time - last[0])
    row = memory.odometry[count]
    row[BEGIN], row[END] = last[0], time
    for i in range(3):
        row[VELOCITY + i] = 0.5 * (last[1 + i] + twist[i])
    duration = time - max(start, last[0])
    if duration > 0.0:
        carry(memory, row[VELOCITY:], duration, memory.latest)
    last[0] = time
    for i in range(3):
        last[1 + i] = twist[i]
    return distance


@compiled
def predict(memory: FilterMemory, begin: float, time: float, twist: Any,
            duration: float) -> tuple[PushState, PushState]:
    """
    Carry ``latest`` to a time, and on from there.

    :param memory: ``FilterMemory``.
    :param begin: time of ``latest`` [s].
    :param time: now [s].
    :param twist: mean velocity expected from now on, robot's axes.
    :param duration: for how long [s].
    :return: ``PushState`` now and then.
    """
    numbers = memory.scratch[0, 0]
    for i in range(SIZE):
        numbers[i] = memory.latest[i]
    if time > begin:
        carry(memory, memory.last[1:], time - begin, numbers)
    now = push_state(numbers)
    if duration > 0.0:
        carry(memory, twist, duration, numbers)
    return now, push_state(numbers)


@compiled
def advance(memory: FilterMemory, count: int, start: float, end: float) -> int:
    """
    Carry state and covariance on, and list the motions of the robot meanwhile.

    :param memory: ``FilterMemory``; ``state``, ``covariance`` and ``motions`` are written.
    :param count: number of motions that are kept.
    :param start: time of the state [s].
    :param end: time to which it is carried [s].
    :return: number of motions listed.
    """
    listed = 0
    for k in range(count):
        row = memory.odometry[k]
        duration = min(end, row[END]) - max(start, row[BEGIN])
        if duration > 0.0:
            advance_step(memory, row[VELOCITY:], duration, memory.motions[listed])
            listed += 1
    beyond = end - max(start, memory.last[0])
    if beyond > 0.0:
        advance_step(memory, memory.last[1:], beyond, memory.motions[listed])
        listed += 1
    return listed


@compiled
def advance_step(memory: FilterMemory, twist: Any, duration: float, motion: Any) -> None:
    """
    Carry state and covariance over one step.

    :param memory: ``FilterMemory``; ``state`` and ``covariance`` are written.
    :param twist: mean motion over the step, robot's axes.
    :param duration: of the step [s].
    :param motion: row of ``FilterMemory.motions``, is written.
    """
    model, state = motion_model(memory), push_state(memory.state)
    rates = object_rates(model, state, twist)
    transition, product = memory.scratch[0], memory.scratch[1]
    distance = linearize_step(state, rates, duration, transition)
    multiply(transition, memory.covariance, product)
    multiply(product, transition.T, memory.covariance)
    after = propagated_state(model, state, rates, twist, duration)
    for i in range(SIZE):
        memory.covariance[i, i] += distance * memory.walk[i]
        memory.state[i] = after[i]
    for i in range(3):
        motion[i] = twist[i]
    motion[DURATION], motion[DISTANCE], motion[HEADING] = duration, distance, state.phi


@compiled
def forget_before(memory: FilterMemory, count: int, time: float) -> int:
    """
    Drop motions that ended before a time.

    :param memory: ``FilterMemory``; the other ones move to the front.
    :param count: number of motions that are kept.
    :param time: [s].
    :return: number of motions that are left.
    """
    left = 0
    for k in range(count):
        if memory.odometry[k, END] > time:
            for i in range(ODOMETRY_COLUMNS):
                memory.odometry[left, i] = memory.odometry[k, i]
            left += 1
    return left


@compiled
def correct(memory: FilterMemory, innovation: tuple[float, float, float], noise: PoseCovariance,
            gate: float) -> bool:
    """
    Correct state and covariance by a pose, unless it lies outside the gate.

    :param memory: ``FilterMemory``; ``state`` and ``covariance`` are written.
    :param innovation: v, measured pose minus that of the state.
    :param noise: R, ``PoseCovariance`` of the pose.
    :param gate: largest squared Mahalanobis distance of v.
    :return: whether it lies within the gate.
    """
    spread, scaled = memory.scratch[0], memory.scratch[1, 0]
    expect_innovation(memory.covariance, noise, spread)
    for i in range(MEASURED):
        scaled[i] = innovation[i]
    solve_lower(spread, scaled)
    if scaled[0] ** 2 + scaled[1] ** 2 + scaled[2] ** 2 > gate:
        return False
    apply_gains(memory, innovation)
    hold_center(memory.state, memory.center)
    return True


@compiled
def expect_innovation(covariance: Any, noise: PoseCovariance, factor: Any) -> None:
    """
    Factorize the covariance of an innovation.

    :param covariance: P, shape (7, 7).
    :param noise: R, ``PoseCovariance`` of the pose.
    :param factor: L in the lower triangle of its first three rows, is written.
    """
    for i in range(MEASURED):
        for j in range(MEASURED):
            factor[i, j] = covariance[i, j]
    factor[0, 0] += noise.x_x
    factor[1, 0] += noise.x_y
    factor[2, 0] += noise.x_theta
    factor[1, 1] += noise.y_y
    factor[2, 1] += noise.y_theta
    factor[2, 2] += noise.theta_theta
    factorize(factor)


@compiled
def apply_gains(memory: FilterMemory, innovation: tuple[float, float, float]) -> None:
    """
    Correct state and covariance.

    :param memory: ``FilterMemory``, L in its scratch; ``state`` and ``covariance`` are written.
    :param innovation: v.
    """
    state, covariance = memory.state, memory.covariance
    factor, gain, before = memory.scratch[0], memory.scratch[1, 0], memory.scratch[2]
    for i in range(SIZE):
        for j in range(SIZE):
            before[i, j] = covariance[i, j]
    for i in range(SIZE):
        for j in range(MEASURED):
            gain[j] = before[i, j]
        solve_lower(factor, gain)
        solve_upper(factor, gain)
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
    :param center: as of ``FilterMemory``.
    """
    off_x, off_y = state[4] - center[0], state[5] - center[1]
    off = math.sqrt(off_x * off_x + off_y * off_y)
    if off > center[2]:
        state[4] = center[0] + off_x * center[2] / off
        state[5] = center[1] + off_y * center[2] / off


@compiled
def factorize(matrix: Any) -> None:
    """
    Replace the lower triangle of a positive definite matrix by that of its Cholesky factor.

    :param matrix: its first three rows and columns are meant, is written.
    """
    for j in range(MEASURED):
        for k in range(j + 1):
            total = matrix[j, k]
            for m in range(k):
                total -= matrix[j, m] * matrix[k, m]
            matrix[j, k] = math.sqrt(total) if j == k else total / matrix[k, k]


@compiled
def solve_lower(factor: Any, values: Any) -> None:
    """
    Solve ``L x = b`` in place.

    :param factor: L.
    :param values: b, is replaced by x.
    """
    for j in range(MEASURED):
        for m in range(j):
            values[j] -= factor[j, m] * values[m]
        values[j] /= factor[j, j]


@compiled
def solve_upper(factor: Any, values: Any) -> None:
    """
    Solve ``L' x = b`` in place.

    :param factor: L.
    :param values: b, is replaced by x.
    """
    for j in range(MEASURED - 1, -1, -1):
        for m in range(j + 1, MEASURED):
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


def load_machine_code(memory: FilterMemory) -> None:
    """
    Call everything once, so that nothing is compiled or loaded while the robot moves.

    :param memory: ``FilterMemory``, is not changed.
    """
    copied = FilterMemory(*(array.copy() for array in memory))
    time = float(memory.last[0])
    replay(copied, 0, time)
    add_motion(copied, 0, time, time, STOP)
    predict(copied, time, time, STOP, 0.0)
    advance(copied, 0, time, time)
    forget_before(copied, 0, time)
    correct(copied, (0.0, 0.0, 0.0), PoseCovariance.from_deviations(1.0, 1.0), 0.0)
