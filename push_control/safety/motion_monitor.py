"""
Does the robot do what it is commanded to do: commands and measured velocities compared.

A drive that follows its commands with some delay, lag and acceleration has a velocity between
two bounds, for every axis. Both follow the commands of the last ``RESPONSE_TIME``:

    high:  at once to their maximum where that is higher, else towards it with the slowest lag
    low:   likewise to their minimum

What the robot drives outside of the bounds, beyond a tolerance, is summed up as a distance, of
which a little is forgiven at any time. A robot that is too slow may be held by something, and has
more patience than one that moves on its own.

A delay that is longer than that shows in the last seconds: shifted by it, the response of a drive
that follows as it should is what was measured.
"""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_control.safety.status import SafetyReason, SafetyReport
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, Twist

# Delay with which a drive may begin to follow, odometry included [s]; chosen: above the latencies
# of bases that are driven over a network (0.05 to 0.2 s).
RESPONSE_TIME = 0.3
# How slowly it may follow then: lag over the nominal one, and besides [s], and acceleration over
# the limit; chosen: loaded bases are slower than stated.
LAG_RATIO = 2.0
LAG_MARGIN = 0.05
ACCELERATION_RATIO = 0.5
# Velocity beyond the bounds that is no fault: constant part [m/s], and over the speed; chosen: the
# noise of odometry, and wheels that are not quite of the stated size.
SPEED_TOLERANCE = 0.03
RELATIVE_TOLERANCE = 0.25
# Lever by which a rotation counts as a distance [m]; chosen: a radius of the robots.
LEVER = 0.2
# Distance driven outside of the bounds that is forgiven [m/s]; chosen: a third of the tolerance.
FORGIVEN_SPEED = 0.01
# Distance driven outside of the bounds at which it is a fault, for a robot that moves otherwise
# than commanded and for one that does not move [m]; chosen: with 0.3 m/s after 0.1 s and 0.3 s.
MAX_EXCESS = 0.02
MAX_SHORTFALL = 0.05
# History in which the delay is looked for, longest delay, and step of the search [s]; chosen.
HISTORY_TIME = 3.0
MAX_DELAY = 1.2
DELAY_STEP = 0.05
# Period of the search [s]; chosen: it takes a millisecond.
DELAY_PERIOD = 0.5
# A delay is the reason where it leaves less than this part of the variance, and of what is left
# without one, and where the velocity varies enough [m/s]; chosen.
EXPLAINED_RATIO = 0.3
LEAST_VARIATION = 0.03
# Steps of odometry longer than this are a gap [s]: nothing is known of the time between; chosen.
LONGEST_STEP = 0.5


class _Sample(NamedTuple):
    """A velocity from a time on [s]."""

    time: float
    twist: Twist


class _Axis:
    """Bounds of the velocity along one axis, or of the yaw rate."""

    def __init__(self, acceleration: float, time_constant: float) -> None:
        self._acceleration = acceleration
        self._time_constant = time_constant
        # Bounds, and the velocity of a drive that follows as it should.
        self.low = self.high = self.nominal = 0.0

    def reset(self, measured: float) -> None:
        self.low = self.high = self.nominal = measured

    def update(self, commands: tuple[float, ...], dt: float) -> None:
        """Move the bounds towards the least and the greatest of the last commands."""
        least, greatest = min(commands), max(commands)
        acceleration = ACCELERATION_RATIO * self._acceleration
        lag = LAG_RATIO * self._time_constant + LAG_MARGIN
        self.high = max(greatest, self.high - _change(self.high - greatest, acceleration, lag, dt))
        self.low = min(least, self.low + _change(least - self.low, acceleration, lag, dt))
        error = commands[-1] - self.nominal
        self.nominal += math.copysign(_change(abs(error), self._acceleration, self._time_constant,
                                              dt), error)

    def excess(self, measured: float, tolerance: float) -> tuple[float, float]:
        """Return by how much a velocity is beyond the bounds: in motion, and short of it."""
        above, below = measured - self.high, self.low - measured
        beyond = max(above, below) - tolerance
        if beyond <= 0.0:
            return 0.0, 0.0
        bound = self.high if above > below else self.low
        is_short = (abs(measured) < abs(bound)
                    and (measured * bound >= 0.0 or abs(measured) < tolerance))
        return (0.0, beyond) if is_short else (beyond, 0.0)


def _change(error: float, acceleration: float, time_constant: float, dt: float) -> float:
    """Return by how much an error, at least 0, decays in a time."""
    decayed = -math.expm1(-dt / time_constant) if time_constant > 0.0 else 1.0
    return min(acceleration * dt, error * decayed)


class MotionMonitor:
    """Compares the velocity of the robot with its commands."""

    def __init__(self, robot: RoundRobot) -> None:
        """
        Begin with a robot at rest.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._axes = (_Axis(robot.max_acceleration, robot.time_constant),
                      _Axis(robot.max_acceleration, robot.time_constant),
                      _Axis(robot.max_yaw_acceleration, robot.time_constant))
        self._commands: deque[_Sample] = deque()
        self._measured: deque[_Sample] = deque()
        # What a drive would do that follows as it should.
        self._nominal: deque[_Sample] = deque()
        self.reset()

    def reset(self) -> None:
        """Begin anew, at whatever velocity the robot has: somebody else has commanded it."""
        self._commands.clear()
        self._forget_motion()

    def _forget_motion(self) -> None:
        self._measured.clear()
        self._nominal.clear()
        self._excess = 0.0
        self._shortfall = 0.0
        self._delay_due = math.inf

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when [s], of the clock of odometry.
        """
        self._commands.append(_Sample(time, command))
        while len(self._commands) > 1 and self._commands[1].time < time - RESPONSE_TIME:
            self._commands.popleft()

    def check(self, odometry: Odometry) -> SafetyReport | None:
        """
        Compare a measured velocity with the commands before it.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: ``SafetyReport``, or None where the robot follows.
        """
        time, twist = odometry.time, odometry.twist
        last_time = self._measured[-1].time if self._measured else None
        if last_time is not None and time <= last_time:
            return None
        if last_time is None or time - last_time > LONGEST_STEP or not self._commands:
            self._forget_motion()
            self._delay_due = time + DELAY_PERIOD
            for axis, measured in zip(self._axes, twist):
                axis.reset(measured)
            self._remember(time, twist)
            return None
        return self._compare(twist, time, time - last_time)

    def _remember(self, time: float, twist: Twist) -> None:
        self._measured.append(_Sample(time, twist))
        self._nominal.append(_Sample(time, Twist(*(axis.nominal for axis in self._axes))))
        while self._measured[0].time < time - HISTORY_TIME:
            self._measured.popleft()
            self._nominal.popleft()

    def _compare(self, twist: Twist, time: float, dt: float) -> SafetyReport | None:
        recent = [sample.twist for sample in self._commands]
        by_axis = list(zip(*recent))
        speed = math.hypot(twist.v_x, twist.v_y)
        scales = (speed, speed, abs(twist.omega))
        units = (1.0, 1.0, LEVER)
        excess = shortfall = 0.0
        for i, axis in enumerate(self._axes):
            axis.update(by_axis[i], dt)
            scale = max(scales[i], abs(axis.low), abs(axis.high))
            tolerance = SPEED_TOLERANCE / units[i] + RELATIVE_TOLERANCE * scale
            over, under = axis.excess(twist[i], tolerance)
            excess, shortfall = max(excess, units[i] * over), max(shortfall, units[i] * under)
        self._excess = max(0.0, self._excess + (excess - FORGIVEN_SPEED) * dt)
        self._shortfall = max(0.0, self._shortfall + (shortfall - FORGIVEN_SPEED) * dt)
        self._remember(time, twist)
        is_fault = self._excess > MAX_EXCESS or self._shortfall > MAX_SHORTFALL
        if not is_fault and time < self._delay_due:
            return None
        self._delay_due = time + DELAY_PERIOD
        delay = self._delay()
        if delay is not None:
            return SafetyReason.FOLLOWS_LATE.report(delay=delay)
        if not is_fault:
            return None
        reason = (SafetyReason.MOVES_OTHERWISE if self._excess > MAX_EXCESS
                  else SafetyReason.NOT_MOVING)
        return reason.report(commanded=_text(recent[0]), measured=_text(twist))

    def _delay(self) -> float | None:
        """Estimate the delay that explains what was measured [s]; None where none does."""
        times = np.array([sample.time for sample in self._measured])
        units = (1.0, 1.0, LEVER)
        measured = np.array([sample.twist for sample in self._measured]) * units
        nominal = np.array([sample.twist for sample in self._nominal]) * units
        covered = times >= times[0] + MAX_DELAY
        variation = float(measured[covered].var(axis=0).sum()) if covered.any() else 0.0
        if variation < LEAST_VARIATION ** 2:
            return None

        # The response shifted by every delay, shape (delays, times).
        delays = np.arange(0.0, MAX_DELAY + DELAY_STEP, DELAY_STEP, dtype=np.float64)
        shifted_times = times[covered] - delays[:, None]
        errors = np.zeros(len(delays))
        for column, response in zip(measured[covered].T, nominal.T):
            difference = column - np.interp(shifted_times, times, response)
            errors += np.square(difference).mean(axis=1)
        best = int(errors.argmin())
        is_explained = errors[best] < EXPLAINED_RATIO * min(errors[0], variation)
        delay = float(delays[best])
        return delay if is_explained and delay > RESPONSE_TIME else None


def _text(twist: Twist) -> str:
    return f'({twist.v_x:.2f} m/s, {twist.v_y:.2f} m/s, {twist.omega:.2f} rad/s)'
