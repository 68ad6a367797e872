"""
One step of object and robot: implicit, on velocity level, without springs or penalties.

The geometry is taken at the predicted middle of the step and the gap carried back from there to
its start, which leaves neither drift nor error of first order.

Arguments have the same meaning in every function: ``state`` and ``body`` are numbers in the order
of ``layout``, ``supports`` rows (x, y from the mass centre [m], capacity, capacity on plain floor
[N]), ``outline`` the vertices [m], ``floor`` the patches of ``floor_rows``, ``forces`` the
friction on each support (x, y, x, y, ...) [N] that is written, ``command`` the (v_x, v_y, omega)
asked of the robot, ``drive`` (time constant [s], acceleration limit [m/s^2], yaw acceleration
limit [rad/s^2]), ``h`` the step [s].
"""

import math

from push_sim_node.kernel.actuation import chord_velocity, track_command
from push_sim_node.kernel.compiled import compiled
from push_sim_node.kernel.contact_law import nearest, surface_velocity
from push_sim_node.kernel.floor import set_local_capacities
from push_sim_node.kernel.layout import (
    A_OMEGA, A_X, A_Y, COM_X, COM_Y, CONTACT_LOSS, DISC_RADIUS, FORCE_N, FORCE_T, IMPACT_LOSS,
    INERTIA, ITERATIONS, MASS, MODE, OMEGA, P_X, P_Y, PHI, ROBOT_RADIUS, STEPS, SUPPORT_LOSS,
    THETA, U_OMEGA, U_X, U_Y, UNSOLVED, V_X, V_Y, WORK, X, Y,
)
from push_sim_node.kernel.solver import COARSE, solve
from push_sim_node.kernel.support_friction import friction_forces

# A robot that touches without moving must not push the object by rounding errors.
ROUNDING = 1e-14


@compiled
def geometry(state, body, outline, guess, robot, h):
    """
    Contact in the middle of the step, for a predicted velocity.

    ``guess`` is the object's (v_x, v_y, omega), ``robot`` the mean one of the robot, world axes.

    :return: cosine and sine of the orientation; (n_x, n_y, moment arms of n and t [m]); (normal
        velocity of the robot, that which the object's contact point must have at least,
        tangential velocity of the robot's surface) [m/s].
    """
    x, y = state[X] + 0.5 * h * guess[0], state[Y] + 0.5 * h * guess[1]
    theta = state[THETA] + 0.5 * h * guess[2]
    c, s = math.cos(theta), math.sin(theta)
    p_x, p_y = state[P_X] + 0.5 * h * robot[0], state[P_Y] + 0.5 * h * robot[1]
    n_x, n_y, c_x, c_y, gap = nearest(
        outline, body[DISC_RADIUS], body[ROBOT_RADIUS], x - c * body[COM_X] + s * body[COM_Y],
        y - s * body[COM_X] - c * body[COM_Y], theta, p_x, p_y, state[PHI] + 0.5 * h * robot[2])
    arm_n = (c_x - x) * n_y - (c_y - y) * n_x
    arm_t = (c_x - x) * n_x + (c_y - y) * n_y
    u_n, u_t = surface_velocity(body[ROBOT_RADIUS], n_x, n_y, c_x - p_x, c_y - p_y, robot[0],
                                robot[1], robot[2])
    gap -= 0.5 * h * (n_x * guess[0] + n_y * guess[1] + arm_n * guess[2] - u_n)
    if abs(gap) < ROUNDING:
        gap = 0.0
    return c, s, (n_x, n_y, arm_n, arm_t), (u_n, u_n - gap / h, u_t)


@compiled
def account(state, body, contact, push, velocity, impulse, support_loss):
    """Book the energies of a step: work of the robot = kinetic energy + losses, exactly."""
    n_x, n_y, arm_n, arm_t = contact
    v_x, v_y, omega = velocity
    work = impulse[0] * push[0] + impulse[1] * push[2]
    received = (impulse[0] * (n_x * v_x + n_y * v_y + arm_n * omega)
                + impulse[1] * (n_x * v_y - n_y * v_x + arm_t * omega))
    d_x, d_y, d_omega = v_x - state[V_X], v_y - state[V_Y], omega - state[OMEGA]
    state[WORK] += work
    state[SUPPORT_LOSS] += support_loss
    state[CONTACT_LOSS] += work - received
    state[IMPACT_LOSS] += 0.5 * (body[MASS] * (d_x * d_x + d_y * d_y)
                                 + body[INERTIA] * d_omega * d_omega)


@compiled
def step(state, body, supports, outline, floor, forces, command, drive, h):
    """Move object and robot by one step, in place."""
    e_x, e_y, e_omega, m_x, m_y, m_omega = track_command(state[U_X], state[U_Y], state[U_OMEGA],
                                                         command, drive, h)
    u_x, u_y = chord_velocity(state[PHI], m_x, m_y, m_omega, h)
    guess = (state[V_X] + h * state[A_X], state[V_Y] + h * state[A_Y],
             state[OMEGA] + h * state[A_OMEGA])
    c, s, contact, push = geometry(state, body, outline, guess, (u_x, u_y, m_omega), h)
    if len(floor) > 0:
        set_local_capacities(floor, supports, state[X] + 0.5 * h * guess[0], state[Y] + 0.5 * h * guess[1], c, s)
    velocity, at, impulse, mode, count, left = solve(state, body, supports, c, s, h, guess,
                                                     contact, push)
    power = friction_forces(body, supports, forces, c, s, at, velocity)
    account(state, body, contact, push, velocity, impulse, h * power)
    keep = 1.0 / h if mode == state[MODE] else 0.0
    v_x, v_y, omega = velocity
    state[A_X], state[A_Y] = keep * (v_x - state[V_X]), keep * (v_y - state[V_Y])
    state[A_OMEGA] = keep * (omega - state[OMEGA])
    state[V_X], state[V_Y], state[OMEGA] = v_x, v_y, omega
    state[X] += h * v_x
    state[Y] += h * v_y
    state[THETA] += h * omega
    state[P_X] += h * u_x
    state[P_Y] += h * u_y
    state[PHI] += h * m_omega
    state[U_X], state[U_Y], state[U_OMEGA] = e_x, e_y, e_omega
    state[MODE], state[FORCE_N], state[FORCE_T] = mode, impulse[0] / h, impulse[1] / h
    state[ITERATIONS] += count
    state[STEPS] += 1
    if left > COARSE:
        state[UNSOLVED] += 1


@compiled
def advance(state, body, supports, outline, floor, forces, command, drive, duration, longest):
    """Take equal steps, none above ``longest`` [s], that end exactly after ``duration`` [s]."""
    count = max(1, int(math.ceil(duration / longest - 1e-9)))
    for _ in range(count):
        step(state, body, supports, outline, floor, forces, command, drive, duration / count)
