"""Constraints of one segment with their exact derivatives, as casadi functions."""

import casadi as ca
from push_planner.iterate import Bounds
from push_planner.stage import collocate, Constants, NODE, POINTS, robot_motion, switch

EQUALITIES = len(NODE) + POINTS
# What the rows that must not be negative stand for, in their order; the last repeats.
ROWS = (*2 * ('the yaw rate of the robot',), 'the speed of the robot',
        *2 * ('the range of normals at the vertex',), *2 * ('the friction cone at first touch',),
        'the friction cone')


class StageFunctions:
    """
    Value, slope and bend of the constraints of one segment.

    Outputs are the negative end node, the scaled residuals and the rows that must not be negative;
    inputs are (node, angle before, angle, length, rates), moving and the parameters.

    :param drive: the robot's drive.
    :param supports: number of supports.
    """

    def __init__(self, drive, supports):
        """Build the functions."""
        constants, flat = Constants.symbols(supports)
        limits = ca.SX.sym('limits', len(Bounds._fields))
        inputs, moving = ca.SX.sym('inputs', len(NODE) + 3 + POINTS), ca.SX.sym('moving')
        parts = ca.vertsplit(inputs)
        node, (before, angle, length) = tuple(parts[:len(NODE)]), parts[len(NODE):len(NODE) + 3]
        jump, j_n, j_t = switch(constants, node, before, angle, moving)
        end, residuals, forces = collocate(drive, constants, node, node[3] + jump, angle, length,
                                           parts[len(NODE) + 3:])
        friction = sum(support[2] for support in constants.terms.supports)
        # The impulse counts at the first touch only; elsewhere its rows are always kept.
        share = (1 - moving) / constants.terms.mass
        bounds = Bounds(*ca.vertsplit(limits))
        rows = _limits(bounds, end, robot_motion(drive, constants, angle, end[3]))
        rows += _cone(bounds, share * j_n + moving, share * j_t)
        for f_n, f_t in forces:
            rows += _cone(bounds, f_n / friction, f_t / friction)
        out = ca.vertcat(*[-value for value in end],
                         *[residual / friction for residual in residuals], *rows)
        given = [inputs, moving, ca.vertcat(flat, limits)]
        weights = ca.SX.sym('weights', out.numel())
        self.rows, self.width, self.parameters = out.numel(), inputs.numel(), given[2].numel()
        self.value = ca.Function('value', given, [out])
        self.slope = ca.Function('slope', given, [out, ca.densify(ca.jacobian(out, inputs))],
                                 {'cse': True})
        self.bend = ca.Function('bend', [*given, weights], [
            ca.densify(ca.hessian(ca.dot(weights, out), inputs)[0])], {'cse': True})


def _limits(bounds, end, motion):
    along, across, turn = motion
    offset = end[NODE.index('gamma')] - end[NODE.index('theta')]
    return [bounds.turn - turn, bounds.turn + turn,
            bounds.speed ** 2 - along ** 2 - across ** 2,
            offset - bounds.lowest, bounds.highest - offset]


def _cone(bounds, along, across):
    return [bounds.slope * along - across, bounds.slope * along + across]
