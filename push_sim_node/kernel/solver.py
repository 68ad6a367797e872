"""
The velocity at the end of a step: support friction and contact together.

Support friction is iterated on its weights; for given weights the contact is solved in closed
form: ``(M + sum D_i J_i^T J_i) v = M v_n + J_n^T l_n + J_t^T l_t``.

Arguments are named as in ``step``; ``c`` and ``s`` are cosine and sine of the orientation,
``guess`` the predicted (v_x, v_y, omega), ``contact`` and ``push`` what ``geometry`` returned.
"""

import math

from push_sim_node.kernel.compiled import compiled
from push_sim_node.kernel.contact_law import contact_impulse, violation
from push_sim_node.kernel.layout import (
    ANY, CONTACT_FRICTION, INERTIA, MASS, MODES, OMEGA, V_X, V_Y,
)
from push_sim_node.kernel.support_friction import augmented_mass, velocity_of

TOLERANCE = 1e-6
COARSE = 1e-4
MOST_ITERATIONS = 60


@compiled
def constrained(state, body, augmented, contact, push, only):
    """
    Velocity for given friction weights, with the contact solved.

    :return: velocity (v_x, v_y, omega), impulse (normal, tangential) [N s], mode.
    """
    n_x, n_y, arm_n, arm_t = contact
    v_x, v_y, omega = velocity_of(augmented, body[MASS] * state[V_X], body[MASS] * state[V_Y],
                                  body[INERTIA] * state[OMEGA])
    a_x, a_y, a_omega = velocity_of(augmented, n_x, n_y, arm_n)
    b_x, b_y, b_omega = velocity_of(augmented, -n_y, n_x, arm_t)
    normal, tangential, mode = contact_impulse(
        n_x * a_x + n_y * a_y + arm_n * a_omega, n_x * b_x + n_y * b_y + arm_n * b_omega,
        n_x * b_y - n_y * b_x + arm_t * b_omega,
        push[1] - (n_x * v_x + n_y * v_y + arm_n * omega),
        push[2] - (n_x * v_y - n_y * v_x + arm_t * omega), body[CONTACT_FRICTION],
        only)
    return (v_x + normal * a_x + tangential * b_x, v_y + normal * a_y + tangential * b_y,
            omega + normal * a_omega + tangential * b_omega), (normal, tangential), mode


@compiled
def iterate(state, body, supports, c, s, h, guess, contact, push, only):
    """
    Velocity at the end of the step, by iteration on the friction weights.

    ``only`` is ANY, or the contact mode to hold.

    :return: velocity (v_x, v_y, omega); that of the last friction weights; impulse (normal,
        tangential) [N s]; mode; iterations; last change of the velocity [m/s].
    """
    velocity, at, impulse, mode, count, change = guess, guess, (0.0, 0.0), 0, 0, 1.0
    gyration = body[INERTIA] / body[MASS]
    while count < MOST_ITERATIONS and change > TOLERANCE:
        count += 1
        at = velocity
        augmented = augmented_mass(body, supports, c, s, h, at[0], at[1], at[2])
        velocity, impulse, mode = constrained(state, body, augmented, contact, push, only)
        change = math.sqrt((velocity[0] - at[0]) ** 2 + (velocity[1] - at[1]) ** 2
                           + gyration * (velocity[2] - at[2]) ** 2)
    return velocity, at, impulse, mode, count, change


@compiled
def solve(state, body, supports, c, s, h, guess, contact, push):
    """
    Velocity at the end of the step.

    The iteration may run in circles where a contact can wedge (with much friction both sticking
    and separation satisfy the equations of fixed weights). Then every mode is held in turn, and
    the one that fits best is taken.

    :return: as ``iterate``, the last number being what is left unsolved [m/s].
    """
    best = iterate(state, body, supports, c, s, h, guess, contact, push, ANY)
    if best[5] <= TOLERANCE:
        return best
    n_x, n_y, arm_n, arm_t = contact
    count = best[4]
    for mode in range(len(MODES)):
        velocity, at, impulse, _, more, change = iterate(state, body, supports, c, s, h, guess,
                                                         contact, push, mode)
        v_x, v_y, omega = velocity
        change += violation(mode, push[1] - (n_x * v_x + n_y * v_y + arm_n * omega),
                            n_x * v_y - n_y * v_x + arm_t * omega - push[2], impulse[0],
                            impulse[1], body[CONTACT_FRICTION], body[MASS])
        count += more
        if change < best[5]:
            best = velocity, at, impulse, mode, count, change
    return best[0], best[1], best[2], best[3], count, best[5]
