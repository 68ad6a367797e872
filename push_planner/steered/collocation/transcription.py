"""
Transcription of a push into a nonlinear program, by direct collocation.

    minimise    S + SMOOTHNESS sum_k change_k^2
    subject to  x_{k+1} = Radau step of x_k        (dynamics)
                moment balance = 0                 (at every Radau point)
                contact force in the planning cone (at every Radau point and the first touch)
                limits of pushing angle and robot  (at the end of every step)
                start and goal

States x of a step: the free length S of the push (see ``mesh``), the same in all steps, and the
``Node``. Controls: change of the pushing angle, and w at the Radau points. Object, speeds, cone,
start and goal are parameters, so that a program is built once for its ``Dimensions``.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, Optional

import casadi as ca
import numpy as np
from push_model.trigonometry import cos_and_sin
from push_planner.steered.collocation.collocation import (
    collocate, contact_impulse, force_at_start, IntegrationStep, Node, robot_speed_squared,
    robot_yaw_rate,
)
from push_planner.steered.collocation.dimensions import (
    BoundaryValues, Constraint, Dimensions, Limits, StepData,
)
from push_planner.steered.push_parameters import contact_frame, PushKind, PushParameters

# Sliding speed over the pushing speed below which the supports' friction becomes viscous. Chosen:
# small against the speeds of supports off the centre of rotation, and smooth enough for Newton.
SMOOTHING = 0.02
# Cost of the squared changes of the pushing angle [m/rad^2]. Chosen: small against the path, so
# that it only decides between equally long ones.
SMOOTHNESS = 1e-3

Inequality = tuple[Constraint, Any]


class BlockRows(NamedTuple):
    """
    Rows of a block.

    :param equalities: expressions that are 0.
    :param inequalities: (``Constraint``, expression that is at least 0).
    """

    equalities: list[Any]
    inequalities: list[Inequality]

    def column(self) -> Any:
        """Stack all rows."""
        return ca.vertcat(*self.equalities, *(row for _, row in self.inequalities))

    def constraints(self) -> list[Optional[Constraint]]:
        """Name the rows; None for an equality."""
        equalities = ca.vertcat(*self.equalities).numel()
        return [None] * equalities + [constraint for constraint, _ in self.inequalities]


class CommonSymbols(NamedTuple):
    """
    Parameters of the whole push as symbols, apart and in one column.

    :param parameters: ``PushParameters``.
    :param limits: ``Limits``.
    :param boundary: ``BoundaryValues``.
    :param column: all of them.
    """

    parameters: PushParameters
    limits: Limits
    boundary: BoundaryValues
    column: Any


class StepSymbols(NamedTuple):
    """
    Variables and parameters of a step as symbols, apart and in columns.

    :param variables: all variables.
    :param inputs: all parameters.
    :param free_length: S [m].
    :param node: ``Node`` at the start.
    :param change: of the pushing angle [rad].
    :param rates: w at the Radau points [1/m].
    :param data: ``StepData``.
    """

    variables: Any
    inputs: Any
    free_length: Any
    node: Node
    change: Any
    rates: list[Any]
    data: StepData


class PushRows:
    """
    All rows of the program of a push, as expressions.

    Attributes: ``common``, the parameters of the whole push; ``symbols``, those of a step and its
    variables; ``end``, the states at the end; ``of_step``, ``of_first`` and ``of_end``,
    ``BlockRows`` of every step, of the first one besides, and of the end. The first rows of a step
    are its end state, negative, then the moment balances.

    :param dimensions: ``Dimensions``.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Write all rows."""
        self._dimensions = dimensions
        self.common = common_symbols(dimensions)
        self.symbols = self._step_symbols()
        self.end = ca.SX.sym('end', dimensions.state_count)
        self.of_step = self._step_rows(self.common, self.symbols)
        self.of_first = self._first_rows(self.common, self.symbols)
        self.of_end = self._end_rows(self.common, self.end)

    def _step_symbols(self) -> StepSymbols:
        dimensions = self._dimensions
        variables = ca.SX.sym('z', dimensions.step_size)
        parts = ca.vertsplit(variables)
        inputs = ca.SX.sym('step', len(StepData._fields))
        return StepSymbols(variables, inputs, parts[0], self._node(parts),
                           parts[dimensions.state_count], parts[dimensions.state_count + 1:],
                           StepData(*ca.vertsplit(inputs)))

    def _node(self, states: Sequence[Any]) -> Node:
        w, rho, theta, q_x, q_y = states[1:6]
        if self._dimensions.kind == 'held':
            return Node(w, rho, theta, q_x, q_y, theta)
        if self._dimensions.kind == 'rolling':
            return Node(w, rho, theta, q_x, q_y, 0.0)
        return Node(w, rho, theta, q_x, q_y, states[6])

    def _step_rows(self, common: CommonSymbols, symbols: StepSymbols) -> BlockRows:
        dimensions = self._dimensions
        parameters, limits, data = common.parameters, common.limits, symbols.data
        step = IntegrationStep(data.length + data.free_fraction * symbols.free_length,
                               data.may_steer * symbols.change, data.v_squared,
                               data.v_squared_slope, dimensions.jumps, SMOOTHING)
        result = collocate(dimensions.kind, parameters, symbols.node, step, symbols.rates)
        # Forces and moments per friction of the supports are of the order of 1.
        friction = sum(support[2] for support in parameters.terms.supports)
        end = ca.vertcat(symbols.free_length, *result.end[:dimensions.state_count - 1])
        rows: list[Inequality] = []
        for normal, tangential in result.forces:
            rows += _cone_rows(Constraint.CONE, limits.cone_slope, limits.cone_slack,
                               normal / friction, tangential / friction)
        if not dimensions.jumps:
            largest = data.max_angle_slope * step.length
            rows += [(Constraint.ANGLE_RATE, largest - symbols.change),
                     (Constraint.ANGLE_RATE, largest + symbols.change)]
        rows += self._robot_rows(common, result.end, data.v_squared_end)
        if dimensions.kind == 'differential':
            delta = contact_frame(parameters, result.end.theta, result.end.phi).delta
            rows += [(Constraint.VERTEX, delta - limits.min_normal),
                     (Constraint.VERTEX, limits.max_normal - delta)]
        residuals = [residual / friction for residual in result.residuals]
        return BlockRows([-end, *residuals], rows)

    def _robot_rows(self, common: CommonSymbols, node: Node, v_squared: Any) -> list[Inequality]:
        if self._dimensions.kind == 'rolling':
            return []
        limits = common.limits
        robot_w = robot_yaw_rate(self._dimensions.kind, common.parameters, node.rho, node.w)
        speed_squared = robot_speed_squared(common.parameters, node.rho, robot_w)
        return [(Constraint.YAW_RATE, limits.yaw_rate ** 2 - v_squared * robot_w ** 2),
                (Constraint.SPEED, limits.speed ** 2 - v_squared * speed_squared)]

    def _first_rows(self, common: CommonSymbols, symbols: StepSymbols) -> BlockRows:
        kind, parameters = self._dimensions.kind, common.parameters
        node, boundary, limits = symbols.node, common.boundary, common.limits
        response = contact_impulse(kind, parameters, node)
        equal = [node.w - boundary.moving * boundary.w
                 - (1.0 - boundary.moving) * response.w_jump,
                 node.theta, node.q_x - boundary.q_x, node.q_y - boundary.q_y]
        if kind == 'differential':
            equal.append(node.phi)
        rows = _cone_rows(Constraint.TOUCH, limits.cone_slope, limits.touch_slack,
                          response.normal, response.tangential)
        # The rate of the angle, a control, is left out: it acts on the object's inertia alone.
        step = IntegrationStep(1.0, 0.0, symbols.data.v_squared, symbols.data.v_squared_slope,
                               False, SMOOTHING)
        force = force_at_start(kind, parameters, node, step)
        friction = sum(support[2] for support in parameters.terms.supports)
        rows += _cone_rows(Constraint.TOUCH, limits.cone_slope, limits.touch_slack,
                           force[0] / friction, force[1] / friction)
        # Not the range of normals: the start is taken as it is.
        rows += self._robot_rows(common, node, symbols.data.v_squared_end)
        return BlockRows(equal, rows)

    def _end_rows(self, common: CommonSymbols, states: Any) -> BlockRows:
        dimensions, boundary = self._dimensions, common.boundary
        node = self._node(ca.vertsplit(states))
        x, y = object_origin(dimensions.kind, common.parameters, node)
        equal = [x - boundary.x, y - boundary.y]
        delta, c_x, c_y = contact_frame(common.parameters, node.theta, node.phi)
        if not dimensions.heading_free:
            equal.append(node.theta - boundary.theta)
        if dimensions.straight_end:
            angle = delta + node.rho
            equal.append((boundary.f_x - c_x) * ca.sin(angle)
                         - (boundary.f_y - c_y) * ca.cos(angle))
            if dimensions.kind == 'differential':
                equal.append(delta - boundary.delta)
        return BlockRows(equal, [])


class Transcription:
    """
    The program of a push as one expression.

    Its variables are (z_0, ..., z_{n-1}, x_n): those of each step, and the states at the end. Its
    rows are those of each step, then those of the first step alone, then those of the end.

    Attributes: ``x``, the variables; ``p``, the parameters, those of the whole push first;
    ``cost``; ``rows``; ``constraints``, what each row limits, None for an equality; ``equality``,
    whether it is one, shape (m,).

    :param dimensions: ``Dimensions``.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Join all rows."""
        rows = PushRows(dimensions)
        n, size, states = dimensions.step_count, dimensions.step_size, dimensions.state_count
        self.x = ca.MX.sym('x', dimensions.variable_count)
        common = ca.MX.sym('common', rows.common.column.numel())
        steps = ca.MX.sym('steps', rows.symbols.inputs.numel(), n)
        self.p = ca.veccat(common, steps)
        z, end = ca.reshape(self.x[:n * size], size, n), self.x[n * size:]
        inputs = [rows.symbols.variables, rows.symbols.inputs, rows.common.column]
        of_step, of_first = (ca.Function('rows', inputs, [block.column()], {'cse': True})
                             for block in (rows.of_step, rows.of_first))
        of_end = ca.Function('end', [rows.end, rows.common.column], [rows.of_end.column()])
        of_steps = of_step.map(n)(z, steps, common)
        # The first rows of a step are its end state, negative: the next step begins there.
        following = ca.horzcat(z[:states, 1:], end)
        gaps = of_steps[:states, :] + following
        self.rows = ca.veccat(ca.vertcat(gaps, of_steps[states:, :]),
                              of_first(z[:, 0], steps[:, 0], common), of_end(end, common))
        self.cost = SMOOTHNESS * ca.sumsqr(z[states, :]) + end[0]
        self.constraints = (rows.of_step.constraints() * n + rows.of_first.constraints()
                            + rows.of_end.constraints())
        self.equality = np.array([constraint is None for constraint in self.constraints])


def object_origin(kind: PushKind, parameters: PushParameters, node: Node) -> tuple[Any, Any]:
    """
    Find the object's origin from the followed point.

    :param kind: how the contact moves with the robot.
    :return: (x, y) in the object's start frame [m].
    """
    delta, c_x, c_y = contact_frame(parameters, node.theta, node.phi)
    to_contact = parameters.radius if kind == 'rolling' else 0.0
    c, s = cos_and_sin(node.theta)
    n_x, n_y = cos_and_sin(node.theta + delta)
    return (node.q_x + to_contact * n_x - c * c_x + s * c_y,
            node.q_y + to_contact * n_y - s * c_x - c * c_y)


def common_symbols(dimensions: Dimensions) -> CommonSymbols:
    """Make symbols for the parameters of the whole push."""
    parameters, column = PushParameters.symbols(dimensions.supports)
    limits = ca.SX.sym('limits', len(Limits._fields))
    boundary = ca.SX.sym('boundary', len(BoundaryValues._fields))
    return CommonSymbols(parameters, Limits(*ca.vertsplit(limits)),
                         BoundaryValues(*ca.vertsplit(boundary)),
                         ca.vertcat(column, limits, boundary))


def _cone_rows(constraint: Constraint, slope: Any, slack: Any, normal: Any,
               tangential: Any) -> list[Inequality]:
    return [(constraint, slope * normal - tangential + slack),
            (constraint, slope * normal + tangential + slack)]
