"""
Finding out that the speeds of a base are another part of what is commanded.

From the velocity measured at the start of a window on, a base with the gains g follows the
commands c of the window as ``push_dynamics.actuation`` says, v' = (M(g) c - v) / T. The errors of
such models, that differ in the gains of both wheels or axes or of one of them,

    e(g) = min_d mean |v - v_g,d|^2

with commands that act a little earlier or later, by d, are compared. A wheel or axis tells of its
own gain where all commands of the window are fast: one with a least speed does not follow slow
ones, whatever its gain. One model has to explain the motion, and the present one not; several
windows in a row have to say the same.
"""

from collections import deque
import math
import statistics
from typing import NamedTuple

import numpy as np
from push_base.speed_gain import gain_matrix
from push_dynamics.actuation import track_commands
from push_model.geometry import FloatArray
from push_model.parabola import vertex_offset
from push_model.parameters import RoundRobot

# Duration of a window, and time between two [s]; chosen: a base that is slow all of a sudden is
# stopped after two of these windows.
WINDOW = 0.2
PERIOD = 0.04
# Ratio between the gains of two models, and their number on each side of 1; chosen: from 0.4 to
# 2.5, in steps that a parabola bridges.
STEP, STEPS = 1.12, 8
MODELS = 2 * STEPS + 1
# Errors of the dead time that count as such [s]; chosen: that of a sample of odometry, and twice.
SHIFTS = -0.05, -0.025, 0.0, 0.025, 0.05
# Slowest commands of a window [m/s]; chosen: about as slow as anything is pushed.
MIN_SPEED = 0.06
# Part of the mean square of the velocity that the best model leaves, the same of what the present
# one leaves, and by how much that is more [m/s]. Chosen: errors of accelerations and lags, which
# change within a window, do not fit so well.
MAX_UNEXPLAINED = 0.02
MAX_ERROR_RATIO = 0.2
MIN_IMPROVEMENT = 0.008
# Windows in a row that have to agree, and ratio of the gains up to which they do; chosen.
ENOUGH_RESULTS = 4
AGREEMENT = 1.1
# Standard deviation of a gain, beside that of the windows, which all have the same errors of
# models; chosen: gains are right to that with a lag that is half of the stated one, or twice.
MODEL_STD = 0.02


class GainChange(NamedTuple):
    """
    Gains over those that were believed.

    :param first: of the left wheel, or of the translation of a holonomic base.
    :param second: of the right wheel, or of the rotation.
    :param deviation: standard deviation of each.
    """

    first: float
    second: float
    deviation: float = MODEL_STD


class GainWindow(NamedTuple):
    """
    What was commanded and measured.

    :param times: of the measurements, shape (n,) [s].
    :param measured: twists, shape (n, 3) [m/s, m/s, rad/s].
    :param commands: that act between two measurements, later by each of the ``SHIFTS``, shape
        (s, n - 1, 3).
    """

    times: FloatArray
    measured: FloatArray
    commands: FloatArray


class GainSearch:
    """Compares gains by windows of motion."""

    def __init__(self, robot: RoundRobot, channels: FloatArray) -> None:
        """
        Start without any window.

        :param robot: the ``RoundRobot``, nominal.
        :param channels: from a twist to the speeds that count, shape (k, 3).
        """
        self._robot = robot
        self._channels = channels
        self._drive: FloatArray = np.array([
            (robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration)])
        ratios: FloatArray = STEP ** np.arange(-STEPS, STEPS + 1, dtype=np.float64)
        ones = np.ones(len(ratios))
        # Both gains alike, the first one alone, the second one alone.
        self._families = ((ratios, ratios), (ratios, ones), (ones, ratios))
        self._matrices = np.array([gain_matrix(robot, first, second) for family in self._families
                                   for first, second in zip(*family)])
        self._results: deque[GainChange] = deque(maxlen=ENOUGH_RESULTS)

    def clear(self) -> None:
        """Forget the windows until now."""
        self._results.clear()

    def add(self, window: GainWindow) -> GainChange | None:
        """
        Compare all models with a window.

        :param window: of a base whose commands are as the gains that are believed have it.
        :return: the ``GainChange`` that the last windows agree on, else None.
        """
        is_fast = self._are_fast(window.commands)
        if not any(is_fast):
            return None
        middle = len(SHIFTS) // 2
        as_believed = window._replace(commands=window.commands[middle:middle + 1])
        # Most windows fit the dead time and the gains that are believed.
        if self._present_error(as_believed) <= MIN_IMPROVEMENT ** 2:
            self._results.clear()
            return None
        measured = window.measured @ self._channels.T
        mean_square = float((measured ** 2).sum(axis=1).mean())
        present = self._present_error(window)
        if present <= MIN_IMPROVEMENT ** 2:
            self._results.clear()
            return None
        by_model = np.einsum('mij,snj->nsmi', self._matrices, window.commands)
        errors = self._errors(window, by_model)
        for family, may_differ in enumerate((True, *is_fast)):
            if not may_differ:
                errors[family * MODELS:(family + 1) * MODELS] = math.inf
        best = int(errors.argmin())
        least = float(errors[best])
        if not (least < MAX_UNEXPLAINED * mean_square and least < MAX_ERROR_RATIO * present
                and present - least > MIN_IMPROVEMENT ** 2):
            self._results.clear()
            return None
        self._results.append(self._interpolated(errors, best))
        return self._agreed()

    def _are_fast(self, commands: FloatArray) -> tuple[bool, bool]:
        """Tell which of both wheels, or translation and rotation, are driven fast all along."""
        if self._robot.drive == 'differential':
            speeds = np.abs(commands @ self._channels.T)
        else:
            translation = np.hypot(commands[..., 0], commands[..., 1])
            speeds = np.stack((translation, np.abs(commands @ self._channels[2])), axis=-1)
        first, second = (speeds.min(axis=(0, 1)) >= MIN_SPEED).tolist()
        return first, second

    def _present_error(self, window: GainWindow) -> float:
        """Compute e of the gains that are believed."""
        by_model = window.commands.transpose(1, 0, 2)[:, :, None]
        return float(self._errors(window, by_model)[0])

    def _errors(self, window: GainWindow, by_model: FloatArray) -> FloatArray:
        """Compute e of some models, by their commands of shape (n - 1, s, m, 3)."""
        steps, *shape, _ = by_model.shape
        commands = by_model.reshape(steps, -1, 3)
        missing: FloatArray = np.empty(commands.shape)
        velocities: FloatArray = np.empty(commands.shape[1:])
        velocities[:] = window.measured[0]
        for k, duration in enumerate(np.diff(window.times).tolist()):
            track_commands(velocities, commands[k], self._drive, duration)
            missing[k] = velocities - window.measured[k + 1]
        errors = ((missing @ self._channels.T) ** 2).sum(axis=-1).mean(axis=0)
        return errors.reshape(shape).min(axis=0)

    def _interpolated(self, errors: FloatArray, best: int) -> GainChange:
        """Find the gains of the least error between two models."""
        family, index = divmod(best, MODELS)
        values = errors[family * MODELS:(family + 1) * MODELS].tolist()
        ratio = STEP ** (index - STEPS + vertex_offset(values, index))
        return (GainChange(ratio, ratio), GainChange(ratio, 1.0), GainChange(1.0, ratio))[family]

    def _agreed(self) -> GainChange | None:
        if len(self._results) < ENOUGH_RESULTS:
            return None
        gains = [[result.first for result in self._results],
                 [result.second for result in self._results]]
        if any(max(values) > AGREEMENT * min(values) for values in gains):
            return None
        self._results.clear()
        first, second = map(statistics.median, gains)
        scatter = max(map(statistics.pstdev, gains))
        return GainChange(first, second, math.hypot(MODEL_STD, scatter))
