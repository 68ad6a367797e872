"""
Search for the delay with which a base follows: expected velocities, shifted in time, compared.

Where x is the velocity that a base should have without a delay, and v the one that was measured,
the delay is

    tau = argmin_d  sum_axes Var[v(t) - x(t - d)],    d = 0, step, 2 step, ... max_delay

A constant difference is left out of account, as wheels of another size would make a ramp look
late. A parabola through the least variance and its neighbours gives the delay between two steps.
"""

from collections import deque
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parabola import vertex_offset
from push_model.signals import Twist
from push_safety.tolerances import LEVER_ARM, REST_SPEED

# Columns of a sample: its time, the measured velocity, and the expected one.
TIME, MEASURED, EXPECTED, SAMPLE_SIZE = 0, 1, 4, 7
# Rotations count as distances.
UNITS = 1.0, *2 * (1.0, 1.0, LEVER_ARM)


@compiled
def compare_delays(samples: Any, first: int, delays: Any, variances: Any) -> None:
    """
    Compare what was measured with what was expected, shifted by every delay.

    :param samples: in order of their times, shape (n, 7), n above 1.
    :param first: index of the first one that is compared.
    :param delays: shape (d,) [s].
    :param variances: of the differences, summed over the axes, shape (d,), is written.
    """
    count = len(samples) - first
    for d in range(len(delays)):
        variances[d] = 0.0
        for j in range(3):
            mean = mean_square = 0.0
            k = 0
            for i in range(first, len(samples)):
                time = samples[i, TIME] - delays[d]
                while k < len(samples) - 2 and samples[k + 1, TIME] <= time:
                    k += 1
                part = (time - samples[k, TIME]) / (samples[k + 1, TIME] - samples[k, TIME])
                part = min(1.0, max(0.0, part))
                before, after = samples[k, EXPECTED + j], samples[k + 1, EXPECTED + j]
                difference = samples[i, MEASURED + j] - before - part * (after - before)
                mean += difference / count
                mean_square += difference * difference / count
            variances[d] += mean_square - mean * mean


class DelayMatch(NamedTuple):
    """
    The delay that explains a motion best.

    :param delay: to a step of the search [s].
    :param precise_delay: the same between two steps [s].
    :param variance: of the difference that it leaves, summed over the axes [m^2/s^2].
    :param undelayed_variance: of the difference without a delay.
    :param measured_variance: of the measured velocity.
    """

    delay: float
    precise_delay: float
    variance: float
    undelayed_variance: float
    measured_variance: float


class DelaySearch:
    """Holds the latest velocities, and compares them."""

    def __init__(self, *, history_time: float, max_delay: float, step: float) -> None:
        """
        Start without a history.

        :param history_time: time of which velocities are compared [s].
        :param max_delay: greatest delay that is tried [s].
        :param step: between two delays [s].
        """
        self._history_time = history_time
        self._max_delay = max_delay
        self._step = step
        self._samples: deque[tuple[float, ...]] = deque()
        self._units: FloatArray = np.array(UNITS, dtype=np.float64)
        self._delays: FloatArray = np.arange(0.0, max_delay + step, step, dtype=np.float64)
        self._variances: FloatArray = np.zeros(len(self._delays))
        # Compares nothing; but loads machine code before the robot moves.
        compare_delays(np.zeros((2, SAMPLE_SIZE)), 2, self._delays[:0], self._variances)

    def clear(self) -> None:
        """Forget the history."""
        self._samples.clear()

    @property
    def is_empty(self) -> bool:
        """Tell whether there is no history."""
        return not self._samples

    @property
    def is_at_rest(self) -> bool:
        """Tell whether the newest velocities, measured and expected, are zero."""
        return not self._samples or _are_zero(self._samples[-1][MEASURED:])

    def add(self, time: float, measured: Twist, expected: Twist) -> None:
        """
        Note a velocity.

        :param time: when [s], later than the last.
        :param expected: what the base should have without a delay.
        """
        self._samples.append((time, *measured, *expected))
        while self._samples[0][TIME] < time - self._history_time:
            self._samples.popleft()

    def find(self, min_time: float) -> DelayMatch | None:
        """
        Find the delay that explains the history best.

        :param min_time: least time that has to be compared [s].
        :return: ``DelayMatch``; None where the history is too short.
        """
        if len(self._samples) < 2:
            return None
        samples = np.array(self._samples, dtype=np.float64) * self._units
        times = samples[:, TIME]
        # A base that is at rest at first has been so before, as far as is known.
        unknown_time = 0.0 if _are_zero(samples[0, MEASURED:].tolist()) else self._max_delay
        first = int(np.searchsorted(times, times[0] + unknown_time))
        if first == len(times) or times[-1] - times[first] < min_time:
            return None
        compare_delays(samples, first, self._delays, self._variances)
        variances: list[float] = self._variances.tolist()
        best = int(self._variances.argmin())
        delay = float(self._delays[best])
        return DelayMatch(
            delay, delay + self._step * vertex_offset(variances, best), variances[best],
            variances[0],
            float(samples[first:, MEASURED:EXPECTED].var(axis=0).sum()))


def _are_zero(values: Sequence[float]) -> bool:
    return max(map(abs, values)) < REST_SPEED
