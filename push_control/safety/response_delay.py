"""
Delay with which a robot follows its commands, where it is longer than any that is good.

The response that the drive should have, shifted in time by the delay, is what was measured, but
for a constant difference: wheels of another size would make a ramp look late.
"""

from collections import deque
from typing import Any

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.signals import Twist

# History in which the delay is looked for, longest delay, and step of the search [s]; chosen.
HISTORY_TIME = 3.0
MAX_DELAY = 1.2
DELAY_STEP = 0.05
# Period of the search [s]; chosen: it takes a quarter of a millisecond, and a base that is late is
# stopped within 0.3 s of where that shows.
PERIOD = 0.2
# A delay is the reason where it leaves less than this part of the variance, and of what is left
# without one; chosen. What it leaves is this at least [m/s]; chosen: so that the steps of a base
# that ignores changes of its commands by 15 mm/s are not taken for a delay.
EXPLAINED_RATIO = 0.3
LEAST_ERROR = 0.0045
# Speed below which the robot stands [m/s, rad/s]; chosen: noise of odometry.
STANDING_SPEED = 0.02


# Numbers of a sample: its time, the measured velocity, and that of a drive that follows at once.
TIME, MEASURED, NOMINAL, SAMPLE_SIZE = 0, 1, 4, 7


@compiled
def compare_delays(samples: Any, first: int, delays: Any, errors: Any) -> None:
    """
    Compare what was measured with the response shifted by every delay.

    :param samples: in order of their times, shape (n, 7), n above 1.
    :param first: number of the first one that is compared.
    :param delays: shape (d,) [s].
    :param errors: variances of the differences, summed over the axes, shape (d,), is written.
    """
    count = len(samples) - first
    for d in range(len(delays)):
        errors[d] = 0.0
        for j in range(3):
            mean = mean_square = 0.0
            k = 0
            for i in range(first, len(samples)):
                time = samples[i, TIME] - delays[d]
                while k < len(samples) - 2 and samples[k + 1, TIME] <= time:
                    k += 1
                part = (time - samples[k, TIME]) / (samples[k + 1, TIME] - samples[k, TIME])
                part = min(1.0, max(0.0, part))
                before, after = samples[k, NOMINAL + j], samples[k + 1, NOMINAL + j]
                difference = samples[i, MEASURED + j] - before - part * (after - before)
                mean += difference / count
                mean_square += difference * difference / count
            errors[d] += mean_square - mean * mean


class ResponseDelay:
    """Looks now and then for the delay that explains what was measured."""

    def __init__(self, lever: float, shortest: float) -> None:
        """
        Begin without a history.

        :param lever: by which a rotation counts as a distance [m].
        :param shortest: delay from which on something is wrong [s].
        """
        self._units: FloatArray = np.array((1.0, *2 * (1.0, 1.0, lever)), dtype=np.float64)
        self._shortest = shortest
        self._samples: deque[tuple[float, ...]] = deque()
        self._due = 0.0
        self._delays: FloatArray = np.arange(0.0, MAX_DELAY + DELAY_STEP, DELAY_STEP,
                                             dtype=np.float64)
        self._errors: FloatArray = np.zeros(len(self._delays))
        # Compares nothing; but loads machine code before the robot moves.
        compare_delays(np.zeros((2, SAMPLE_SIZE)), 2, self._delays[:0], self._errors)

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
        self._samples.append((time, *measured, *nominal))
        while self._samples[0][TIME] < time - HISTORY_TIME:
            self._samples.popleft()

    def find(self, *, at_once: bool) -> float | None:
        """
        Estimate the delay, where it is due.

        :param at_once: whether it is due now, as something is wrong.
        :return: the delay [s]; None where none explains what was measured.
        """
        time, *velocities = self._samples[-1]
        # A robot that stands as it is commanded to is not late any more.
        stands = max(map(abs, velocities)) < STANDING_SPEED
        if not at_once and (time < self._due or stands):
            return None
        self._due = time + PERIOD
        return self._estimate()

    def _estimate(self) -> float | None:
        samples = np.array(self._samples, dtype=np.float64) * self._units
        times = samples[:, TIME]
        # A robot that stood at first has stood before, as far as is known.
        stood = np.abs(samples[0, MEASURED:]).max() < STANDING_SPEED
        first = int(np.searchsorted(times, times[0] + (0.0 if stood else MAX_DELAY)))
        # A delay that is longer than what is compared explains any motion.
        if first == len(times) or times[-1] - times[first] < self._shortest:
            return None
        variation = float(samples[first:, MEASURED:NOMINAL].var(axis=0).sum())
        errors = self._errors
        compare_delays(samples, first, self._delays, errors)
        best = int(errors.argmin())
        is_explained = (errors[best] + LEAST_ERROR ** 2
                        < EXPLAINED_RATIO * min(errors[0], variation))
        delay = float(self._delays[best])
        return delay if is_explained and delay >= self._shortest else None
