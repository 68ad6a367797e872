"""
Steady turning of an object that is pushed at a fixed point, inertia included.

The push keeps its direction in the object frame, so the velocity imposed at C turns with the
object, ``a_C = omega k x v_C``, and in ``moment_balance`` the inertial term becomes the damping
``-m omega (r . v_C)``: the steady rate depends on v^2 / (mu g L), but neither on m nor on I.
"""

import math

from push_model.dynamics import contact_force, Input, moment_balance, ObjectTerms, State
from push_model.quasi_static import quasi_static_yaw_rate
from scipy.optimize import brentq

FIXED = (1.0, 0.0)
SMOOTHING = 1e-7


def steady_yaw_rate(obj, contact_point, direction, speed):
    """
    Find the turning rate at which the push goes on for ever.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s], above 0.
    :return: omega [rad/s].
    :raises ValueError: for a push away from the mass centre, which holds no steady turn.
    """
    terms = ObjectTerms.of(obj)
    ahead = ((terms.com_x - contact_point[0]) * math.cos(direction)
             + (terms.com_y - contact_point[1]) * math.sin(direction))
    if ahead <= 0.0:
        raise ValueError(f'direction: got {direction:g} rad, which leads away from the mass '
                         'centre, expected one within 90 degrees of it')

    def residual(omega):
        return moment_balance(terms, *_steady(contact_point, direction, speed, omega), 0.0, FIXED,
                              SMOOTHING * speed)

    # Inertia only damps the turn, so the quasi-static rate bounds it; a little more on both ends,
    # for rounding, and for the smoothing where the turn is about a support.
    bound = quasi_static_yaw_rate(obj, contact_point, speed * math.cos(direction),
                                  speed * math.sin(direction))
    more = math.copysign(1e-5 * speed, bound)
    return brentq(residual, -more, bound + more, xtol=1e-13) if residual(0.0) else 0.0


def steady_force(obj, contact_point, direction, speed, normal):
    """
    Find the force of the robot on the object in the steady turn.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s], above 0.
    :param normal: angle of the contact normal in the object frame [rad].
    :return: (F_n, F_t) [N].
    """
    omega = steady_yaw_rate(obj, contact_point, direction, speed)
    state, inputs = _steady(contact_point, direction, speed, omega)
    force = contact_force(ObjectTerms.of(obj), state._replace(gamma=normal), inputs, 0.0, FIXED,
                          SMOOTHING * speed)
    return tuple(float(part) for part in force)


def _steady(contact_point, direction, speed, omega):
    v_x, v_y = speed * math.cos(direction), speed * math.sin(direction)
    return (State(0.0, 0.0, 0.0, omega, 0.0, *contact_point),
            Input(v_x, v_y, -omega * v_y, omega * v_x, omega))
