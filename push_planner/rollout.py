"""
The push integrated finely, segment by segment, for given pushing angles.

After each switch of the pushing angle w settles within millimetres when slow: steps begin short
and grow.
"""

import functools
from typing import NamedTuple

import casadi as ca
import numpy as np

from push_planner.stage import collocate, Constants, NODE, POINTS, radau, switch

NEWTON_STEPS = 5
GROWTH = 1.6


class Segment(NamedTuple):
    """
    One segment of constant pushing angle, integrated.

    :param begin: node after the jump, shape (5,), see ``push_planner.stage.NODE``.
    :param ways: way from the segment's begin to the ends of the steps, shape (k,) [m].
    :param nodes: nodes at the ends of the steps, shape (k, 5).
    :param forces: (F_n, F_t) at the Radau points, shape (k * POINTS, 2) [N].
    :param force_ways: ways of the same points, shape (k * POINTS,) [m].
    :param impulse: (jump of w [1/m], J_n, J_t [N s]) at its begin.
    """

    begin: np.ndarray
    ways: np.ndarray
    nodes: np.ndarray
    forces: np.ndarray
    force_ways: np.ndarray
    impulse: tuple


class Rollout:
    """
    Integrate segments of a push.

    :param problem: the ``PushProblem``.
    :param spacing: longest step [m].
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    :param first: first step after a switch, or None for one that resolves the settling [m].
    """

    def __init__(self, problem, spacing, smoothing, first=None):
        """Take what stays the same."""
        self._speed = problem.settings.pushing_speed
        self._constants = Constants.of(problem)
        self._column = self._constants.column()
        self._spacing, self._smoothing = spacing, smoothing
        self._kind = problem.robot.drive, len(problem.obj.supports)
        self._first = 0.3 * settling_way(problem) if first is None else first

    def segment(self, node, before, angle, length):
        """
        Integrate one segment.

        :param node: node at its begin, before the jump, shape (5,).
        :param before: pushing angle before, or None at the first touch [rad].
        :param angle: pushing angle of the segment [rad].
        :param length: way of the contact [m].
        :return: ``Segment``.
        """
        moving = 0.0 if before is None else 1.0
        jump, j_n, j_t = (float(value) for value in switch(self._constants, node, before or 0.0,
                                                           angle, moving))
        begin = np.array(node, dtype=float)
        begin[NODE.index('w')] += jump
        steps = graded(length, self._first, self._spacing)
        nodes, forces = _advance(*self._kind, len(steps))(begin, angle, steps[None, :],
                                                          self._smoothing, self._column)
        nodes = np.array(nodes).T
        ways = np.cumsum(steps)
        points = (ways - steps)[:, None] + steps[:, None] * radau()[0]
        return Segment(begin, ways, nodes, np.array(forces).T.reshape(-1, 2), points.ravel(),
                       (jump, j_n / self._speed, j_t / self._speed))


def settling_way(problem):
    """
    Way over which the turning rate settles after a switch, ``v^2 (I/m + r^2) / (mu g r L)`` [m].

    :param problem: the ``PushProblem``.
    """
    vehicle = problem.vehicle
    obj = problem.obj
    inertia = obj.inertia + obj.mass * vehicle.arm ** 2
    friction = sum(obj.capacities) * vehicle.arm * vehicle.wheelbase
    return problem.settings.pushing_speed ** 2 * inertia / friction


def graded(length, first, longest):
    """
    Divide a way into steps that grow to a longest one.

    :param length: the way [m].
    :param first: about the first step [m].
    :param longest: the longest step [m].
    :return: steps, summing to the way.
    """
    steps = [min(first, longest, length)]
    while steps[-1] < longest and sum(steps) < length:
        steps.append(min(longest, GROWTH * steps[-1]))
    rest = length - sum(steps)
    if rest > 0.0:
        count = int(np.ceil(rest / longest))
        steps += [rest / count] * count
    return np.array(steps) * (length / sum(steps))


@functools.lru_cache(maxsize=64)
def _advance(drive, supports, count):
    step = _step(drive, supports)
    return step.mapaccum('advance', count) if count > 1 else step


@functools.lru_cache(maxsize=16)
def _step(drive, supports):
    constants, flat = Constants.symbols(supports)
    node, rates = ca.SX.sym('node', len(NODE)), ca.SX.sym('rates', POINTS)
    angle, length, smoothing = (ca.SX.sym(name) for name in ('angle', 'length', 'smoothing'))
    parts = tuple(ca.vertsplit(node))
    end, residuals, forces = collocate(drive, constants, parts, parts[3], angle, length,
                                       ca.vertsplit(rates), smoothing)
    residual = ca.vertcat(*residuals)
    given = [node, angle, length, smoothing, flat]
    newton = ca.Function('newton', [rates, *given],
                         [rates - ca.solve(ca.jacobian(residual, rates), residual)])
    finish = ca.Function('finish', [rates, *given],
                         [ca.vertcat(*end), ca.vertcat(*[c for force in forces for c in force])])
    found = ca.repmat(parts[3], POINTS, 1)
    for _ in range(NEWTON_STEPS):
        found = newton(found, *given)
    return ca.Function('step', given, list(finish(found, *given)))
