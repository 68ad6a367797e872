"""
Does the robot do what it is commanded to do: commands and measured velocities compared.

Each ``DriveModels`` model says what velocity v the commands give. The residual to the measured
velocity, over its tolerance s, is summed up for every model by a one-sided CUSUM (Page 1954):

    g <- max(0, g + (max_i |v_measured,i - v_i| / s_i - 1) dt)

A base follows as long as one model explains its motion. It does not where g is above a threshold
for all those that have explained it until then: a model that fails while another one holds counts
no more for a while, so that delay and lag of the base are soon known. A base that is known to
follow more closely (``CloseFollowing``) is held to a closer tolerance, with a second g; and one
that keeps its velocity while its commands vary (``StuckTest``) does not follow, however little
they vary.

White noise leaves between two false alarms about exp(2 k h / q^2) samples (Siegmund 1985), where
-k and q are mean and deviation of the summands in steps, and h is the threshold in steps, 15 of
0.02 s. On all three axes with a deviation of 0.6 s that is never (k = 0.2, q = 0.36), with 0.7 s
(8 mm/s at rest, 20 mm/s at 0.15 m/s) every 40 minutes (k = 0.07, q = 0.42).
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_control.safety.close_following import CloseFollowing, LEVER
from push_control.safety.drive_models import DriveModels, RESPONSE_TIME
from push_control.safety.response_delay import ResponseDelay
from push_control.safety.status import SafetyReason, SafetyReport
from push_control.safety.stuck_test import StuckTest
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist

# Residual that is no fault: constant part [m/s], over the velocity along the same axis, over that
# of the wheels, and over the acceleration [s]; chosen: the noise of odometry, wheels that are not
# quite of the stated size or not of the same, and delays between those of the models.
SPEED_TOLERANCE = 0.012
AXIS_TOLERANCE = 0.08
WHEEL_TOLERANCE = 0.03
TIME_TOLERANCE = 0.035
# The same of a base that is known to follow closely: constant part [m/s], and over the parts by
# velocity above; chosen: noise of odometry, and half of the error of wheels.
CLOSE_SPEED_TOLERANCE = 0.009
CLOSE_RATIO = 0.5
# Rows of the sums, for the two tolerances.
STATED, CLOSE = 0, 1
# Sum at which a model does not explain the motion [s]; chosen: a base that fails is stopped within
# 0.3 s, and none that follows in hours of simulated drives, with other lags and delays.
THRESHOLD = 0.3
# Delay from which on it is named [s]; chosen: above the sum of those of the models and a lag, and
# between two steps of the search.
LATE_TIME = 0.425
# Sum below which a model explains the motion, so that others that do not are at fault [s]; chosen.
HOLDING_SUM = 0.1
# Greatest sum [s]; chosen: nothing is wrong half a second after the base follows again.
MAX_SUM = 0.9
# Greatest residual over the tolerance; chosen: one wrong message is no fault, nor are two.
MAX_RATIO = 8.0
# Time for which a model that has failed while another held counts no more [s]; chosen: the delay
# of a network stays as long.
MEMORY = 30.0
# Time of which the worst is reported [s]; chosen: longer than it takes to find a fault, by which
# time the robot may have been commanded to stand.
REPORTED_TIME = 1.0
# Steps of odometry longer than this are a gap [s]: nothing is known of the time between; chosen.
LONGEST_STEP = 0.5


@compiled
def sum_residuals(velocities: Any, rates: Any, measured: Any, ratios: Any, sums: Any,
                  dt: float) -> None:
    """
    Compare a measured velocity with those of the models, and sum up what is left.

    :param velocities: of the models, shape (m, 3) [m/s, m/s, rad/s].
    :param rates: how fast they change, shape (m, 3) [m/s^2, m/s^2, rad/s^2].
    :param measured: shape (3,).
    :param ratios: residuals over their tolerances, shape (m, 3), is written.
    :param sums: g of each model, with the stated tolerance and with the close one, shape (2, m),
        is written [s].
    :param dt: time since the last measurement [s].
    """
    for i in range(len(velocities)):
        wheels = (abs(velocities[i, 0]) + abs(velocities[i, 1])
                  + LEVER * abs(velocities[i, 2]))
        greatest = close = 0.0
        for j in range(3):
            unit = LEVER if j == 2 else 1.0
            steady = AXIS_TOLERANCE * unit * abs(velocities[i, j]) + WHEEL_TOLERANCE * wheels
            transient = TIME_TOLERANCE * unit * rates[i, j]
            residual = unit * abs(velocities[i, j] - measured[j])
            ratios[i, j] = residual / (SPEED_TOLERANCE + steady + transient)
            greatest = max(greatest, ratios[i, j])
            close = max(close, residual / (CLOSE_SPEED_TOLERANCE + CLOSE_RATIO * steady
                                           + transient))
        sums[STATED, i] = min(MAX_SUM, max(0.0, sums[STATED, i]
                                           + (min(greatest, MAX_RATIO) - 1.0) * dt))
        sums[CLOSE, i] = min(MAX_SUM, max(0.0, sums[CLOSE, i]
                                          + (min(close, MAX_RATIO) - 1.0) * dt))


@compiled
def find_nearest(sums: Any, excluded_until: Any, time: float, least: Any) -> int:
    """
    Find how well the motion is explained, and note which models do not while another does.

    :param sums: g of each model, with both tolerances, shape (2, m) [s].
    :param excluded_until: until when each does not count, shape (m,), is written [s].
    :param time: now [s].
    :param least: g of the best models, shape (2,), is written; above ``THRESHOLD`` none explains
        the motion [s].
    :return: number of the model that is nearest by the close tolerance.
    """
    least[:] = math.inf
    nearest = 0
    for i in range(len(excluded_until)):
        if excluded_until[i] <= time:
            least[STATED] = min(least[STATED], sums[STATED, i])
            if sums[CLOSE, i] < least[CLOSE]:
                least[CLOSE] = sums[CLOSE, i]
                nearest = i
    for i in range(len(excluded_until)):
        if least[STATED] > THRESHOLD:
            # The base may have changed, as one that has started again.
            excluded_until[i] = -math.inf
        elif least[STATED] < HOLDING_SUM and sums[STATED, i] > THRESHOLD:
            excluded_until[i] = time + MEMORY
    return nearest


class _Discrepancy(NamedTuple):
    """
    A velocity that is not as expected.

    :param time: of its odometry [s].
    :param ratio: greatest residual over its tolerance.
    :param axis: of that, of the ``Twist``.
    :param expected: by the commands.
    :param measured: by odometry.
    """

    time: float
    ratio: float
    axis: int
    expected: Twist
    measured: Twist


class MotionMonitor:
    """Compares the velocity of the robot with its commands."""

    def __init__(self, robot: RoundRobot) -> None:
        """
        Begin with a robot at rest.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._models = DriveModels(robot)
        self._delay = ResponseDelay(LEVER, LATE_TIME)
        count = len(self._models.velocities)
        # Of each model: residuals over their tolerances, their sums g [s], and until when it does
        # not count [s]; the least sums [s].
        self._ratios: FloatArray = np.zeros((count, 3))
        self._sums: FloatArray = np.zeros((2, count))
        self._excluded_until: FloatArray = np.full(count, -math.inf)
        self._least: FloatArray = np.zeros(2)
        self._following = CloseFollowing()
        self._stuck_test = StuckTest(count)
        self._time: float | None = None
        # Where it has lately followed least.
        self._worst: _Discrepancy | None = None
        # Whether the base may have got other commands than those that are known, and until when
        # it may follow them [s].
        self._is_interrupted = False
        self._unknown_until = -math.inf
        # Changes nothing; but loads machine code before the robot moves.
        self._compare(np.zeros(3), True, 0.0, 0.0)

    def _compare(self, measured: FloatArray, is_settled: bool, time: float, dt: float) -> int:
        """
        Compare a measured velocity with those of the models, and find how well they explain it.

        :param measured: (v_x, v_y, omega), shape (3,) [m/s, m/s, rad/s].
        :param is_settled: whether the close tolerance counts.
        :param time: now [s].
        :param dt: time since the last measurement [s].
        :return: as of ``find_nearest``.
        """
        sum_residuals(self._models.velocities, self._models.rates, measured, self._ratios,
                      self._sums, dt)
        if not is_settled:
            self._sums[CLOSE] = 0.0
        return find_nearest(self._sums, self._excluded_until, time, self._least)

    def reset(self) -> None:
        """Begin anew, at whatever velocity the robot has: somebody else has commanded it."""
        self._models.reset(STOP)
        self._time = None
        self._unknown_until = -math.inf

    def interrupt(self) -> None:
        """Begin anew at the next odometry: what the base has been sent meanwhile is not known."""
        self._is_interrupted = True

    def forgive(self) -> None:
        """Begin anew with a robot that stands as commanded."""
        self._worst = None
        self._sums[:] = 0.0
        self._stuck_test.clear()
        self._delay.clear()

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when [s], of the clock of odometry.
        """
        self._models.add_command(command, time)

    def check(self, odometry: Odometry) -> SafetyReport | None:
        """
        Compare a measured velocity with the commands before it.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: ``SafetyReport``, or None where the robot follows.
        """
        time, twist, last = odometry.time, odometry.twist, self._time
        if last is not None and time <= last:
            return None
        self._time = time
        if last is None or not self._models.is_commanded:
            self._restart(time, twist)
            return None
        if self._is_interrupted or time - last > LONGEST_STEP:
            self._restart(time, twist)
            self._unknown_until = time + RESPONSE_TIME
            return None
        self._models.update(time, time - last)
        if time < self._unknown_until:
            # It may still follow what it was sent before, or have stopped without commands.
            self._models.velocities[:] = twist
            return None
        self._delay.add(time, twist, self._models.nominal_velocity)
        measured = np.array(twist, dtype=np.float64)
        is_settled = self._following.is_settled(self._models.nominal_error, time)
        nearest = self._compare(measured, is_settled, time, time - last)
        self._stuck_test.add(self._models.velocities, self._models.rates, measured, time - last)
        is_stuck = is_settled and self._stuck_test.is_stuck(self._excluded_until, time)
        is_fault = self._is_unexplained(nearest, time - last, is_stuck)
        self._worst = self._find_worst(nearest, odometry)
        delay = self._delay.find(at_once=is_fault)
        if delay is not None:
            return SafetyReason.FOLLOWS_LATE.report(delay=delay)
        return self._report(self._worst) if is_fault else None

    def _restart(self, time: float, twist: Twist) -> None:
        """Let all models have the measured velocity, which somebody has commanded."""
        self._is_interrupted = False
        self._worst = None
        self._sums[:] = 0.0
        self._stuck_test.clear()
        self._models.reset(twist)
        self._delay.clear()
        self._delay.add(time, twist, twist)

    def _is_unexplained(self, nearest: int, dt: float, is_stuck: bool) -> bool:
        """Tell whether no model explains the motion as closely as this base is known to follow."""
        stated, close = self._least.tolist()
        velocity = Twist(*self._models.velocities[nearest].tolist())
        self._following.add(velocity, dt, is_close=close <= HOLDING_SUM)
        if stated > THRESHOLD:
            return True
        is_far = close > THRESHOLD and self._following.is_known(velocity)
        if self._following.has_given_up or not (is_far or is_stuck):
            return False
        self._following.give_up()
        return True

    def _find_worst(self, nearest: int, odometry: Odometry) -> _Discrepancy:
        """Find where the robot has lately followed least, by the model that is nearest."""
        ratios: list[float] = self._ratios[nearest].tolist()
        ratio, time, worst = max(ratios), odometry.time, self._worst
        if worst is not None and worst.ratio >= ratio and time < worst.time + REPORTED_TIME:
            return worst
        expected = Twist(*self._models.velocities[nearest].tolist())
        return _Discrepancy(time, ratio, ratios.index(ratio), expected, odometry.twist)

    def _report(self, found: _Discrepancy) -> SafetyReport:
        """Say what the robot did in place of what it should."""
        expected, measured = found.expected[found.axis], found.measured[found.axis]
        unit = LEVER if found.axis == 2 else 1.0
        is_short = abs(measured) < abs(expected) and (
            measured * expected >= 0.0 or unit * abs(measured) < 2.0 * SPEED_TOLERANCE)
        reason = SafetyReason.NOT_MOVING if is_short else SafetyReason.MOVES_OTHERWISE
        return reason.report(expected=_text(found.expected), measured=_text(found.measured))


def _text(twist: Twist) -> str:
    return f'({twist.v_x:.2f} m/s, {twist.v_y:.2f} m/s, {twist.omega:.2f} rad/s)'
