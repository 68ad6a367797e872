"""
Loads of the supports in the compiled step, shifted by a push above the floor.

The law is that of ``push_model.friction``: the centre of pressure p, from the mass centre,
makes the load of support i ``N_i0 + m g eta_i . p``. Once a support would pull it lifts: between
the p where the first one lifts and the p on the edge of the hull, where two supports carry all,
loads are interpolated. Both ends balance, hence all between them; up to four supports leave no
other choice. Beyond that edge the object would tip; it is held flat.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled, load_moment
from push_dynamics.contact_law import ContactImpulse, MiddleOfStep, Velocity
from push_dynamics.layout import (
    CENTER_OF_MASS_HEIGHT, CONTACT_HEIGHT, GRADIENT_X, GRADIENT_Y, INERTIA, LOAD_FRACTION,
    LOAD_RATIO, MASS, PRESSURE_X, PRESSURE_Y, SUPPORT_X, SUPPORT_Y, V_X, V_Y,
)
from push_dynamics.solver import CONVERGED, StepSolution
from push_dynamics.wall_solver import solve_step, wall_impulse
from push_model.parameters import GRAVITY

# Share of an edge by which a ray through a support may miss both edges that meet there: far above
# rounding, and far below any load that matters.
CORNER_ROUNDING = 1e-9
# Most iterations on the loads: chosen, as many as on the friction weights. A push takes one or
# two.
MAX_ITERATIONS = 60


class Pressure(NamedTuple):
    """Centre of pressure relative to the mass centre, world axes (x, y) [m]."""

    x: float
    y: float


class TippingEdge(NamedTuple):
    """
    The two supports about which a shift of the centre of pressure tips the object.

    :param first: number of the one.
    :param second: number of the other.
    :param distance: of the edge along the shift, over the length of the shift.
    :param share: of the weight on the second, where the centre of pressure is on the edge.
    """

    first: int
    second: int
    distance: float
    share: float


@compiled
def transfers_loads(body: Any) -> bool:
    """Say whether contact or mass centre are above the floor."""
    return body[CONTACT_HEIGHT] > 0.0 or body[CENTER_OF_MASS_HEIGHT] > 0.0


@compiled
def pressure_of(state: Any, body: Any, touches: Any, middle: MiddleOfStep, velocity: Velocity,
                impulse: ContactImpulse) -> Pressure:
    """
    Find the centre of pressure over a step; walls act at the height of the robot's contact.

    :param state: numbers in the order of ``layout``, at the start of the step.
    :param body: numbers in the order of ``layout``.
    :param touches: of object and walls, rows in the order of ``layout``.
    :param velocity: ``Velocity`` at the end of the step.
    """
    h, contact = middle.h, middle.contact
    contact_height, height = body[CONTACT_HEIGHT], body[CENTER_OF_MASS_HEIGHT]
    mass, weight = body[MASS], h * body[MASS] * GRAVITY
    impulse_x = impulse.normal * contact.n_x - impulse.tangential * contact.n_y
    impulse_y = impulse.normal * contact.n_y + impulse.tangential * contact.n_x
    if len(touches) > 0:
        wall_x, wall_y = wall_impulse(touches)
        impulse_x, impulse_y = impulse_x + wall_x, impulse_y + wall_y
    change_x, change_y = mass * (velocity.v_x - state[V_X]), mass * (velocity.v_y - state[V_Y])
    return Pressure(load_moment(contact_height, height, impulse_x, change_x) / weight,
                    load_moment(contact_height, height, impulse_y, change_y) / weight)


@compiled
def tipping_edge(supports: Any, p_x: float, p_y: float) -> TippingEdge:
    """
    Find where a shift of the centre of pressure leaves the hull of the carrying supports.

    Of all chords between two supports, the ray from the mass centre crosses the edge last.

    :param supports: rows in the order of ``layout``.
    :param p_x: shift, object axes, x [m].
    :param p_y: shift, object axes, y [m].
    """
    edge = TippingEdge(0, 0, 0.0, 0.0)
    for i in range(len(supports)):
        if supports[i][LOAD_FRACTION] <= 0.0:
            continue
        a_x, a_y = supports[i][SUPPORT_X], supports[i][SUPPORT_Y]
        for j in range(len(supports)):
            d_x, d_y = supports[j][SUPPORT_X] - a_x, supports[j][SUPPORT_Y] - a_y
            # Edges with the mass centre to their left, as seen from i to j, cross outwards.
            outwards = p_x * d_y - p_y * d_x
            if outwards <= 0.0 or supports[j][LOAD_FRACTION] <= 0.0:
                continue
            distance = (a_x * d_y - a_y * d_x) / outwards
            share = (a_x * p_y - a_y * p_x) / outwards
            if distance > edge.distance and abs(share - 0.5) <= 0.5 + CORNER_ROUNDING:
                edge = TippingEdge(i, j, distance, min(1.0, max(0.0, share)))
    return edge


@compiled
def shift_loads(supports: Any, c: float, s: float, pressure: Pressure) -> None:
    """
    Write the ratios of the loads to those at rest.

    :param supports: rows in the order of ``layout``: LOAD_RATIO is written.
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    :param pressure: centre of pressure.
    """
    p_x, p_y = c * pressure.x + s * pressure.y, c * pressure.y - s * pressure.x
    # Part of the shift at which the first support lifts.
    lift = math.inf
    for i in range(len(supports)):
        change = supports[i][GRADIENT_X] * p_x + supports[i][GRADIENT_Y] * p_y
        if change < 0.0:
            lift = min(lift, -supports[i][LOAD_FRACTION] / change)
    first, second, share, beyond = 0, 0, 0.0, 0.0
    if lift < 1.0:
        edge = tipping_edge(supports, p_x, p_y)
        first, second, share = edge.first, edge.second, edge.share
        beyond = 1.0 if edge.distance <= lift else min(1.0, (1.0 - lift) / (edge.distance - lift))
    carried_part = min(lift, 1.0)
    for i in range(len(supports)):
        fraction = supports[i][LOAD_FRACTION]
        if fraction > 0.0:
            change = supports[i][GRADIENT_X] * p_x + supports[i][GRADIENT_Y] * p_y
            load = (1.0 - beyond) * (fraction + carried_part * change)
            if i == first:
                load += beyond * (1.0 - share)
            if i == second:
                load += beyond * share
            supports[i][LOAD_RATIO] = max(0.0, load) / fraction


@compiled
def solve_with_loads(state: Any, body: Any, supports: Any, touches: Any, middle: MiddleOfStep,
                     guess: Velocity) -> StepSolution:
    """
    Solve for the velocity at the end of the step, with the loads that belong to it.

    Arguments are as in ``wall_solver.solve_step``. It starts with the loads of the last step, and
    leaves those of the solution in ``supports``.

    :return: ``StepSolution``; its residual includes what the last change of the loads may change
        the velocity by.
    """
    pressure = Pressure(state[PRESSURE_X], state[PRESSURE_Y])
    shift_loads(supports, middle.c, middle.s, pressure)
    solution = solve_step(state, body, supports, touches, middle, guess)
    following = pressure_of(state, body, touches, middle, solution.velocity, solution.impulse)
    count = 1
    # Velocity by shift: the moment of the weight, over a step, over the radius of gyration.
    rate = middle.h * GRAVITY * math.sqrt(body[MASS] / body[INERTIA])
    change = rate * math.hypot(following.x - pressure.x, following.y - pressure.y)
    while change > CONVERGED and count < MAX_ITERATIONS:
        count += 1
        pressure = following
        shift_loads(supports, middle.c, middle.s, pressure)
        again = solve_step(state, body, supports, touches, middle, solution.velocity)
        solution = StepSolution(again.velocity, again.weight_velocity, again.impulse,
                                solution.iterations + again.iterations, again.residual)
        following = pressure_of(state, body, touches, middle, solution.velocity, solution.impulse)
        change = rate * math.hypot(following.x - pressure.x, following.y - pressure.y)
    state[PRESSURE_X] = following.x
    state[PRESSURE_Y] = following.y
    return StepSolution(solution.velocity, solution.weight_velocity, solution.impulse,
                        solution.iterations, solution.residual + change)
