"""
Does the base keep its velocity while its commands vary, as one that is stuck at the last of them.

Two explanations of the velocity u that was measured are compared: the base follows a model with
velocity v, but for a constant difference; or it keeps a constant velocity, whatever v does. Their
squared errors are integrated over the past, weighted with exp(-age / T), by

    Q_follows = C[v - u],    Q_stuck = C[u],    e = Q_follows - 2 Q_stuck

where C is the integral of the squared deviations from the weighted mean. The base is stuck where
e > Q_0 + tau^2 X for every model that has explained its motion until now, where X is the integral
of the squared acceleration of the model: a base that follows later by tau differs by so much.
That is so for no base that follows by more than 0.41 of what is commanded to it, whatever its
wheels, loads and offsets are, and noise of odometry adds to Q_stuck what it adds to Q_follows.

As in Page's test, what speaks for a model counts up to E_0 only: where e is below -E_0, all that
was measured until then weighs less by E_0 / |e|. A base that has just followed a fast turn would
otherwise be believed for as long as T.
"""

import math
from typing import Any

import numpy as np
from push_control.safety.close_following import LEVER
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray

# Time constant T by which the past is forgotten [s]; chosen: commands that vary slowly show in
# it, and a second or more noticed nothing sooner in simulated drives.
MEMORY = 0.5
# Q_0 [m^2/s]; chosen: variations of commands by 4.5 mm/s for T. Bases that ignore changes of their
# commands by up to 15 mm/s do not reach it in simulated drives.
LEAST_EXCESS = 1e-5
# E_0 [m^2/s]; chosen: twice Q_0, so that the noise of a few messages leaves it out of reach.
MOST_SUPPORT = 2e-5
# tau [s]; chosen: half of the step of the delays of the models, nearly.
LATENESS = 0.02
# Columns of the integrals of a model: Q_follows, Q_stuck, their weight [s], and X.
FOLLOWS, STUCK, WEIGHT, ACCELERATION, INTEGRAL_COUNT = 0, 1, 2, 3, 4
# Rows of the means of a model: of v - u, and of u.
DIFFERENCE, MEASURED = 0, 1


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
    decay = math.exp(-dt / MEMORY)
    for i in range(len(velocities)):
        weight = decay * integrals[i, WEIGHT] + dt
        part = dt / weight
        follows = stuck = acceleration = 0.0
        for j in range(3):
            unit = LEVER if j == 2 else 1.0
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
        ratio = MOST_SUPPORT / support if support > MOST_SUPPORT else 1.0
        integrals[i, FOLLOWS] = ratio * follows
        integrals[i, STUCK] = ratio * stuck
        integrals[i, WEIGHT] = ratio * weight
        integrals[i, ACCELERATION] = decay * integrals[i, ACCELERATION] + dt * acceleration


@compiled
def least_excess(integrals: Any, excluded_until: Any, time: float) -> float:
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
                        - LATENESS * LATENESS * integrals[i, ACCELERATION])
    return least


class StuckTest:
    """Tells a base that keeps its velocity from one that follows a model."""

    def __init__(self, count: int) -> None:
        """
        Begin without a past.

        :param count: number of models.
        """
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
        """
        Take in a measured velocity.

        :param velocities: of the models, shape (m, 3) [m/s, m/s, rad/s].
        :param rates: how fast they change, shape (m, 3) [m/s^2, m/s^2, rad/s^2].
        :param measured: shape (3,).
        :param dt: time since the last one, above 0 [s].
        """
        add_sample(velocities, rates, measured, self._means, self._integrals, dt)

    def is_stuck(self, excluded_until: FloatArray, time: float) -> bool:
        """
        Tell whether a constant velocity explains the motion better than every model.

        :param excluded_until: until when each model does not count, shape (m,) [s].
        :param time: now [s].
        """
        excess = least_excess(self._integrals, excluded_until, time)
        return LEAST_EXCESS < excess < math.inf
