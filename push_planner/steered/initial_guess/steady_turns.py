"""
Steady turns of an object that is pushed at a contact that stays in place: yaw rate and force.

In a steady turn w is constant, and the moment balance determines it from the direction of the
push. Inertia counts: the faster the push, the less the object turns. The ends of the range of
directions that the contact allows give the tightest turns to either side.
"""

import functools
import math
from typing import NamedTuple, Optional

import casadi as ca
import numpy as np
from push_model.geometry import FloatArray
from push_planner.steered.collocation.collocation import (
    IntegrationStep, moment_and_force, MotionPoint,
)
from push_planner.steered.initial_guess.buffered_function import BufferedFunction
from push_planner.steered.push_parameters import contact_frame, PushParameters, SupportLayout

# Directions in the table, and the largest of them [rad]. Chosen: 3.4 degrees apart, interpolated
# between; the largest is about 70 degrees, outside every friction cone.
DIRECTIONS = 41
MAX_STEERING_ANGLE = 1.2
# Halvings of the bracket of w. Chosen: 2^-24 of its width is far below what a guess needs.
HALVINGS = 24
# Sliding speed over the pushing speed below which friction becomes viscous. Chosen: smaller than
# that of the program, as no derivative is needed.
SMOOTHING = 1e-3
# Half-width of the bracket of w, times the distance from contact to mass centre. Chosen: several
# times 1 / distance, the yaw rate over speed of an object that turns about its mass centre.
BRACKET = 4.0
# Tolerance on the largest pushing angle [rad]: rounding.
ANGLE_ROUNDING = 1e-9


class SteadyTurn(NamedTuple):
    """
    A steady turn.

    :param steering_angle: alpha, from the line C to F to the push [rad].
    :param w: yaw rate over the pushing speed [1/m].
    """

    steering_angle: float
    w: float

    @property
    def curvature(self) -> float:
        """Curvature of the path of the flat output [1/m]."""
        return self.w / math.cos(self.steering_angle)


class ContactLimits(NamedTuple):
    """
    Limits of a contact, and the motion of its normal.

    :param slope: tangent of the half-angle of the cone, infinite where it does not count.
    :param max_angle: largest pushing angle [rad].
    :param lever: ``R_p cos(D)`` of a differential drive, whose heading sets the normal; 0 of a
        contact that is held on the object [m].
    :param heading_offset: D of a differential drive [rad].
    """

    slope: float
    max_angle: float
    lever: float = 0.0
    heading_offset: float = 0.0

    def steered_angles(self, rates: FloatArray) -> FloatArray:
        """
        Pushing angles at which a differential drive turns as fast as the object [rad].

        From ``w = sin(rho + D) / (R_p cos(D))``; about 90 degrees where it cannot.

        :param rates: w, shape (n,) [1/m].
        """
        return np.arcsin(np.clip(self.lever * rates, -1.0, 1.0)) - self.heading_offset


class SteadyTurns(NamedTuple):
    """
    Steady turns over the direction of the push.

    :param steering_angles: from the line C to F to the push, increasing, shape (n,) [rad].
    :param rates: w of each, shape (n,) [1/m].
    :param forces: (F_n, F_t) of each, shape (n, 2) [N].
    """

    steering_angles: FloatArray
    rates: FloatArray
    forces: FloatArray

    def limits(self, contact: ContactLimits,
               offset: float) -> Optional[tuple[SteadyTurn, SteadyTurn]]:
        """
        Find the steady turns at the ends of the range that the contact allows.

        :param offset: of the normal from the line C to F [rad].
        :return: ``SteadyTurn`` (to the left, to the right); None where straight ahead is outside.
        """
        held = self.steering_angles - offset
        rho = held if contact.lever == 0.0 else contact.steered_angles(self.rates)
        reserve = contact.max_angle + ANGLE_ROUNDING - np.abs(rho)
        if math.isfinite(contact.slope):
            # The forces are along the normal of a contact that is held.
            c, s = np.cos(held - rho), np.sin(held - rho)
            normal, tangential = (c * self.forces[:, 0] + s * self.forces[:, 1],
                                  c * self.forces[:, 1] - s * self.forces[:, 0])
            reserve = np.minimum(reserve, contact.slope * normal - np.abs(tangential))
        straight = len(self.steering_angles) // 2
        if not reserve[straight] >= 0.0:
            return None
        return self._end(reserve, straight, -1), self._end(reserve, straight, 1)

    def _end(self, reserve: FloatArray, straight: int, side: int) -> SteadyTurn:
        """Turn where the reserve becomes 0, or at the end of the table, to one side."""
        last = len(reserve) - 1
        here = straight
        while 0 < here < last and reserve[here + side] >= 0.0:
            here += side
        fraction = 0.0
        if 0 < here < last:
            fraction = reserve[here] / max(reserve[here] - reserve[here + side], 1e-12)
        beyond = min(max(here + side, 0), last)
        steering_angle, w = (values[here] + fraction * (values[beyond] - values[here])
                             for values in (self.steering_angles, self.rates))
        return SteadyTurn(float(steering_angle), float(w))


class TurnKey(NamedTuple):
    """
    Key of the steady turns: all on which they depend.

    :param supports: ``SupportLayout`` of the ``PushParameters``.
    :param column: the same as numbers.
    :param offset: of the normal from the line C to F [rad].
    :param v_squared: V [m^2/s^2].
    """

    supports: SupportLayout
    column: tuple[float, ...]
    offset: float
    v_squared: float


@functools.lru_cache(maxsize=64)
def turn_limits(key: TurnKey, contact: ContactLimits) -> Optional[tuple[SteadyTurn, SteadyTurn]]:
    """Find the tightest steady turns; see ``SteadyTurns.limits``."""
    return steady_turns(key).limits(contact, key.offset)


@functools.lru_cache(maxsize=64)
def steady_turns(key: TurnKey) -> SteadyTurns:
    """Tabulate the steady turns."""
    steering_angles: FloatArray = np.linspace(-MAX_STEERING_ANGLE, MAX_STEERING_ANGLE, DIRECTIONS,
                                              dtype=np.float64)
    rates, forces = _table(key.supports)(steering_angles[:, None] - key.offset, key.v_squared,
                                         np.array(key.column))
    return SteadyTurns(steering_angles, rates.ravel(), forces)


@functools.lru_cache(maxsize=16)
def _table(supports: SupportLayout) -> BufferedFunction:
    """Build the function (pushing angles, V, parameters) -> (w, forces), solved by bisection."""
    parameters, column = PushParameters.symbols(supports)
    angle, v_squared, w = ca.SX.sym('angle'), ca.SX.sym('v_squared'), ca.SX.sym('w')
    step = IntegrationStep(0.0, 0.0, v_squared, 0.0, False, SMOOTHING)
    # Contact and robot rotate with the object.
    balance = moment_and_force(parameters, MotionPoint(0.0, 0.0, w, angle, w), 0.0, 0.0, step, 0.0)
    inputs = [w, angle, v_squared, column]
    moment = ca.Function('moment', inputs, [balance.residual])
    forces = ca.Function('forces', inputs, [ca.vertcat(*balance.force)])
    _, c_x, c_y = contact_frame(parameters, 0.0, 0.0)
    bracket = BRACKET / ca.sqrt((parameters.terms.com_x - c_x) ** 2
                                + (parameters.terms.com_y - c_y) ** 2)
    low, high = -bracket, bracket
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        # The moment rises with w: friction and inertia both resist rotation.
        above = moment(middle, angle, v_squared, column) > 0.0
        low, high = ca.if_else(above, low, middle), ca.if_else(above, middle, high)
    root = 0.5 * (low + high)
    one = ca.Function('turn', [angle, v_squared, column],
                      [root, forces(root, angle, v_squared, column)])
    return BufferedFunction(one.map(DIRECTIONS))
