"""
One segment of constant pushing angle as algebra: Radau IIA in arc length of the contact.

Scale-free: velocities are per pushing speed v, so w = omega / v [1/m], and inertia carries v^2.
Nothing divides by v, and v -> 0 is the quasi-static limit.
"""

from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from push_model.drive import center_velocity, yaw_rate
from push_model.dynamics import contact_force, impulse, kinematics, moment_balance
from push_model.state import Input, ObjectTerms, State

POINTS = 3
SMOOTHING = 0.005
NODE = ('x', 'y', 'theta', 'w', 'gamma')


class Constants(NamedTuple):
    """
    What stays the same along a push; numbers or casadi symbols.

    :param terms: ``ObjectTerms`` with mass and inertia times v^2.
    :param c_x: contact in the object frame [m].
    :param c_y: the same, y.
    :param share: lam of the rolling contact.
    :param radius: R_p [m].
    :param heading_offset: D = gamma - phi [rad].
    """

    terms: ObjectTerms
    c_x: Any
    c_y: Any
    share: Any
    radius: Any
    heading_offset: Any

    @classmethod
    def of(cls, problem):
        """
        Take the constants from a problem.

        :param problem: the ``PushProblem``.
        """
        terms = ObjectTerms.of(problem.obj)
        squared = problem.settings.pushing_speed ** 2
        terms = terms._replace(mass=terms.mass * squared, inertia=terms.inertia * squared)
        return cls(terms, *problem.contact_point, problem.rolling[0], problem.robot.radius,
                   problem.heading_offset)

    @classmethod
    def symbols(cls, supports):
        """
        Make symbols for an object on a number of supports.

        :param supports: number of supports.
        :return: (``Constants`` of symbols, the same as one column).
        """
        flat = ca.SX.sym('constants', 9 + 3 * supports)
        parts = ca.vertsplit(flat)
        feet = tuple(tuple(parts[9 + 3 * i:12 + 3 * i]) for i in range(supports))
        return cls(ObjectTerms(*parts[:4], feet), *parts[4:9]), flat

    def column(self):
        """Return the numbers in the order of ``symbols``, shape (9 + 3 k,)."""
        feet = [value for support in self.terms.supports for value in support]
        return np.array([*self.terms[:4], *self[1:], *feet])


def radau():
    """
    Coefficients of the Radau IIA scheme: points, integration matrix A and its inverse.

    The last point is the end of the step; the last row of A holds the weights.
    """
    points = np.array(ca.collocation_points(POINTS, 'radau'))
    powers = np.arange(POINTS)
    values = points[:, None] ** powers
    integrals = points[:, None] ** (powers + 1) / (powers + 1)
    matrix = integrals @ np.linalg.inv(values)
    return points, matrix, np.linalg.inv(matrix)


def switch(constants, node, before, angle, moving):
    """
    Jump of w where the pushing angle changes at once, and the impulse that this takes.

    :param constants: ``Constants``.
    :param node: (x, y, theta, w, gamma).
    :param before: pushing angle before [rad].
    :param angle: pushing angle after [rad].
    :param moving: 1 on the way, 0 at the first touch, where nothing moved before.
    :return: (jump of w [1/m], J_n, J_t [N m]; impulses times v).
    """
    _, _, theta, w, gamma = node
    dv_x = ca.cos(gamma + angle) - moving * ca.cos(gamma + before)
    dv_y = ca.sin(gamma + angle) - moving * ca.sin(gamma + before)
    state = State(0.0, 0.0, theta, w, gamma, constants.c_x, constants.c_y)
    return impulse(constants.terms, state, dv_x, dv_y)


def collocate(drive, constants, node, w, angle, length, rates, smoothing=SMOOTHING):
    """
    Write one Radau step of a segment.

    :param drive: the robot's drive.
    :param constants: ``Constants``.
    :param node: (x, y, theta, w, gamma) at the beginning; its w is not used.
    :param w: w at the beginning, after the jump [1/m].
    :param angle: pushing angle [rad].
    :param length: h, way of the contact [m].
    :param rates: w at the points of the step, unknowns [1/m].
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    :return: (node at the end, residuals [N m], forces [(F_n, F_t)] at the points).
    """
    _, matrix, inverse = radau()
    # Vertex or held normal: the contact point does not move in the object, R_e plays no part.
    rolling = (constants.share, 0.0)
    yaw = [yaw_rate(drive, constants.radius, angle, constants.heading_offset, rate)
           for rate in rates]
    bends = [constants.share * rate + (1 - constants.share) * turn
             for rate, turn in zip(rates, yaw)]
    slopes, residuals, forces = [], [], []
    for i in range(POINTS):
        theta = node[2] + length * _dot(matrix[i], rates)
        gamma = node[4] + length * _dot(matrix[i], bends)
        c, s = ca.cos(gamma + angle), ca.sin(gamma + angle)
        state = State(0.0, 0.0, theta, rates[i], gamma, constants.c_x, constants.c_y)
        inputs = Input(c, s, -bends[i] * s, bends[i] * c, yaw[i])
        change = _dot(inverse[i], [rate - w for rate in rates]) / length
        residuals.append(moment_balance(constants.terms, state, inputs, change, rolling,
                                        smoothing))
        forces.append(contact_force(constants.terms, state, inputs, change, rolling, smoothing))
        slopes.append(kinematics(state, inputs, change, rolling))
    weights = matrix[-1]
    end = (node[0] + length * _dot(weights, [slope.x for slope in slopes]),
           node[1] + length * _dot(weights, [slope.y for slope in slopes]),
           node[2] + length * _dot(weights, rates), rates[-1],
           node[4] + length * _dot(weights, bends))
    return end, residuals, forces


def robot_motion(drive, constants, angle, w):
    """
    Motion of the robot per speed of the contact.

    :param drive: the robot's drive.
    :param constants: ``Constants``.
    :param angle: pushing angle [rad].
    :param w: object's yaw rate per speed [1/m].
    :return: (velocity of the centre along n, along t [-], yaw rate [1/m]).
    """
    turn = yaw_rate(drive, constants.radius, angle, constants.heading_offset, w)
    return (*center_velocity(constants.radius, angle, turn), turn)


def _dot(weights, values):
    return sum(float(a) * value for a, value in zip(weights, values))
