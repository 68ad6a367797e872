"""
The push as a nonlinear programme in stages, as fatrop wants it.

States of a stage: way S of the free part and the ``Node``; inputs: change of the pushing angle and
w at the Radau points. Object, speeds, cone, start and goal are parameters, so that a programme is
built once per kind.
"""

import casadi as ca
import numpy as np
from push_planner.constants import Constants, place
from push_planner.shape import Ends, Limits, STEP_FIELDS
from push_planner.stage import collocate, robot_speed, robot_turn, touch
from push_planner.step import Node, Step

SMOOTHING = 0.02
SMOOTHNESS = 1e-3
PENALTY = 100.0


class Equations:
    """
    Symbolic rows of a programme.

    :param shape: ``Shape``.
    """

    def __init__(self, shape):
        """Write them."""
        self.shape = shape
        self.names = []
        constants, flat = Constants.symbols(shape.supports)
        limits = ca.SX.sym('limits', len(Limits._fields))
        ends = ca.SX.sym('ends', len(Ends._fields))
        self.grid = ca.SX.sym('grid', len(STEP_FIELDS) + shape.states - 1, shape.steps)
        self.common = ca.vertcat(flat, limits, ends)
        self.p = ca.vertcat(self.common, ca.vec(self.grid))
        self.x = ca.SX.sym('x', shape.width * shape.steps + shape.states)
        stage, first, last = self._functions(constants, limits, ends, flat)
        self.g, cost = [], 0.0
        for k in range(shape.steps):
            begin = shape.width * k
            here = self.x[begin:begin + shape.width]
            after = self.x[begin + shape.width:begin + shape.width + shape.states]
            end, equal, rows = stage(here, self.grid[:, k], self.common)
            self._add(after - end)
            if k == 0:
                equal_first, rows_first = first(here, self.grid[:, 0], self.common)
                self._add(equal_first)
                self._add(equal)
                self._add(rows_first, self.first_names)
            else:
                self._add(equal)
            self._add(rows, self.row_names)
            cost += SMOOTHNESS * here[shape.states] ** 2
        final = self.x[shape.width * shape.steps:]
        self._add(last(final, self.common))
        self.cost = cost + final[0]
        self.rows = ca.cse(ca.vertcat(*self.g))
        self.equality = np.array([not name for name in self.names])

    def _add(self, rows, names=None):
        self.g.append(rows)
        self.names += names or [''] * rows.numel()

    def _node(self, states):
        w, rho, theta, q_x, q_y = states[1:6]
        phi = {'held': theta, 'rolling': 0.0}.get(self.shape.kind)
        return Node(w, rho, theta, q_x, q_y, states[6] if phi is None else phi)

    def _functions(self, constants, limits, ends, flat):
        shape = self.shape
        limits, ends = Limits(*ca.vertsplit(limits)), Ends(*ca.vertsplit(ends))
        z = ca.SX.sym('z', shape.width)
        parts = ca.vertsplit(z)
        node, change, rates = self._node(parts), parts[shape.states], parts[shape.states + 1:]
        grid = ca.SX.sym('step', len(STEP_FIELDS) + shape.states - 1)
        length, share, square, slope, free, rate, pace = ca.vertsplit(grid[:len(STEP_FIELDS)])
        step = Step(length + share * parts[0], free * change, square, slope, shape.jumps,
                    SMOOTHING)
        out = collocate(shape.kind, constants, node, step, rates)
        friction = sum(support[2] for support in constants.terms.supports)
        end = ca.vertcat(parts[0], *out.node[:shape.states - 1])
        end[1:] += grid[len(STEP_FIELDS):]
        rows = [row for force in out.forces
                for row in _cone(limits.slope, limits.slack, *(f / friction for f in force))]
        names = ['cone'] * len(rows)
        if not shape.jumps:
            reach = rate * step.length
            rows += [reach - change, reach + change]
            names += ['rate'] * 2
        rows += self._robot_rows(constants, limits, out.node, pace)
        names += [] if shape.kind == 'rolling' else ['turn', 'speed']
        self.row_names = names + ['vertex'] * (len(rows) - len(names))
        stage = ca.Function('stage', [z, grid, self.common], [
            end, ca.vertcat(*[residual / friction for residual in out.residuals]),
            ca.vertcat(*rows)])
        return stage, self._first((z, grid), node, constants, limits, ends), self._last(
            constants, ends)

    def _robot_rows(self, constants, limits, end, square):
        if self.shape.kind == 'rolling':
            return []
        turn = robot_turn(self.shape.kind, constants, end.rho, end.w)
        rows = [limits.turn ** 2 - square * turn ** 2,
                limits.speed ** 2 - square * robot_speed(constants, end.rho, turn)]
        if self.shape.kind == 'differential':
            delta, _, _ = place(constants, end.theta, end.phi)
            rows += [delta - limits.lowest, limits.highest - delta]
        return rows

    def _first(self, given, node, constants, limits, ends):
        jump, j_n, j_t = touch(self.shape.kind, constants, node)
        equal = [node.w - ends.moving * ends.w - (1.0 - ends.moving) * jump, node.theta,
                 node.q_x - ends.q_x, node.q_y - ends.q_y]
        if self.shape.kind == 'differential':
            equal.append(node.phi)
        rows = _cone(limits.slope, limits.touch_slack, j_n, j_t)
        if self.shape.kind != 'rolling':
            # Of the robot's rows, those of the vertex hold at a start that is taken as it is.
            rows += self._robot_rows(constants, limits, node, given[1][len(STEP_FIELDS) - 1])[:2]
        self.first_names = ['touch', 'touch', 'turn', 'speed'][:len(rows)]
        return ca.Function('first', [*given, self.common], [ca.vertcat(*equal),
                                                            ca.vertcat(*rows)])

    def _last(self, constants, ends):
        states = ca.SX.sym('final', self.shape.states)
        node = self._node(ca.vertsplit(states))
        x, y = origin(self.shape.kind, constants, node)
        rows = [x - ends.x, y - ends.y]
        delta, c_x, c_y = place(constants, node.theta, node.phi)
        if not self.shape.heading_free:
            rows.append(node.theta - ends.theta)
        if self.shape.straight:
            angle = delta + node.rho
            rows.append((ends.f_x - c_x) * ca.sin(angle) - (ends.f_y - c_y) * ca.cos(angle))
            if self.shape.kind == 'differential':
                rows.append(delta - ends.delta)
        return ca.Function('last', [states, self.common], [ca.vertcat(*rows)])


def origin(kind, constants, node):
    """
    Find the object's origin from the followed point.

    :param kind: one of ``push_planner.constants.KINDS``.
    :param constants: ``Constants``.
    :param node: ``Node``.
    :return: (x, y) in the object's start frame [m].
    """
    delta, c_x, c_y = place(constants, node.theta, node.phi)
    out = constants.radius if kind == 'rolling' else 0.0
    c, s = ca.cos(node.theta), ca.sin(node.theta)
    gamma = node.theta + delta
    return (node.q_x + out * ca.cos(gamma) - c * c_x + s * c_y,
            node.q_y + out * ca.sin(gamma) - s * c_x - c * c_y)


def _cone(slope, slack, along, across):
    return [slope * along - across + slack, slope * along + across + slack]
