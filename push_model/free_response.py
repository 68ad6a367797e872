"""How a small disturbance of a straight push dies out, or grows, in the linear motion."""

import numpy as np


def free_response(motion, times):
    """
    Turn over time, as a share of the turn from which the object is let go.

    With the poles p and q, ``(p exp(q t) - q exp(p t)) / (p - q)``, written with their mean and
    half their difference so that equal poles do no harm.

    :param motion: ``stability.LinearMotion``.
    :param times: since the object was let go without turning rate [s], shape (n,).
    :return: share, shape (n,).
    """
    first, second = motion.poles
    mean, half = 0.5 * (first + second), 0.5 * (first - second)
    times = np.asarray(times, dtype=float)
    # exp(mean t) sinh(half t) / half, without overflow of its factors.
    rising = times * np.exp(second * times) if half == 0.0 else \
        np.exp(second * times) * np.expm1(2.0 * half * times) / (2.0 * half)
    even = 0.5 * (np.exp(first * times) + np.exp(second * times))
    return np.real(even - mean * rising)
