"""Coulomb friction: under the supports, and at the contact."""

import math


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


def mean_square(obj, angle):
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


def ellipsoid_square(obj):
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
