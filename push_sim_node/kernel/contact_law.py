"""
Contact of a disc robot with an object: where it is, and the impulse in closed form.

Unilateral and inelastic, with Coulomb friction. n points from robot to object, t is n turned by
+90 degrees.
"""

import math

from push_sim_node.kernel.compiled import closest_on_polygon, compiled, lowest_vertex
from push_sim_node.kernel.layout import ANY, SEPARATE, SLIDE_LEFT, SLIDE_RIGHT, STICK


@compiled
def nearest(outline, disc_radius, robot_radius, x, y, theta, p_x, p_y, phi):
    """
    Nearest points of object and robot.

    :param outline: vertices in the object frame, shape (k, 2) [m]; ignored for a disc.
    :param disc_radius: radius of a disc about the object frame, 0 for a polygon [m].
    :param robot_radius: R_p [m]; infinite for a fence.
    :param x: object frame in the world, x [m].
    :param y: the same, y [m].
    :param theta: its orientation [rad].
    :param p_x: robot centre, x [m].
    :param p_y: the same, y [m].
    :param phi: heading of the robot, which only a fence needs [rad].
    :return: normal (x, y), the object's point (x, y) [m], gap [m] (negative on overlap).
    """
    d_x, d_y = p_x - x, p_y - y
    if math.isinf(robot_radius):
        n_x, n_y = math.cos(phi), math.sin(phi)
        c_x, c_y = -disc_radius * n_x, -disc_radius * n_y
        if disc_radius == 0.0:
            c, s = math.cos(theta), math.sin(theta)
            i = lowest_vertex(outline, c * n_x + s * n_y, c * n_y - s * n_x)
            c_x = c * outline[i][0] - s * outline[i][1]
            c_y = s * outline[i][0] + c * outline[i][1]
        return n_x, n_y, x + c_x, y + c_y, n_x * (c_x - d_x) + n_y * (c_y - d_y)
    if disc_radius > 0.0:
        away = math.sqrt(d_x * d_x + d_y * d_y)
        n_x, n_y = -d_x / away, -d_y / away
        return n_x, n_y, x - disc_radius * n_x, y - disc_radius * n_y, \
            away - disc_radius - robot_radius
    c, s = math.cos(theta), math.sin(theta)
    c_x, c_y, m_x, m_y, away, _, _ = closest_on_polygon(outline, c * d_x + s * d_y,
                                                        c * d_y - s * d_x)
    return c * m_x - s * m_y, s * m_x + c * m_y, x + c * c_x - s * c_y, y + s * c_x + c * c_y, \
        away - robot_radius


@compiled
def surface_velocity(robot_radius, n_x, n_y, away_x, away_y, v_x, v_y, omega):
    """
    Velocity of the robot's surface at the contact, along n and t [m/s].

    :param robot_radius: R_p [m]; infinite for a fence.
    :param n_x: contact normal, x.
    :param n_y: the same, y.
    :param away_x: from the robot's position to the contact, x [m]; only a fence needs it.
    :param away_y: the same, y [m].
    :param v_x: velocity of the robot's position, world axes, x [m/s].
    :param v_y: the same, y [m/s].
    :param omega: its yaw rate [rad/s].
    """
    normal, tangential = n_x * v_x + n_y * v_y, n_x * v_y - n_y * v_x
    if math.isinf(robot_radius):
        return normal - omega * (n_x * away_y - n_y * away_x), tangential
    return normal, tangential + omega * robot_radius


@compiled
def contact_impulse(w_nn, w_nt, w_tt, need_n, need_t, friction_coefficient, only):
    """
    Impulse that keeps the bodies apart: none, sticking, or sliding on the edge of the cone.

    ``w`` maps impulse to relative velocity and is positive definite; then the sign of the
    sticking impulse tells the side that slides, and the divisor below is positive.

    :param w_nn: normal velocity per normal impulse [1/kg].
    :param w_nt: normal velocity per tangential impulse [1/kg].
    :param w_tt: tangential velocity per tangential impulse [1/kg].
    :param need_n: normal velocity that is missing without an impulse [m/s].
    :param need_t: tangential velocity that is missing for sticking [m/s].
    :param friction_coefficient: mu_c.
    :param only: ANY, or the mode to take whether it is the right one or not.
    :return: (normal impulse [N s], tangential impulse [N s], mode).
    """
    if only == SEPARATE or (only == ANY and need_n <= 0.0):
        return 0.0, 0.0, SEPARATE
    determinant = w_nn * w_tt - w_nt * w_nt
    normal = (w_tt * need_n - w_nt * need_t) / determinant
    tangential = (w_nn * need_t - w_nt * need_n) / determinant
    if only == STICK or (only == ANY and abs(tangential) <= friction_coefficient * normal):
        return normal, tangential, STICK
    mode = only
    if only == ANY:
        mode = SLIDE_LEFT if tangential > 0.0 else SLIDE_RIGHT
    slope = friction_coefficient if mode == SLIDE_LEFT else -friction_coefficient
    divisor = w_nn + slope * w_nt
    normal = need_n / divisor if divisor > 0.0 else 0.0
    return normal, slope * normal, mode


@compiled
def violation(mode, missing, slip, impulse_n, impulse_t, friction_coefficient, mass):
    """
    Say how far a contact is from the law of the mode that it was given [m/s].

    :param mode: SEPARATE, STICK, SLIDE_LEFT or SLIDE_RIGHT.
    :param missing: normal velocity that the object's contact point lacks [m/s].
    :param slip: tangential velocity of that point relative to the robot's surface [m/s].
    :param impulse_n: normal impulse [N s].
    :param impulse_t: tangential impulse [N s].
    :param friction_coefficient: mu_c.
    :param mass: of the object, to compare impulses with velocities [kg].
    """
    wrong = max(0.0, missing) + max(0.0, -impulse_n) / mass
    if mode == STICK:
        return wrong + max(0.0, abs(impulse_t) - friction_coefficient * impulse_n) / mass
    if mode == SLIDE_LEFT:
        return wrong + max(0.0, slip)
    if mode == SLIDE_RIGHT:
        return wrong + max(0.0, -slip)
    return wrong
