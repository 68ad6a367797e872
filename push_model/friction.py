"""Coulomb friction: under the supports, and at the contact."""

import dataclasses
import math

import numpy as np


def friction_weight(capacity, v_x, v_y, smoothing):
    """
    Ratio of friction force to sliding velocity, ``q / sqrt(|v|^2 + eps^2)``; ``f = -weight v``.

    Works on numbers, arrays and casadi symbols alike, and inside numba.

    :param capacity: q = mu N [N].
    :param v_x: sliding velocity, x [m/s].
    :param v_y: sliding velocity, y [m/s].
    :param smoothing: eps, the speed below which friction turns viscous [m/s], above 0.
    :return: weight [N s/m].
    """
    return capacity / (v_x * v_x + v_y * v_y + smoothing * smoothing) ** 0.5


def friction_center(obj):
    """
    Friction centre F in the object frame, ``p_F = sum q_i s_i / sum q_i`` [m].

    :param obj: the ``PushedObject``.
    :return: (x, y) [m].
    :raises ValueError: where no support has friction.
    """
    total = _total_capacity(obj)
    return (sum(q * s.x for q, s in zip(obj.capacities, obj.supports)) / total,
            sum(q * s.y for q, s in zip(obj.capacities, obj.supports)) / total)


def c_squared(obj, angle):
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
    return sum(q * ((foot.x - x_f) * c + (foot.y - y_f) * s) ** 2
               for q, foot in zip(obj.capacities, obj.supports)) / total


def ellipsoid_c_squared(obj):
    """
    Square of ``tau_max / f_max``, which the ellipsoidal limit surface takes for c^2 [m^2].

    :param obj: the ``PushedObject``.
    :raises ValueError: where no support has friction.
    """
    x_f, y_f = friction_center(obj)
    moment = sum(q * math.hypot(foot.x - x_f, foot.y - y_f)
                 for q, foot in zip(obj.capacities, obj.supports))
    return (moment / _total_capacity(obj)) ** 2


def _total_capacity(obj):
    total = sum(obj.capacities)
    if total <= 0.0:
        raise ValueError('PushedObject.supports: got friction 0 under every support, expected '
                         'friction under at least one')
    return total


MIN_FRICTION_RATIO = 0.1


def with_friction_center(obj, center):
    """
    Let supports rub more on one side and less on the other, as evenly as possible.

    :param obj: the ``PushedObject``.
    :param center: friction centre wanted, object frame (x, y) [m].
    :return: ``PushedObject`` with as much friction in all; its centre is nearer where that one
        would take supports that pull.
    """
    offsets = np.array([(foot.x, foot.y) for foot in obj.supports]) - friction_center(obj)
    capacities = np.array(obj.capacities)
    second = offsets.T @ (capacities[:, None] * offsets) / capacities.sum()
    tilt = offsets @ np.linalg.pinv(second, rcond=1e-9) @ (np.array(center) - friction_center(obj))
    tilt *= min(1.0, (1.0 - MIN_FRICTION_RATIO) / max(1e-12, -tilt.min()))
    supports = tuple(
        dataclasses.replace(foot, friction_coefficient=foot.friction_coefficient * float(share))
        for foot, share in zip(obj.supports, 1.0 + tilt))
    return dataclasses.replace(obj, supports=supports)
