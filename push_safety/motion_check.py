"""
Fourth check: motion against commands, the velocity of the robot and what its commands mean.

Each ``DriveModels`` model says what velocity v the commands give. The residual to the measured
velocity, over its tolerance s, is summed up for every model by a one-sided CUSUM (Page 1954):

    g <- max(0, g + (max_i |v_measured,i - v_i| / s_i - 1) dt)

A base follows as long as one model explains its motion. It does not where g is above a threshold
for all those that have explained it until then: a model that fails while another one holds counts
no more for a while, so that delay and lag of the base are soon known. Three things are noticed
earlier than that:

* A base that is known to follow more closely (``CloseFollowing``) is held to a closer tolerance,
  with a second g.
* One that keeps its velocity while its commands vary (``StuckDetector``) does not follow, however
  little they vary.
* One that does what it was commanded to do a while ago (``LateDetector``) follows late.

White noise leaves between two false alarms about exp(2 k h / q^2) samples (Siegmund 1985), where
-k and q are mean and deviation of the summands in steps, and h is the threshold in steps, 15 of
0.02 s. On all three axes with a deviation of 0.6 s that is never (k = 0.2, q = 0.36), with 0.7 s
(8 mm/s at rest, 20 mm/s at 0.15 m/s) every 40 minutes (k = 0.07, q = 0.42).
"""

import math
from typing import Any, NamedTuple, Sequence

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.delay_search import DelaySearch
from push_safety.drive_models import DriveModels
from push_safety.status import SafetyReason, SafetyReport
from push_safety.tolerances import (
    AXIS_TOLERANCE, CLOSE_RATIO, CLOSE_SPEED_TOLERANCE, COMMAND_JUMP, LATE_VARIANCE_RATIO,
    LEARNING_TIME, LEVER_ARM, MAX_MOTION_GAP, MAX_RESIDUAL_SUM, MAX_RESPONSE_TIME, MIN_LATE_ERROR,
    MIN_LATENESS, SETTLING_TIME, SPEED_TOLERANCE, STUCK_EXCESS, STUCK_LATENESS, TIME_TOLERANCE,
    WHEEL_TOLERANCE)

# Rows of the sums, for the two tolerances.
STATED, CLOSE = 0, 1
# Sum below which a model explains the motion, so that others that do not are at fault [s]; chosen.
HOLDING_SUM = 0.1
# Greatest sum [s]; chosen: nothing is wrong half a second after the base follows again.
MAX_SUM = 0.9
# Sum above which a base that is known to follow closely may have changed [s]; chosen: a single
# measurement beyond its tolerance waits for the next.
CHANGED_SUM = 0.0
# Greatest sum while another check explains the motion [s]; chosen: a base that follows again is at
# fault for three measurements more.
EXPLAINED_SUM = MAX_RESIDUAL_SUM + 0.05
# Greatest residual over the tolerance; chosen: one wrong message is no fault, nor are two.
MAX_RATIO = 8.0
# Time for which a model that has failed while another held counts no more [s]; chosen: the delay
# of a network stays as long.
EXCLUSION_TIME = 30.0
# Time of which the worst is reported [s]; chosen: longer than it takes to find a fault, by which
# time the robot may have been commanded to stop.
REPORTED_TIME = 1.0
# Velocity of an axis that moves, so that it shows how the base follows [m/s]; chosen: above the
# noise of odometry.
MOVING_SPEED = 0.012

# Time constant T by which the past of ``StuckDetector`` is forgotten [s]; chosen: commands that
# vary slowly show in it, and a second or more noticed nothing sooner in simulated drives.
STUCK_MEMORY = 0.5
# E_0 [m^2/s]; chosen: twice Q_0, so that the noise of a few messages leaves it out of reach.
MAX_SUPPORT = 2.0 * STUCK_EXCESS
# Columns of the integrals of a model: Q_follows, Q_stuck, their weight [s], and X.
FOLLOWS, STUCK, WEIGHT, ACCELERATION, INTEGRAL_COUNT = 0, 1, 2, 3, 4
# Rows of the means of a model: of v - u, and of u.
DIFFERENCE, MEASURED = 0, 1

# History, longest delay and step of the search for a base that is late [s]; chosen.
LATE_HISTORY_TIME, MAX_LATENESS, LATENESS_STEP = 3.0, 1.2, 0.05
# Period of the search [s]; chosen: it takes a quarter of a millisecond, and a base that is late is
# stopped within 0.3 s of where that shows.
LATENESS_PERIOD = 0.2


@compiled
def sum_residuals(velocities: Any, rates: Any, measured: Any, ratios: Any, sums: Any,
                  dt: float) -> None:
    """
    Compare a measured velocity with those of the models, and sum up the residuals.

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
                  + LEVER_ARM * abs(velocities[i, 2]))
        stated = close = 0.0
        for j in range(3):
            unit = LEVER_ARM if j == 2 else 1.0
            steady = AXIS_TOLERANCE * unit * abs(velocities[i, j]) + WHEEL_TOLERANCE * wheels
            transient = TIME_TOLERANCE * unit * rates[i, j]
            residual = unit * abs(velocities[i, j] - measured[j])
            ratios[i, j] = residual / (SPEED_TOLERANCE + steady + transient)
            stated = max(stated, ratios[i, j])
            close = max(close, residual / (CLOSE_SPEED_TOLERANCE + CLOSE_RATIO * steady
                                           + transient))
        sums[STATED, i] = min(MAX_SUM, max(0.0, sums[STATED, i]
                                           + (min(stated, MAX_RATIO) - 1.0) * dt))
        sums[CLOSE, i] = min(MAX_SUM, max(0.0, sums[CLOSE, i]
                                          + (min(close, MAX_RATIO) - 1.0) * dt))


@compiled
def find_nearest(sums: Any, excluded_until: Any, time: float, least: Any) -> int:
    """
    Find how well the motion is explained, and note which models do not while another does.

    :param sums: g of each model, with both tolerances, shape (2, m) [s].
    :param excluded_until: until when each does not count, shape (m,), is written [s].
    :param time: now [s].
    :param least: g of the best models, shape (2,), is written; above ``MAX_RESIDUAL_SUM`` none
        explains the motion [s].
    :return: index of the model that is nearest by the close tolerance.
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
        if least[STATED] > MAX_RESIDUAL_SUM:
            # The base may have changed, as one that has started again.
            excluded_until[i] = -math.inf
        elif least[STATED] < HOLDING_SUM and sums[STATED, i] > MAX_RESIDUAL_SUM:
            excluded_until[i] = time + EXCLUSION_TIME
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


class CloseFollowing:
    """
    Notes along which axes, and for how long, a base has followed closely.

    What is tolerated of any base is more than most bases need. One that has kept a closer
    tolerance for some seconds, along every axis that moves, is held to it from then on. Where it
    leaves that tolerance, as under another load or with noise, it is known less well, and must
    keep it twice as long before it is held to it again. A base that has been stopped for it alone
    may be a good one under another load, or on a busy computer: that happens once, and then what
    any base may do counts.
    """

    def __init__(self) -> None:
        """Start with a base of which nothing is known."""
        self._durations = [0.0, 0.0, 0.0]
        self._learning_time = LEARNING_TIME
        self._was_far = False
        self._settled_at = -math.inf

    def is_settled(self, error: Sequence[float], time: float) -> bool:
        """
        Tell whether the base has come to follow its commands, or they have jumped just now.

        :param error: of the velocity of a nominal base against its command [m/s, m/s, rad/s].
        """
        if max(abs(error[0]), abs(error[1]), LEVER_ARM * abs(error[2])) > COMMAND_JUMP:
            self._settled_at = time + SETTLING_TIME
        return time >= self._settled_at

    def add(self, velocity: Twist, dt: float, *, is_close: bool) -> None:
        """
        Note how a base follows.

        :param velocity: of the model that is nearest.
        :param dt: for how long [s].
        """
        if not is_close:
            self._was_far = True
            return
        if self._was_far:
            self._was_far = False
            self._durations = [0.0, 0.0, 0.0]
            self._learning_time *= 2.0
        for axis, moves in enumerate(_moving_axes(velocity)):
            if moves:
                self._durations[axis] += dt

    def disable(self) -> None:
        """Never hold the base to more than the stated tolerance again."""
        self._learning_time = math.inf

    @property
    def is_disabled(self) -> bool:
        """Tell whether only the stated tolerance counts."""
        return math.isinf(self._learning_time)

    def is_known(self, velocity: Twist) -> bool:
        """Tell whether a base that moves so is known to follow closely; one at rest is not."""
        durations = [duration for duration, moves in zip(self._durations, _moving_axes(velocity))
                     if moves]
        return bool(durations) and min(durations) >= self._learning_time


def _moving_axes(velocity: Twist) -> tuple[bool, bool, bool]:
    v_x, v_y, omega = velocity
    return abs(v_x) > MOVING_SPEED, abs(v_y) > MOVING_SPEED, LEVER_ARM * abs(omega) > MOVING_SPEED


@compiled
def add_sample(velocities: Any, rates: Any, measured: Any, means: Any, integrals: Any,
               dt: float) -> None:
    """
    Continue means and integrals of all models by a sample.

    :param velocities: of the models, shape (m, 3) [m/s, m/s, rad/s].
    :param rates: how fast they change, shape (m, 3) [m/s^2, m/s^2, rad/s^2].
    :param measured: shape (3,).
    :param means: shape (m, 2, 3), is written [m/s].
    :param integrals: shape (m, 4), is written [m^2/s, m^2/s, s, m^2/s^3].
    :param dt: time since the last sample [s].
    """
    decay = math.exp(-dt / STUCK_MEMORY)
    for i in range(len(velocities)):
        weight = decay * integrals[i, WEIGHT] + dt
        part = dt / weight
        follows = stuck = acceleration = 0.0
        for j in range(3):
            unit = LEVER_ARM if j == 2 else 1.0
            difference = unit * (velocities[i, j] - measured[j]) - means[i, DIFFERENCE, j]
            change = unit * measured[j] - means[i, MEASURED, j]
            means[i, DIFFERENCE, j] += part * difference
            means[i, MEASURED, j] += part * change
            follows += difference * difference
            stuck += change * change
            acceleration += unit * unit * rates[i, j] * rates[i, j]
        # A sample shifts the mean as well, by its part.
        follows = decay * integrals[i, FOLLOWS] + dt * (1.0 - part) * follows
        stuck = decay * integrals[i, STUCK] + dt * (1.0 - part) * stuck
        support = 2.0 * stuck - follows
        ratio = MAX_SUPPORT / support if support > MAX_SUPPORT else 1.0
        integrals[i, FOLLOWS] = ratio * follows
        integrals[i, STUCK] = ratio * stuck
        integrals[i, WEIGHT] = ratio * weight
        integrals[i, ACCELERATION] = decay * integrals[i, ACCELERATION] + dt * acceleration


@compiled
def min_excess(integrals: Any, excluded_until: Any, time: float) -> float:
    """
    Find by how much worse the models that count explain the motion than a constant velocity.

    :param integrals: as of ``add_sample``.
    :param excluded_until: until when each model does not count, shape (m,) [s].
    :param time: now [s].
    :return: the least ``e - tau^2 X`` [m^2/s].
    """
    least = math.inf
    for i in range(len(excluded_until)):
        if excluded_until[i] <= time:
            least = min(least, integrals[i, FOLLOWS] - 2.0 * integrals[i, STUCK]
                        - STUCK_LATENESS * STUCK_LATENESS * integrals[i, ACCELERATION])
    return least


class StuckDetector:
    """
    Tells a base that keeps its velocity, as it is stuck at a command, from one that follows.

    Two explanations of the velocity u that was measured are compared: the base follows a model
    with velocity v, but for a constant difference; or it keeps a constant velocity, whatever v
    does. Their squared errors are integrated over the past, weighted with exp(-age / T), by

        Q_follows = C[v - u],    Q_stuck = C[u],    e = Q_follows - 2 Q_stuck

    where C is the integral of the squared deviations from the weighted mean. The base is stuck
    where e > Q_0 + tau^2 X for every model that has explained its motion until now, where X is the
    integral of the squared acceleration of the model: a base that follows later by tau differs by
    so much. That is so for no base that follows by more than 0.41 of what is commanded to it,
    whatever its wheels, loads and offsets are, and noise of odometry adds to Q_stuck what it adds
    to Q_follows.

    As in Page's test, what speaks for a model counts up to E_0 only: where e is below -E_0, all
    that was measured until then weighs less by E_0 / |e|. A base that has just followed a fast
    turn would otherwise count as following for as long as T.
    """

    def __init__(self, count: int) -> None:
        """Start without a past, for some number of models."""
        self._means: FloatArray = np.zeros((count, 2, 3))
        self._integrals: FloatArray = np.zeros((count, INTEGRAL_COUNT))
        # Changes nothing; but loads machine code before the robot moves.
        self.add(np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(3), 1.0)
        self.is_stuck(np.zeros(count), 0.0)
        self.clear()

    def clear(self) -> None:
        """Forget the past."""
        self._integrals[:] = 0.0

    def add(self, velocities: FloatArray, rates: FloatArray, measured: FloatArray,
            dt: float) -> None:
        """Take in a measured velocity, as ``add_sample`` does."""
        add_sample(velocities, rates, measured, self._means, self._integrals, dt)

    def is_stuck(self, excluded_until: FloatArray, time: float) -> bool:
        """
        Tell whether a constant velocity explains the motion better than every model.

        :param excluded_until: until when each model does not count, shape (m,) [s].
        """
        excess = min_excess(self._integrals, excluded_until, time)
        return STUCK_EXCESS < excess < math.inf


class LateDetector:
    """Looks now and then for a delay that is longer than any that is good."""

    def __init__(self) -> None:
        """Start without a history."""
        self._search = DelaySearch(history_time=LATE_HISTORY_TIME, max_delay=MAX_LATENESS,
                                   step=LATENESS_STEP)
        self._due = 0.0
        self._time = 0.0

    def clear(self) -> None:
        """Forget the history."""
        self._search.clear()

    def add(self, time: float, measured: Twist, nominal: Twist) -> None:
        """Note a velocity, and that of a drive that would follow at once."""
        if self._search.is_empty:
            self._due = time + LATENESS_PERIOD
        self._time = time
        self._search.add(time, measured, nominal)

    def find(self, *, at_once: bool) -> float | None:
        """
        Estimate the delay, where it is due.

        :param at_once: whether it is due now, as something is wrong.
        :return: the delay [s]; None where none explains what was measured.
        """
        # A robot that is at rest as it is commanded to be is not late any more.
        if not at_once and (self._time < self._due or self._search.is_at_rest):
            return None
        self._due = self._time + LATENESS_PERIOD
        # A delay that is longer than what is compared explains any motion.
        match = self._search.find(MIN_LATENESS)
        if match is None or match.delay < MIN_LATENESS:
            return None
        limit = LATE_VARIANCE_RATIO * min(match.undelayed_variance, match.measured_variance)
        return match.precise_delay if match.variance + MIN_LATE_ERROR ** 2 < limit else None


class MotionCheck:
    """Compares the velocity of the robot with its commands."""

    def __init__(self, robot: RoundRobot) -> None:
        """Start with a robot at rest, as stated."""
        self._models = DriveModels(robot)
        count = len(self._models.velocities)
        # Of each model: residuals over their tolerances, their sums g [s], and until when it does
        # not count [s]; the least sums [s].
        self._ratios: FloatArray = np.zeros((count, 3))
        self._sums: FloatArray = np.zeros((2, count))
        self._excluded_until: FloatArray = np.full(count, -math.inf)
        self._least: FloatArray = np.zeros(2)
        self._following = CloseFollowing()
        self._is_known = False
        self._stuck_detector = StuckDetector(count)
        self._late_detector = LateDetector()
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
        """Restart at whatever velocity the robot has: somebody else has commanded it."""
        self._models.reset(STOP)
        self._time = None
        self._unknown_until = -math.inf

    def interrupt(self) -> None:
        """Restart at the next odometry; commands sent in between are unknown."""
        self._is_interrupted = True

    def forgive(self) -> None:
        """Restart with a robot that is at rest as commanded."""
        self._worst = None
        self._sums[:] = 0.0
        self._stuck_detector.clear()
        self._late_detector.clear()

    @property
    def has_changed(self) -> bool:
        """Tell whether a base that is known to follow closely does not, be it a fault or not."""
        return self._is_known and float(self._least[CLOSE]) > CHANGED_SUM

    def limit_sums(self) -> None:
        """Let a base that follows again be at fault no longer, as another check explains it."""
        np.minimum(self._sums, EXPLAINED_SUM, out=self._sums)

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
        if self._is_interrupted or time - last > MAX_MOTION_GAP:
            self._restart(time, twist)
            self._unknown_until = time + MAX_RESPONSE_TIME
            return None
        self._models.update(time, time - last)
        if time < self._unknown_until:
            # It may still follow what it was sent before, or have stopped without commands.
            self._models.velocities[:] = twist
            return None
        self._late_detector.add(time, twist, self._models.nominal_velocity)
        measured = np.array(twist, dtype=np.float64)
        is_settled = self._following.is_settled(self._models.nominal_error, time)
        nearest = self._compare(measured, is_settled, time, time - last)
        self._stuck_detector.add(self._models.velocities, self._models.rates, measured,
                                 time - last)
        is_stuck = is_settled and self._stuck_detector.is_stuck(self._excluded_until, time)
        is_fault = self._is_unexplained(nearest, time - last, is_stuck)
        self._worst = self._find_worst(nearest, odometry)
        delay = self._late_detector.find(at_once=is_fault)
        if delay is not None:
            return SafetyReason.FOLLOWS_LATE.report(delay=delay)
        return self._report(self._worst) if is_fault else None

    def _restart(self, time: float, twist: Twist) -> None:
        """Let all models have the measured velocity, which somebody has commanded."""
        self._is_interrupted = False
        self._worst = None
        self._sums[:] = 0.0
        self._stuck_detector.clear()
        self._models.reset(twist)
        self._late_detector.clear()
        self._late_detector.add(time, twist, twist)

    def _is_unexplained(self, nearest: int, dt: float, is_stuck: bool) -> bool:
        """Tell whether no model explains the motion as closely as this base is known to follow."""
        stated, close = self._least.tolist()
        velocity = Twist(*self._models.velocities[nearest].tolist())
        self._following.add(velocity, dt, is_close=close <= HOLDING_SUM)
        self._is_known = self._following.is_known(velocity)
        if stated > MAX_RESIDUAL_SUM:
            return True
        is_far = close > MAX_RESIDUAL_SUM and self._is_known
        if self._following.is_disabled or not (is_far or is_stuck):
            return False
        self._following.disable()
        return True

    def _find_worst(self, nearest: int, odometry: Odometry) -> _Discrepancy:
        """Find where the robot has lately followed least, by the model that is nearest."""
        ratios: list[float] = self._ratios[nearest].tolist()
        ratio, time, worst = max(ratios), odometry.time, self._worst
        if worst is not None and worst.ratio >= ratio and time < worst.time + REPORTED_TIME:
            return worst
        expected = Twist(*self._models.velocities[nearest].tolist())
        return _Discrepancy(time, ratio, ratios.index(ratio), expected, odometry.twist)

    def _report(self, worst: _Discrepancy) -> SafetyReport:
        """Say what the robot did in place of what it should."""
        expected, measured = worst.expected[worst.axis], worst.measured[worst.axis]
        unit = LEVER_ARM if worst.axis == 2 else 1.0
        is_short = abs(measured) < abs(expected) and (
            measured * expected >= 0.0 or unit * abs(measured) < 2.0 * SPEED_TOLERANCE)
        reason = SafetyReason.NOT_MOVING if is_short else SafetyReason.MOVES_OTHERWISE
        return reason.report(expected=_text(worst.expected), measured=_text(worst.measured))


def _text(twist: Twist) -> str:
    return f'({twist.v_x:.2f} m/s, {twist.v_y:.2f} m/s, {twist.omega:.2f} rad/s)'
