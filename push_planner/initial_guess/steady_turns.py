"""
Steady turns of an object pushed at a contact that stays in place: turning rate and force.

Inertia counts: at speed an object turns less. The ends of the range that the contact allows give
the tightest turns to either side.
"""

import functools
import math
from typing import NamedTuple

import casadi as ca
import numpy as np
from push_planner.collocation.collocation import balance, Step
from push_planner.collocation.nlp_solver import Buffered
from push_planner.push_parameters import PARAMETER_COUNT, place, PushParameters

ANGLES = 41
STEEPEST = 1.2
HALVINGS = 24
SMOOTHING = 1e-3


class SteadyTurn(NamedTuple):
    """
    A steady turn.

    :param steering_angle: angle from the line C to F to the push [rad].
    :param w: turning rate over the pushing speed [1/m].
    """

    steering_angle: float
    w: float

    @property
    def curvature(self):
        """Curvature of the way of the flat point [1/m]."""
        return self.w / math.cos(self.steering_angle)


class SteadyTurns(NamedTuple):
    """
    Steady turns over the angle of the push.

    :param steers: angles from the line C to F to the push, shape (n,) [rad].
    :param rates: w of each, shape (n,) [1/m].
    :param forces: (F_n, F_t) of each, shape (n, 2) [N].
    """

    steers: np.ndarray
    rates: np.ndarray
    forces: np.ndarray

    def limits(self, slope, widest, offset):
        """
        Find the steady turns at the ends of what the contact allows.

        :param slope: tangent of the half-angle of the cone, infinite where it does not count.
        :param widest: largest pushing angle [rad].
        :param offset: of the normal from the line C to F [rad].
        :return: ``SteadyTurn`` (to the left, to the right); None where straight ahead is not
            allowed itself.
        """
        inside = np.abs(self.steers - offset) <= widest + 1e-9
        room = np.minimum(widest - np.abs(self.steers - offset), np.inf)
        if math.isfinite(slope):
            room = np.minimum(room, slope * self.forces[:, 0] - np.abs(self.forces[:, 1]))
            inside = room >= 0.0
        middle = len(self.steers) // 2
        if not inside[middle]:
            return None
        return self._end(room, middle, -1), self._end(room, middle, 1)

    def _end(self, room, middle, side):
        here = middle
        while 0 < here < len(room) - 1 and room[here + side] >= 0.0:
            here += side
        share = 0.0
        if 0 < here < len(room) - 1:
            share = room[here] / max(room[here] - room[here + side], 1e-12)
        after = min(max(here + side, 0), len(room) - 1)
        steering_angle, w = (values[here] + share * (values[after] - values[here])
                             for values in (self.steers, self.rates))
        return SteadyTurn(float(steering_angle), float(w))


@functools.lru_cache(maxsize=64)
def steady_turns(problem_key):
    """
    Tabulate the steady turns.

    :param problem_key: ``TurnKey``.
    :return: ``SteadyTurns``.
    """
    steers = np.linspace(-STEEPEST, STEEPEST, ANGLES)
    supports = (len(problem_key.column) - PARAMETER_COUNT) // 3
    column = np.array(problem_key.column)
    rates, forces = _table(supports)(steers[:, None] - problem_key.offset, problem_key.square,
                                     column)
    return SteadyTurns(steers, rates.ravel(), forces)


class TurnKey(NamedTuple):
    """
    What steady turns depend on.

    :param column: the ``PushParameters`` as numbers.
    :param offset: of the normal from the line C to F [rad].
    :param square: V [m^2/s^2].
    """

    column: tuple
    offset: float
    square: float


@functools.lru_cache(maxsize=16)
def _table(supports):
    push_parameters, flat = PushParameters.symbols(supports)
    angle, square, w = ca.SX.sym('angle'), ca.SX.sym('square'), ca.SX.sym('w')
    step = Step(0.0, 0.0, square, 0.0, False, SMOOTHING)
    residual, force, _ = balance(push_parameters, (0.0, 0.0, w, angle, w), 0.0, 0.0, step, 0.0)
    given = [w, angle, square, flat]
    moment = ca.Function('moment', given, [residual])
    forces = ca.Function('forces', given, [ca.vertcat(*force)])
    # The moment rises with w: friction and inertia both resist turning.
    _, c_x, c_y = place(push_parameters, 0.0, 0.0)
    reach = 4.0 / ca.sqrt((push_parameters.terms.com_x - c_x) ** 2 + (push_parameters.terms.com_y - c_y) ** 2)
    low, high = -reach, reach
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = moment(middle, angle, square, flat) > 0.0
        low, high = ca.if_else(above, low, middle), ca.if_else(above, middle, high)
    found = 0.5 * (low + high)
    one = ca.Function('turn', [angle, square, flat], [found, forces(found, angle, square, flat)])
    return Buffered(one.map(ANGLES))
