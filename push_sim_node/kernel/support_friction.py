"""Support friction inside the implicit step: weights ``D_i = h q_i / |v_i|`` added to the mass."""

from push_sim_node.kernel.compiled import compiled, friction_weight
from push_sim_node.kernel.layout import INERTIA, MASS, SMOOTHING


@compiled
def augmented_mass(body, supports, c, s, h, v_x, v_y, omega):
    """
    ``M + sum D_i J_i^T J_i``, as (mass, coupling x, coupling y, inertia left by elimination).

    :param body: numbers in the order MASS, INERTIA, ...
    :param supports: rows (x, y from the mass centre [m], capacity, capacity on plain floor [N]),
        shape (k, 4).
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    :param h: step [s].
    :param v_x: velocity of the mass centre that the weights belong to, x [m/s].
    :param v_y: the same, y [m/s].
    :param omega: yaw rate that the weights belong to [rad/s].
    """
    mass, inertia, b_x, b_y = body[MASS], body[INERTIA], 0.0, 0.0
    for i in range(len(supports)):
        s_x, s_y, capacity, _ = supports[i]
        r_x, r_y = c * s_x - s * s_y, s * s_x + c * s_y
        weight = h * friction_weight(capacity, v_x - omega * r_y, v_y + omega * r_x,
                                     body[SMOOTHING])
        mass += weight
        b_x -= weight * r_y
        b_y += weight * r_x
        inertia += weight * (r_x * r_x + r_y * r_y)
    return mass, b_x, b_y, inertia - (b_x * b_x + b_y * b_y) / mass


@compiled
def velocity_of(augmented, p_x, p_y, spin):
    """
    Velocity (v_x, v_y, omega) that a momentum gives.

    :param augmented: what ``augmented_mass`` returned.
    :param p_x: momentum, x [N s].
    :param p_y: the same, y [N s].
    :param spin: angular momentum about the mass centre [N m s].
    """
    mass, b_x, b_y, inertia = augmented
    omega = (spin - (b_x * p_x + b_y * p_y) / mass) / inertia
    return (p_x - b_x * omega) / mass, (p_y - b_y * omega) / mass, omega


@compiled
def friction_forces(body, supports, forces, c, s, at, velocity):
    """
    Write the friction on each support, and return the power that it takes [W].

    :param body: numbers in the order MASS, INERTIA, ...
    :param supports: rows (x, y from the mass centre [m], capacity, capacity on plain floor [N]),
        shape (k, 4).
    :param forces: friction on each support (x, y) [N], flat, shape (2 k,): is written.
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    :param at: (v_x, v_y, omega) that the weights belong to.
    :param velocity: (v_x, v_y, omega) that the weights act on.
    """
    power = 0.0
    for i in range(len(supports)):
        s_x, s_y, capacity, _ = supports[i]
        r_x, r_y = c * s_x - s * s_y, s * s_x + c * s_y
        weight = friction_weight(capacity, at[0] - at[2] * r_y, at[1] + at[2] * r_x,
                                 body[SMOOTHING])
        v_x, v_y = velocity[0] - velocity[2] * r_y, velocity[1] + velocity[2] * r_x
        forces[2 * i], forces[2 * i + 1] = -weight * v_x, -weight * v_y
        power += weight * (v_x * v_x + v_y * v_y)
    return power
