"""
Whether pushes say that friction on the floor is not as statics has it.

Two fits of the same pushes differ in the prior of the friction on the floor, ``STATICS`` and
``FREE``. With c_j the cost of push j, p - p_0 the distance from the prior, S its deviations and D
the information of the pushes, the logarithm of the likelihood of the pushes of one object is,
but for a constant (Laplace's method),

    L = -1/2 (sum_j c_j + |S^-1 (p - p_0)|^2 + log det(1 + S D S)).

An object is freed where L grows by more than LOG_ODDS, and would without the push that speaks most
for it: one push that went wrong frees nothing.
"""

from typing import NamedTuple, Sequence

import numpy as np
from push_control.identification.friction_changes import CONTACT_FRICTION
from push_control.identification.pooled_fit import Fit, huber_weights, Pool
from push_model.geometry import FloatArray

# Odds at which supports and floor are as the object's file has them: 20 to 1. Chosen.
LOG_ODDS = 3.0


class _Likelihood(NamedTuple):
    """Logarithm of the likelihood of the pushes of one object; costs of the pushes, (n,)."""

    log: float
    costs: FloatArray


def freed(pool: Pool, statics: Fit, free: Fit) -> list[bool]:
    """
    Say of which objects the friction on the floor is not as statics has it.

    :param pool: pushes of all objects.
    :param statics: fit with the prior ``STATICS``.
    :param free: fit with the prior ``FREE``.
    """
    # What is left where friction is free is noise; else it may be friction.
    sigma = min(statics.sigma, free.sigma)
    return [_is_freed(one, other) for one, other in zip(
        _likelihoods(pool, statics, sigma), _likelihoods(pool, free, sigma))]


def _is_freed(statics: _Likelihood, free: _Likelihood) -> bool:
    most_telling = max(0.0, float((statics.costs - free.costs).max()))
    return free.log - statics.log - 0.5 * most_telling > LOG_ODDS


def _likelihoods(pool: Pool, fit: Fit, sigma: float) -> Sequence[_Likelihood]:
    """Return the likelihood of each object; mu_c is as good as known, as all share it."""
    slope, residuals, _ = fit.linearization
    weights = huber_weights(residuals, sigma) / sigma ** 2
    costs = (weights * residuals ** 2).reshape(-1, 3).sum(axis=1)
    off = (fit.unknowns - pool.nominal) / fit.stds
    likelihoods: list[_Likelihood] = []
    first = 0
    for one, columns in zip(pool.sets, pool.columns):
        own = np.delete(columns, CONTACT_FRICTION)
        rows = slice(3 * first, 3 * (first + len(one.starts)))
        scaled = slope[rows, own] * fit.stds[own]
        information = scaled.T @ (weights[rows, None] * scaled)
        _, log_determinant = np.linalg.slogdet(np.eye(len(own)) + information)
        each = costs[first:first + len(one.starts)]
        cost = float(each.sum() + (off[own] ** 2).sum() + log_determinant)
        likelihoods.append(_Likelihood(-0.5 * cost, each))
        first += len(one.starts)
    return likelihoods
