"""
Velocity of the object at the end of a step: support friction and contact together.

The implicit step is ``(M + sum D_i J_i^T J_i) v = M v_0 + J_n^T l_n + J_t^T l_t``: M the mass
matrix, v = (v_x, v_y, omega) the velocity of the mass centre at the end of the step and v_0 at its
start, J_i, J_n and J_t the rows that map v to the velocity of support i and to the normal and
tangential velocity of the contact point, l_n and l_t the contact impulses. The friction weights
``D_i = h q_i / |v_i|`` depend on v: they are iterated, and for given weights the contact is solved
in closed form. Where a push shifts the loads, ``load_transfer`` iterates on them around this.

Arguments are named as in ``step``; ``guess`` is the predicted v, ``middle`` the contact in the
middle of the step.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled
from push_dynamics.contact_law import (
    contact_impulse, ContactEquations, ContactImpulse, law_violation, MiddleOfStep,
    SurfaceVelocity, Velocity,
)
from push_dynamics.layout import (
    ANY_MODE, CONTACT_CREEP, CONTACT_FRICTION, INERTIA, MASS, MODE_COUNT, OMEGA, SEPARATE, V_X,
    V_Y,
)
from push_dynamics.support_friction import augmented_mass, AugmentedMass, velocity_of

# Change of the velocity [m/s] at which the iteration ends: chosen, a thousandth of a millimetre
# per second, far below what a pose sensor sees.
CONVERGED = 1e-6
# Most iterations with one choice of contact mode: 99 % of the steps of violent random pushes
# (those of test_plant_random) need six at most; one that has not ended by then runs in a circle.
MAX_ITERATIONS = 60


class StepSolution(NamedTuple):
    """
    Velocity at the end of a step, and the contact impulse that leads to it.

    :param velocity: (v_x, v_y, omega) of the mass centre, world axes.
    :param weight_velocity: the velocity that the friction weights of the last iteration belong to.
    :param impulse: of the robot on the object.
    :param iterations: number of them.
    :param residual: what is left unsolved, as a velocity [m/s].
    """

    velocity: Velocity
    weight_velocity: Velocity
    impulse: ContactImpulse
    iterations: int
    residual: float


@compiled
def creep_speed(body: Any, surface: SurfaceVelocity) -> float:
    """Compute the slip of a sticking contact at its friction limit [m/s]."""
    return body[CONTACT_CREEP] * math.sqrt(surface.normal ** 2 + surface.tangential ** 2)


@compiled
def constrained_velocity(state: Any, body: Any, augmented: AugmentedMass, middle: MiddleOfStep,
                         mode: int) -> tuple[Velocity, ContactImpulse]:
    """
    Compute the velocity for given friction weights, with the contact solved.

    :return: velocity; ``ContactImpulse``.
    """
    surface = middle.surface
    n_x, n_y, arm_n, arm_t = middle.contact
    v_x, v_y, omega = velocity_of(augmented, body[MASS] * state[V_X], body[MASS] * state[V_Y],
                                  body[INERTIA] * state[OMEGA])
    # Velocity per normal and per tangential impulse.
    a_x, a_y, a_omega = velocity_of(augmented, n_x, n_y, arm_n)
    b_x, b_y, b_omega = velocity_of(augmented, -n_y, n_x, arm_t)
    equations = ContactEquations(
        n_x * a_x + n_y * a_y + arm_n * a_omega, n_x * b_x + n_y * b_y + arm_n * b_omega,
        n_x * b_y - n_y * b_x + arm_t * b_omega,
        surface.required - (n_x * v_x + n_y * v_y + arm_n * omega),
        surface.tangential - (n_x * v_y - n_y * v_x + arm_t * omega))
    impulse = contact_impulse(equations, body[CONTACT_FRICTION], mode, creep_speed(body, surface))
    normal, tangential = impulse.normal, impulse.tangential
    velocity = Velocity(v_x + normal * a_x + tangential * b_x,
                        v_y + normal * a_y + tangential * b_y,
                        omega + normal * a_omega + tangential * b_omega)
    return velocity, impulse


@compiled
def iterate(state: Any, body: Any, supports: Any, middle: MiddleOfStep, guess: Velocity,
            mode: int) -> StepSolution:
    """
    Iterate on the friction weights.

    :param mode: ANY_MODE, or the contact mode to impose.
    :return: ``StepSolution``, the residual being the last change of the velocity.
    """
    velocity, weight_velocity = guess, guess
    impulse = ContactImpulse(0.0, 0.0, SEPARATE)
    count, change = 0, 1.0
    gyration_squared = body[INERTIA] / body[MASS]
    while count < MAX_ITERATIONS and change > CONVERGED:
        count += 1
        weight_velocity = velocity
        augmented = augmented_mass(body, supports, middle.c, middle.s, middle.h, weight_velocity)
        velocity, impulse = constrained_velocity(state, body, augmented, middle, mode)
        change = math.sqrt((velocity.v_x - weight_velocity.v_x) ** 2
                           + (velocity.v_y - weight_velocity.v_y) ** 2
                           + gyration_squared * (velocity.omega - weight_velocity.omega) ** 2)
    return StepSolution(velocity, weight_velocity, impulse, count, change)


@compiled
def solve(state: Any, body: Any, supports: Any, middle: MiddleOfStep,
          guess: Velocity) -> StepSolution:
    """
    Solve for the velocity at the end of the step.

    The iteration may run in circles where a contact can wedge (with much friction both sticking
    and separation satisfy the equations of fixed weights). Then every mode is imposed in turn,
    and the one that fits best is taken.

    :return: ``StepSolution``; after imposed modes the residual includes the violation of the
        contact law.
    """
    surface = middle.surface
    n_x, n_y, arm_n, arm_t = middle.contact
    count = 0
    best = StepSolution(guess, guess, ContactImpulse(0.0, 0.0, SEPARATE), 0, math.inf)
    for mode in range(ANY_MODE, MODE_COUNT):
        solution = iterate(state, body, supports, middle, guess, mode)
        residual = solution.residual
        if mode == ANY_MODE and residual <= CONVERGED:
            return solution
        count += solution.iterations
        if mode != ANY_MODE:
            v_x, v_y, omega = solution.velocity
            missing = surface.required - (n_x * v_x + n_y * v_y + arm_n * omega)
            slip = n_x * v_y - n_y * v_x + arm_t * omega - surface.tangential
            residual += law_violation(solution.impulse, missing, slip, body[CONTACT_FRICTION],
                                      body[MASS], creep_speed(body, surface))
        if mode == ANY_MODE or residual < best.residual:
            best = StepSolution(solution.velocity, solution.weight_velocity, solution.impulse,
                                count, residual)
    return StepSolution(best.velocity, best.weight_velocity, best.impulse, count, best.residual)
