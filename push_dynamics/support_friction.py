"""
Support friction inside the implicit step: weights ``D_i = h q_i / |v_i|`` added to the mass.

q_i is the friction capacity of support i under its present load, v_i its velocity (smoothed near
0, see ``push_model.friction.friction_weight``), h the step. ``M + sum D_i J_i^T J_i`` is
symmetric, its translational block a multiple of the identity: it is inverted by eliminating the
translation.
"""

from typing import Any, NamedTuple

from push_dynamics.compiled import compiled, friction_weight
from push_dynamics.contact_law import MiddleOfStep, Velocity
from push_dynamics.layout import (
    CAPACITY, INERTIA, LOAD_RATIO, MASS, SMOOTHING_SPEED, SUPPORT_X, SUPPORT_Y,
)


class AugmentedMass(NamedTuple):
    """
    Mass matrix with the friction weights, translation eliminated.

    :param mass: m + sum D_i [kg].
    :param coupling_x: moment per velocity along x [kg m].
    :param coupling_y: moment per velocity along y [kg m].
    :param inertia: what is left for the rotation [kg m^2].
    """

    mass: float
    coupling_x: float
    coupling_y: float
    inertia: float


@compiled
def augmented_mass(body: Any, supports: Any, c: float, s: float, h: float,
                   velocity: Velocity) -> AugmentedMass:
    """
    Compute ``M + sum D_i J_i^T J_i``.

    :param body: numbers in the order of ``layout``.
    :param supports: rows in the order of ``layout``, shape (k, 8).
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    :param h: step [s].
    :param velocity: ``Velocity`` that the weights belong to.
    """
    mass, inertia, b_x, b_y = body[MASS], body[INERTIA], 0.0, 0.0
    for i in range(len(supports)):
        s_x, s_y = supports[i][SUPPORT_X], supports[i][SUPPORT_Y]
        capacity = supports[i][CAPACITY] * supports[i][LOAD_RATIO]
        r_x, r_y = c * s_x - s * s_y, s * s_x + c * s_y
        weight = h * friction_weight(capacity, velocity.v_x - velocity.omega * r_y,
                                     velocity.v_y + velocity.omega * r_x, body[SMOOTHING_SPEED])
        mass += weight
        b_x -= weight * r_y
        b_y += weight * r_x
        inertia += weight * (r_x * r_x + r_y * r_y)
    return AugmentedMass(mass, b_x, b_y, inertia - (b_x * b_x + b_y * b_y) / mass)


@compiled
def velocity_of(augmented: AugmentedMass, p_x: float, p_y: float, spin: float) -> Velocity:
    """
    Compute the velocity that a momentum gives.

    :param p_x: momentum, x [N s].
    :param p_y: momentum, y [N s].
    :param spin: angular momentum about the mass centre [N m s].
    """
    mass, b_x, b_y, inertia = augmented
    omega = (spin - (b_x * p_x + b_y * p_y) / mass) / inertia
    return Velocity((p_x - b_x * omega) / mass, (p_y - b_y * omega) / mass, omega)


@compiled
def write_friction_forces(forces: Any, body: Any, supports: Any, middle: MiddleOfStep,
                          weight_velocity: Velocity, velocity: Velocity) -> float:
    """
    Write the friction on each support, and return the power that it dissipates [W].

    :param forces: friction on each support (x, y, x, y, ...) [N], shape (2 k,), is written.
    :param body: values in the order of ``layout``.
    :param supports: rows in the order of ``layout``, shape (k, 8).
    :param weight_velocity: that the friction weights belong to.
    :param velocity: that they act on.
    """
    c, s = middle.c, middle.s
    power = 0.0
    for i in range(len(supports)):
        s_x, s_y = supports[i][SUPPORT_X], supports[i][SUPPORT_Y]
        capacity = supports[i][CAPACITY] * supports[i][LOAD_RATIO]
        r_x, r_y = c * s_x - s * s_y, s * s_x + c * s_y
        weight = friction_weight(capacity, weight_velocity.v_x - weight_velocity.omega * r_y,
                                 weight_velocity.v_y + weight_velocity.omega * r_x,
                                 body[SMOOTHING_SPEED])
        v_x, v_y = velocity.v_x - velocity.omega * r_y, velocity.v_y + velocity.omega * r_x
        forces[2 * i] = -weight * v_x
        forces[2 * i + 1] = -weight * v_y
        power += weight * (v_x * v_x + v_y * v_y)
    return power
