"""
Dynamics of an object that is pushed through one rolling (or fixed) contact.

Numbers, casadi SX and MX serve alike as arguments, so that planner, studies and tests evaluate
the same expressions. Symbols: C contact point, G mass centre, r_G = G - C, n and t contact
normal and tangent, omega the object's yaw rate, omega_p the robot's.

    (I + m |r_G|^2) omega' = sum_i (s_i - C) x f_i - m (k x r_G) . a_bias
    a_bias = a_C - omega^2 r_G + omega R_e (omega - omega_p) n

a_C is the time derivative of the material velocity imposed at C along the motion.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

from push_model.friction import (
    friction_weight, LoadTransfer, slide_direction, SlidingSupport, transferred_capacities,
)
from push_model.parameters import PushedObject
from push_model.trigonometry import cos_and_sin

STATE = ('x', 'y', 'theta', 'omega', 'gamma', 'c_x', 'c_y')
INPUT = ('v_x', 'v_y', 'a_x', 'a_y', 'omega_p')
# Sliding speed below which support friction becomes viscous [m/s]. Chosen: a thousandth of a slow
# push of 1 cm/s, and still large enough for implicit integration.
SMOOTHING = 1e-5
# The pair (lam, R_e [m]), ``contact.RollingConstants`` or in its order.
Rolling = tuple[Any, Any]


class ObjectTerms(NamedTuple):
    """
    Terms of an object in the equations, as numbers or casadi symbols.

    :param mass: m [kg].
    :param inertia: I about the mass centre [kg m^2].
    :param com_x: mass centre in the object frame, x [m].
    :param com_y: mass centre in the object frame, y [m].
    :param supports: (x, y [m], friction capacity q [N]) of each support, object frame.
    :param transfer: ``LoadTransfer``; None where contact and mass centre are at floor height.
    """

    mass: Any
    inertia: Any
    com_x: Any
    com_y: Any
    supports: tuple[tuple[Any, Any, Any], ...]
    transfer: LoadTransfer | None = None

    @classmethod
    def of(cls, obj: PushedObject) -> 'ObjectTerms':
        """Take the terms from an object."""
        supports = tuple((s.x, s.y, q) for s, q in zip(obj.supports, obj.capacities))
        return cls(obj.mass, obj.inertia, *obj.center_of_mass, supports, LoadTransfer.of(obj))


class State(NamedTuple):
    """
    Object frame (x, y, theta), yaw rate omega, normal gamma, contact point (c_x, c_y).

    x, y, theta, gamma are in the world; c_x, c_y in the object frame [m, rad, rad/s].
    """

    x: Any
    y: Any
    theta: Any
    omega: Any
    gamma: Any
    c_x: Any
    c_y: Any


class Input(NamedTuple):
    """Velocity (v_x, v_y) imposed at C and its rate (a_x, a_y), world axes; robot yaw rate."""

    v_x: Any
    v_y: Any
    a_x: Any
    a_y: Any
    omega_p: Any


def moment_balance(terms: ObjectTerms, state: Iterable[Any], inputs: Iterable[Any],
                   omega_dot: Any, rolling: Rolling, smoothing: Any = SMOOTHING) -> Any:
    """
    Residual of the moment equation about C [N m]; zero on the motion.

    ``(I + m |r_G|^2) omega' + m (k x r_G) . a_bias - sum (s_i - C) x f_i``.
    Nothing divides by speed: scaling all velocities (smoothing too) by v, accelerations by v^2,
    scales inertia by v^2 only.

    :param state: ``State`` (or a sequence in its order).
    :param inputs: ``Input`` (or a sequence in its order).
    :param omega_dot: yaw acceleration of the object [rad/s^2].
    :param rolling: (lam, R_e [m]) of ``contact.rolling_constants``.
    :param smoothing: speed below which support friction becomes viscous [m/s].
    :return: residual [N m].
    """
    state, inputs = State(*state), Input(*inputs)
    r_x, r_y = _lever(terms, state)
    bias_x, bias_y = _bias(terms, state, inputs, rolling)
    _, _, moment = _support_friction(terms, state, inputs, smoothing, (
        bias_x - omega_dot * r_y, bias_y + omega_dot * r_x))
    inertia = terms.inertia + terms.mass * (r_x * r_x + r_y * r_y)
    return inertia * omega_dot + terms.mass * (r_x * bias_y - r_y * bias_x) - moment


def yaw_acceleration(terms: ObjectTerms, state: Iterable[Any], inputs: Iterable[Any],
                     rolling: Rolling, smoothing: Any = SMOOTHING) -> Any:
    """
    Yaw acceleration of the object [rad/s^2], from ``moment_balance`` = 0.

    Arguments as for ``moment_balance``.
    """
    state = State(*state)
    at_rest = moment_balance(terms, state, inputs, 0.0, rolling, smoothing)
    if terms.transfer is None:
        r_x, r_y = _lever(terms, state)
        inertia = terms.inertia + terms.mass * (r_x * r_x + r_y * r_y)
    else:
        # Loads, and with them friction, are linear in the acceleration of the mass centre.
        inertia = moment_balance(terms, state, inputs, 1.0, rolling, smoothing) - at_rest
    return -at_rest / inertia


def derivative(terms: ObjectTerms, state: Iterable[Any], inputs: Iterable[Any], rolling: Rolling,
               smoothing: Any = SMOOTHING) -> State:
    """
    Time derivative of the state, a ``State`` of rates.

    ``gamma' = lam omega + (1 - lam) omega_p``; the contact moves in the object frame by
    ``R_e (omega - omega_p) t``. Arguments as for ``moment_balance``.
    """
    state, inputs = State(*state), Input(*inputs)
    omega_dot = yaw_acceleration(terms, state, inputs, rolling, smoothing)
    return kinematics(state, inputs, omega_dot, rolling)


def kinematics(state: Iterable[Any], inputs: Iterable[Any], omega_dot: Any,
               rolling: Rolling) -> State:
    """
    Rates of the state for a given yaw acceleration; only the rolling constraint, no forces.

    :param state: ``State``.
    :param inputs: ``Input``.
    :param omega_dot: yaw acceleration [rad/s^2].
    :param rolling: (lam, R_e [m]).
    :return: ``State`` of rates.
    """
    state, inputs = State(*state), Input(*inputs)
    normal_ratio, effective_radius = rolling
    w_x, w_y = rotated(state.theta, state.c_x, state.c_y)
    slip = effective_radius * (state.omega - inputs.omega_p)
    cosine, sine = cos_and_sin(state.gamma - state.theta)
    return State(inputs.v_x + state.omega * w_y, inputs.v_y - state.omega * w_x, state.omega,
                 omega_dot, normal_ratio * state.omega + (1 - normal_ratio) * inputs.omega_p,
                 -slip * sine, slip * cosine)


def contact_force(terms: ObjectTerms, state: Iterable[Any], inputs: Iterable[Any],
                  omega_dot: Any, rolling: Rolling,
                  smoothing: Any = SMOOTHING) -> tuple[Any, Any]:
    """
    Force of the robot on the object, ``F_C = m a_G - sum f_i``.

    Arguments as for ``moment_balance``.

    :return: (F_n, F_t) along n and t [N]. Rolling holds while F_n > 0 and |F_t| <= mu_c F_n.
    """
    state, inputs = State(*state), Input(*inputs)
    r_x, r_y = _lever(terms, state)
    bias_x, bias_y = _bias(terms, state, inputs, rolling)
    a_x, a_y = bias_x - omega_dot * r_y, bias_y + omega_dot * r_x
    f_x, f_y, _ = _support_friction(terms, state, inputs, smoothing, (a_x, a_y))
    force_x = terms.mass * a_x - f_x
    force_y = terms.mass * a_y - f_y
    return _along_normal(state.gamma, force_x, force_y)


def impulse(terms: ObjectTerms, state: Iterable[Any], dv_x: Any,
            dv_y: Any) -> tuple[Any, Any, Any]:
    """
    Effect of a jump of the velocity at C: ``(I + m |r_G|^2) d_omega = -m (k x r_G) . dv``.

    The contact is taken to hold; the caller checks the impulse: J_n > 0 and |J_t| <= mu_c J_n.

    :param state: ``State`` before the jump.
    :param dv_x: jump of the material velocity at C, world x [m/s].
    :param dv_y: jump of the material velocity at C, world y [m/s].
    :return: (d_omega [rad/s], J_n [N s], J_t [N s]).
    """
    state = State(*state)
    r_x, r_y = _lever(terms, state)
    inertia = terms.inertia + terms.mass * (r_x * r_x + r_y * r_y)
    d_omega = -terms.mass * (r_x * dv_y - r_y * dv_x) / inertia
    j_n, j_t = _along_normal(state.gamma, terms.mass * (dv_x - d_omega * r_y),
                             terms.mass * (dv_y + d_omega * r_x))
    return d_omega, j_n, j_t


def rotated(angle: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """
    Rotate a vector, of numbers or of casadi's symbols.

    :param angle: [rad].
    :param x: of the vector.
    :param y: of the vector.
    :return: (x, y).
    """
    cosine, sine = cos_and_sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


def _along_normal(gamma: Any, x: Any, y: Any) -> tuple[Any, Any]:
    cosine, sine = cos_and_sin(gamma)
    return cosine * x + sine * y, cosine * y - sine * x


def _lever(terms: ObjectTerms, state: State) -> tuple[Any, Any]:
    """Vector r from C to G in world axes."""
    return rotated(state.theta, terms.com_x - state.c_x, terms.com_y - state.c_y)


def _bias(terms: ObjectTerms, state: State, inputs: Input, rolling: Rolling) -> tuple[Any, Any]:
    """Find a_bias, the acceleration of G where the yaw rate does not change."""
    r_x, r_y = _lever(terms, state)
    _, effective_radius = rolling
    centripetal = state.omega * effective_radius * (state.omega - inputs.omega_p)
    cosine, sine = cos_and_sin(state.gamma)
    return (inputs.a_x - state.omega ** 2 * r_x + centripetal * cosine,
            inputs.a_y - state.omega ** 2 * r_y + centripetal * sine)


def _support_friction(terms: ObjectTerms, state: State, inputs: Input, smoothing: Any,
                      acceleration: tuple[Any, Any]) -> tuple[Any, Any, Any]:
    """Sum of the friction forces f_i (x, y), and their moment about C."""
    force_x, force_y, moment = 0.0, 0.0, 0.0
    capacities = _capacities(terms, state, inputs, smoothing, acceleration)
    for (s_x, s_y, _), capacity in zip(terms.supports, capacities):
        arm_x, arm_y = rotated(state.theta, s_x - state.c_x, s_y - state.c_y)
        v_x, v_y = inputs.v_x - state.omega * arm_y, inputs.v_y + state.omega * arm_x
        weight = friction_weight(capacity, v_x, v_y, smoothing)
        force_x, force_y = force_x - weight * v_x, force_y - weight * v_y
        moment = moment + weight * (arm_y * v_x - arm_x * v_y)
    return force_x, force_y, moment


def _capacities(terms: ObjectTerms, state: State, inputs: Input, smoothing: Any,
                acceleration: tuple[Any, Any]) -> list[Any]:
    """Friction capacities of the supports, under the loads that G's acceleration shifts."""
    if terms.transfer is None:
        return [capacity for _, _, capacity in terms.supports]
    sliding: list[SlidingSupport] = []
    for (s_x, s_y, capacity), support in zip(terms.supports, terms.transfer.supports):
        arm_x, arm_y = rotated(state.theta, s_x - state.c_x, s_y - state.c_y)
        slide = slide_direction(inputs.v_x - state.omega * arm_y,
                                inputs.v_y + state.omega * arm_x, smoothing)
        gradient = rotated(state.theta, support.gradient_x, support.gradient_y)
        sliding.append(SlidingSupport(capacity, support.friction_coefficient, *gradient, *slide))
    return transferred_capacities(terms.transfer, sliding, terms.mass * acceleration[0],
                                  terms.mass * acceleration[1])
