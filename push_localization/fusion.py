"""
Fusion of measurements whose errors last.

Where a wall is not quite where the map has it, it is so in the next scan as well. So ten scans a
second do not tell ten times as much: no number of them makes the place more certain than one alone
does. With the covariance P = L L' before a measurement of information H, and the eigenvalues v
with vectors U of L' H L,

    P' = L U diag(f) U' L',    f = ((1 + sqrt v) / (1 + v))^2 where v > 1, else 1.

Where the measurement knows less than is known (v < 1), nothing changes; where it knows much more,
what remains is its own covariance, 1 / v. In between the bound is that of two errors that are
fully correlated, at the gain of a Kalman filter: (1 - k + k / sqrt v)^2 with k = v / (1 + v).
"""

from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray

# Variance over that of the estimate that stands for no measurement at all.
NO_INFORMATION = 1e9


class _Directions(NamedTuple):
    """Directions in which estimate and measurement are independent, and the factors f there."""

    axes: FloatArray
    factors: FloatArray


def fused_covariance(covariance: FloatArray, information: FloatArray) -> FloatArray:
    """
    Return the covariance after a measurement whose errors last.

    :param covariance: P before it, shape (n, n).
    :param information: H of the measurement, at least 0, shape (n, n).
    """
    axes, factors = _directions(covariance, information)
    return (axes * factors) @ axes.T


def lasting_correction(covariance: FloatArray, information: FloatArray,
                       correction: FloatArray) -> FloatArray:
    """
    Return what a correction by a measurement whose errors last may change.

    Where it knows less than is known (v < 1) that is nothing: again and again the same error would
    come in, a part of it each time, until all of it has.

    :param covariance: P before it, shape (n, n).
    :param information: H of the measurement, shape (n, n).
    :param correction: of the estimate by both, shape (n,).
    :return: shape (n,).
    """
    axes, factors = _directions(covariance, information)
    parts = np.linalg.solve(axes, correction)
    return axes @ np.where(factors < 1.0, parts, 0.0)


def lasting_noise(covariance: FloatArray, information: FloatArray) -> FloatArray | None:
    """
    Return the covariance of an independent measurement that has the same effect.

    :param covariance: P before it, shape (n, n).
    :param information: H of the measurement, shape (n, n).
    :return: shape (n, n); None where it knows nothing that is not known.
    """
    axes, factors = _directions(covariance, information)
    if factors.min() >= 1.0:
        return None
    noise = np.where(factors < 1.0, factors / np.maximum(1.0 - factors, 1.0 / NO_INFORMATION),
                     NO_INFORMATION)
    return (axes * noise) @ axes.T


def _directions(covariance: FloatArray, information: FloatArray) -> _Directions:
    root = np.linalg.cholesky(covariance)
    values, vectors = np.linalg.eigh(root.T @ information @ root)
    ratios = np.maximum(values, 1.0)
    factors = ((1.0 + np.sqrt(ratios)) / (1.0 + ratios)) ** 2
    return _Directions(np.asarray(root @ vectors, dtype=float), factors)
