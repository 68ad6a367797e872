"""
A push at constant pushing angles, one after the other, integrated in time.

On a flat face the normal turns with the object (lam = 1), so that a constant pushing angle is a
direction that stays the same in the object frame: ``a_C = omega k x v_C``. Between two angles the
velocity imposed at C jumps, which is an impulse (``push_model.dynamics.impulse``).
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.analysis.time_integration import integrate
from push_model.contact import contact_point, face_normal
from push_model.dynamics import equation_of_motion, impulse, Input, ObjectTerms, State
from push_model.geometry import Pose

SPACING = 0.004


class IntegratedPush(NamedTuple):
    """
    A push that was integrated; two samples at a jump, before and after.

    :param times: [s], shape (n,).
    :param states: in the order of ``push_model.dynamics.STATE``, shape (n, 7).
    :param forces: of the robot on the object (F_n, F_t), shape (n, 2) [N].
    :param impulses: (time [s], J_n, J_t [N s]) of each jump, the first touch included, shape
        (k, 3).
    """

    times: np.ndarray
    states: np.ndarray
    forces: np.ndarray
    impulses: np.ndarray

    @property
    def end(self):
        """``Pose`` of the object at the end."""
        return Pose(*self.states[-1, :3])


def push_at_angles(obj, contact, angles, lengths, speed, radius=0.0, start=Pose(0.0, 0.0, 0.0)):
    """
    Push an object from rest on a face; the contact is taken to hold.

    :param obj: the ``PushedObject``.
    :param contact: ``Contact`` on a face.
    :param angles: pushing angle of each piece, from the normal [rad], shape (n,).
    :param lengths: way of the contact in each piece, above 0, shape (n,) [m].
    :param speed: of the contact, the same in all pieces [m/s].
    :param radius: of a robot that does not turn [m]; 0 for a point, or for a robot that turns
        with the object, so that the contact stays in place.
    :param start: ``Pose`` of the object.
    :return: ``IntegratedPush``.
    :raises RuntimeError: where the integration fails.
    """
    rolling, terms = (1.0, radius), ObjectTerms.of(obj)
    normal = start.theta + face_normal(obj, contact.index)
    state = State(*start, 0.0, normal, *contact_point(obj, contact))
    begin, before = 0.0, (0.0, 0.0)
    parts, impulses = [], []
    for angle, length in zip(angles, lengths):
        velocity = _velocity(state, angle, speed)
        jump = impulse(terms, state, velocity[0] - before[0], velocity[1] - before[1])
        state = state._replace(omega=state.omega + float(jump[0]))
        impulses.append((begin, float(jump[1]), float(jump[2])))
        push = _push(angle, speed)
        times = np.linspace(0.0, length / speed, 2 + math.ceil(length / SPACING))
        states = integrate(obj, rolling, push, state, times)[1]
        parts.append((begin + times, states, _forces(obj, rolling, push, states)))
        state, begin = State(*states[-1]), begin + times[-1]
        before = _velocity(state, angle, speed)
    return IntegratedPush(*map(np.concatenate, zip(*parts)), np.array(impulses))


def _velocity(state, angle, speed):
    return (speed * math.cos(state.gamma + angle), speed * math.sin(state.gamma + angle))


def _push(angle, speed):
    def push(_, state):
        v_x, v_y = _velocity(state, angle, speed)
        return Input(v_x, v_y, -state.omega * v_y, state.omega * v_x, 0.0)

    return push


def _forces(obj, rolling, push, states):
    inputs = np.array([push(0.0, State(*state)) for state in states])
    function = equation_of_motion(obj, rolling).map(len(states))
    return np.array(function(states.T, inputs.T)[1]).T
