"""
Fit the friction of objects that are pushed by the same robot: one mu_c, the rest object by object.

With p the unknowns of all objects, e_j(p) how far push j ends from where it was recorded (angles
times a length) and p_0, s the prior, the cost is

    sum_j w_j |e_j(p)|^2 / sigma^2 + sum_i ((p_i - p_i0) / s_i)^2.

sigma is estimated from the median of what is left; a push that is off by more than OUTLIER sigma
counts less (Huber's weights w_j). The cost is minimized by Gauss's and Newton's method.
"""

import math
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_control.identification.friction_changes import CONTACT_FRICTION, PATTERNS
from push_control.identification.push_set import integrated, Linearization, PushSet
from push_model.geometry import FloatArray

# Chosen: converged long before.
ITERATIONS = 12
# Steps are halved so often where the cost would grow, and the search ends at a relative step of
# the cost below this.
HALVINGS = 5
ENOUGH = 1e-4
# Huber's threshold, in standard deviations of a push's root mean square. Chosen, as usual.
OUTLIER = 2.0
# Least standard deviation [m]. Measured on recordings of the plant: what the points of the paths
# and the touch at the end leave; intervals then cover the truth about as often as stated.
MIN_SIGMA = 6e-4


class FrictionPrior(NamedTuple):
    """
    Prior standard deviations of the friction on the floor about that of the nominal object.

    :param center: of F, over the root of c^2.
    :param log: of the logarithm of the ratio of c^2.
    :param pattern: of the amount of a pattern.
    """

    center: float
    log: float
    pattern: float


# Supports stand where the object's file has them, and the floor is even: friction under a foot
# differs by about a tenth. Chosen.
STATICS = FrictionPrior(0.05, 0.06, 0.08)
# Supports or friction are guesses. Chosen.
FREE = FrictionPrior(0.25, 0.3, 0.3)
# Contact friction within a factor of 1.8, friction on the floor within one of 1.2. Chosen.
LOG_FRICTION = 0.6
LOG_FLOOR_FRICTION = 0.2


class Pool(NamedTuple):
    """
    Push sets whose objects share mu_c: the first of the unknowns of all.

    :param sets: of each object.
    :param columns: where the unknowns of each object stand among those of all.
    """

    sets: tuple[PushSet, ...]
    columns: tuple[NDArray[np.int_], ...]

    @classmethod
    def of(cls, sets: Sequence[PushSet]) -> 'Pool':
        """Give each unknown its place."""
        columns: list[NDArray[np.int_]] = []
        used = 1
        for one in sets:
            own = len(one.nominal) - 1
            columns.append(np.insert(used + np.arange(own), CONTACT_FRICTION, 0))
            used += own
        return cls(tuple(sets), tuple(columns))

    @property
    def nominal(self) -> FloatArray:
        """Unknowns of the nominal objects, shape (u,); mu_c is their geometric mean."""
        unknowns = np.zeros(1 + int(max(columns.max() for columns in self.columns)))
        for one, columns in zip(self.sets, self.columns):
            unknowns[columns] = one.nominal
        unknowns[0] = np.mean([one.nominal[CONTACT_FRICTION] for one in self.sets])
        return unknowns

    def stds(self, priors: Sequence[FrictionPrior]) -> FloatArray:
        """Prior standard deviations of all unknowns, shape (u,), from those of each object."""
        stds = np.full(len(self.nominal), LOG_FRICTION)
        for one, columns, prior in zip(self.sets, self.columns, priors):
            center = prior.center * one.length
            stds[columns] = [center, center, prior.log, LOG_FRICTION,
                             LOG_FLOOR_FRICTION, *[prior.pattern] * (len(columns) - PATTERNS)]
        return stds

    def residuals(self, unknowns: FloatArray) -> FloatArray:
        """Return ends minus recorded ends for k sets of unknowns (k, u), shape (k, 3 n) [m]."""
        each = integrated(self.sets, [unknowns[:, columns] for columns in self.columns])
        return np.hstack([one.ends for one in each])

    def linearized(self, unknowns: FloatArray) -> Linearization:
        """Linearize the pushes of all objects about unknowns (u,)."""
        changed = [one.differences(unknowns[columns])
                   for one, columns in zip(self.sets, self.columns)]
        each = [one.linearized() for one in integrated(self.sets, changed)]
        slopes: list[FloatArray] = []
        for one, columns in zip(each, self.columns):
            slope = np.zeros((len(one.residuals), len(unknowns)))
            slope[:, columns] = one.slope
            slopes.append(slope)
        return Linearization(np.vstack(slopes), np.concatenate([one.residuals for one in each]),
                             np.concatenate([one.slides for one in each]))


class Fit(NamedTuple):
    """
    Unknowns of least cost.

    :param unknowns: shape (u,).
    :param stds: prior standard deviations, shape (u,).
    :param linearization: there.
    :param sigma: standard deviation of what is left, per coordinate of an end [m].
    :param weights: of the squared residuals, shape (3 n,).
    """

    unknowns: FloatArray
    stds: FloatArray
    linearization: Linearization
    sigma: float
    weights: FloatArray


def fitted(pool: Pool, stds: FloatArray, start: Fit | None = None) -> Fit:
    """
    Minimize the cost.

    :param pool: pushes.
    :param stds: prior standard deviations, shape (u,).
    :param start: fit with another prior; None for the nominal objects.
    """
    fit = (start._replace(stds=stds) if start
           else _fit(pool.nominal, stds, pool.linearized(pool.nominal)))
    for _ in range(ITERATIONS):
        better = _improved(pool, fit)
        if better is None:
            break
        fit = _fit(better, stds, pool.linearized(better))
    return fit


def huber_weights(residuals: FloatArray, sigma: float) -> FloatArray:
    """
    Weigh the squared residuals, less where a push is off by more than OUTLIER sigma (Huber 1964).

    :param residuals: of n pushes, shape (3 n,) [m].
    :param sigma: standard deviation of a residual [m].
    :return: shape (3 n,).
    """
    return np.repeat(np.minimum(1.0, OUTLIER * sigma / np.maximum(_sizes(residuals), 1e-12)), 3)


def _fit(unknowns: FloatArray, stds: FloatArray, linearization: Linearization) -> Fit:
    """Estimate the standard deviation of what is left [m], and weights (3 n,) of the pushes."""
    residuals = linearization.residuals
    degrees = max(1.0, len(residuals) - len(unknowns))
    typical = float(np.median(_sizes(residuals))) * math.sqrt(len(residuals) / degrees)
    weights = huber_weights(residuals, max(MIN_SIGMA, typical))
    sigma = max(MIN_SIGMA, math.sqrt(float(weights @ residuals ** 2) / degrees))
    return Fit(unknowns, stds, linearization, sigma, weights)


def _sizes(residuals: FloatArray) -> FloatArray:
    """Root mean square of the three residuals of each push, shape (n,) [m]."""
    return np.sqrt((residuals.reshape(-1, 3) ** 2).mean(axis=1))


def _improved(pool: Pool, fit: Fit) -> FloatArray | None:
    """Take the best of the step and its halvings; None where the cost hardly falls."""
    slope, residuals, _ = fit.linearization
    weights, off = fit.weights / fit.sigma ** 2, fit.unknowns - pool.nominal
    step = -np.linalg.solve(slope.T @ (weights[:, None] * slope) + np.diag(1.0 / fit.stds ** 2),
                            slope.T @ (weights * residuals) + off / fit.stds ** 2)
    tried = fit.unknowns + 0.5 ** np.arange(HALVINGS)[:, None] * step
    costs = pool.residuals(tried) ** 2 @ weights + (
        ((tried - pool.nominal) / fit.stds) ** 2).sum(axis=1)
    cost = float(weights @ residuals ** 2 + ((off / fit.stds) ** 2).sum())
    best = int(np.argmin(costs))
    return tried[best] if costs[best] <= cost * (1.0 - ENOUGH) else None
