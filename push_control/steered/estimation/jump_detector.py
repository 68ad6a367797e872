"""
Detection of a jump of the centre of friction, from how the object rotates.

Heading innovations of a right model are white. After a jump the object keeps rotating by more, or
by less, than the filter expects, and their mean differs from zero until the filter has followed.
Page's test detects that mean. Noise above what poses state gives no mean; it only widens the
scale, which differences of consecutive innovations tell whatever their mean is:

    ``E[(v_k - v_{k-1})^2] / 2 = var(v)``.
"""

import math

from push_control.steered.estimation.cusum import CusumTest

# Smoothing factor of the variance of innovations, per pose; at first it is their mean. Chosen:
# averages over a second.
VARIANCE_SMOOTHING = 0.05


class JumpDetector:
    """Tells from heading innovations that the object rotates otherwise than expected."""

    def __init__(self, threshold: float):
        """
        Start without an innovation.

        :param threshold: CUSUM value at which a jump is detected, in standard deviations.
        """
        self._threshold = threshold
        self._test = CusumTest(threshold)
        self._last = 0.0
        self._count = 0
        self._variance = 0.0

    def restart(self) -> None:
        """Sum up anew, at an innovation that has another cause."""
        self._test = CusumTest(self._threshold)

    def update(self, innovation: float, variance: float) -> bool:
        """
        Add an innovation, and tell whether there was a jump.

        :param innovation: measured minus expected heading [rad].
        :param variance: that the filter expects of it [rad^2].
        """
        if self._count > 0:
            half_square = 0.5 * (innovation - self._last) ** 2
            smoothing = max(VARIANCE_SMOOTHING, 1.0 / self._count)
            self._variance += smoothing * (half_square - self._variance)
        self._last = innovation
        self._count += 1
        scale = math.sqrt(max(variance, self._variance))
        return self._test.update(innovation / scale) != 0
