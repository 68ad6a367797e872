"""
Coulomb friction under the supports of an object, the loads on them, and what both amount to.

Each support i at s_i bears the load N_i and resists sliding with at most ``q_i = mu_i N_i``. The
centre of friction F is their mean, weighted by q_i; c^2, a mean square about F, says how hard the
object is to rotate compared with how hard it is to move.

A push above the floor shifts loads. The mass centre G stands at the height z_G, the robot touches
the object at the height z_C and exerts no vertical force. The object stays flat on its supports,
so that the moments about G balance and the weight acts on the floor at the centre of pressure p,
from G:

    ``p = (z_C F_C - z_G m a_G) / (m g)``

F_C is the horizontal contact force. Of a rigid plate on springs of equal stiffness, each support
then bears ``N_i = N_i0 + m g eta_i . p``: N_i0 is its load at rest, and eta_i the gradient that
distributes the moment. Three supports leave no choice. A support whose load would become negative
lifts off; where p reaches the edge of the hull of the supports, the object tips.
"""

from collections.abc import Iterable
import dataclasses
import functools
import math
from typing import Any, NamedTuple

import numpy as np
from push_model.geometry import convex_hull, Coordinates
from push_model.parameters import PushedObject

# Chosen: a support keeps at least this fraction of its friction when the centre of friction is
# shifted. Any value above 0 keeps supports from pulling.
MIN_FRICTION_RATIO = 0.1
# Supports in one line, or nearly so, carry no moment across it: chosen, singular values below this
# fraction of the greatest count as none.
LINE_TOLERANCE = 1e-9


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


@functools.lru_cache(maxsize=256)
def friction_center(obj: PushedObject) -> tuple[float, float]:
    """
    Centre of friction F in the object frame, ``p_F = sum q_i s_i / sum q_i`` [m].

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

    :param angle: direction of the push in the object frame [rad].
    :return: c^2 about F [m^2].
    :raises ValueError: where no support has friction.
    """
    return c_squared_along(friction_covariance(obj), angle)


class FrictionCovariance(NamedTuple):
    """
    Friction-weighted mean products of the support coordinates about F, object axes [m^2].

    :param x_x: ``<x^2>``.
    :param x_y: ``<x y>``.
    :param y_y: ``<y^2>``.
    """

    x_x: float
    x_y: float
    y_y: float


def friction_covariance(obj: PushedObject) -> FrictionCovariance:
    """
    Compute the mean products of the support coordinates.

    :raises ValueError: where no support has friction.
    """
    total = _total_capacity(obj)
    x_f, y_f = friction_center(obj)
    rows = [(q / total, support.x - x_f, support.y - y_f)
            for q, support in zip(obj.capacities, obj.supports)]
    return FrictionCovariance(sum(weight * x * x for weight, x, _ in rows),
                              sum(weight * x * y for weight, x, y in rows),
                              sum(weight * y * y for weight, _, y in rows))


def c_squared_along(covariance: FrictionCovariance, angle: float) -> float:
    """
    Mean square of the support coordinates in a direction e, ``c^2 = e' <d d'> e`` [m^2].

    :param angle: of e in the object frame [rad].
    """
    c, s = math.cos(angle), math.sin(angle)
    return covariance.x_x * c * c + 2.0 * covariance.x_y * c * s + covariance.y_y * s * s


def ellipsoid_c_squared(obj: PushedObject) -> float:
    """
    Square of ``tau_max / f_max``, which the ellipsoidal limit surface takes for c^2 [m^2].

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


class SupportTransfer(NamedTuple):
    """
    Terms of one support in load transfer, as numbers or casadi symbols, object frame.

    :param friction_coefficient: mu.
    :param gradient_x: change of its fraction of the weight by the centre of pressure, x [1/m].
    :param gradient_y: the same, y [1/m].
    """

    friction_coefficient: Any
    gradient_x: Any
    gradient_y: Any


class LoadTransfer(NamedTuple):
    """
    Heights of an object, and how its supports share a moment.

    :param contact_height: z_C [m].
    :param center_of_mass_height: z_G [m].
    :param supports: ``SupportTransfer`` of each support.
    """

    contact_height: Any
    center_of_mass_height: Any
    supports: tuple[SupportTransfer, ...]

    @classmethod
    def of(cls, obj: PushedObject) -> 'LoadTransfer | None':
        """Take the heights from an object; None where both are 0 and nothing shifts."""
        if not has_heights(obj):
            return None
        return cls(obj.contact_height, obj.center_of_mass_height, tuple(
            SupportTransfer(support.friction_coefficient, *gradient)
            for support, gradient in zip(obj.supports, load_gradients(obj))))


class SlidingSupport(NamedTuple):
    """
    A support that slides, as numbers or casadi symbols; all vectors in the same axes.

    :param capacity: friction capacity under its load at rest [N].
    :param friction_coefficient: mu.
    :param gradient_x: eta_i, x [1/m].
    :param gradient_y: eta_i, y [1/m].
    :param slide_x: velocity over its (smoothed) magnitude, x.
    :param slide_y: the same, y.
    """

    capacity: Any
    friction_coefficient: Any
    gradient_x: Any
    gradient_y: Any
    slide_x: Any
    slide_y: Any


def has_heights(obj: PushedObject) -> bool:
    """Say whether a push transfers loads."""
    return obj.contact_height > 0.0 or obj.center_of_mass_height > 0.0


def load_moment(contact_height: Any, center_of_mass_height: Any, force: Any,
                inertial_force: Any) -> Any:
    """
    Moment that the loads must balance, ``z_C F - z_G m a_G``: one component, or an array of both.

    Works on numbers, arrays and casadi symbols alike, and inside numba. Divided by the weight it
    is the centre of pressure.

    :param contact_height: z_C [m].
    :param center_of_mass_height: z_G [m].
    :param force: contact force F [N].
    :param inertial_force: ``m a_G`` [N].
    :return: moment, as a vector in the plane: m g p [N m].
    """
    return contact_height * force - center_of_mass_height * inertial_force


def transferred_capacities(transfer: LoadTransfer, supports: Iterable[SlidingSupport],
                           inertial_x: Any = 0.0, inertial_y: Any = 0.0) -> list[Any]:
    """
    Friction capacities of sliding supports under the loads that their own friction shifts.

    Friction is ``f = -sum (q_i + mu_i eta_i . M) u_i`` with u_i the direction of sliding and M the
    moment of ``load_moment``, whose contact force is ``m a_G - f``: two linear equations for f. No
    support is taken to lift.

    :param supports: ``SlidingSupport`` of each support.
    :param inertial_x: ``m a_G``, x [N].
    :param inertial_y: ``m a_G``, y [N].
    :return: capacity of each support [N].
    """
    supports = tuple(supports)
    z_c, z_g = transfer.contact_height, transfer.center_of_mass_height
    # B = sum mu_i u_i eta_i^T, friction per moment; f_0 is the friction under the loads at rest.
    b_xx, b_xy, b_yx, b_yy, f_x, f_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for support in supports:
        mu_x = support.friction_coefficient * support.slide_x
        mu_y = support.friction_coefficient * support.slide_y
        b_xx, b_xy = b_xx + mu_x * support.gradient_x, b_xy + mu_x * support.gradient_y
        b_yx, b_yy = b_yx + mu_y * support.gradient_x, b_yy + mu_y * support.gradient_y
        f_x = f_x - support.capacity * support.slide_x
        f_y = f_y - support.capacity * support.slide_y
    # (1 - z_C B) f = f_0 - B (z_C - z_G) m a_G
    moment_x = load_moment(z_c, z_g, inertial_x, inertial_x)
    moment_y = load_moment(z_c, z_g, inertial_y, inertial_y)
    f_x, f_y = (f_x - b_xx * moment_x - b_xy * moment_y, f_y - b_yx * moment_x - b_yy * moment_y)
    a_xx, a_xy, a_yx, a_yy = 1.0 - z_c * b_xx, -z_c * b_xy, -z_c * b_yx, 1.0 - z_c * b_yy
    determinant = a_xx * a_yy - a_xy * a_yx
    f_x, f_y = ((a_yy * f_x - a_xy * f_y) / determinant, (a_xx * f_y - a_yx * f_x) / determinant)
    moment_x = load_moment(z_c, z_g, inertial_x - f_x, inertial_x)
    moment_y = load_moment(z_c, z_g, inertial_y - f_y, inertial_y)
    return [support.capacity + support.friction_coefficient
            * (support.gradient_x * moment_x + support.gradient_y * moment_y)
            for support in supports]


def load_gradients(obj: PushedObject) -> tuple[tuple[float, float], ...]:
    """
    Gradients eta_i of the loads by the centre of pressure, object frame, shape (k, 2) [1/m].

    ``eta_i = S^-1 d_i``: d_i is the position from the middle of the supports that carry a load at
    rest, S the sum of ``d_i d_i^T``. ``sum eta_i = 0`` and ``sum eta_i s_i^T = 1``, so
    that loads balance. A support without load at rest stays without.
    """
    return _load_gradients(
        tuple((support.x, support.y) for support in obj.supports),
        tuple(load > 0.0 for load in obj.loads))


# Kept, as variations of an object mostly stand on the same supports; 256 such sets take few kB.
@functools.lru_cache(maxsize=256)
def _load_gradients(positions: tuple[tuple[float, float], ...],
                    carrying: tuple[bool, ...]) -> tuple[tuple[float, float], ...]:
    carries = np.array(carrying)[:, None]
    offsets = np.array(positions) - np.array(positions)[np.array(carrying)].mean(axis=0)
    offsets = np.where(carries, offsets, 0.0)
    inverse = np.linalg.pinv(offsets.T @ offsets, rcond=LINE_TOLERANCE)
    return tuple((x, y) for x, y in (offsets @ inverse).tolist())


def tipping_height(obj: PushedObject) -> float:
    """
    Least height at which a slow push tips the object [m]; infinite where no friction resists.

    Pushed in the direction e, the centre of pressure lies at ``z_C mu e``. On the edge between two
    corners a and b of the hull of the supports, from G, only these carry, so that
    ``z = |a + t (b - a)| / (mu_a + t (mu_b - mu_a))``, least over t and over the edges.
    """
    friction: dict[tuple[float, float], float] = {}
    for support, load in zip(obj.supports, obj.loads):
        position = (support.x - obj.center_of_mass[0], support.y - obj.center_of_mass[1])
        if load > 0.0:
            friction[position] = max(support.friction_coefficient, friction.get(position, 0.0))
    corners = convex_hull(list(friction))
    return min(_edge_height(corners[i - 1], corner, friction[corners[i - 1]], friction[corner])
               for i, corner in enumerate(corners))


def _edge_height(a: tuple[float, float], b: tuple[float, float], mu_a: float,
                 mu_b: float) -> float:
    d_x, d_y, rise = b[0] - a[0], b[1] - a[1], mu_b - mu_a
    along, length, square = a[0] * d_x + a[1] * d_y, d_x * d_x + d_y * d_y, a[0] ** 2 + a[1] ** 2
    slope = rise * along - mu_a * length
    share = 0.0 if slope == 0.0 else min(1.0, max(0.0, (mu_a * along - rise * square) / slope))
    mu = mu_a + share * rise
    distance = math.hypot(a[0] + share * d_x, a[1] + share * d_y)
    return distance / mu if mu > 0.0 else math.inf


def check_tipping(obj: PushedObject) -> None:
    """
    Refuse an object that a push at its contact height tips over.

    :raises ValueError: naming the height at which it tips.
    """
    if not has_heights(obj):
        return
    height = tipping_height(obj)
    if obj.contact_height >= height:
        raise ValueError(f'PushedObject.contact_height: got {obj.contact_height:g} m, expected '
                         f'below {math.floor(1e3 * height) / 1e3:g} m, where a push tips the '
                         'object over')


def slide_direction(v_x: Any, v_y: Any, smoothing: Any) -> tuple[Any, Any]:
    """
    Direction of sliding, smoothed near 0 as ``friction.friction_weight`` is.

    :param v_x: sliding velocity, x [m/s].
    :param v_y: sliding velocity, y [m/s].
    :param smoothing: speed below which support friction becomes viscous [m/s].
    :return: (x, y).
    """
    weight = friction_weight(1.0, v_x, v_y, smoothing)
    return weight * v_x, weight * v_y


def _total_capacity(obj: PushedObject) -> float:
    total = sum(obj.capacities)
    if total <= 0.0:
        raise ValueError('PushedObject.supports: got friction 0 under every support, expected '
                         'friction under at least one')
    return total
