"""
Equilibria of a straight push, their stability, and how much disturbance they bear.

Friction acts on the pushed object like gravity on a rocking stone. About an equilibrium, where
the centre of friction is straight ahead of the contact (alpha = 0) at the distance r, small
rotations e_theta of the object obey

    (I + m |r_G|^2) e_theta'' + (Q / v) (r^2 + c^2) e_theta' + Q (R_e cos(rho) - r) e_theta = 0

with Q the friction capacity of all supports together and r_G from the contact to the mass centre.
It is stable where ``r < R_e cos(rho)``.
"""

import cmath
import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from push_model.friction import c_squared, friction_center
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from scipy.optimize import brentq
from studies.analysis.pushing_location import PushingLocation

# Samples among which equilibria are bracketed. Chosen: 0.2 degrees over two full rotations.
SAMPLES = 4096
# Pushing angles beyond this have no equilibrium: the push leads away from the object [rad].
MAX_PUSHING_ANGLE = 0.5 * math.pi
# What ends the return of an object to its equilibrium.
ToleranceLimit = Literal['equilibrium', 'cone', 'end', 'none']


class Equilibrium(NamedTuple):
    """
    A steady state of a straight push.

    :param rotation: of the object from the location's reference [rad].
    :param rho: pushing angle, from the normal to the push [rad].
    :param arm: r, distance from contact to centre of friction [m].
    :param margin: ``R_e cos(rho) - r`` [m]: above 0 stable, below 0 unstable.
    :param travel: of the contact along t from the reference, on the object [m].
    """

    rotation: float
    rho: float
    arm: float
    margin: float
    travel: float

    @property
    def is_stable(self) -> bool:
        """Tell whether a small disturbance dies out."""
        return self.margin > 0.0


class Tolerance(NamedTuple):
    """
    Greatest rotation one way from an equilibrium from which an object still returns.

    :param rotation: of the object from equilibrium, with its sign [rad].
    :param rho: change of the pushing angle that goes with it [rad].
    :param limit: 'equilibrium' (an unstable one), 'cone' (edge of the rolling cone), 'end' (of
        the face), or 'none' (up to a rotation of 180 degrees).
    """

    rotation: float
    rho: float
    limit: ToleranceLimit


class LinearMotion(NamedTuple):
    """
    Small rotations e_theta about an equilibrium.

    ``inertia e_theta'' + damping e_theta' + stiffness e_theta = 0``.

    :param inertia: [kg m^2].
    :param damping: [N m s].
    :param stiffness: [N m].
    """

    inertia: float
    damping: float
    stiffness: float

    @property
    def poles(self) -> tuple[complex, complex]:
        """Both roots [1/s]; the one with the greater real part comes first."""
        root = cmath.sqrt(self.damping ** 2 - 4.0 * self.inertia * self.stiffness)
        # In the form that does not cancel, for slow pushes.
        fast = -0.5 * (self.damping + root) / self.inertia
        return self.stiffness / (self.inertia * fast), fast

    @property
    def growth_rate(self) -> float:
        """Rate at which a disturbance grows, below 0 where it decays [1/s]."""
        return self.poles[0].real

    @property
    def damping_ratio(self) -> float:
        """Damping over critical damping; nan for an unstable equilibrium."""
        if self.stiffness <= 0.0:
            return math.nan
        return 0.5 * self.damping / math.sqrt(self.inertia * self.stiffness)


def equilibria(location: PushingLocation) -> list[Equilibrium]:
    """
    Find the equilibria of a pushing location, by rotation.

    :param location: ``PushingLocation``.
    :return: list of ``Equilibrium``, with pushing angles within 90 degrees, rotations within 360
        degrees to either side and the contact on its face or vertex.
    """
    low, high = _search_range(location)

    def lateral(rotation: float) -> float:
        return float(location.friction_center(rotation)[1])

    rotations = np.linspace(low, high, SAMPLES)
    sides = location.friction_center(rotations)[1]
    rotations_at_rest = set(rotations[sides == 0.0].tolist())
    rotations_at_rest |= {brentq(lateral, rotations[i], rotations[i + 1], xtol=1e-14)
                          for i in np.flatnonzero(sides[:-1] * sides[1:] < 0.0)}
    return [equilibrium_at(location, rotation) for rotation in sorted(rotations_at_rest)
            if location.friction_center(rotation)[0] > 0.0]


def equilibrium_at(location: PushingLocation, rotation: float) -> Equilibrium:
    """
    Describe the equilibrium at a rotation where the centre of friction is straight ahead.

    :param location: ``PushingLocation``.
    :param rotation: of the object from the location's reference [rad], where alpha is 0.
    :return: ``Equilibrium``.
    """
    effective_radius, rho = location.rolling.effective_radius, float(location.rho(rotation))
    arm = float(location.friction_center(rotation)[0])
    return Equilibrium(float(rotation), rho, arm, effective_radius * math.cos(rho) - arm,
                       effective_radius * rotation)


def tolerances(location: PushingLocation, equilibrium: Equilibrium,
               contact_friction: float) -> tuple[Tolerance, Tolerance]:
    """
    Tell how far the object may be rotated from an equilibrium and still return.

    :param location: ``PushingLocation``.
    :param equilibrium: one of its ``equilibria``.
    :param contact_friction: mu_c; the push stays in the cone while ``|rho| <= atan(mu_c)``. An
        object that rotates back tilts the contact force further out: where the cone limits, this
        is an upper bound, and ``rolling_limits`` has the force itself.
    :return: (``Tolerance`` clockwise, ``Tolerance`` counter-clockwise); both 0 where the
        equilibrium is unstable, or outside the cone.
    """
    cone = math.atan(contact_friction)
    if not equilibrium.is_stable:
        return Tolerance(0.0, 0.0, 'equilibrium'), Tolerance(0.0, 0.0, 'equilibrium')
    if abs(equilibrium.rho) > cone:
        return Tolerance(0.0, 0.0, 'cone'), Tolerance(0.0, 0.0, 'cone')
    unstable = [other.rotation for other in equilibria(location) if not other.is_stable]
    clockwise, counter_clockwise = location.rotation_range
    return (_tolerance(location, equilibrium, cone, -1.0, unstable, clockwise),
            _tolerance(location, equilibrium, cone, 1.0, unstable, counter_clockwise))


def _tolerance(location: PushingLocation, equilibrium: Equilibrium, cone: float, side: float,
               unstable: list[float], end: float) -> Tolerance:
    """
    Find the first limit on one side.

    :param side: 1 counter-clockwise, -1 clockwise.
    :param unstable: rotations of the unstable equilibria [rad].
    :param end: rotation at which the contact leaves its face or vertex on this side [rad].
    """
    normal_ratio = location.rolling.normal_ratio
    limits: list[tuple[float, ToleranceLimit]] = []
    for rotation in unstable:
        limits.append((side * (rotation - equilibrium.rotation), 'equilibrium'))
    limits.append((side * (end - equilibrium.rotation), 'end'))
    limits.append((math.pi, 'none'))
    if normal_ratio > 0.0:
        limits.append(((cone + side * equilibrium.rho) / normal_ratio, 'cone'))
    rotation, limit = min(pair for pair in limits if pair[0] > 0.0)
    return Tolerance(side * rotation, -normal_ratio * side * rotation, limit)


def linear_motion(obj: PushedObject, location: PushingLocation, equilibrium: Equilibrium,
                  speed: float) -> LinearMotion:
    """
    Motion of an object after a small disturbance.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` on it.
    :param equilibrium: one of its ``equilibria``.
    :param speed: of the push [m/s], above 0.
    :return: ``LinearMotion``.
    """
    direction, arm = location.push_direction - equilibrium.rotation, equilibrium.arm
    x_f, y_f = friction_center(obj)
    lever = math.hypot(obj.center_of_mass[0] - x_f + arm * math.cos(direction),
                       obj.center_of_mass[1] - y_f + arm * math.sin(direction))
    capacity = sum(obj.capacities)
    return LinearMotion(obj.inertia + obj.mass * lever ** 2,
                        capacity / speed * (arm ** 2 + c_squared(obj, direction)),
                        capacity * equilibrium.margin)


def free_response(motion: LinearMotion, times: ArrayLike) -> FloatArray:
    """
    Rotation over time, as a fraction of that from which the object is released at rest.

    With the poles p and q, ``(p exp(q t) - q exp(p t)) / (p - q)``, written with their mean and
    half their difference so that equal poles do no harm.

    :param motion: ``LinearMotion``.
    :param times: since the object was released [s], shape (n,).
    :return: fraction, shape (n,).
    """
    slow, fast = motion.poles
    difference = slow - fast
    times = np.asarray(times, dtype=float)
    # (exp(slow t) - exp(fast t)) / difference, with factors that do not overflow.
    rising = np.exp(slow * times) * (times if difference == 0.0 else
                                     -np.expm1(-difference * times) / difference)
    return np.real(0.5 * (np.exp(slow * times) + np.exp(fast * times))
                   - 0.5 * (slow + fast) * rising)


def _search_range(location: PushingLocation) -> tuple[float, float]:
    normal_ratio, full = location.rolling.normal_ratio, 2.0 * math.pi
    low, high = -full, full
    if normal_ratio > 0.0:
        low = max(low, (location.pushing_angle - MAX_PUSHING_ANGLE) / normal_ratio)
        high = min(high, (location.pushing_angle + MAX_PUSHING_ANGLE) / normal_ratio)
    return max(low, location.rotation_range[0]), min(high, location.rotation_range[1])
