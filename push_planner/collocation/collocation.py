"""
One step of a push as algebra: Radau IIA in arc length of the contact.

Velocities are per pushing speed v, so w = omega / v [1/m], and inertia carries ``V = v^2``.
Nothing divides by v, and V -> 0 is the quasi-static limit. Poses are in the object's start frame.
"""

import functools
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.dynamics import contact_force, impulse, Input, kinematics, moment_balance, State
from push_model.robot_kinematics import center_velocity, yaw_rate
from push_planner.push_parameters import place


class Node(NamedTuple):
    """
    State between two steps.

    :param w: object's yaw rate over the pushing speed [1/m].
    :param rho: pushing angle [rad].
    :param theta: turn of the object since the start [rad].
    :param q_x: followed point [m]: the contact where it stays in place on the object, else the
        robot's centre; it moves along the push.
    :param q_y: the same, y.
    :param phi: turn of a differential drive since the start [rad]; 0 for others.
    """

    w: Any
    rho: Any
    theta: Any
    q_x: Any
    q_y: Any
    phi: Any = 0.0


class Step(NamedTuple):
    """
    What a step is given.

    :param length: h, way of the contact [m].
    :param change: change of the pushing angle over the step [rad], or its jump at the begin.
    :param square: V at the begin [m^2/s^2].
    :param slope: dV/ds [m/s^2].
    :param jumps: whether the change is a jump.
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    """

    length: Any
    change: Any
    square: Any
    slope: Any
    jumps: bool
    smoothing: Any


class StepResult(NamedTuple):
    """
    What comes of a step.

    :param samples: ``Node`` at the points; the last is the end.
    :param residuals: of the moment equation at the points [N m].
    :param forces: (F_n, F_t) at the points [N].
    """

    samples: list
    residuals: list
    forces: list

    @property
    def node(self):
        """The ``Node`` at the end."""
        return self.samples[-1]


@functools.lru_cache(maxsize=8)
def radau(points):
    """
    Coefficients of the Radau IIA scheme: points, integration matrix A and its inverse.

    The last point is the end of the step; the last row of A holds the weights.

    :param points: K, number of points.
    """
    places = np.array(ca.collocation_points(points, 'radau'))
    powers = np.arange(points)
    values = places[:, None] ** powers
    integrals = places[:, None] ** (powers + 1) / (powers + 1)
    matrix = integrals @ np.linalg.inv(values)
    return places, matrix, np.linalg.inv(matrix)


ZERO = Input(0.0, 0.0, 0.0, 0.0, 0.0)


def contact_impulse(kind, push_parameters, node, change=None):
    """
    Jump of w where the velocity imposed at the contact changes at once, and its impulse.

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
    :param push_parameters: ``PushParameters``.
    :param node: ``Node`` before.
    :param change: jump of the pushing angle [rad]; None: first touch, nothing moved before.
    :return: (jump of w [1/m], J_n, J_t [m/s per v]; impulses per mass and speed).
    """
    phi = node.theta if kind == 'held' else node.phi
    delta, c_x, c_y = place(push_parameters, node.theta, phi)
    before = delta + node.rho
    v_x, v_y = ca.cos(before), ca.sin(before)
    if change is not None:
        v_x, v_y = ca.cos(before + change) - v_x, ca.sin(before + change) - v_y
    state = State(0.0, 0.0, 0.0, 0.0, delta, c_x, c_y)
    jump, j_n, j_t = impulse(push_parameters.terms, state, v_x, v_y)
    return jump, j_n / push_parameters.terms.mass, j_t / push_parameters.terms.mass


def collocate(kind, push_parameters, node, step, rates):
    """
    Write one Radau step.

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
    :param push_parameters: ``PushParameters``.
    :param node: ``Node`` at the begin.
    :param step: ``Step``.
    :param rates: w at the points of the step, unknowns [1/m].
    :return: ``StepResult``.
    """
    places, matrix, inverse = radau(len(rates))
    h = step.length
    w = node.w + (contact_impulse(kind, push_parameters, node, step.change)[0] if step.jumps else 0.0)
    angles = [node.rho + (1.0 if step.jumps else float(c)) * step.change for c in places]
    bend = 0.0 if step.jumps else step.change / h
    turns = [robot_yaw_rate(kind, push_parameters, angle, rate) for angle, rate in zip(angles, rates)]
    residuals, forces, turned, ways = [], [], [], []
    for i, c in enumerate(places):
        theta = node.theta + h * _dot(matrix[i], rates)
        phi = _robot_heading(kind, node, theta, h, matrix[i], turns)
        slope_w = _dot(inverse[i], [rate - w for rate in rates]) / h
        residual, force, gamma = balance(push_parameters, (theta, phi, rates[i], angles[i], turns[i]),
                                         bend, slope_w, step, float(c))
        residuals.append(residual)
        forces.append(force)
        turned.append((theta, phi))
        ways.append((ca.cos(gamma + angles[i]), ca.sin(gamma + angles[i])))
    samples = [Node(rate, angle, theta, node.q_x + h * _dot(row, [way[0] for way in ways]),
                    node.q_y + h * _dot(row, [way[1] for way in ways]), phi)
               for rate, angle, (theta, phi), row in zip(rates, angles, turned, matrix)]
    return StepResult(samples, residuals, forces)


def robot_yaw_rate(kind, push_parameters, angle, w):
    """
    Robot's yaw rate over the pushing speed [1/m].

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
    :param push_parameters: ``PushParameters``.
    :param angle: pushing angle [rad].
    :param w: the object's yaw rate over the pushing speed [1/m].
    """
    if kind == 'rolling':
        return 0.0
    drive = 'holonomic' if kind == 'held' else 'differential'
    return yaw_rate(drive, push_parameters.radius, angle, push_parameters.heading_offset, w)


def robot_speed(push_parameters, angle, turn):
    """
    Square of the speed of the robot's centre over that of the contact.

    :param push_parameters: ``PushParameters``.
    :param angle: pushing angle [rad].
    :param turn: robot's yaw rate over the pushing speed [1/m].
    """
    along, across = center_velocity(push_parameters.radius, angle, turn)
    return along ** 2 + across ** 2


def _robot_heading(kind, node, theta, h, row, turns):
    if kind == 'held':
        return theta
    return node.phi + h * _dot(row, turns) if kind == 'differential' else 0.0


def balance(push_parameters, point, bend, slope_w, step, c):
    """
    Write the equation of motion at one point, in axes of the object.

    :param push_parameters: ``PushParameters``.
    :param point: (theta, phi, w, pushing angle, robot's yaw rate over the pushing speed).
    :param bend: rate of the pushing angle [rad/m].
    :param slope_w: dw/ds [1/m^2].
    :param step: ``Step``.
    :param c: place of the point in the step.
    :return: (residual of the moment [N m], (F_n, F_t) [N], gamma since the start [rad]).
    """
    theta, phi, w, angle, turn = point
    delta, c_x, c_y = place(push_parameters, theta, phi)
    rolling = push_parameters.share, push_parameters.effective
    state = State(0.0, 0.0, 0.0, w, delta, c_x, c_y)
    u_x, u_y = ca.cos(delta + angle), ca.sin(delta + angle)
    turned = kinematics(state, ZERO._replace(omega_p=turn), 0.0, rolling).gamma + bend
    square = step.square + c * step.length * step.slope
    terms = push_parameters.terms._replace(mass=push_parameters.terms.mass * square,
                                           inertia=push_parameters.terms.inertia * square)
    inputs = Input(u_x, u_y, -turned * u_y, turned * u_x, turn)
    residual = moment_balance(terms, state, inputs, slope_w, rolling, step.smoothing)
    force = contact_force(terms, state, inputs, slope_w, rolling, step.smoothing)
    # d(v w)/dt = V w' + V'/2 w, and a_C has V'/2 along the push: inertia without friction.
    half = 0.5 * step.slope
    bare, still = push_parameters.terms._replace(supports=()), state._replace(omega=0.0)
    faster = Input(0.0, 0.0, half * u_x, half * u_y, 0.0)
    residual += moment_balance(bare, still, faster, half * w, rolling)
    more = contact_force(bare, still, faster, half * w, rolling)
    return residual, (force[0] + more[0], force[1] + more[1]), theta + delta


def _dot(weights, values):
    return sum(float(a) * value for a, value in zip(weights, values))
