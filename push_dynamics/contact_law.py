"""
Contact of a disc robot with an object: where it is, and its impulse in closed form.

The law is unilateral and inelastic, with Coulomb friction (Signorini's condition on velocities).
The unit normal n points from the robot to the object, t is n rotated by +90 degrees.

A contact that sticks may creep: its surfaces then slip in proportion to the tangential force and
to the speed V of the robot's surface, ``slip = kappa V l_t / (mu_c l_n)``, as in the linear theory
of rolling contact (Kalker 1967). At the friction limit the slip is ``kappa V``, where sliding
begins; with kappa = 0 the law is that of Coulomb.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import closest_on_polygon, compiled, lowest_vertex
from push_dynamics.layout import ANY_MODE, SEPARATE, SLIDE_LEFT, SLIDE_RIGHT, STICK
from push_model.geometry import Pose


class Velocity(NamedTuple):
    """Velocity (v_x, v_y) [m/s], world axes, and yaw rate omega [rad/s]."""

    v_x: float
    v_y: float
    omega: float


class ContactPoint(NamedTuple):
    """
    Nearest points of robot and object.

    :param n_x: contact normal, x.
    :param n_y: contact normal, y.
    :param x: nearest point of the object in the world, x [m].
    :param y: the same, y [m].
    :param gap: distance of the robot from it [m], negative where they overlap.
    """

    n_x: float
    n_y: float
    x: float
    y: float
    gap: float


class ContactGeometry(NamedTuple):
    """
    Contact as the mass centre of the object sees it: J_n = (n, arm_n), J_t = (t, arm_t).

    :param n_x: contact normal, x.
    :param n_y: contact normal, y.
    :param arm_n: moment arm of n about the mass centre [m].
    :param arm_t: moment arm of t about the mass centre [m].
    """

    n_x: float
    n_y: float
    arm_n: float
    arm_t: float


class SurfaceVelocity(NamedTuple):
    """
    Velocity of the robot's surface at the contact, and what it demands of the object.

    :param normal: along n [m/s].
    :param required: normal velocity that the object's contact point needs at least, so that the
        gap is not negative at the end of the step [m/s].
    :param tangential: along t [m/s].
    """

    normal: float
    required: float
    tangential: float


class MiddleOfStep(NamedTuple):
    """
    Contact in the predicted middle of a step.

    :param h: length of the step [s].
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    :param contact: ``ContactGeometry``.
    :param surface: ``SurfaceVelocity``.
    """

    h: float
    c: float
    s: float
    contact: ContactGeometry
    surface: SurfaceVelocity


class ContactEquations(NamedTuple):
    """
    Equations of an impulse l at a contact: ``W l = need`` where it sticks.

    ``W = ((w_nn, w_nt), (w_nt, w_tt))`` is positive definite.

    :param w_nn: normal velocity per normal impulse [1/kg].
    :param w_nt: normal velocity per tangential impulse [1/kg].
    :param w_tt: tangential velocity per tangential impulse [1/kg].
    :param need_n: normal velocity that is missing without an impulse [m/s].
    :param need_t: tangential velocity that is missing for sticking [m/s].
    """

    w_nn: float
    w_nt: float
    w_tt: float
    need_n: float
    need_t: float


class ContactImpulse(NamedTuple):
    """
    Impulse of the robot on the object.

    :param normal: along n [N s].
    :param tangential: along t [N s].
    :param mode: SEPARATE, STICK, SLIDE_LEFT or SLIDE_RIGHT.
    """

    normal: float
    tangential: float
    mode: int


@compiled
def nearest_points(outline: Any, disc_radius: float, robot_radius: float, pose: Pose,
                   robot: Pose) -> ContactPoint:
    """
    Find the nearest points of object and robot.

    :param outline: vertices in the object frame, shape (k, 2) [m]; ignored for a disc.
    :param disc_radius: radius of a disc about the object frame, 0 for a polygon [m].
    :param robot_radius: R_p [m]; infinite for a flat pusher.
    :param pose: of the object frame in the world.
    :param robot: pose of the robot; only a flat pusher needs its heading.
    """
    x, y, theta = pose
    d_x, d_y = robot.x - x, robot.y - y
    if math.isinf(robot_radius):
        n_x, n_y = math.cos(robot.theta), math.sin(robot.theta)
        c_x, c_y = -disc_radius * n_x, -disc_radius * n_y
        if disc_radius == 0.0:
            c, s = math.cos(theta), math.sin(theta)
            i = lowest_vertex(outline, c * n_x + s * n_y, c * n_y - s * n_x)
            c_x = c * outline[i][0] - s * outline[i][1]
            c_y = s * outline[i][0] + c * outline[i][1]
        return ContactPoint(n_x, n_y, x + c_x, y + c_y, n_x * (c_x - d_x) + n_y * (c_y - d_y))
    if disc_radius > 0.0:
        distance = math.sqrt(d_x * d_x + d_y * d_y)
        n_x, n_y = -d_x / distance, -d_y / distance
        return ContactPoint(n_x, n_y, x - disc_radius * n_x, y - disc_radius * n_y,
                            distance - disc_radius - robot_radius)
    c, s = math.cos(theta), math.sin(theta)
    # All of these are in the object frame.
    c_x, c_y, n_x, n_y, distance, _, _ = closest_on_polygon(outline, c * d_x + s * d_y,
                                                            c * d_y - s * d_x)
    return ContactPoint(c * n_x - s * n_y, s * n_x + c * n_y, x + c * c_x - s * c_y,
                        y + s * c_x + c * c_y, distance - robot_radius)


@compiled
def surface_velocity(robot_radius: float, nearest: ContactPoint, robot: Pose,
                     velocity: Velocity) -> tuple[float, float]:
    """
    Compute the velocity of the robot's surface at the contact, along n and t [m/s].

    :param robot_radius: R_p [m]; infinite for a flat pusher.
    :param robot: pose of the robot; only a flat pusher needs its position.
    :param velocity: of the robot's position, world axes.
    """
    n_x, n_y = nearest.n_x, nearest.n_y
    v_x, v_y, omega = velocity
    normal, tangential = n_x * v_x + n_y * v_y, n_x * v_y - n_y * v_x
    if math.isinf(robot_radius):
        arm_x, arm_y = nearest.x - robot.x, nearest.y - robot.y
        return normal - omega * (n_x * arm_y - n_y * arm_x), tangential
    return normal, tangential + omega * robot_radius


@compiled
def _sliding_impulse(equations: ContactEquations, friction_coefficient: float,
                     mode: int) -> ContactImpulse:
    """Compute the impulse on one edge of the cone; arguments as in ``contact_impulse``."""
    slope = friction_coefficient if mode == SLIDE_LEFT else -friction_coefficient
    divisor = equations.w_nn + slope * equations.w_nt
    normal = equations.need_n / divisor if divisor > 0.0 else 0.0
    return ContactImpulse(normal, slope * normal, mode)


@compiled
def _creeping_impulse(equations: ContactEquations, friction_coefficient: float, mode: int,
                      creep_speed: float) -> ContactImpulse:
    """
    Compute the impulse of a contact that creeps; arguments as in ``contact_impulse``.

    With ``l_t = r l_n`` and ``k = kappa V / mu_c`` sticking solves
    ``w_nn l_n + w_nt l_t = need_n``, ``w_nt l_n + w_tt l_t = need_t - k r``. Without l_n this is
    ``a r^2 + b r + c = 0``. The slip that is left falls as r grows while ``w_nn + w_nt r > 0``,
    and of the two roots one is in that range: ``-2 c / (b + sqrt(b^2 - 4 a c))``.
    """
    w_nn, w_nt, w_tt, need_n, need_t = equations
    k = creep_speed / friction_coefficient
    a = k * w_nt
    b = k * w_nn + need_n * w_tt - need_t * w_nt
    c = need_n * w_nt - need_t * w_nn
    divisor = b + math.sqrt(max(0.0, b * b - 4.0 * a * c))
    in_cone = abs(2.0 * c) <= friction_coefficient * divisor
    if divisor > 0.0 and (mode == STICK or (mode == ANY_MODE and in_cone)):
        slope = -2.0 * c / divisor
        normal = need_n / (w_nn + slope * w_nt)
        return ContactImpulse(normal, slope * normal, STICK)
    if mode == STICK or mode == ANY_MODE:
        mode = SLIDE_LEFT if c < 0.0 else SLIDE_RIGHT
    return _sliding_impulse(equations, friction_coefficient, mode)


@compiled
def contact_impulse(equations: ContactEquations, friction_coefficient: float, mode: int,
                    creep_speed: float = 0.0) -> ContactImpulse:
    """
    Compute the impulse that keeps the bodies apart: none, sticking, or on the edge of the cone.

    Sticking solves ``W l = need``, sliding ``w_nn l_n + w_nt l_t = need_n`` with
    ``l_t = +-mu_c l_n``. W is positive definite; therefore the sign of the sticking impulse tells
    the side that slides, and the divisor below is positive for the mode that the law selects.

    :param friction_coefficient: mu_c.
    :param mode: ANY_MODE, or the mode to impose whether it is the right one or not.
    :param creep_speed: slip of a sticking contact at its friction limit, kappa V [m/s].
    """
    w_nn, w_nt, w_tt, need_n, need_t = equations
    if mode == SEPARATE or (mode == ANY_MODE and need_n <= 0.0):
        return ContactImpulse(0.0, 0.0, SEPARATE)
    if creep_speed > 0.0 and friction_coefficient > 0.0:
        return _creeping_impulse(equations, friction_coefficient, mode, creep_speed)
    determinant = w_nn * w_tt - w_nt * w_nt
    normal = (w_tt * need_n - w_nt * need_t) / determinant
    tangential = (w_nn * need_t - w_nt * need_n) / determinant
    in_cone = abs(tangential) <= friction_coefficient * normal
    if mode == STICK or (mode == ANY_MODE and in_cone):
        return ContactImpulse(normal, tangential, STICK)
    if mode == ANY_MODE:
        mode = SLIDE_LEFT if tangential > 0.0 else SLIDE_RIGHT
    return _sliding_impulse(equations, friction_coefficient, mode)


@compiled
def law_violation(impulse: ContactImpulse, missing: float, slip: float,
                  friction_coefficient: float, mass: float, creep_speed: float = 0.0) -> float:
    """
    Measure how far a contact is from the law of its mode [m/s]; 0 where it keeps to it.

    :param missing: normal velocity that the object's contact point lacks [m/s].
    :param slip: tangential velocity of that point relative to the robot's surface [m/s].
    :param friction_coefficient: mu_c.
    :param mass: of the object, to compare impulses with velocities [kg].
    :param creep_speed: slip at which sliding begins [m/s].
    """
    penetration = max(0.0, missing) + max(0.0, -impulse.normal) / mass
    if impulse.mode == STICK:
        outside = max(0.0, abs(impulse.tangential) - friction_coefficient * impulse.normal)
        return penetration + outside / mass
    if impulse.mode == SLIDE_LEFT:
        return penetration + max(0.0, slip + creep_speed)
    if impulse.mode == SLIDE_RIGHT:
        return penetration + max(0.0, creep_speed - slip)
    return penetration
