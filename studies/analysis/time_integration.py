"""
Pushes integrated in time, on ``push_model.dynamics`` as it stands, by LSODA of scipy.

The rotation relaxes ever faster as a push slows down, so that explicit schemes fail: hence one
that turns implicit where it must.

On a flat face the normal rotates with the object (lam = 1), so that a constant pushing angle is a
direction that stays the same in the object frame: ``a_C = omega k x v_C``. Between two angles the
velocity imposed at C jumps, which is an impulse (``push_model.dynamics.impulse``).
"""

from collections.abc import Callable, Iterable
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from push_model.contact import contact_point, face_normal
from push_model.dynamics import impulse, INPUT, Input, ObjectTerms, Rolling, STATE, State
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, PushedObject
from scipy.integrate import solve_ivp

# Relative and absolute tolerance of the integration. Chosen: three digits more than the tests of
# other integrations of the same motion ask for.
TOLERANCE = 1e-9
# Distance of the contact between the samples of a push at constant angles [m]. Chosen for smooth
# plots.
SPACING = 0.004
ORIGIN = Pose(0.0, 0.0, 0.0)
# Input of a push at a time [s] and a state.
Push = Callable[[float, State], Input]


def integrate(obj: PushedObject, rolling: Rolling, push: Push, start: Iterable[Any],
              times: ArrayLike,
              stop: Callable[[State], float] | None = None) -> tuple[FloatArray, FloatArray]:
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
    function: Any = equation_of_motion(obj, rolling)
    state, inputs = np.zeros(len(STATE)), np.zeros(len(INPUT))
    rate, force = np.zeros(len(STATE)), np.zeros(2)
    # The function reads and writes these arrays in place.
    buffer, evaluate = function.buffer()
    for index, array in enumerate((state, inputs)):
        buffer.set_arg(index, array.data)
    for index, array in enumerate((rate, force)):
        buffer.set_res(index, array.data)

    def slope(time: float, at: FloatArray) -> FloatArray:
        state[:] = at
        inputs[:] = push(time, State(*at))
        evaluate()
        return rate.copy()

    times = np.asarray(times, dtype=float)
    run = solve_ivp(slope, (times[0], times[-1]), np.array(start, dtype=float), method='LSODA',
                    t_eval=times, events=_Stop(stop) if stop else None, rtol=TOLERANCE,
                    atol=TOLERANCE)
    if run.status < 0:
        raise RuntimeError(f'integration of the push ended at {run.t[-1] if run.t.size else 0:g} '
                           f's: {run.message}')
    return run.t, run.y.T


class _Stop:
    """Event of ``solve_ivp`` that ends the motion."""

    terminal = True

    def __init__(self, stop: Callable[[State], float]) -> None:
        self._stop = stop

    def __call__(self, _: float, at: FloatArray) -> float:
        return self._stop(State(*at))


def straight_push(v_x: float, v_y: float) -> Push:
    """
    Push at constant velocity by a robot that does not rotate.

    :param v_x: velocity, world x [m/s].
    :param v_y: velocity, world y [m/s].
    :return: function for ``integrate``.
    """
    inputs = Input(v_x, v_y, 0.0, 0.0, 0.0)
    return lambda time, state: inputs


def body_fixed_push(direction: float, speed: float) -> Push:
    """
    Push at constant speed whose direction stays the same in the object frame.

    The robot rotates with the object, so that the contact stays where it is on both.

    :param direction: in the object frame [rad].
    :param speed: of the contact [m/s].
    :return: function for ``integrate``.
    """
    def push(_: float, state: State) -> Input:
        v_x = speed * math.cos(state.theta + direction)
        v_y = speed * math.sin(state.theta + direction)
        return Input(v_x, v_y, -state.omega * v_y, state.omega * v_x, state.omega)

    return push


class IntegratedPush(NamedTuple):
    """
    A push that was integrated; two samples at a jump, before and after.

    :param times: [s], shape (n,).
    :param states: in the order of ``push_model.dynamics.STATE``, shape (n, 7).
    :param forces: of the robot on the object (F_n, F_t), shape (n, 2) [N].
    :param impulses: (time [s], J_n, J_t [N s]) of each jump, the first touch included, shape
        (k, 3).
    """

    times: FloatArray
    states: FloatArray
    forces: FloatArray
    impulses: FloatArray

    @property
    def end(self) -> Pose:
        """``Pose`` of the object at the end."""
        return Pose(*self.states[-1, :3])


def push_at_angles(obj: PushedObject, contact: Contact, angles: Iterable[float],
                   lengths: Iterable[float], speed: float, *, robot_radius: float = 0.0,
                   start: Pose = ORIGIN) -> IntegratedPush:
    """
    Push an object from rest on a face, at one pushing angle after the other.

    The contact is taken to hold.

    :param obj: the ``PushedObject``.
    :param contact: ``Contact`` on a face.
    :param angles: pushing angle of each segment, from the normal [rad], shape (n,).
    :param lengths: distance of the contact in each segment, above 0, shape (n,) [m].
    :param speed: of the contact, the same in all segments [m/s].
    :param robot_radius: of a robot that does not rotate [m]; 0 for a point, or for a robot that
        rotates with the object, so that the contact stays in place.
    :param start: ``Pose`` of the object.
    :return: ``IntegratedPush``.
    :raises RuntimeError: where the integration fails.
    """
    rolling, terms = (1.0, robot_radius), ObjectTerms.of(obj)
    normal = start.theta + face_normal(obj, contact.index)
    state = State(*start, 0.0, normal, *contact_point(obj, contact))
    start_time = 0.0
    before = 0.0, 0.0
    times: list[FloatArray] = []
    states: list[FloatArray] = []
    forces: list[FloatArray] = []
    impulses: list[tuple[float, float, float]] = []
    for angle, length in zip(angles, lengths):
        velocity = _contact_velocity(state, angle, speed)
        d_omega, j_n, j_t = impulse(terms, state, velocity[0] - before[0],
                                    velocity[1] - before[1])
        state = state._replace(omega=state.omega + float(d_omega))
        impulses.append((start_time, float(j_n), float(j_t)))
        push = _constant_angle_push(angle, speed)
        count = 2 + math.ceil(length / SPACING)
        elapsed = np.linspace(0.0, length / speed, count, dtype=np.float64)
        _, integrated = integrate(obj, rolling, push, state, elapsed)
        times.append(start_time + elapsed)
        states.append(integrated)
        forces.append(_contact_forces(obj, rolling, push, integrated))
        state = State(*integrated[-1])
        start_time += float(elapsed[-1])
        before = _contact_velocity(state, angle, speed)
    return IntegratedPush(np.concatenate(times), np.concatenate(states), np.concatenate(forces),
                          np.array(impulses))


def _contact_velocity(state: State, angle: float, speed: float) -> tuple[float, float]:
    return (speed * math.cos(state.gamma + angle), speed * math.sin(state.gamma + angle))


def _constant_angle_push(angle: float, speed: float) -> Push:
    def push(_: float, state: State) -> Input:
        v_x, v_y = _contact_velocity(state, angle, speed)
        return Input(v_x, v_y, -state.omega * v_y, state.omega * v_x, 0.0)

    return push


def _contact_forces(obj: PushedObject, rolling: Rolling, push: Push,
                    states: FloatArray) -> FloatArray:
    inputs = np.array([push(0.0, State(*state)) for state in states])
    function = equation_of_motion(obj, rolling).map(len(states))
    return np.array(function(states.T, inputs.T)[1]).T
