"""The equation of motion as one casadi function, for planner, studies and tests."""

from typing import Any

import casadi as ca
from push_model.dynamics import (
    contact_force, derivative, INPUT, Input, ObjectTerms, Rolling, SMOOTHING, STATE, State)
from push_model.parameters import PushedObject


def equation_of_motion(obj: PushedObject, rolling: Rolling,
                       smoothing: Any = SMOOTHING) -> ca.Function:
    """
    Build the equation of motion as a casadi function.

    :param rolling: (lam, R_e [m]).
    :param smoothing: speed below which support friction becomes viscous [m/s].
    :return: ``casadi.Function`` (state (7,), input (5,)) -> (rate (7,), contact force (2,) [N]).
    """
    terms = ObjectTerms.of(obj)
    x, u = ca.SX.sym('x', len(STATE)), ca.SX.sym('u', len(INPUT))
    state, inputs = State(*ca.vertsplit(x)), Input(*ca.vertsplit(u))
    rate = derivative(terms, state, inputs, rolling, smoothing)
    force = contact_force(terms, state, inputs, rate.omega, rolling, smoothing)
    return ca.Function('motion', [x, u], [ca.vertcat(*rate), ca.vertcat(*force)],
                       ['state', 'input'], ['rate', 'force'])
