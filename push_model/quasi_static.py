"""
Quasi-static pushing: the inertia-free limit, and the pushed object seen as a vehicle.

Symbols: C contact point, F centre of friction, r their distance, e the direction from C to F, c^2
the limit-surface ratio [m^2] (``friction.c_squared``), omega the yaw rate of the object.
"""

from collections.abc import Callable, Iterable, Sequence
import math
from typing import Any, NamedTuple

from push_model.friction import (
    c_squared, ellipsoid_c_squared, friction_center, friction_weight, has_heights, load_gradients,
    LoadTransfer, slide_direction, SlidingSupport, transferred_capacities,
)
from push_model.geometry import Coordinates
from push_model.parameters import PushedObject

# Support friction becomes viscous below this fraction of the contact's speed. Chosen: far below
# every slide that matters, and above what the search for the root resolves.
SMOOTHING_RATIO = 1e-9
# Of the search for a root: truncation of the interpolation towards the middle, by this factor
# times width ** 2 / first width, and evaluations more than bisection needs; as in its paper.
TRUNCATION_FACTOR = 0.2
EXTRA_EVALUATIONS = 1
# Of the search for the centre of friction under a push: change at which it ends [m], and most
# iterations; chosen: each shrinks the change by mu z over the distance, far below 1.
CENTER_TOLERANCE = 1e-12
CENTER_ITERATIONS = 50
# Columns of ``sliding_rows``.
SLIDING_COLUMNS = 5
# Smallest distance of a contact from the centre of friction [m]: nearer, nothing steers. Chosen:
# far below any object, far above rounding.
MIN_ARM = 1e-6


class Vehicle(NamedTuple):
    """
    An object pushed at a point, seen as a bicycle driven in reverse (model: quasi-static).

    The flat output z never moves sideways; the contact C is the steered axle:
    ``tan(steer) = L * curvature of z``. Exact for the ellipsoidal limit surface.

    :param arm: r, distance from C to the centre of friction F [m].
    :param c_squared: c^2 of the supports along the push [m^2].
    :param angle: direction from C to F in the object frame [rad].
    :param contact_point: C in the object frame (x, y) [m].
    :param flat_output: z = F + (c^2 / r) e in the object frame (x, y) [m].
    :param wheelbase: distance from C to z, ``L = r + c^2 / r`` [m].
    """

    arm: float
    c_squared: float
    angle: float
    contact_point: tuple[float, float]
    flat_output: tuple[float, float]
    wheelbase: float


def vehicle_along(contact_point: tuple[float, float], arm: float, angle: float,
                  square: float) -> Vehicle:
    """
    Describe an object by the line from C to F and its c^2.

    :param contact_point: C in the object frame (x, y) [m].
    :param arm: r, distance from C to F [m].
    :param angle: direction from C to F in the object frame [rad].
    :param square: c^2 of the supports along it [m^2].
    """
    length = arm + square / arm
    return Vehicle(arm, square, angle, contact_point,
                   (contact_point[0] + length * math.cos(angle),
                    contact_point[1] + length * math.sin(angle)), length)


def vehicle(obj: PushedObject, contact_point: Coordinates,
            center: Coordinates | None = None) -> Vehicle:
    """
    Describe an object that is pushed at a point as a vehicle.

    With heights, centre of friction and c^2 are those under the loads that the push shifts.

    :param contact_point: C in the object frame (x, y) [m].
    :param center: centre of friction to use in place of the object's own (x, y) [m].
    :raises ValueError: where C coincides with the centre of friction: nothing steers there.
    """
    x_f, y_f = pushed_friction_center(obj, contact_point) if center is None else center
    x_c, y_c = contact_point
    arm = math.hypot(x_f - x_c, y_f - y_c)
    if arm < MIN_ARM:
        raise ValueError(f'contact_point: got {contact_point}, the centre of friction, '
                         'expected a point apart from it')
    angle = math.atan2(y_f - y_c, x_f - x_c)
    if has_heights(obj):
        square = straight_push(obj, (x_c, y_c), angle, (x_f, y_f)).c_squared
    else:
        square = c_squared(obj, angle)
    return vehicle_along((x_c, y_c), arm, angle, square)


class SlowStraightPush(NamedTuple):
    """
    An object that is pushed straight, loads transferred; first order about that motion.

    :param center: centre of friction under the push, object frame (x, y) [m].
    :param c_squared: c^2 that gives the wheelbase ``(r^2 + c^2) / r`` from that centre [m^2].
    """

    center: tuple[float, float]
    c_squared: float


def straight_push(obj: PushedObject, contact_point: tuple[float, float], angle: float,
                  center: tuple[float, float] | None = None) -> SlowStraightPush:
    """
    Centre of friction and c^2 of an object that slides in one direction.

    With x_i along and y_i across the push, from the centre of friction under the transferred
    loads, and r' its distance from the contact:

        Z = z_C (sum mu_i eta_iy y_i + z_C (sum mu_i eta_iy) (sum mu_i eta_ix y_i)
                 / (1 - z_C sum mu_i eta_ix))
        c^2 = <x_i^2> r' / (r' - Z)

    For supports of one mu, Z = mu z_C: the wheelbase is then ``r + mu z_C + (c_0^2 - (mu z_C)^2)
    / r``, with r and c_0 those at rest.

    :param contact_point: C in the object frame (x, y) [m].
    :param angle: direction of the push in the object frame [rad].
    :param center: centre of friction under the push, where it is known [m].
    """
    slide = straight_slide(obj.contact_height, sliding_rows(obj), angle)
    x, y = slide.center if center is None else center
    arm = (x - contact_point[0]) * math.cos(angle) + (y - contact_point[1]) * math.sin(angle)
    return SlowStraightPush((x, y), slide.c_squared * arm / (arm - slide.shift))


class StraightSlide(NamedTuple):
    """
    Supports of an object that slides in one direction, wherever it is pushed.

    :param center: centre of friction under the transferred loads, object frame (x, y) [m].
    :param c_squared: ``<x_i^2>`` about it [m^2].
    :param shift: Z of ``straight_push`` [m].
    """

    center: tuple[float, float]
    c_squared: float
    shift: float


def sliding_rows(obj: PushedObject) -> list[tuple[float, ...]]:
    """
    List what ``straight_slide`` reads of the supports.

    :return: x, y [m], capacity at rest q [N], and ``mu eta`` (x, y) [1/m] of each support.
    """
    return [(support.x, support.y, capacity, support.friction_coefficient * gradient[0],
             support.friction_coefficient * gradient[1])
            for support, capacity, gradient in zip(obj.supports, obj.capacities,
                                                   load_gradients(obj))]


def straight_slide(height: float, rows: Any, angle: float) -> StraightSlide:
    """
    Evaluate the supports of an object that slides in one direction e at constant speed.

    Their total friction F acts against e, and the loads balance the moment ``z_C F e``: capacities
    are ``q_i + z_C F mu_i eta_i . e``, whose sum is F, so ``F = sum q_i / (1 - z_C sum mu_i eta_i
    . e)``. Works on arrays and lists alike, and inside numba.

    :param height: of the contact, z_C [m].
    :param rows: ``sliding_rows``.
    :param angle: of e in the object frame [rad].
    """
    e_x, e_y = math.cos(angle), math.sin(angle)
    at_rest = along = across = 0.0
    for row in rows:
        at_rest += row[2]
        along += row[3] * e_x + row[4] * e_y
        across += row[4] * e_x - row[3] * e_y
    total = at_rest / (1.0 - height * along)
    mean_x = mean_y = 0.0
    for row in rows:
        weight = row[2] / total + height * (row[3] * e_x + row[4] * e_y)
        mean_x += weight * row[0]
        mean_y += weight * row[1]
    square = by_along = by_across = 0.0
    for row in rows:
        weight = row[2] / total + height * (row[3] * e_x + row[4] * e_y)
        x = (row[0] - mean_x) * e_x + (row[1] - mean_y) * e_y
        y = (row[1] - mean_y) * e_x - (row[0] - mean_x) * e_y
        square += weight * x * x
        by_along += (row[3] * e_x + row[4] * e_y) * y
        by_across += (row[4] * e_x - row[3] * e_y) * y
    shift = height * (by_across + height * across * by_along / (1.0 - height * along))
    return StraightSlide((mean_x, mean_y), square, shift)


def pushed_friction_center(obj: PushedObject, contact_point: Coordinates) -> tuple[float, float]:
    """
    Find the centre of friction straight ahead of a push, object frame (x, y) [m].

    With heights it lies further ahead than at rest, and where friction differs from support to
    support also to the side of it.

    :param contact_point: C in the object frame (x, y) [m].
    """
    center = friction_center(obj)
    if not has_heights(obj):
        return center
    x_c, y_c = contact_point
    for _ in range(CENTER_ITERATIONS):
        angle = math.atan2(center[1] - y_c, center[0] - x_c)
        center, previous = straight_push(obj, (x_c, y_c), angle).center, center
        if math.dist(center, previous) < CENTER_TOLERANCE:
            break
    return center


def quasi_static_yaw_rate(obj: PushedObject, contact_point: Coordinates, v_x: float,
                          v_y: float) -> float:
    """
    Quasi-static yaw rate on the supports themselves: ``sum (s_i - C) x f_i = 0``.

    :param contact_point: C in the object frame (x, y) [m].
    :param v_x: velocity imposed at C, object frame, x [m/s].
    :param v_y: velocity imposed at C, object frame, y [m/s].
    :return: omega [rad/s]; 0 at rest.
    """
    speed = math.hypot(v_x, v_y)
    if speed == 0.0:
        return 0.0
    arms = [(s.x - contact_point[0], s.y - contact_point[1]) for s in obj.supports]
    transfer = LoadTransfer.of(obj)

    def moment(omega: float) -> float:
        total = 0.0
        slides = [(v_x - omega * y, v_y + omega * x) for x, y in arms]
        capacities = sliding_capacities(obj, transfer, slides, SMOOTHING_RATIO * speed)
        for (x, y), (slide_x, slide_y), capacity in zip(arms, slides, capacities):
            weight = friction_weight(capacity, slide_x, slide_y, SMOOTHING_RATIO * speed)
            total += weight * (y * slide_x - x * slide_y)
        return total

    # At this rate the farthest support slides backwards; others may need a higher one.
    bound = 2.0 * speed / max(math.hypot(x, y) for x, y in arms)
    while moment(bound) * moment(-bound) > 0.0:
        bound *= 2.0
    return find_root(moment, -bound, bound, 1e-13 * bound)


def sliding_capacities(obj: PushedObject, transfer: LoadTransfer | None,
                       slides: Sequence[tuple[float, float]],
                       smoothing: float) -> Sequence[float]:
    """
    Friction capacities of the supports in slow sliding [N].

    :param transfer: its ``LoadTransfer``, or None.
    :param slides: sliding velocity of each support, object frame (x, y) [m/s].
    :param smoothing: speed below which support friction becomes viscous [m/s].
    """
    if transfer is None:
        return obj.capacities
    return transferred_capacities(transfer, (
        SlidingSupport(capacity, *support, *slide_direction(*slide, smoothing))
        for capacity, support, slide in zip(obj.capacities, transfer.supports, slides)))


def ellipsoid_yaw_rate(square: Any, x_c: Any, y_c: Any, v_x: Any, v_y: Any) -> Any:
    """
    Yaw rate by the ellipsoidal limit surface: ``(x_c v_y - y_c v_x) / (c^2 + x_c^2 + y_c^2)``.

    Works on numbers and casadi symbols alike.

    :param square: c^2 [m^2].
    :param x_c: contact in the object's axes with the centre of friction as origin, x [m].
    :param y_c: contact in the object's axes with the centre of friction as origin, y [m].
    :param v_x: velocity imposed at the contact, same axes, x [m/s].
    :param v_y: velocity imposed at the contact, same axes, y [m/s].
    :return: omega [rad/s].
    """
    return (x_c * v_y - y_c * v_x) / (square + x_c * x_c + y_c * y_c)


class YawRates(NamedTuple):
    """
    Rotation per distance of the contact, by three models, for one pushing direction [rad/m].

    :param angle: alpha, from the line C to F to the push [rad].
    :param supports: on the supports themselves.
    :param near_straight: by the ellipsoid with the supports' own c^2 along the push.
    :param ellipsoid: by the ellipsoidal limit surface, ``c = tau_max / f_max``.
    """

    angle: float
    supports: float
    near_straight: float
    ellipsoid: float


def compare_yaw_rates(obj: PushedObject, contact_point: tuple[float, float],
                      angles: Iterable[float]) -> list[YawRates]:
    """
    Compare the quasi-static limit on the supports with the ellipsoidal limit surface.

    :param contact_point: C in the object frame (x, y) [m].
    :param angles: alpha of each row [rad].
    :return: list of ``YawRates``.
    """
    view = vehicle(obj, contact_point)
    x_f, y_f = pushed_friction_center(obj, contact_point)
    x_c, y_c = contact_point[0] - x_f, contact_point[1] - y_f
    rows: list[YawRates] = []
    for angle in angles:
        v_x, v_y = math.cos(view.angle + angle), math.sin(view.angle + angle)
        rows.append(YawRates(
            angle, quasi_static_yaw_rate(obj, contact_point, v_x, v_y),
            near_straight=ellipsoid_yaw_rate(view.c_squared, x_c, y_c, v_x, v_y),
            ellipsoid=ellipsoid_yaw_rate(ellipsoid_c_squared(obj), x_c, y_c, v_x, v_y)))
    return rows


def find_root(function: Callable[[float], float], low: float, high: float,
              tolerance: float) -> float:
    """
    Find a root of a continuous function, never much slower than by bisection.

    The method interpolates, truncates and projects: Oliveira and Takahashi, "An enhancement of the
    bisection method average performance preserving minmax optimality", ACM Transactions on
    Mathematical Software 47(1), 2020. It is written here because a node must import scipy neither
    when it starts, which takes longer than all else, nor in the middle of a push.

    :param function: of a number.
    :param low: one bound of the root.
    :param high: the other one; the function has the other sign there, or is 0 at a bound.
    :param tolerance: largest error of the root, above rounding.
    :raises ValueError: where the function has the same sign at both bounds.
    """
    at_low, at_high = function(low), function(high)
    if at_low == 0.0 or at_high == 0.0:
        return low if at_low == 0.0 else high
    if (at_low > 0.0) == (at_high > 0.0):
        raise ValueError(f'function: got {at_low:g} at {low:g} and {at_high:g} at {high:g}, '
                         'expected different signs')
    factor = TRUNCATION_FACTOR / (high - low)
    bisections = math.ceil(math.log2(max((high - low) / (2.0 * tolerance), 1.0)))
    # Half the width that is allowed before the next evaluation.
    allowed = tolerance * 2.0 ** (bisections + EXTRA_EVALUATIONS)
    while high - low > 2.0 * tolerance:
        middle = 0.5 * (low + high)
        x = _next_estimate(middle, (at_high * low - at_low * high) / (at_high - at_low),
                           factor * (high - low) ** 2, allowed - 0.5 * (high - low))
        value = function(x)
        # No number lies between the bounds where the tolerance is below rounding.
        if value == 0.0 or not low < x < high:
            return x
        if (value > 0.0) == (at_high > 0.0):
            high, at_high = x, value
        else:
            low, at_low = x, value
        allowed *= 0.5
    return 0.5 * (low + high)


def _next_estimate(middle: float, interpolated: float, truncation: float, radius: float) -> float:
    """Move an estimate towards the middle, and so near to it that bisection is not slower."""
    to_middle = middle - interpolated
    if truncation > abs(to_middle):
        return middle
    truncated = interpolated + math.copysign(truncation, to_middle)
    if abs(truncated - middle) <= radius:
        return truncated
    return middle - math.copysign(radius, to_middle)
