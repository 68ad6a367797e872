"""
Delay with which a robot follows its commands, where it is longer than any that is good.

The response that the drive should have, shifted in time by the delay, is what was measured.
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
# Period of the search [s]; chosen: it takes a tenth of a millisecond.
PERIOD = 0.5
# A delay is the reason where it leaves less than this part of the variance, and of what is left
# without one, and where the velocity varies enough [m/s]; chosen.
EXPLAINED_RATIO = 0.3
LEAST_VARIATION = 0.03
# Speed below which the robot stood when the history began [m/s]; chosen: noise of odometry.
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
    :param errors: mean squares of the differences, summed over the axes, shape (d,), is written.
    """
    for d in range(len(delays)):
        total = 0.0
        k = 0
        for i in range(first, len(samples)):
            time = samples[i, TIME] - delays[d]
            while k < len(samples) - 2 and samples[k + 1, TIME] <= time:
                k += 1
            part = (time - samples[k, TIME]) / (samples[k + 1, TIME] - samples[k, TIME])
            part = min(1.0, max(0.0, part))
            for j in range(3):
                before, after = samples[k, NOMINAL + j], samples[k + 1, NOMINAL + j]
                difference = samples[i, MEASURED + j] - before - part * (after - before)
                total += difference * difference
        errors[d] = total / (len(samples) - first)


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
        time = self._samples[-1][TIME]
        if not at_once and time < self._due:
            return None
        self._due = time + PERIOD
        return self._estimate()

    def _estimate(self) -> float | None:
        samples = np.array(self._samples, dtype=np.float64) * self._units
        times = samples[:, TIME]
        # A robot that stood at first has stood before, as far as is known.
        stood = np.abs(samples[0, MEASURED:]).max() < STANDING_SPEED
        first = int(np.searchsorted(times, times[0] + (0.0 if stood else MAX_DELAY)))
        compared = samples[first:, MEASURED:NOMINAL]
        variation = float(compared.var(axis=0).sum()) if len(compared) else 0.0
        if variation < LEAST_VARIATION ** 2:
            return None
        errors = self._errors
        compare_delays(samples, first, self._delays, errors)
        best = int(errors.argmin())
        is_explained = errors[best] < EXPLAINED_RATIO * min(errors[0], variation)
        delay = float(self._delays[best])
        return delay if is_explained and delay >= self._shortest else None
