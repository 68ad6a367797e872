"""
Velocity at the end of a step in which walls touch the object: all contacts together.

The equations are those of ``solver`` with the impulses of walls added. For given friction weights
each contact is solved in closed form while the others keep their impulses, in turn, until none
changes (block Gauss-Seidel on Coulomb cones: Jean, The non-smooth contact dynamics method, 1999).

Walls do not move, and a robot of given velocity would push with any force: what it presses onto
walls holds it back at ``MAX_PUSH_FORCE``.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_dynamics.contact_law import (
    contact_impulse, ContactEquations, ContactGeometry, ContactImpulse, MiddleOfStep,
    SurfaceVelocity, Velocity,
)
from push_dynamics.layout import (
    ANY_MODE, CONTACT_FRICTION, CONTACT_LOSS, IMPACT_LOSS, INERTIA, MASS, MAX_PUSH_FORCE, OMEGA,
    SEPARATE, SLIDE_LEFT, SLIDE_RIGHT, STICK, TOUCH_ARM_N, TOUCH_ARM_T, TOUCH_GAP, TOUCH_N_X,
    TOUCH_N_Y, TOUCH_NORMAL, TOUCH_REQUIRED, TOUCH_TANGENTIAL, V_X, V_Y, WALL_DEPTH, WALL_FORCE_X,
    WALL_FORCE_Y, WALL_FRICTION, WALL_TOUCHES,
)
from push_dynamics.solver import CONVERGED, creep_speed, MAX_ITERATIONS, solve, StepSolution
from push_dynamics.support_friction import augmented_mass, AugmentedMass, velocity_of

# Rounds over all contacts for one set of friction weights; chosen: two or three do for a box flat
# at a wall, the rest is for what wedges.
MAX_ROUNDS = 30
# Change of velocity below which such rounds end [m/s]; chosen: a tenth of what ends the iteration.
ROUND_CONVERGED = 0.1 * CONVERGED


@compiled
def add_impulse(augmented: AugmentedMass, contact: ContactGeometry, velocity: Velocity,
                normal: float, tangential: float) -> Velocity:
    """
    Add what an impulse gives to a velocity.

    :param normal: along n [N s].
    :param tangential: along t [N s].
    """
    n_x, n_y, arm_n, arm_t = contact
    change = velocity_of(augmented, normal * n_x - tangential * n_y,
                         normal * n_y + tangential * n_x, normal * arm_n + tangential * arm_t)
    return Velocity(velocity.v_x + change.v_x, velocity.v_y + change.v_y,
                    velocity.omega + change.omega)


@compiled
def equations_of(augmented: AugmentedMass, contact: ContactGeometry, velocity: Velocity,
                 required: float, tangential: float) -> ContactEquations:
    """
    Set up the equations of one contact.

    :param velocity: of the object without the impulse of this contact.
    :param required: normal velocity of the contact point at least [m/s].
    :param tangential: its tangential velocity where it sticks [m/s].
    """
    n_x, n_y, arm_n, arm_t = contact
    a = velocity_of(augmented, n_x, n_y, arm_n)
    b = velocity_of(augmented, -n_y, n_x, arm_t)
    return ContactEquations(
        n_x * a.v_x + n_y * a.v_y + arm_n * a.omega, n_x * b.v_x + n_y * b.v_y + arm_n * b.omega,
        n_x * b.v_y - n_y * b.v_x + arm_t * b.omega,
        required - (n_x * velocity.v_x + n_y * velocity.v_y + arm_n * velocity.omega),
        tangential - (n_x * velocity.v_y - n_y * velocity.v_x + arm_t * velocity.omega))


@compiled
def limited_impulse(equations: ContactEquations, impulse: ContactImpulse, friction: float,
                    limit: float) -> ContactImpulse:
    """
    Limit the normal impulse; the tangential one is then what sticks within its cone.

    :param friction: Coulomb coefficient.
    :param limit: greatest normal impulse [N s].
    """
    if impulse.normal <= limit:
        return impulse
    tangential = (equations.need_t - equations.w_nt * limit) / equations.w_tt
    if tangential > friction * limit:
        return ContactImpulse(limit, friction * limit, SLIDE_LEFT)
    if tangential < -friction * limit:
        return ContactImpulse(limit, -friction * limit, SLIDE_RIGHT)
    return ContactImpulse(limit, tangential, STICK)


@compiled
def touch_geometry(touch: Any) -> ContactGeometry:
    """
    Read the geometry of a touch.

    :param touch: a row in the order of ``layout``.
    """
    return ContactGeometry(touch[TOUCH_N_X], touch[TOUCH_N_Y], touch[TOUCH_ARM_N],
                           touch[TOUCH_ARM_T])


@compiled
def wall_impulse(touches: Any) -> tuple[float, float]:
    """
    Sum up the impulses of walls, world axes (x, y) [N s].

    :param touches: rows in the order of ``layout``.
    """
    x, y = 0.0, 0.0
    for i in range(len(touches)):
        touch = touches[i]
        normal, tangential = touch[TOUCH_NORMAL], touch[TOUCH_TANGENTIAL]
        x += normal * touch[TOUCH_N_X] - tangential * touch[TOUCH_N_Y]
        y += normal * touch[TOUCH_N_Y] + tangential * touch[TOUCH_N_X]
    return x, y


@compiled
def solve_touch(body: Any, augmented: AugmentedMass, touch: Any, velocity: Velocity) -> Velocity:
    """
    Solve for the impulse of one wall, while the other contacts keep theirs.

    :param touch: a row in the order of ``layout``: its impulses are written.
    :param velocity: of the object with all impulses.
    :return: the same with the new impulse.
    """
    contact = touch_geometry(touch)
    velocity = add_impulse(augmented, contact, velocity, -touch[TOUCH_NORMAL],
                           -touch[TOUCH_TANGENTIAL])
    impulse = contact_impulse(
        equations_of(augmented, contact, velocity, touch[TOUCH_REQUIRED], 0.0),
        body[WALL_FRICTION], ANY_MODE)
    touch[TOUCH_NORMAL] = impulse.normal
    touch[TOUCH_TANGENTIAL] = impulse.tangential
    return add_impulse(augmented, contact, velocity, impulse.normal, impulse.tangential)


@compiled
def solve_robot(body: Any, augmented: AugmentedMass, middle: MiddleOfStep, velocity: Velocity,
                impulse: ContactImpulse) -> tuple[Velocity, ContactImpulse]:
    """
    Solve for the impulse of the robot, while walls keep theirs.

    :param velocity: of the object with all impulses.
    :param impulse: of the robot so far.
    :return: velocity and impulse anew.
    """
    contact, surface = middle.contact, middle.surface
    velocity = add_impulse(augmented, contact, velocity, -impulse.normal, -impulse.tangential)
    equations = equations_of(augmented, contact, velocity, surface.required, surface.tangential)
    friction = body[CONTACT_FRICTION]
    impulse = limited_impulse(
        equations, contact_impulse(equations, friction, ANY_MODE, creep_speed(body, surface)),
        friction, middle.h * body[MAX_PUSH_FORCE])
    return add_impulse(augmented, contact, velocity, impulse.normal,
                       impulse.tangential), impulse


@compiled
def speed_change(body: Any, before: Velocity, after: Velocity) -> float:
    """Measure a change of velocity, rotation by the radius of gyration [m/s]."""
    return math.sqrt((after.v_x - before.v_x) ** 2 + (after.v_y - before.v_y) ** 2
                     + body[INERTIA] / body[MASS] * (after.omega - before.omega) ** 2)


@compiled
def solve_contacts(state: Any, body: Any, augmented: AugmentedMass, touches: Any,
                   middle: MiddleOfStep,
                   impulse: ContactImpulse) -> tuple[Velocity, ContactImpulse, float]:
    """
    Solve for all impulses with given friction weights.

    :param touches: rows in the order of ``layout``: impulses are read and written.
    :param impulse: of the robot, to begin with.
    :return: velocity; impulse of the robot; changes of the velocity in the last round [m/s].
    """
    velocity = velocity_of(augmented, body[MASS] * state[V_X], body[MASS] * state[V_Y],
                           body[INERTIA] * state[OMEGA])
    velocity = add_impulse(augmented, middle.contact, velocity, impulse.normal,
                           impulse.tangential)
    for i in range(len(touches)):
        touch = touches[i]
        velocity = add_impulse(augmented, touch_geometry(touch), velocity, touch[TOUCH_NORMAL],
                               touch[TOUCH_TANGENTIAL])
    change = math.inf
    for _ in range(MAX_ROUNDS):
        before = velocity
        velocity, impulse = solve_robot(body, augmented, middle, velocity, impulse)
        change = speed_change(body, before, velocity)
        # One by one: where the object is wedged, impulses grow while their sum does not.
        for i in range(len(touches)):
            before = velocity
            velocity = solve_touch(body, augmented, touches[i], velocity)
            change += speed_change(body, before, velocity)
        if change < ROUND_CONVERGED:
            break
    return velocity, impulse, change


@compiled
def solve_at_walls(state: Any, body: Any, supports: Any, touches: Any, middle: MiddleOfStep,
                   guess: Velocity) -> StepSolution:
    """
    Iterate on the friction weights, with all contacts solved; arguments as in ``solve_step``.

    :return: ``StepSolution``, the residual being the last changes of the velocity.
    """
    velocity, weight_velocity = guess, guess
    impulse = ContactImpulse(0.0, 0.0, SEPARATE)
    count, change = 0, 1.0
    while count < MAX_ITERATIONS and change > CONVERGED:
        count += 1
        weight_velocity = velocity
        augmented = augmented_mass(body, supports, middle.c, middle.s, middle.h, weight_velocity)
        velocity, impulse, unsolved = solve_contacts(state, body, augmented, touches, middle,
                                                     impulse)
        change = unsolved + speed_change(body, weight_velocity, velocity)
    return StepSolution(velocity, weight_velocity, impulse, count, change)


@compiled
def solve_step(state: Any, body: Any, supports: Any, touches: Any, middle: MiddleOfStep,
               guess: Velocity) -> StepSolution:
    """
    Solve for the velocity at the end of the step.

    :param touches: of object and walls, rows in the order of ``layout``: their impulses are
        written. Without any this is ``solver.solve``.
    :return: ``StepSolution``.
    """
    if len(touches) == 0:
        return solve(state, body, supports, middle, guess)
    return solve_at_walls(state, body, supports, touches, middle, guess)


@compiled
def held_speed(middle: MiddleOfStep, solution: StepSolution) -> float:
    """Compute by what speed walls hold the robot back along the contact normal [m/s]."""
    n_x, n_y, arm_n, _ = middle.contact
    v_x, v_y, omega = solution.velocity
    lacking = middle.surface.required - (n_x * v_x + n_y * v_y + arm_n * omega)
    return lacking if lacking > CONVERGED else 0.0


@compiled
def held_back(middle: MiddleOfStep, held: float) -> MiddleOfStep:
    """
    Return the contact with a robot that is held back.

    :param held: what its surface lacks along the normal [m/s].
    """
    surface = middle.surface
    return MiddleOfStep(
        middle.h, middle.c, middle.s, middle.contact,
        SurfaceVelocity(surface.normal - held, surface.required, surface.tangential))


@compiled
def write_touches(state: Any, touches: Any, velocity: Velocity, h: float) -> None:
    """
    Write force, count and depth of touches, and add the energies that walls take.

    :param touches: rows in the order of ``layout``.
    :param velocity: of the object at the end of the step.
    """
    impulse_x, impulse_y = wall_impulse(touches)
    state[WALL_FORCE_X] = impulse_x / h
    state[WALL_FORCE_Y] = impulse_y / h
    for i in range(len(touches)):
        touch = touches[i]
        n_x, n_y, arm_n, arm_t = touch_geometry(touch)
        normal = n_x * velocity.v_x + n_y * velocity.v_y + arm_n * velocity.omega
        slip = n_x * velocity.v_y - n_y * velocity.v_x + arm_t * velocity.omega
        state[IMPACT_LOSS] -= touch[TOUCH_NORMAL] * normal
        state[CONTACT_LOSS] -= touch[TOUCH_TANGENTIAL] * slip
        state[WALL_DEPTH] = max(state[WALL_DEPTH], -touch[TOUCH_GAP])
        if touch[TOUCH_NORMAL] > 0.0:
            state[WALL_TOUCHES] += 1.0
