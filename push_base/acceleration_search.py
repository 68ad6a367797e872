"""
Finding a base that accelerates less than stated, as one with a velocity smoother before it.

Models with the nominal lag accelerate by a_k, as stated or a part of that. Along an axis, that of
translation or of rotation, the error of a model is

    e_k = min_d  mean |v(t) - x_k(t - d)|^2

so that what a dead time explains is left to the dead time. A model other than the present one
counts where it explains the motion, and the present one does far worse; that has to be so several
times. While commands change no faster than the base follows, all models agree, and nothing counts.
"""

from collections import deque
import math

from push_model.geometry import FloatArray

# Model of a base that accelerates as stated.
AS_STATED = 0
# Accelerations of the other models over what is stated; chosen: steps by which a change of the
# speed takes two fifths more of its time, down to an eighth.
SLOW_RATIOS = 0.5, 0.35, 0.25, 0.18, 0.125
# Velocity has to vary by so much along an axis [m/s]; part of the variance that the best model
# leaves at most, and of what the present one leaves; and by how much that is more [m/s]. Chosen: a
# lag that is half of the stated one, or twice as long, explains none of that.
MIN_VARIATION = 0.03
MAX_UNEXPLAINED = 0.1
MAX_ERROR_RATIO = 0.25
MIN_IMPROVEMENT = 0.01
# Number of results that are remembered, and of those that have to agree; chosen: half a second.
RESULTS, ENOUGH_RESULTS = 9, 5


class AccelerationSearch:
    """
    Chooses the model of one axis.

    ``model``: index of the one that is believed, ``AS_STATED`` or one above the index of its
    ratio in ``SLOW_RATIOS``.
    """

    def __init__(self) -> None:
        """Start with a base that accelerates as stated."""
        self._results: deque[int] = deque(maxlen=RESULTS)
        self.model = AS_STATED

    @property
    def ratio(self) -> float | None:
        """Acceleration over what is stated; None for as stated."""
        return None if self.model == AS_STATED else SLOW_RATIOS[self.model - 1]

    def start_from(self, ratio: float) -> None:
        """
        Believe the model that is nearest to what is known.

        :param ratio: acceleration over what is stated; above 1 for as stated.
        """
        ratios = 1.0, *SLOW_RATIOS
        self._results.clear()
        self.model = min(range(len(ratios)),
                         key=lambda model: abs(math.log(ratios[model] / min(1.0, ratio))))

    def add(self, errors: FloatArray, variance: float) -> bool:
        """
        Compare the models once.

        :param errors: e_k of ``AS_STATED`` and of each slow one, shape (m,) [m^2/s^2].
        :param variance: of the measured velocity along the axis [m^2/s^2].
        :return: whether another model than the believed one explains the motion far better.
        """
        if variance < MIN_VARIATION ** 2:
            return False
        best = int(errors.argmin())
        present, least = float(errors[self.model]), float(errors[best])
        is_better = (least < MAX_UNEXPLAINED * variance and least < MAX_ERROR_RATIO * present
                     and present - least > MIN_IMPROVEMENT ** 2)
        if is_better:
            self._results.append(best)
            self._choose()
        elif present < MAX_UNEXPLAINED * variance:
            self._results.append(self.model)
        return is_better

    def _choose(self) -> None:
        """Believe a model that is the best one often enough, or slower ones on average."""
        others = sorted(result for result in self._results if result != self.model)
        if len(others) < ENOUGH_RESULTS:
            return
        self.model = others[len(others) // 2]
        self._results.clear()
