"""
One step of object and robot: implicit, on velocity level, without springs or penalties.

The geometry is taken at the predicted middle of the step, and the gap carried back from there to
its start; this leaves neither drift nor an error of first order.

Arguments have the same meaning in every function: ``world`` is object and robot, ``state`` and
``body`` are arrays of it, ``h`` is the step [s].
"""

import math
from typing import Any

from push_dynamics.actuation import chord_velocity, track_command, TrackedCommand
from push_dynamics.compiled import compiled
from push_dynamics.contact_law import (
    ContactGeometry, MiddleOfStep, nearest_points, surface_velocity, SurfaceVelocity, Velocity,
)
from push_dynamics.floor import set_local_capacities
from push_dynamics.layout import (
    A_OMEGA, A_X, A_Y, COM_X, COM_Y, CONTACT_LOSS, DISC_RADIUS, IMPACT_LOSS, INERTIA,
    INTEGRATION_LOSS, ITERATIONS, MASS, MODE, NORMAL_FORCE, OMEGA, ROBOT_AT_WALL, ROBOT_OMEGA,
    ROBOT_RADIUS, ROBOT_THETA, ROBOT_V_X, ROBOT_V_Y, ROBOT_X, ROBOT_Y, SEPARATE, STEPS,
    SUPPORT_LOSS, TANGENTIAL_FORCE, THETA, UNSOLVED_STEPS, V_X, V_Y, WORK, World, X, Y,
)
from push_dynamics.load_transfer import solve_with_loads, transfers_loads
from push_dynamics.solver import solve, StepSolution
from push_dynamics.support_friction import write_friction_forces
from push_dynamics.touches import find_touches
from push_dynamics.wall_solver import held_back, held_speed, solve_at_walls, write_touches
from push_dynamics.walls import bounding_radius, is_near_walls, robot_beside_walls
from push_model.geometry import Pose

# Gap that counts as none [m], chosen a little above the rounding errors of world coordinates of
# some metres: a robot that touches without moving must not push the object by them.
ROUNDING = 1e-14
# Residual of the velocity above which a step counts as unsolved [m/s]: chosen, 0.1 mm/s.
UNSOLVED_RESIDUAL = 1e-4
# Velocity [m/s], [rad/s] below which the object rests: chosen, in an hour it moves by less than
# its pose is rounded to. Friction that is viscous near rest would let it slow down for ever.
REST_SPEED = 1e-20
# Fraction of a step by which a duration may exceed a whole number of steps, for its rounding.
STEP_ROUNDING = 1e-9


@compiled
def middle_of_step(state: Any, body: Any, outline: Any, guess: Velocity, robot: Velocity,
                   h: float) -> MiddleOfStep:
    """
    Find the contact in the middle of the step, for a predicted velocity.

    :param guess: predicted velocity of the object.
    :param robot: mean velocity of the robot over the step, world axes.
    """
    x, y = state[X] + 0.5 * h * guess.v_x, state[Y] + 0.5 * h * guess.v_y
    theta = state[THETA] + 0.5 * h * guess.omega
    c, s = math.cos(theta), math.sin(theta)
    pose = Pose(x - c * body[COM_X] + s * body[COM_Y], y - s * body[COM_X] - c * body[COM_Y],
                theta)
    robot_pose = Pose(state[ROBOT_X] + 0.5 * h * robot.v_x, state[ROBOT_Y] + 0.5 * h * robot.v_y,
                      state[ROBOT_THETA] + 0.5 * h * robot.omega)
    nearest = nearest_points(outline, body[DISC_RADIUS], body[ROBOT_RADIUS], pose, robot_pose)
    n_x, n_y, c_x, c_y, gap = nearest
    arm_n = (c_x - x) * n_y - (c_y - y) * n_x
    arm_t = (c_x - x) * n_x + (c_y - y) * n_y
    u_n, u_t = surface_velocity(body[ROBOT_RADIUS], nearest, robot_pose, robot)
    gap -= 0.5 * h * (n_x * guess.v_x + n_y * guess.v_y + arm_n * guess.omega - u_n)
    if abs(gap) < ROUNDING:
        gap = 0.0
    return MiddleOfStep(h, c, s, ContactGeometry(n_x, n_y, arm_n, arm_t),
                        SurfaceVelocity(u_n, u_n - gap / h, u_t))


@compiled
def add_energies(state: Any, body: Any, middle: MiddleOfStep, guess: Velocity,
                 solution: StepSolution, support_loss: float) -> None:
    """
    Add the energies of a step: work of the robot = kinetic energy + losses, exactly.

    An implicit step takes every change of velocity for inelastic, ``(v - v_0)^T M (v - v_0) / 2``.
    What the acceleration of the last step does not predict is a jump, and costs the same with the
    jump in place of the change: an impact. The remainder, of first order, is the step's own. So is
    what the contact takes along the normal, but for the step that closes a gap: there it is the
    impact's.
    """
    surface = middle.surface
    n_x, n_y, arm_n, arm_t = middle.contact
    v_x, v_y, omega = solution.velocity
    impulse = solution.impulse
    work = impulse.normal * surface.normal + impulse.tangential * surface.tangential
    closing = impulse.normal * (surface.normal - (n_x * v_x + n_y * v_y + arm_n * omega))
    sliding = impulse.tangential * (surface.tangential - (n_x * v_y - n_y * v_x + arm_t * omega))
    d_x, d_y, d_omega = v_x - state[V_X], v_y - state[V_Y], omega - state[OMEGA]
    state[WORK] += work
    state[SUPPORT_LOSS] += support_loss
    state[CONTACT_LOSS] += sliding
    j_x, j_y, j_omega = v_x - guess.v_x, v_y - guess.v_y, omega - guess.omega
    jump = 0.5 * (body[MASS] * (j_x * j_x + j_y * j_y) + body[INERTIA] * j_omega * j_omega)
    change = 0.5 * (body[MASS] * (d_x * d_x + d_y * d_y) + body[INERTIA] * d_omega * d_omega)
    impact = min(jump, change)
    if state[MODE] == SEPARATE:
        impact += closing
    state[IMPACT_LOSS] += impact
    state[INTEGRATION_LOSS] += change + closing - impact


@compiled
def move_object(state: Any, solution: StepSolution, h: float) -> None:
    """Write pose, velocity, acceleration and contact of the object at the end of the step."""
    v_x, v_y, omega = solution.velocity
    if max(abs(v_x), abs(v_y), abs(omega)) < REST_SPEED:
        v_x, v_y, omega = 0.0, 0.0, 0.0
    # Across a change of mode the acceleration jumps: it predicts nothing then.
    rate = 1.0 / h if solution.impulse.mode == state[MODE] else 0.0
    state[A_X] = rate * (v_x - state[V_X])
    state[A_Y] = rate * (v_y - state[V_Y])
    state[A_OMEGA] = rate * (omega - state[OMEGA])
    state[V_X] = v_x
    state[V_Y] = v_y
    state[OMEGA] = omega
    state[X] += h * v_x
    state[Y] += h * v_y
    state[THETA] += h * omega
    state[MODE] = solution.impulse.mode
    state[NORMAL_FORCE] = solution.impulse.normal / h
    state[TANGENTIAL_FORCE] = solution.impulse.tangential / h


@compiled
def rests_out_of_reach(state: Any, body: Any, outline: Any, robot: Velocity, h: float) -> bool:
    """
    Tell whether the object rests where the robot cannot touch it within the step.

    :param robot: mean velocity of the robot over the step, world axes.
    """
    for i in range(V_X, A_OMEGA + 1):
        if state[i] != 0.0:
            return False
    if state[MODE] != SEPARATE or transfers_loads(body):
        return False
    nearest = (bounding_radius(body, outline) + body[ROBOT_RADIUS]
               + h * math.sqrt(robot.v_x * robot.v_x + robot.v_y * robot.v_y))
    d_x, d_y = state[ROBOT_X] - state[X], state[ROBOT_Y] - state[Y]
    return d_x * d_x + d_y * d_y > nearest * nearest


@compiled
def move_robot(state: Any, tracked: TrackedCommand, robot: Velocity, h: float) -> None:
    """
    Write pose and velocity of the robot at the end of the step.

    :param robot: mean velocity of the robot over the step, world axes.
    """
    state[ROBOT_X] += h * robot.v_x
    state[ROBOT_Y] += h * robot.v_y
    state[ROBOT_THETA] += h * robot.omega
    state[ROBOT_V_X] = tracked.end_x
    state[ROBOT_V_Y] = tracked.end_y
    state[ROBOT_OMEGA] = tracked.end_omega


@compiled
def stop_robot(state: Any, body: Any, walls: Any, lacking: Velocity, h: float) -> None:
    """
    Take from the robot, at the end of a step, the velocity that walls do not let it have.

    :param walls: ``WallGrid``.
    :param lacking: what it lacks at the contact, as walls hold the object, world axes.
    """
    c, s = math.cos(state[ROBOT_THETA]), math.sin(state[ROBOT_THETA])
    v_x, v_y = state[ROBOT_V_X], state[ROBOT_V_Y]
    driven = Velocity(c * v_x - s * v_y - lacking.v_x, s * v_x + c * v_y - lacking.v_y, 0.0)
    end = robot_beside_walls(walls, body, state[ROBOT_X], state[ROBOT_Y], driven, h)
    state[ROBOT_V_X] = c * end.v_x + s * end.v_y
    state[ROBOT_V_Y] = c * end.v_y - s * end.v_x


@compiled
def push_object(world: World, robot: Velocity, h: float, is_near: bool) -> Velocity:
    """
    Move the object by one step.

    :param robot: mean velocity of the robot over the step, world axes.
    :param is_near: whether walls may touch the object.
    :return: what the robot lacks at the contact, as walls hold the object, world axes.
    """
    state, body, supports, outline = world.state, world.body, world.supports, world.outline
    guess = Velocity(state[V_X] + h * state[A_X], state[V_Y] + h * state[A_Y],
                     state[OMEGA] + h * state[A_OMEGA])
    middle = middle_of_step(state, body, outline, guess, robot, h)
    x, y = state[X] + 0.5 * h * guess.v_x, state[Y] + 0.5 * h * guess.v_y
    count = 0
    if is_near:
        pose = Pose(x - middle.c * body[COM_X] + middle.s * body[COM_Y],
                    y - middle.s * body[COM_X] - middle.c * body[COM_Y],
                    state[THETA] + 0.5 * h * guess.omega)
        count = find_touches(world, pose, guess, h)
    if len(world.floor) > 0:
        set_local_capacities(world.floor, supports, x, y, middle.c, middle.s)
    if transfers_loads(body):
        solution = solve_with_loads(state, body, supports, world.touches[:count], middle, guess)
    elif count == 0:
        solution = solve(state, body, supports, middle, guess)
    else:
        solution = solve_at_walls(state, body, supports, world.touches[:count], middle, guess)
    held = 0.0
    if count > 0:
        held = held_speed(middle, solution)
        middle = held_back(middle, held)
        write_touches(state, world.touches[:count], solution.velocity, h)
    if len(world.forces) > 0:
        power = write_friction_forces(world.forces, body, supports, middle,
                                      solution.weight_velocity, solution.velocity)
        add_energies(state, body, middle, guess, solution, h * power)
    move_object(state, solution, h)
    state[ITERATIONS] += solution.iterations
    if solution.residual > UNSOLVED_RESIDUAL:
        state[UNSOLVED_STEPS] += 1
    return Velocity(held * middle.contact.n_x, held * middle.contact.n_y, 0.0)


@compiled
def step(world: World, h: float) -> None:
    """Move object and robot by one step, in place."""
    state, body, walls = world.state, world.body, world.walls
    tracked = track_command(state[ROBOT_V_X], state[ROBOT_V_Y], state[ROBOT_OMEGA], world.command,
                            world.drive, h)
    u_x, u_y = chord_velocity(state[ROBOT_THETA], tracked.mean_x, tracked.mean_y,
                              tracked.mean_omega, h)
    robot = Velocity(u_x, u_y, tracked.mean_omega)
    state[STEPS] += 1
    is_near = len(walls.rows) > 0 and is_near_walls(state, body, world.outline, walls, robot, h)
    if is_near:
        robot = robot_beside_walls(walls, body, state[ROBOT_X], state[ROBOT_Y], robot, h)
    lacking = Velocity(0.0, 0.0, 0.0)
    # What the step would come to, for less: most of the time a robot drives around.
    if len(world.floor) == 0 and rests_out_of_reach(state, body, world.outline, robot, h):
        for i in range(len(world.forces)):
            world.forces[i] = 0.0
        state[NORMAL_FORCE] = 0.0
        state[TANGENTIAL_FORCE] = 0.0
    else:
        lacking = push_object(world, robot, h, is_near)
    robot = Velocity(robot.v_x - lacking.v_x, robot.v_y - lacking.v_y, robot.omega)
    move_robot(state, tracked, robot, h)
    if robot.v_x != u_x or robot.v_y != u_y:
        state[ROBOT_AT_WALL] = 1.0
        stop_robot(state, body, walls, lacking, h)


@compiled
def step_count(duration: float, longest: float) -> int:
    """
    Count equal steps, none above ``longest`` [s], that end exactly after ``duration`` [s].

    :param duration: above 0 [s].
    :param longest: step [s].
    """
    return max(1, int(math.ceil(duration / longest - STEP_ROUNDING)))


@compiled
def advance(world: World, duration: float, longest: float) -> None:
    """Take equal steps, none above ``longest`` [s], that end exactly after ``duration`` [s]."""
    count = step_count(duration, longest)
    for _ in range(count):
        step(world, duration / count)
