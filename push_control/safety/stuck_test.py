"""
Does the base keep its velocity while its commands vary, as one that is stuck at the last of them.

Two explanations of the velocity u that was measured are compared: the base follows a model with
velocity v, but for a constant difference; or it keeps a constant velocity, whatever v does. Their
squared errors are integrated over the past, weighted with exp(-age / T), by

    Q_follows = C_uu - 2 C_uv + C_vv,    Q_stuck = C_uu

where C are the integrals of products of the deviations from the weighted means. The base is stuck
where ``Q_follows > 2 Q_stuck + Q_0`` for every model that has explained its motion until now. That
is so for no base that follows by more than 0.41 of what is commanded to it, whatever its wheels,
loads and offsets are, and noise of odometry adds to Q_stuck what it adds to Q_follows.
"""

import math
from typing import Any

import numpy as np
from push_control.safety.close_following import LEVER
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray

# Time constant T by which the past is forgotten [s]; chosen: what a base did before it was stuck
# counts for as long; in simulated drives half a second was noticed later.
MEMORY = 0.25
# Q_0 [m^2/s]; chosen: variations of commands by 4.5 mm/s for T. Bases that ignore changes of their
# commands by up to 15 mm/s do not reach it in simulated drives.
LEAST_EXCESS = 5e-6
# Columns of the integrals: C_vv, and C_uv; both are C_uu in the row of what was measured.
VARIANCE, COVARIANCE = 0, 1


@compiled
def add_sample(velocities: Any, measured: Any, means: Any, integrals: Any, weight: float,
               dt: float) -> float:
    """
    Continue means and integrals of all models, and of what was measured, by a sample.

    :param velocities: of the models, shape (m, 3) [m/s, m/s, rad/s].
    :param measured: shape (3,).
    :param means: of the models, and of what was measured in the last row, shape (m + 1, 3), is
        written [m/s].
    :param integrals: likewise, shape (m + 1, 2), is written [m^2/s].
    :param weight: of all samples before [s].
    :param dt: time since the last sample [s].
    :return: weight of all samples [s].
    """
    last = len(velocities)
    decay = math.exp(-dt / MEMORY)
    total = decay * weight + dt
    part = dt / total
    for i in range(last + 1):
        variance = covariance = 0.0
        for j in range(3):
            unit = LEVER if j == 2 else 1.0
            difference = unit * measured[j] - means[last, j]
            change = difference if i == last else unit * velocities[i, j] - means[i, j]
            variance += change * change
            covariance += change * difference
            means[i, j] += part * change
        # A sample shifts the mean as well, by its part.
        integrals[i, VARIANCE] = decay * integrals[i, VARIANCE] + dt * (1.0 - part) * variance
        integrals[i, COVARIANCE] = (decay * integrals[i, COVARIANCE]
                                    + dt * (1.0 - part) * covariance)
    return total


@compiled
def least_excess(integrals: Any, excluded_until: Any, time: float) -> float:
    """
    Find by how much worse the models that count explain the motion than a constant velocity.

    :param integrals: as of ``add_sample``.
    :param excluded_until: until when each model does not count, shape (m,) [s].
    :param time: now [s].
    :return: the least ``Q_follows - 2 Q_stuck`` [m^2/s].
    """
    least = math.inf
    for i in range(len(excluded_until)):
        if excluded_until[i] <= time:
            least = min(least, integrals[i, VARIANCE] - 2.0 * integrals[i, COVARIANCE]
                        - integrals[-1, VARIANCE])
    return least


class StuckTest:
    """Tells a base that keeps its velocity from one that follows a model."""

    def __init__(self, count: int) -> None:
        """
        Begin without a past.

        :param count: number of models.
        """
        self._means: FloatArray = np.zeros((count + 1, 3))
        self._integrals: FloatArray = np.zeros((count + 1, 2))
        # Of all samples [s].
        self._weight = 0.0
        # Changes nothing; but loads machine code before the robot moves.
        self.add(np.zeros((count, 3)), np.zeros(3), 1.0)
        self.is_stuck(np.zeros(count), 0.0)
        self.clear()

    def clear(self) -> None:
        """Forget the past."""
        self._integrals[:] = 0.0
        self._weight = 0.0

    def add(self, velocities: FloatArray, measured: FloatArray, dt: float) -> None:
        """
        Take in a measured velocity.

        :param velocities: of the models, shape (m, 3) [m/s, m/s, rad/s].
        :param measured: shape (3,).
        :param dt: time since the last one, above 0 [s].
        """
        self._weight = add_sample(velocities, measured, self._means, self._integrals,
                                  self._weight, dt)

    def is_stuck(self, excluded_until: FloatArray, time: float) -> bool:
        """
        Tell whether a constant velocity explains the motion better than every model.

        :param excluded_until: until when each model does not count, shape (m,) [s].
        :param time: now [s].
        """
        excess = least_excess(self._integrals, excluded_until, time)
        return LEAST_EXCESS < excess < math.inf
