"""State and input of a pushed object, and what the equations need of it, by name."""

from typing import Any, NamedTuple

STATE = ('x', 'y', 'theta', 'omega', 'gamma', 'c_x', 'c_y')
INPUT = ('v_x', 'v_y', 'a_x', 'a_y', 'omega_p')


class ObjectTerms(NamedTuple):
    """What the equations need of an object, as numbers or casadi symbols (object frame, SI)."""

    mass: Any
    inertia: Any
    com_x: Any
    com_y: Any
    supports: tuple

    @classmethod
    def of(cls, obj):
        """
        Take the terms from an object.

        :param obj: the ``PushedObject``.
        """
        supports = tuple((s.x, s.y, q) for s, q in zip(obj.supports, obj.capacities))
        return cls(obj.mass, obj.inertia, *obj.center_of_mass, supports)


class State(NamedTuple):
    """
    Object frame (x, y, theta), yaw rate omega, normal gamma, contact point (c_x, c_y).

    x, y, theta, gamma are in the world; c_x, c_y in the object frame [m, rad, rad/s].
    """

    x: Any
    y: Any
    theta: Any
    omega: Any
    gamma: Any
    c_x: Any
    c_y: Any


class Input(NamedTuple):
    """Velocity (v_x, v_y) imposed at C and its rate (a_x, a_y), world axes; robot yaw rate."""

    v_x: Any
    v_y: Any
    a_x: Any
    a_y: Any
    omega_p: Any
