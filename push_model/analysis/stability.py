"""
Equilibria of a straight push, their stability, and how much disturbance they bear.

Friction acts on the pushed object like gravity on a rocking stone. About an equilibrium, where
the friction centre is straight ahead of the contact (alpha = 0) at the distance h,

    (I + m |r|^2) phi'' + (Q / v) (h^2 + <x^2>) phi' + Q (R_e cos(rho) - h) phi = 0

with Q the friction capacity of all supports together and r from the contact to the mass centre.
It is stable where ``h < R_e cos(rho)``.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np
from push_model.friction import c_squared, friction_center
from scipy.optimize import brentq

SAMPLES = 4096
WIDEST = 0.5 * math.pi


class Equilibrium(NamedTuple):
    """
    A steady state of a straight push.

    :param turn: of the object from the location's reference [rad].
    :param rho: pushing angle, from the normal to the push [rad].
    :param arm: h, distance from contact to friction centre [m].
    :param margin: ``R_e cos(rho) - h`` [m]: above 0 stable, below 0 unstable.
    :param travel: of the contact along t from the reference, on the object [m].
    """

    turn: float
    rho: float
    arm: float
    margin: float
    travel: float

    @property
    def is_stable(self):
        """Whether a small disturbance dies out."""
        return self.margin > 0.0


class Tolerance(NamedTuple):
    """
    How far an object may be turned one way from its equilibrium and still return.

    :param turn: of the object from equilibrium, with its sign [rad].
    :param rho: change of the pushing angle that goes with it [rad].
    :param limit: 'equilibrium' (an unstable one), 'cone' (edge of the rolling cone), 'end' (of
        the face), or 'none' (up to a turn of 180 degrees).
    """

    turn: float
    rho: float
    limit: str


class LinearMotion(NamedTuple):
    """
    Small turns phi about an equilibrium: ``inertia phi'' + damping phi' + stiffness phi = 0``.

    :param inertia: [kg m^2].
    :param damping: [N m s].
    :param stiffness: [N m].
    """

    inertia: float
    damping: float
    stiffness: float

    @property
    def poles(self):
        """Both roots [1/s]; the one with the greater real part comes first."""
        root = cmath.sqrt(self.damping ** 2 - 4.0 * self.inertia * self.stiffness)
        # In the form that does not cancel, for slow pushes.
        fast = -0.5 * (self.damping + root) / self.inertia
        return self.stiffness / (self.inertia * fast), fast

    @property
    def growth_rate(self):
        """Rate at which a disturbance grows, below 0 where it decays [1/s]."""
        return self.poles[0].real

    @property
    def damping_ratio(self):
        """Damping over critical damping; nan for an unstable equilibrium."""
        if self.stiffness <= 0.0:
            return math.nan
        return 0.5 * self.damping / math.sqrt(self.inertia * self.stiffness)


def equilibria(location):
    """
    Find the equilibria of a pushing location, by turn.

    :param location: ``PushingLocation``.
    :return: list of ``Equilibrium``, with pushing angles within 90 degrees, turns within a full
        turn to either side and the contact on its face or vertex.
    """
    low, high = _range(location)

    def aside(turn):
        return float(location.friction_center(turn)[1])

    turns = np.linspace(low, high, SAMPLES)
    sides = location.friction_center(turns)[1]
    found = set(turns[sides == 0.0].tolist())
    found |= {brentq(aside, turns[i], turns[i + 1], xtol=1e-14)
              for i in np.flatnonzero(sides[:-1] * sides[1:] < 0.0)}
    return [equilibrium_at(location, turn) for turn in sorted(found)
            if location.friction_center(turn)[0] > 0.0]


def equilibrium_at(location, turn):
    """
    Describe the equilibrium at a turn where the friction centre is straight ahead.

    :param location: ``PushingLocation``.
    :param turn: of the object from the location's reference [rad], where alpha is 0.
    :return: ``Equilibrium``.
    """
    effective, rho = location.rolling[1], float(location.rho(turn))
    arm = float(location.friction_center(turn)[0])
    return Equilibrium(float(turn), rho, arm, effective * math.cos(rho) - arm, effective * turn)


def tolerances(location, equilibrium, contact_friction):
    """
    Tell how far the object may be turned from an equilibrium and still return.

    :param location: ``PushingLocation``.
    :param equilibrium: one of its ``equilibria``.
    :param contact_friction: mu_c; the push stays in the cone while ``|rho| <= atan(mu_c)``. An
        object that turns back tilts the contact force further out: where the cone limits, this
        is an upper bound, and ``rolling_limits`` has the force itself.
    :return: (``Tolerance`` clockwise, ``Tolerance`` counter-clockwise); both 0 where the
        equilibrium is unstable, or outside the cone.
    """
    share, cone = location.rolling[0], math.atan(contact_friction)
    if not equilibrium.is_stable:
        return (Tolerance(0.0, 0.0, 'equilibrium'),) * 2
    if abs(equilibrium.rho) > cone:
        return (Tolerance(0.0, 0.0, 'cone'),) * 2
    unstable = [other.turn for other in equilibria(location) if not other.is_stable]
    result = []
    for side, end in zip((-1.0, 1.0), location.turns):
        limits = [(side * (turn - equilibrium.turn), 'equilibrium') for turn in unstable]
        limits += [(side * (end - equilibrium.turn), 'end'), (math.pi, 'none')]
        if share > 0.0:
            limits.append(((cone + side * equilibrium.rho) / share, 'cone'))
        turn, limit = min(pair for pair in limits if pair[0] > 0.0)
        result.append(Tolerance(side * turn, -share * side * turn, limit))
    return tuple(result)


def linear_motion(obj, location, equilibrium, speed):
    """
    Motion of an object after a small disturbance.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` on it.
    :param equilibrium: one of its ``equilibria``.
    :param speed: of the push [m/s], above 0.
    :return: ``LinearMotion``.
    """
    forward, arm = location.forward - equilibrium.turn, equilibrium.arm
    x_f, y_f = friction_center(obj)
    lever = math.hypot(obj.center_of_mass[0] - x_f + arm * math.cos(forward),
                       obj.center_of_mass[1] - y_f + arm * math.sin(forward))
    capacity = sum(obj.capacities)
    return LinearMotion(obj.inertia + obj.mass * lever ** 2,
                        capacity / speed * (arm ** 2 + c_squared(obj, forward)),
                        capacity * equilibrium.margin)


def _range(location):
    share, reach = location.rolling[0], 2.0 * math.pi
    low, high = -reach, reach
    if share > 0.0:
        low = max(low, (location.pushing_angle - WIDEST) / share)
        high = min(high, (location.pushing_angle + WIDEST) / share)
    return max(low, location.turns[0]), min(high, location.turns[1])
