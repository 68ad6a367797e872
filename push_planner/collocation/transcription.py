"""
The push as a nonlinear programme in stages, as fatrop wants it.

States of a stage: way S of the free part and the ``Node``; inputs: change of the pushing angle and
w at the Radau points. Object, speeds, cone, start and goal are parameters, so that a programme is
built once per kind.
"""

import casadi as ca
import numpy as np
from push_planner.collocation.block_structure import Block, BlockStructuredNlp
from push_planner.collocation.collocation import (
    collocate, contact_impulse, Node, robot_speed, robot_yaw_rate, Step,
)
from push_planner.collocation.dimensions import BoundaryValues, Limits, POINTS, STEP_FIELDS
from push_planner.push_parameters import place, PushParameters

SMOOTHING = 0.02
SMOOTHNESS = 1e-3
PENALTY = 100.0


class Transcription:
    """
    Rows of a programme.

    :param shape: ``Dimensions``.
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    """

    def __init__(self, shape, smoothing=SMOOTHING):
        """Write them."""
        self.shape, self._smoothing = shape, smoothing
        push_parameters, flat = PushParameters.symbols(shape.supports)
        limits = ca.SX.sym('limits', len(Limits._fields))
        ends = ca.SX.sym('ends', len(BoundaryValues._fields))
        common = ca.vertcat(flat, limits, ends)
        fields = len(STEP_FIELDS) + shape.states - 1
        parts = self._parts(push_parameters, limits, ends, common)
        counts = [part.rows.size1_out(0) for part in parts]
        order, following = self._order(counts)
        self.names = [self._names[i] for i in order]
        self.equality = np.array([not name for name in self.names])
        sizes = shape.steps, shape.width, shape.states, fields, common.numel()
        changes = shape.states + shape.width * np.arange(shape.steps)
        self.nlp = BlockStructuredNlp(parts, sizes, order, following, lambda x: (
            SMOOTHNESS * ca.sumsqr(x[changes.tolist()]) + x[shape.width * shape.steps]))

    def _order(self, counts):
        """Rows in the order of fatrop: of each stage what follows, what is equal, what is not."""
        shape, (each, besides, _) = self.shape, counts
        n, states = shape.steps, shape.states
        stage, first = np.arange(each), each * n + np.arange(besides)
        equal = sum(not name for name in self._names[each * n:each * n + besides])
        order = [stage[:states], first[:equal], stage[states:states + POINTS], first[equal:],
                 stage[states + POINTS:]]
        order += [stage + each * k for k in range(1, n)] + [each * n + besides + np.arange(
            counts[2])]
        order = np.concatenate(order)
        place = np.argsort(order)
        rows = (each * np.arange(n)[:, None] + np.arange(states)).ravel()
        unknowns = (shape.width * np.arange(1, n + 1)[:, None] + np.arange(states)).ravel()
        return order, (place[rows], unknowns)

    def _node(self, states):
        w, rho, theta, q_x, q_y = states[1:6]
        phi = {'held': theta, 'rolling': 0.0}.get(self.shape.kind)
        return Node(w, rho, theta, q_x, q_y, states[6] if phi is None else phi)

    def _parts(self, push_parameters, limits, ends, common):
        shape = self.shape
        limits, ends = Limits(*ca.vertsplit(limits)), BoundaryValues(*ca.vertsplit(ends))
        z = ca.SX.sym('z', shape.width)
        parts = ca.vertsplit(z)
        node, change = self._node(parts), parts[shape.states]
        grid = ca.SX.sym('step', len(STEP_FIELDS) + shape.states - 1)
        rows, names = self._stage(push_parameters, limits, (parts, node), grid)
        first, first_names = self._first(grid, node, push_parameters, limits, ends)
        final = ca.SX.sym('final', shape.states)
        last = self._last(final, push_parameters, ends)
        self._names = names * shape.steps + first_names + [''] * last.numel()
        return (Block.of(z, [grid, common], rows, SMOOTHNESS * change ** 2),
                Block.of(z, [grid, common], first, 0.0), Block.of(final, [common], last, final[0]))

    def _stage(self, push_parameters, limits, here, grid):
        shape, (parts, node) = self.shape, here
        change, rates = parts[shape.states], parts[shape.states + 1:]
        length, share, square, slope, free, rate, pace = ca.vertsplit(grid[:len(STEP_FIELDS)])
        step = Step(length + share * parts[0], free * change, square, slope, shape.jumps,
                    self._smoothing)
        out = collocate(shape.kind, push_parameters, node, step, rates)
        friction = sum(support[2] for support in push_parameters.terms.supports)
        end = ca.vertcat(parts[0], *out.node[:shape.states - 1])
        end[1:] += grid[len(STEP_FIELDS):]
        rows = [row for force in out.forces
                for row in _cone(limits.slope, limits.slack, *(f / friction for f in force))]
        names = ['cone'] * len(rows)
        if not shape.jumps:
            reach = rate * step.length
            rows += [reach - change, reach + change]
            names += ['rate'] * 2
        rows += self._robot_rows(push_parameters, limits, out.node, pace)
        names += [] if shape.kind == 'rolling' else ['turn', 'speed']
        names += ['vertex'] * (len(rows) - len(names))
        residuals = [residual / friction for residual in out.residuals]
        return (ca.vertcat(-end, *residuals, *rows),
                [''] * (shape.states + len(residuals)) + names)

    def _robot_rows(self, push_parameters, limits, end, square):
        if self.shape.kind == 'rolling':
            return []
        turn = robot_yaw_rate(self.shape.kind, push_parameters, end.rho, end.w)
        rows = [limits.turn ** 2 - square * turn ** 2,
                limits.speed ** 2 - square * robot_speed(push_parameters, end.rho, turn)]
        if self.shape.kind == 'differential':
            delta, _, _ = place(push_parameters, end.theta, end.phi)
            rows += [delta - limits.lowest, limits.highest - delta]
        return rows

    def _first(self, grid, node, push_parameters, limits, ends):
        jump, j_n, j_t = contact_impulse(self.shape.kind, push_parameters, node)
        equal = [node.w - ends.moving * ends.w - (1.0 - ends.moving) * jump, node.theta,
                 node.q_x - ends.q_x, node.q_y - ends.q_y]
        if self.shape.kind == 'differential':
            equal.append(node.phi)
        rows = _cone(limits.slope, limits.touch_slack, j_n, j_t)
        if self.shape.kind != 'rolling':
            # Of the robot's rows, those of the vertex hold at a start that is taken as it is.
            rows += self._robot_rows(push_parameters, limits, node, grid[len(STEP_FIELDS) - 1])[:2]
        names = ['touch', 'touch', 'turn', 'speed'][:len(rows)]
        return ca.vertcat(*equal, *rows), [''] * len(equal) + names

    def _last(self, states, push_parameters, ends):
        node = self._node(ca.vertsplit(states))
        x, y = origin(self.shape.kind, push_parameters, node)
        rows = [x - ends.x, y - ends.y]
        delta, c_x, c_y = place(push_parameters, node.theta, node.phi)
        if not self.shape.heading_free:
            rows.append(node.theta - ends.theta)
        if self.shape.straight:
            angle = delta + node.rho
            rows.append((ends.f_x - c_x) * ca.sin(angle) - (ends.f_y - c_y) * ca.cos(angle))
            if self.shape.kind == 'differential':
                rows.append(delta - ends.delta)
        return ca.vertcat(*rows)


def origin(kind, push_parameters, node):
    """
    Find the object's origin from the followed point.

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
    :param push_parameters: ``PushParameters``.
    :param node: ``Node``.
    :return: (x, y) in the object's start frame [m].
    """
    delta, c_x, c_y = place(push_parameters, node.theta, node.phi)
    out = push_parameters.radius if kind == 'rolling' else 0.0
    c, s = ca.cos(node.theta), ca.sin(node.theta)
    gamma = node.theta + delta
    return (node.q_x + out * ca.cos(gamma) - c * c_x + s * c_y,
            node.q_y + out * ca.sin(gamma) - s * c_x - c * c_y)


def _cone(slope, slack, along, across):
    return [slope * along - across + slack, slope * along + across + slack]
