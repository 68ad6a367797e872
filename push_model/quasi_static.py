"""The inertia-free limit of pushing, and the pushed object seen as a vehicle."""

import math
from typing import NamedTuple

from push_model.friction import c_squared, ellipsoid_c_squared, friction_center, friction_weight
from scipy.optimize import brentq


class Vehicle(NamedTuple):
    """
    An object pushed at a point, seen as a bicycle driven in reverse (model: quasi-static).

    The flat point z never moves sideways; the contact C is the steered axle:
    ``tan(steer) = L * curvature of z``. Exact for the ellipsoidal limit surface.

    :param arm: r, distance from C to the friction centre F [m].
    :param c_squared: c^2 of the supports along the push [m^2].
    :param angle: direction from C to F in the object frame [rad].
    :param contact_point: C in the object frame (x, y) [m].
    :param flat_output: z = F + (c^2 / r) e in the object frame (x, y) [m].
    """

    arm: float
    c_squared: float
    angle: float
    contact_point: tuple
    flat_output: tuple

    @property
    def wheelbase(self):
        """Distance from C to z, ``L = (r^2 + c^2) / r`` [m]."""
        return (self.arm ** 2 + self.c_squared) / self.arm

    def with_c_squared_ratio(self, share):
        """
        See it with supports that turn more or less easily.

        :param share: of the present c^2 that they have.
        :return: ``Vehicle``, its flat point moved along the line from C to F.
        """
        more = (share - 1.0) * self.c_squared / self.arm
        x, y = self.flat_output
        return self._replace(c_squared=share * self.c_squared, flat_output=(
            x + more * math.cos(self.angle), y + more * math.sin(self.angle)))


def vehicle(obj, contact_point, center=None):
    """
    See an object as a vehicle pushed at a point.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param center: friction centre to use in place of the object's own (x, y) [m].
    :return: ``Vehicle``.
    :raises ValueError: where C coincides with the friction centre: nothing steers there.
    """
    x_f, y_f = friction_center(obj) if center is None else center
    arm = math.hypot(x_f - contact_point[0], y_f - contact_point[1])
    if arm < 1e-6:
        raise ValueError(f'contact_point: got {contact_point}, the friction centre itself, '
                         'expected a point apart from it')
    angle = math.atan2(y_f - contact_point[1], x_f - contact_point[0])
    square = c_squared(obj, angle)
    ahead = square / arm
    return Vehicle(arm, square, angle, tuple(contact_point),
                   (x_f + ahead * math.cos(angle), y_f + ahead * math.sin(angle)))


def quasi_static_yaw_rate(obj, contact_point, v_x, v_y):
    """
    Quasi-static turning rate on the supports themselves: ``sum (s_i - C) x f_i = 0``.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param v_x: velocity imposed at C, object frame, x [m/s].
    :param v_y: the same, y [m/s].
    :return: omega [rad/s]; 0 at rest.
    """
    speed = math.hypot(v_x, v_y)
    if speed == 0.0:
        return 0.0
    arms = [(s.x - contact_point[0], s.y - contact_point[1], q)
            for s, q in zip(obj.supports, obj.capacities)]

    def moment(omega):
        total = 0.0
        for x, y, capacity in arms:
            slide_x, slide_y = v_x - omega * y, v_y + omega * x
            weight = friction_weight(capacity, slide_x, slide_y, 1e-9 * speed)
            total += weight * (y * slide_x - x * slide_y)
        return total

    bound = 2.0 * speed / max(math.hypot(x, y) for x, y, _ in arms)
    while moment(bound) * moment(-bound) > 0.0:
        bound *= 2.0
    return brentq(moment, -bound, bound, xtol=1e-13 * bound)


def ellipsoid_yaw_rate(square, x_c, y_c, v_x, v_y):
    """
    Turn by the ellipsoidal limit surface: ``(x_c v_y - y_c v_x) / (c^2 + x_c^2 + y_c^2)``.

    Works on numbers and casadi symbols alike.

    :param square: c^2 [m^2].
    :param x_c: contact in the object's axes with the friction centre as origin, x [m].
    :param y_c: the same, y [m].
    :param v_x: velocity imposed at the contact, same axes, x [m/s].
    :param v_y: the same, y [m/s].
    :return: omega [rad/s].
    """
    return (x_c * v_y - y_c * v_x) / (square + x_c * x_c + y_c * y_c)


class YawRates(NamedTuple):
    """
    Turn per way of the contact, by three models, for one pushing direction [rad/m].

    :param angle: alpha, from the line C to F to the push [rad].
    :param supports: on the supports themselves.
    :param near_straight: by the ellipsoid with the supports' own c^2 along the push.
    :param ellipsoid: by the ellipsoidal limit surface, ``c = tau_max / f_max``.
    """

    angle: float
    supports: float
    near_straight: float
    ellipsoid: float


def compare_yaw_rates(obj, contact_point, angles):
    """
    Hold the quasi-static limit on the supports against the ellipsoidal limit surface.

    :param obj: the ``PushedObject``.
    :param contact_point: C in the object frame (x, y) [m].
    :param angles: alpha of each row [rad].
    :return: list of ``YawRates``.
    """
    view, center = vehicle(obj, contact_point), friction_center(obj)
    x_c, y_c = contact_point[0] - center[0], contact_point[1] - center[1]
    rows = []
    for angle in angles:
        push = math.cos(view.angle + angle), math.sin(view.angle + angle)
        rows.append(YawRates(angle, quasi_static_yaw_rate(obj, contact_point, *push), *(
            ellipsoid_yaw_rate(square, x_c, y_c, *push)
            for square in (view.c_squared, ellipsoid_c_squared(obj)))))
    return rows
