"""
Delay with which a robot follows its commands, where it is longer than any that is good.

The response that the drive should have, shifted in time by the delay, is what was measured.
"""

from collections import deque
from typing import NamedTuple

import numpy as np
from push_model.signals import Twist

# History in which the delay is looked for, longest delay, and step of the search [s]; chosen.
HISTORY_TIME = 3.0
MAX_DELAY = 1.2
DELAY_STEP = 0.05
# Period of the search [s]; chosen: it takes a millisecond.
PERIOD = 0.5
# A delay is the reason where it leaves less than this part of the variance, and of what is left
# without one, and where the velocity varies enough [m/s]; chosen.
EXPLAINED_RATIO = 0.3
LEAST_VARIATION = 0.03
# Speed below which the robot stood when the history began [m/s]; chosen: noise of odometry.
STANDING_SPEED = 0.02


class _Sample(NamedTuple):
    """Velocities at a time: measured, and of a drive that follows at once."""

    time: float
    measured: Twist
    nominal: Twist


class ResponseDelay:
    """Looks now and then for the delay that explains what was measured."""

    def __init__(self, lever: float, shortest: float) -> None:
        """
        Begin without a history.

        :param lever: by which a rotation counts as a distance [m].
        :param shortest: delay from which on something is wrong [s].
        """
        self._units = (1.0, 1.0, lever)
        self._shortest = shortest
        self._samples: deque[_Sample] = deque()
        self._due = 0.0

    def clear(self) -> None:
        """Forget the history."""
        self._samples.clear()

    def add(self, time: float, measured: Twist, nominal: Twist) -> None:
        """
        Note a velocity.

        :param time: when [s].
        :param measured: ``Twist``.
        :param nominal: ``Twist`` that a drive would have that follows at once.
        """
        if not self._samples:
            self._due = time + PERIOD
        self._samples.append(_Sample(time, measured, nominal))
        while self._samples[0].time < time - HISTORY_TIME:
            self._samples.popleft()

    def find(self, *, at_once: bool) -> float | None:
        """
        Estimate the delay, where it is due.

        :param at_once: whether it is due now, as something is wrong.
        :return: the delay [s]; None where none explains what was measured.
        """
        time = self._samples[-1].time
        if not at_once and time < self._due:
            return None
        self._due = time + PERIOD
        return self._estimate()

    def _estimate(self) -> float | None:
        times = np.array([sample.time for sample in self._samples])
        measured = np.array([sample.measured for sample in self._samples]) * self._units
        nominal = np.array([sample.nominal for sample in self._samples]) * self._units
        # A robot that stood at first has stood before, as far as is known.
        stood = np.abs([*measured[0], *nominal[0]]).max() < STANDING_SPEED
        covered = times >= times[0] + (0.0 if stood else MAX_DELAY)
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
        return delay if is_explained and delay >= self._shortest else None
