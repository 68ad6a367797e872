"""
One step of a push as algebra: Radau IIA collocation over the path length s of the contact.

Velocities are per pushing speed v, so w = omega / v [1/m], and inertia is multiplied by V = v^2.
Nothing divides by v, and V -> 0 is the quasi-static limit. Poses are in the object's start frame.
With the Radau points c_i in (0, 1], the integration matrix A and the step length h:

    theta_i = theta_0 + h sum_j A_ij w_j
    phi_i   = phi_0   + h sum_j A_ij w_p(rho_j, w_j)
    q_i     = q_0     + h sum_j A_ij (cos, sin)(gamma_j + rho_j)
    dw/ds_i = (1 / h) sum_j (A^-1)_ij (w_j - w_0)

and the moment balance at each point, in w_i and dw/ds_i, determines the w_i. The pushing angle rho
changes linearly over the step, or by a jump at its start. Scheme: Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5.
"""

from collections.abc import Iterable, Sequence
import functools
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.dynamics import contact_force, impulse, Input, kinematics, moment_balance, State
from push_model.geometry import FloatArray
from push_model.parameters import Drive
from push_model.robot_kinematics import center_velocity, yaw_rate
from push_model.trigonometry import cos_and_sin
from push_planner.steered.push_parameters import contact_frame, PushKind, PushParameters


class Node(NamedTuple):
    """
    State between two steps; numbers or casadi symbols.

    :param w: the object's yaw rate over the pushing speed [1/m].
    :param rho: pushing angle [rad].
    :param theta: rotation of the object since the start [rad].
    :param q_x: followed point, x [m]: the contact where it stays in place on the object, else the
        robot's centre; it moves along the push.
    :param q_y: the same, y [m].
    :param phi: rotation of a differential drive since the start [rad]; 0 for others.
    """

    w: Any
    rho: Any
    theta: Any
    q_x: Any
    q_y: Any
    phi: Any = 0.0


class IntegrationStep(NamedTuple):
    """
    A step, apart from the state at its start.

    :param length: h, path length of the contact [m].
    :param change: change of the pushing angle over the step, or its jump at the start [rad].
    :param v_squared: V at the start [m^2/s^2].
    :param v_squared_slope: dV/ds [m/s^2].
    :param jumps: whether the change is a jump.
    :param smoothing: sliding speed below which the supports' friction becomes viscous, per pushing
        speed.
    """

    length: Any
    change: Any
    v_squared: Any
    v_squared_slope: Any
    jumps: bool
    smoothing: Any


class StepResult(NamedTuple):
    """
    Motion over a step.

    :param samples: ``Node`` at the Radau points; the last is the end.
    :param residuals: of the moment balance at the points [N m].
    :param forces: (F_n, F_t) at the points [N].
    """

    samples: list[Node]
    residuals: list[Any]
    forces: list[tuple[Any, Any]]

    @property
    def end(self) -> Node:
        """The ``Node`` at the end."""
        return self.samples[-1]


class RadauScheme(NamedTuple):
    """
    Coefficients of the Radau IIA scheme of K points.

    :param points: c, shape (K,); the last is 1, the end of the step.
    :param matrix: A, shape (K, K); its last row holds the weights.
    :param inverse: of A.
    """

    points: FloatArray
    matrix: FloatArray
    inverse: FloatArray


class VelocityJumpEffect(NamedTuple):
    """
    Effect of a jump of the velocity that is imposed at the contact, per pushing speed.

    :param w_jump: jump of w [1/m].
    :param normal: J_n per mass.
    :param tangential: J_t per mass.
    """

    w_jump: Any
    normal: Any
    tangential: Any


class MotionPoint(NamedTuple):
    """
    Motion at one point of a step.

    :param theta: rotation of the object since the start [rad].
    :param phi: rotation of the robot since the start [rad].
    :param w: the object's yaw rate over the pushing speed [1/m].
    :param rho: pushing angle [rad].
    :param robot_w: the robot's yaw rate over the pushing speed [1/m].
    """

    theta: Any
    phi: Any
    w: Any
    rho: Any
    robot_w: Any


class Balance(NamedTuple):
    """
    Equation of motion at one point.

    :param residual: of the moment balance [N m].
    :param force: (F_n, F_t) [N].
    :param gamma: angle of the normal in the object's start frame [rad].
    """

    residual: Any
    force: tuple[Any, Any]
    gamma: Any


@functools.lru_cache(maxsize=8)
def radau(count: int) -> RadauScheme:
    """
    Build the Radau IIA scheme.

    :param count: K, number of points.
    """
    points = np.array(ca.collocation_points(count, 'radau'))
    # A integrates polynomials of degree < K exactly: A c^p = c^(p + 1) / (p + 1).
    powers = np.arange(count)
    values = points[:, None] ** powers
    integrals = points[:, None] ** (powers + 1) / (powers + 1)
    matrix = integrals @ np.linalg.inv(values)
    return RadauScheme(points, matrix, np.asarray(np.linalg.inv(matrix), dtype=np.float64))


def contact_impulse(kind: PushKind, parameters: PushParameters, node: Node,
                    change: Any = None) -> VelocityJumpEffect:
    """
    Find how the object responds where the velocity imposed at the contact jumps.

    :param kind: how the contact moves with the robot.
    :param node: ``Node`` before.
    :param change: jump of the pushing angle [rad]; None: first touch, nothing moved before.
    """
    phi = node.theta if kind == 'held' else node.phi
    delta, c_x, c_y = contact_frame(parameters, node.theta, phi)
    v_x, v_y = cos_and_sin(delta + node.rho)
    if change is not None:
        after_x, after_y = cos_and_sin(delta + node.rho + change)
        v_x, v_y = after_x - v_x, after_y - v_y
    state = State(0.0, 0.0, 0.0, 0.0, delta, c_x, c_y)
    w_jump, j_n, j_t = impulse(parameters.terms, state, v_x, v_y)
    return VelocityJumpEffect(w_jump, j_n / parameters.terms.mass, j_t / parameters.terms.mass)


def collocate(kind: PushKind, parameters: PushParameters, node: Node, step: IntegrationStep,
              rates: Sequence[Any]) -> StepResult:
    """
    Write one Radau step; see the formulas of this module.

    :param kind: how the contact moves with the robot.
    :param node: ``Node`` at the start.
    :param rates: w at the points of the step, unknowns [1/m].
    """
    scheme = radau(len(rates))
    h = step.length
    w_start, angles, angle_slope = _steered(kind, parameters, node, step, scheme)
    robot_rates = [robot_yaw_rate(kind, parameters, angle, rate)
                   for angle, rate in zip(angles, rates)]
    thetas: list[Any] = []
    phis: list[Any] = []
    balances: list[Balance] = []
    directions: list[tuple[Any, Any]] = []
    for i, c in enumerate(scheme.points):
        theta = node.theta + h * _dot(scheme.matrix[i], rates)
        phi = _robot_rotation(kind, node, theta, h, scheme.matrix[i], robot_rates)
        w_slope = _dot(scheme.inverse[i], [rate - w_start for rate in rates]) / h
        point = MotionPoint(theta, phi, rates[i], angles[i], robot_rates[i])
        balance = moment_and_force(parameters, point, angle_slope, w_slope, step, float(c))
        thetas.append(theta)
        phis.append(phi)
        balances.append(balance)
        directions.append((ca.cos(balance.gamma + angles[i]), ca.sin(balance.gamma + angles[i])))
    samples = [Node(rates[i], angles[i], thetas[i],
                    node.q_x + h * _dot(row, [x for x, _ in directions]),
                    node.q_y + h * _dot(row, [y for _, y in directions]), phis[i])
               for i, row in enumerate(scheme.matrix)]
    return StepResult(samples, [balance.residual for balance in balances],
                      [balance.force for balance in balances])


def robot_yaw_rate(kind: PushKind, parameters: PushParameters, angle: Any, w: Any) -> Any:
    """
    Yaw rate of the robot over the pushing speed [1/m].

    :param kind: how the contact moves with the robot.
    :param angle: pushing angle [rad].
    :param w: the object's yaw rate over the pushing speed [1/m].
    """
    if kind == 'rolling':
        return 0.0
    drive: Drive = 'holonomic' if kind == 'held' else 'differential'
    return yaw_rate(drive, parameters.radius, angle, parameters.heading_offset, w)


def robot_speed_squared(parameters: PushParameters, angle: Any, robot_w: Any) -> Any:
    """
    Squared speed of the robot's centre over that of the contact.

    :param angle: pushing angle [rad].
    :param robot_w: the robot's yaw rate over the pushing speed [1/m].
    """
    along, across = center_velocity(parameters.radius, angle, robot_w)
    return along ** 2 + across ** 2


def moment_and_force(parameters: PushParameters, point: MotionPoint, angle_slope: Any,
                     w_slope: Any, step: IntegrationStep, c: float) -> Balance:
    """
    Write the equation of motion at one point, in axes of the object.

    :param angle_slope: d rho / ds [rad/m].
    :param w_slope: dw/ds [1/m^2].
    :param c: place of the point in the step, in [0, 1].
    """
    delta, c_x, c_y = contact_frame(parameters, point.theta, point.phi)
    rolling = parameters.normal_ratio, parameters.effective_radius
    state = State(0.0, 0.0, 0.0, point.w, delta, c_x, c_y)
    u_x, u_y = ca.cos(delta + point.rho), ca.sin(delta + point.rho)
    at_rest = Input(0.0, 0.0, 0.0, 0.0, 0.0)
    direction_rate = kinematics(state, at_rest._replace(omega_p=point.robot_w), 0.0,
                                rolling).gamma + angle_slope
    v_squared = step.v_squared + c * step.length * step.v_squared_slope
    terms = parameters.terms._replace(mass=parameters.terms.mass * v_squared,
                                      inertia=parameters.terms.inertia * v_squared)
    inputs = Input(u_x, u_y, -direction_rate * u_y, direction_rate * u_x, point.robot_w)
    residual = moment_balance(terms, state, inputs, w_slope, rolling, step.smoothing)
    force = contact_force(terms, state, inputs, w_slope, rolling, step.smoothing)
    # d(v w)/dt = V w' + V'/2 w, and a_C has V'/2 along the push: inertia without friction.
    half = 0.5 * step.v_squared_slope
    frictionless = parameters.terms._replace(supports=())
    not_rotating = state._replace(omega=0.0)
    faster = Input(0.0, 0.0, half * u_x, half * u_y, 0.0)
    residual += moment_balance(frictionless, not_rotating, faster, half * point.w, rolling)
    more = contact_force(frictionless, not_rotating, faster, half * point.w, rolling)
    return Balance(residual, (force[0] + more[0], force[1] + more[1]), point.theta + delta)


def force_at_start(kind: PushKind, parameters: PushParameters, node: Node,
                   step: IntegrationStep) -> tuple[Any, Any]:
    """
    Write the force at the start of a step, where the angle begins to change at another rate.

    There w goes on, and the moment balance determines dw/ds, in which it is linear.

    :param kind: how the contact moves with the robot.
    :param node: ``Node`` at the start.
    :return: (F_n, F_t) [N].
    """
    point = MotionPoint(node.theta, node.phi, node.w, node.rho,
                        robot_yaw_rate(kind, parameters, node.rho, node.w))
    angle_slope = step.change / step.length
    at_rest, by_unit = (moment_and_force(parameters, point, angle_slope, w_slope, step, 0.0)
                        for w_slope in (0.0, 1.0))
    # Without inertia dw/ds plays no part.
    inertia = by_unit.residual - at_rest.residual
    w_slope = -at_rest.residual / ca.if_else(step.v_squared > 0.0, inertia, ca.inf)
    return moment_and_force(parameters, point, angle_slope, w_slope, step, 0.0).force


def _steered(kind: PushKind, parameters: PushParameters, node: Node, step: IntegrationStep,
             scheme: RadauScheme) -> tuple[Any, list[Any], Any]:
    """Find w after a jump at the start, the pushing angles at the points, and their slope."""
    if step.jumps:
        w_start = node.w + contact_impulse(kind, parameters, node, step.change).w_jump
        return w_start, [node.rho + 1.0 * step.change for _ in scheme.points], 0.0
    return (node.w + 0.0, [node.rho + float(c) * step.change for c in scheme.points],
            step.change / step.length)


def _robot_rotation(kind: PushKind, node: Node, theta: Any, h: Any, row: FloatArray,
                    robot_rates: Sequence[Any]) -> Any:
    if kind == 'held':
        return theta
    return node.phi + h * _dot(row, robot_rates) if kind == 'differential' else 0.0


def _dot(weights: Iterable[Any], values: Iterable[Any]) -> Any:
    return sum(float(a) * value for a, value in zip(weights, values))
