"""
Steady turn of an object that is pushed at a fixed point, inertia included.

The push keeps its direction in the object frame, so the velocity imposed at C rotates with the
object, ``a_C = omega k x v_C``, and in ``moment_balance`` the inertial term becomes the damping
``-m omega (r . v_C)``: the steady rate depends on v^2 / (mu g L), but neither on m nor on I. One
point K of the object stands still, the centre of its circle: ``K = C + k x v / omega``.
"""

import math
from typing import cast

from push_model.dynamics import contact_force, Input, moment_balance, ObjectTerms, State
from push_model.geometry import Coordinates, Pose
from push_model.parameters import PushedObject
from push_model.quasi_static import quasi_static_yaw_rate
from scipy.optimize import brentq

# Rolling constants (lam, R_e) of a contact that is fixed on the object.
FIXED = (1.0, 0.0)
# Support friction becomes viscous below this fraction of the contact's speed. Chosen: as small as
# the search for the root bears where an object rotates about one of its supports.
SMOOTHING_RATIO = 1e-7


def steady_yaw_rate(obj: PushedObject, contact_point: Coordinates, direction: float,
                    speed: float) -> float:
    """
    Find the yaw rate at which the push goes on for ever.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s], above 0.
    :return: omega [rad/s].
    :raises ValueError: for a push away from the mass centre, which holds no steady turn.
    """
    terms = ObjectTerms.of(obj)
    lever = ((terms.com_x - contact_point[0]) * math.cos(direction)
             + (terms.com_y - contact_point[1]) * math.sin(direction))
    if lever <= 0.0:
        raise ValueError(f'direction: got {direction:g} rad, which leads away from the mass '
                         'centre, expected one within 90 degrees of it')

    def residual(omega: float) -> float:
        return moment_balance(terms, *_steady_motion(contact_point, direction, speed, omega), 0.0,
                              FIXED, SMOOTHING_RATIO * speed)

    # Inertia only damps the turn, so the quasi-static rate bounds it; a little more on both ends,
    # for rounding, and for the smoothing where the turn is about a support.
    bound = quasi_static_yaw_rate(obj, contact_point, speed * math.cos(direction),
                                  speed * math.sin(direction))
    slack = math.copysign(1e-5 * speed, bound)
    if not residual(0.0):
        return 0.0
    return cast(float, brentq(residual, -slack, bound + slack, xtol=1e-13))


def steady_force(obj: PushedObject, contact_point: Coordinates, direction: float, speed: float,
                 normal: float) -> tuple[float, float]:
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
    state, inputs = _steady_motion(contact_point, direction, speed, omega)
    force_n, force_t = contact_force(ObjectTerms.of(obj), state._replace(gamma=normal), inputs,
                                     0.0, FIXED, SMOOTHING_RATIO * speed)
    return float(force_n), float(force_t)


def _steady_motion(contact_point: Coordinates, direction: float, speed: float,
                   omega: float) -> tuple[State, Input]:
    v_x, v_y = speed * math.cos(direction), speed * math.sin(direction)
    return (State(0.0, 0.0, 0.0, omega, 0.0, *contact_point),
            Input(v_x, v_y, -omega * v_y, omega * v_x, omega))


def rotation_center(contact_point: Coordinates, direction: float, speed: float,
                    omega: float) -> tuple[float, float]:
    """
    Find the point K about which the object rotates, in the object frame (x, y) [m].

    :param contact_point: C in the object frame (x, y) [m].
    :param direction: of the velocity at C, in the object frame [rad].
    :param speed: of the contact [m/s].
    :param omega: yaw rate [rad/s], not 0.
    :raises ValueError: for a yaw rate of 0, which has no such point.
    """
    if omega == 0.0:
        raise ValueError('omega: got 0, expected a yaw rate: straight motion has no centre')
    return (contact_point[0] - speed * math.sin(direction) / omega,
            contact_point[1] + speed * math.cos(direction) / omega)


def rotated_about(center: tuple[float, float], angle: float) -> Pose:
    """
    Pose of an object that was at the world's origin and rotated about a point of its own.

    :param center: the point, in the object frame and at the start in the world (x, y) [m].
    :param angle: of the rotation [rad].
    :return: ``Pose``.
    """
    x, y = center
    return Pose(x, y, angle) @ Pose(-x, -y, 0.0)
