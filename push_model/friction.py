"""
Coulomb friction under the supports of an object, and what it amounts to for a push.

Each support i at s_i bears the load N_i and resists sliding with at most ``q_i = mu_i N_i``. The
centre of friction F is their mean, weighted by q_i; c^2, a mean square about F, says how hard the
object is to rotate compared with how hard it is to move.
"""

import dataclasses
import math
from typing import Any

import numpy as np
from push_model.geometry import Coordinates
from push_model.parameters import PushedObject

# Chosen: a support keeps at least this fraction of its friction when the centre of friction is
# shifted. Any value above 0 keeps supports from pulling.
MIN_FRICTION_RATIO = 0.1


def friction_weight(capacity: Any, v_x: Any, v_y: Any, smoothing: Any) -> Any:
    """
    Ratio of friction force to sliding velocity, ``q / sqrt(|v|^2 + eps^2)``; ``f = -weight v``.

    Works on numbers, arrays and casadi symbols alike, and inside numba.

    :param capacity: q = mu N [N].
    :param v_x: sliding velocity, x [m/s].
    :param v_y: sliding velocity, y [m/s].
    :param smoothing: eps, the speed below which friction becomes viscous [m/s], above 0.
    :return: weight [N s/m].
    """
    return capacity / (v_x * v_x + v_y * v_y + smoothing * smoothing) ** 0.5


def friction_center(obj: PushedObject) -> tuple[float, float]:
    """
    Centre of friction F in the object frame, ``p_F = sum q_i s_i / sum q_i`` [m].

    :param obj: the ``PushedObject``.
    :return: (x, y) [m].
    :raises ValueError: where no support has friction.
    """
    total = _total_capacity(obj)
    return (sum(q * s.x for q, s in zip(obj.capacities, obj.supports)) / total,
            sum(q * s.y for q, s in zip(obj.capacities, obj.supports)) / total)


def c_squared(obj: PushedObject, angle: float) -> float:
    """
    Friction-weighted mean square of the support coordinates along a push, ``c^2 = <x^2>``.

    Near straight motion real supports act with this c^2, not with ``(tau_max / f_max)^2``.

    :param obj: the ``PushedObject``.
    :param angle: direction of the push in the object frame [rad].
    :return: c^2 about F [m^2].
    :raises ValueError: where no support has friction.
    """
    total = _total_capacity(obj)
    x_f, y_f = friction_center(obj)
    c, s = math.cos(angle), math.sin(angle)
    return sum(q * ((support.x - x_f) * c + (support.y - y_f) * s) ** 2
               for q, support in zip(obj.capacities, obj.supports)) / total


def ellipsoid_c_squared(obj: PushedObject) -> float:
    """
    Square of ``tau_max / f_max``, which the ellipsoidal limit surface takes for c^2 [m^2].

    :param obj: the ``PushedObject``.
    :raises ValueError: where no support has friction.
    """
    x_f, y_f = friction_center(obj)
    moment = sum(q * math.hypot(support.x - x_f, support.y - y_f)
                 for q, support in zip(obj.capacities, obj.supports))
    return (moment / _total_capacity(obj)) ** 2


def with_friction_center(obj: PushedObject, center: Coordinates) -> PushedObject:
    """
    Shift the centre of friction, with the friction of the supports as even as possible.

    Each coefficient is scaled by ``1 + d_i . S^-1 (center - p_F)``, with d_i the position of the
    support from F and S the weighted covariance of these positions: the smallest change, in
    weighted least squares, that keeps the sum of friction and puts F at ``center``.

    :param obj: the ``PushedObject``.
    :param center: requested centre of friction, object frame (x, y) [m].
    :return: ``PushedObject`` with the same friction in all. Its centre is shifted less where the
        whole shift would leave a support with less than a tenth of its friction.
    """
    positions = np.array([(support.x, support.y) for support in obj.supports])
    offsets = positions - friction_center(obj)
    capacities = np.array(obj.capacities)
    covariance = offsets.T @ (capacities[:, None] * offsets) / capacities.sum()
    # Supports on one line have a singular covariance; the centre then moves along the line only.
    inverse = np.linalg.pinv(covariance, rcond=1e-9)
    changes = offsets @ inverse @ (np.array(center) - friction_center(obj))
    changes *= min(1.0, (1.0 - MIN_FRICTION_RATIO) / max(1e-12, -changes.min()))
    supports = tuple(
        dataclasses.replace(
            support, friction_coefficient=support.friction_coefficient * float(ratio))
        for support, ratio in zip(obj.supports, 1.0 + changes))
    return dataclasses.replace(obj, supports=supports)


def _total_capacity(obj: PushedObject) -> float:
    total = sum(obj.capacities)
    if total <= 0.0:
        raise ValueError('PushedObject.supports: got friction 0 under every support, expected '
                         'friction under at least one')
    return total
