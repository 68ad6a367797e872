"""
From the programme's coarse optimum to a motion that is exact.

The optimum is followed segment by segment with the fine integration. Each segment's pushing angle
is corrected by a linear-quadratic law for the deviation so far (about 1e-3 rad), since the open
loop runs away from its path by ``exp(s / L)``.
"""

import functools

import casadi as ca
import numpy as np

from push_planner.iterate import RUN_IN_STEPS
from push_planner.rollout import Rollout
from push_planner.stage import collocate, Constants, NODE, POINTS, switch

WEIGHTS = np.diag([1.0, 1.0, 1.0, 0.0, 0.1, 0.0])
END_WEIGHTS = np.diag([1e4, 1e4, 1e4, 0.0, 1e2, 0.0])
EFFORT = 0.03


def refine(problem, solution, ends, smoothing):
    """
    Integrate an optimum finely, corrected towards its own nodes.

    :param problem: the ``PushProblem``.
    :param solution: ``Solution`` of the programme.
    :param ends: ``Ends`` of the push.
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    :return: list of (pushing angle [rad], length [m], ``Segment``).
    """
    segments = len(solution.angles)
    angles = np.concatenate([solution.angles, np.full(RUN_IN_STEPS, ends.last_angle)])
    lengths = np.concatenate([np.full(segments, solution.way / segments),
                              np.full(RUN_IN_STEPS, ends.run_in / RUN_IN_STEPS)])
    first = np.array([*ends.start[:3], 0.0, ends.start[3]])
    nodes = np.vstack([first, solution.nodes])
    gains = _gains(problem, nodes, angles, lengths, solution.rates)
    rollout = Rollout(problem, problem.settings.sample_spacing, smoothing)
    node, before, driven = first, None, []
    for k in range(segments):
        off = 0.0 if before is None else before - angles[k - 1]
        angle = angles[k] - float(gains[k] @ np.append(node - nodes[k], off))
        segment = rollout.segment(node, before, angle, lengths[k])
        driven.append((angle, lengths[k], segment))
        node, before = segment.nodes[-1], angle
    driven.append((ends.last_angle, ends.run_in,
                   rollout.segment(node, before, ends.last_angle, ends.run_in)))
    return driven


def _gains(problem, nodes, angles, lengths, rates):
    steps, free = len(angles), len(angles) - RUN_IN_STEPS
    linear = _linear(problem.robot.drive, len(problem.obj.supports)).map(steps)
    moving = np.ones(steps)
    moving[0] = 0.0
    previous = np.concatenate([[0.0], angles[:-1]])
    column = np.tile(Constants.of(problem).column()[:, None], steps)
    blocks = [np.array(block) for block in linear(nodes[:-1].T, previous, moving, angles, lengths,
                                                  rates.T, column)]
    size = len(NODE) + 1
    value, gains = END_WEIGHTS, [None] * steps
    for k in reversed(range(steps)):
        end_by_rates, end_by_rest, by_rates, by_rest = (
            block[:, k * block.shape[1] // steps:(k + 1) * block.shape[1] // steps]
            for block in blocks)
        # Columns: node, pushing angle before, pushing angle.
        total = end_by_rest - end_by_rates @ np.linalg.solve(by_rates, by_rest)
        keep = np.zeros((size, size))
        keep[:-1] = total[:, :size]
        act = np.append(total[:, size], 1.0)
        if k >= free:
            gains[k] = np.zeros(size)
            act = np.zeros(size)
        else:
            gains[k] = act @ value @ keep / (EFFORT + act @ value @ act)
        closed = keep - np.outer(act, gains[k])
        value = WEIGHTS + keep.T @ value @ closed
        value = 0.5 * (value + value.T)
    return gains


@functools.lru_cache(maxsize=16)
def _linear(drive, supports):
    constants, flat = Constants.symbols(supports)
    node, rates = ca.SX.sym('node', len(NODE)), ca.SX.sym('rates', POINTS)
    before, moving, angle, length = (ca.SX.sym(name) for name in
                                     ('before', 'moving', 'angle', 'length'))
    parts = tuple(ca.vertsplit(node))
    jump, _, _ = switch(constants, parts, before, angle, moving)
    end, residuals, _ = collocate(drive, constants, parts, parts[3] + jump, angle, length,
                                  ca.vertsplit(rates))
    end, residual = ca.vertcat(*end), ca.vertcat(*residuals)
    rest = ca.vertcat(node, before, angle)
    return ca.Function('linear', [node, before, moving, angle, length, rates, flat],
                       [ca.densify(ca.jacobian(a, b)) for a in (end, residual)
                        for b in (rates, rest)])
