"""
A push integrated in time, on ``push_model.dynamics`` as it stands, by scipy's Radau.

The turn relaxes ever faster as a push slows down, so that explicit schemes fail: hence an
implicit one.
"""

import math

import numpy as np
from push_model.dynamics import equation_of_motion, Input, STATE, State
from scipy.integrate import solve_ivp

TOLERANCE = 1e-8


def integrate(obj, rolling, push, start, times, stop=None):
    """
    Integrate a push whose contact neither slides nor parts.

    :param obj: the ``PushedObject``.
    :param rolling: (lam, R_e [m]) of ``contact.rolling_constants``.
    :param push: function of (time [s], ``State``) that returns the ``Input``.
    :param start: ``State``.
    :param times: where to sample [s], increasing, shape (n,).
    :param stop: function of ``State`` at whose zero the motion ends, or None.
    :return: (times reached, shape (k,), states in the order of ``STATE``, shape (k, 7)).
    :raises RuntimeError: where the integration fails.
    """
    function = equation_of_motion(obj, rolling)
    state, inputs, rate, force = (np.zeros(size) for size in (len(STATE), 5, len(STATE), 2))
    buffer, evaluate = function.buffer()
    for number, array in enumerate((state, inputs)):
        buffer.set_arg(number, memoryview(array))
    for number, array in enumerate((rate, force)):
        buffer.set_res(number, memoryview(array))

    def slope(time, at):
        state[:] = at
        inputs[:] = push(time, State(*at))
        evaluate()
        return rate.copy()

    def end(_, at):
        return stop(State(*at))

    end.terminal = True
    times = np.asarray(times, dtype=float)
    run = solve_ivp(slope, (times[0], times[-1]), np.array(start, dtype=float), method='Radau',
                    t_eval=times, events=end if stop else None, rtol=TOLERANCE, atol=TOLERANCE)
    if run.status < 0:
        raise RuntimeError(f'integration of the push ended at {run.t[-1] if run.t.size else 0:g} '
                           f's: {run.message}')
    return run.t, run.y.T


def straight_push(v_x, v_y):
    """
    Push at constant velocity by a robot that does not spin.

    :param v_x: velocity [m/s], world x.
    :param v_y: the same, y.
    :return: function for ``integrate``.
    """
    inputs = Input(v_x, v_y, 0.0, 0.0, 0.0)
    return lambda time, state: inputs


def body_fixed_push(direction, speed):
    """
    Push at constant speed whose direction stays the same in the object frame.

    The robot turns with the object, so that the contact stays where it is on both.

    :param direction: in the object frame [rad].
    :param speed: of the contact [m/s].
    :return: function for ``integrate``.
    """
    def push(_, state):
        v_x = speed * math.cos(state.theta + direction)
        v_y = speed * math.sin(state.theta + direction)
        return Input(v_x, v_y, -state.omega * v_y, state.omega * v_x, state.omega)

    return push
