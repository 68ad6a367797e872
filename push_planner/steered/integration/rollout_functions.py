"""
Functions of a rollout: one part of a step, and what surrounds the parts.

A part is a Radau step of three points (see ``collocation``), solved by Newton's method: a row of a
``push_dynamics.machine_code.RowFunction``.
"""

import functools
import math
from typing import Any, NamedTuple

import casadi as ca
from push_dynamics.machine_code import RowFunction
from push_model.dynamics import SMOOTHING
from push_planner.steered.collocation.collocation import (
    collocate, contact_impulse, force_at_start, IntegrationStep, Node, radau,
)
from push_planner.steered.collocation.dimensions import StepData
from push_planner.steered.push_parameters import PushKind, PushParameters, SupportLayout

# Radau points of a part. Chosen: order 5 at its end.
POINTS = 3
# Newton iterations of a part. Measured: the durations of 84 pushes are within 2e-9 of those with
# six, also where w jumps and the guess is that it stays; with two iterations within 8e-7.
# With the derivatives of the second iteration in the third, parts take a tenth less time, but 1.7
# times as many are divided, and 156 pushes of 13 kinds take as long (mean).
NEWTON_STEPS = 3
NODE_SIZE = len(Node._fields)
# Numbers of a ``RolloutStep``.
STEP_SIZE = 2 * NODE_SIZE + 5
# Steps back of a rollout that are rounding [m].
ROUNDING = 1e-9


class Checks(NamedTuple):
    """
    Checks of a rollout.

    :param total: sum of all samples, path lengths and V, which is finite where they are.
    :param force_ratio: largest |F_t| / F_n; infinite where the contact pulls.
    :param least_length: length of the shortest step [m].
    :param least_v_squared: least V [m^2/s^2].
    """

    total: Any
    force_ratio: Any
    least_length: Any
    least_v_squared: Any

    @property
    def is_sound(self) -> bool:
        """Tell whether all of the rollout is finite, and its path never goes back."""
        return (math.isfinite(self.total) and self.least_length > -ROUNDING
                and self.least_v_squared >= 0.0)


class RolloutStep(NamedTuple):
    """
    A step of a rollout, as symbols; its numbers are a row of as many columns.

    :param reference: ``Node`` that it is to begin at.
    :param gains: K, of the correction of the change.
    :param change: of the pushing angle [rad].
    :param length: path length [m].
    :param v_squared: V at the start [m^2/s^2].
    :param v_squared_slope: dV/ds [m/s^2].
    :param smoothing: sliding speed below which friction becomes viscous, per pushing speed.
    """

    reference: Any
    gains: Any
    change: Any
    length: Any
    v_squared: Any
    v_squared_slope: Any
    smoothing: Any


@functools.lru_cache(maxsize=16)
def part_function(kind: PushKind, supports: SupportLayout, jumps: bool) -> RowFunction:
    """
    Build one part of a step, which goes on from the one before.

    ``state`` is a node, dw/ds, and the change of the pushing angle over the step. ``step`` is the
    ``RolloutStep`` that the part belongs to, ``part`` its fraction of it and that of what lies
    before it. At the start of a step the change is corrected towards the reference, and the
    pushing angle may jump; where ``restarts`` is 1 the node there is the reference itself. Results
    are the state after the part, the node at its start, samples and forces at its points, the
    force at its start, and what remains of the residual over the supports' friction.

    :param kind: how the contact moves with the robot.
    :param jumps: whether the pushing angle jumps at the start of a step.
    """
    parameters, column = PushParameters.symbols(supports)
    state = ca.SX.sym('state', NODE_SIZE + 2)
    of_step, part, restarts = ca.SX.sym('step', STEP_SIZE), ca.SX.sym('part', 2), ca.SX.sym('r')
    values = RolloutStep(of_step[:NODE_SIZE], of_step[NODE_SIZE:2 * NODE_SIZE],
                         *ca.vertsplit(of_step[2 * NODE_SIZE:]))
    fraction, before = ca.vertsplit(part)
    is_start = before == 0.0
    present = ca.if_else(is_start * restarts, values.reference, state[:NODE_SIZE])
    corrected = ca.if_else(
        is_start, values.change - ca.dot(values.gains, present - values.reference),
        state[NODE_SIZE + 1])
    node, along = Node(*ca.vertsplit(present)), corrected * fraction
    if jumps:
        response = contact_impulse(kind, parameters, node, corrected)
        node = node._replace(w=node.w + is_start * response.w_jump,
                             rho=node.rho + is_start * corrected)
        along = 0.0
    start = ca.vertcat(*node)
    if kind == 'held':
        node = node._replace(phi=node.theta)
    length = fraction * values.length
    v_squared = values.v_squared + values.v_squared_slope * before * values.length
    step = IntegrationStep(length, along, v_squared, values.v_squared_slope, False,
                           values.smoothing)
    # Within a step w goes on smoothly, and so does the guess.
    w_slope = (1.0 - is_start) * state[NODE_SIZE]
    rates = _solved_rates(kind, parameters, node, step, w_slope)
    result = collocate(kind, parameters, node, step, ca.vertsplit(rates))
    first_force = force_at_start(kind, parameters, node, step)
    end_slope = ca.dot(ca.DM(radau(POINTS).inverse[-1]), rates - node.w) / length
    friction = sum(support[2] for support in parameters.terms.supports)
    residual = ca.norm_inf(ca.vertcat(*result.residuals)) / friction
    inputs = {'state': state, 'step': of_step, 'part': part, 'restarts': restarts,
              'column': column}
    outputs: Any = ca.cse([ca.vertcat(*result.end, end_slope, corrected), start,
                           ca.vertcat(*[ca.vertcat(*sample) for sample in result.samples]),
                           ca.vertcat(*[ca.vertcat(*force) for force in result.forces]),
                           ca.vertcat(*first_force), residual])
    return RowFunction(ca.Function(
        'part', list(inputs.values()), outputs, list(inputs),
        ['next_state', 'start', 'samples', 'forces', 'first_force', 'residual']),
        gathered=['step'])


def _solved_rates(kind: PushKind, parameters: PushParameters, node: Node, step: IntegrationStep,
                  w_slope: Any) -> Any:
    """Solve the moment balance for w at the points by Newton's method, guessed by a slope."""
    unknowns = ca.SX.sym('rates', POINTS)
    residual = ca.vertcat(*collocate(kind, parameters, node, step,
                                     ca.vertsplit(unknowns)).residuals)
    improved = unknowns - ca.solve(ca.jacobian(residual, unknowns), residual)
    rates = node.w + w_slope * step.length * ca.DM(radau(POINTS).points)
    for _ in range(NEWTON_STEPS):
        rates = ca.substitute(improved, unknowns, rates)
    return rates


class StepFunctions(NamedTuple):
    """
    Functions around the parts of a rollout.

    :param prepare: ``RolloutStep`` of each step, and path length up to its end.
    :param pick_node: node of a state.
    :param pick_change: change of the pushing angle of a state.
    :param sampling: path length and V at the points of each part, and ``Checks``.
    """

    prepare: RowFunction
    pick_node: RowFunction
    pick_change: RowFunction
    sampling: RowFunction


@functools.lru_cache(maxsize=1)
def step_functions() -> StepFunctions:
    """Build what surrounds the parts of a rollout."""
    node, gains, change = ca.SX.sym('node', NODE_SIZE), ca.SX.sym('gains', 7), ca.SX.sym('change')
    data, speeds = ca.SX.sym('data', len(StepData._fields)), ca.SX.sym('speeds', 2)
    free_length, start = ca.SX.sym('free_length'), ca.SX.sym('start')
    of_step = StepData(*ca.vertsplit(data))
    length = of_step.length + of_step.free_fraction * free_length
    # The friction of the model becomes viscous below a speed in m/s, here it is per speed.
    smoothing = SMOOTHING / ca.sqrt(ca.fmax(speeds[0], of_step.v_squared_end))
    inputs = {'node': node, 'gains': gains, 'change': change, 'data': data, 'speeds': speeds,
              'free_length': free_length, 'start': start}
    step = RolloutStep(node, gains[:NODE_SIZE], change, length, of_step.v_squared,
                       of_step.v_squared_slope, smoothing)
    prepare = ca.Function('prepare', list(inputs.values()), [ca.vertcat(*step), start + length],
                          list(inputs), ['step', 'end'])
    state = ca.SX.sym('state', NODE_SIZE + 2)
    pick_node, pick_change = (
        RowFunction(ca.Function('pick', [state], [picked], ['state'], ['picked']),
                    is_independent=True, gathered=['state'])
        for picked in (state[:NODE_SIZE], state[NODE_SIZE + 1]))
    return StepFunctions(RowFunction(prepare), pick_node, pick_change, _sampling())


def _sampling() -> RowFunction:
    """Build path length and V at the points of a part, and what is checked of it."""
    step, speeds = ca.SX.sym('step', STEP_SIZE), ca.SX.sym('speeds', 2)
    part, start = ca.SX.sym('part', 2), ca.SX.sym('start')
    samples, forces = ca.SX.sym('samples', POINTS * NODE_SIZE), ca.SX.sym('forces', POINTS * 2)
    first, before = ca.SX.sym('first_force', 2), ca.SX.sym('before', len(Checks._fields))
    accumulated, length = Checks(*ca.vertsplit(before)), step[2 * NODE_SIZE + 1]
    s = length * (part[1] + part[0] * ca.DM(radau(POINTS).points))
    v_squared = speeds[0] + speeds[1] * s
    pairs = ca.reshape(ca.vertcat(first, forces), 2, POINTS + 1)
    normal, tangential = pairs[0, :], pairs[1, :]
    ratios = ca.if_else(normal > 0.0, ca.fabs(tangential) / normal, ca.inf)
    checks = Checks(accumulated.total + ca.sum1(ca.vertcat(samples, start + s, v_squared)),
                    ca.fmax(accumulated.force_ratio, ca.mmax(ratios)),
                    ca.fmin(accumulated.least_length, length),
                    ca.fmin(accumulated.least_v_squared, ca.mmin(v_squared)))
    # Where the ratio changes much it may be steeper between the points.
    inside = (tangential / normal)[1:]
    ratio_bound = ca.mmax(ca.fabs(inside)) + ca.mmax(inside) - ca.mmin(inside)
    inputs = {'step': step, 'speeds': speeds, 'start': start, 'part': part, 'samples': samples,
              'forces': forces, 'first_force': first, 'before': before}
    return RowFunction(ca.Function(
        'sampling', list(inputs.values()),
        [start + s, v_squared, ca.vertcat(*checks), ratio_bound],
        list(inputs), ['s', 'v_squared', 'accumulated', 'ratio_bound']),
        gathered=['step', 'speeds', 'start'])
