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
    slow, fast = motion.poles
    apart = slow - fast
    times = np.asarray(times, dtype=float)
    # (exp(slow t) - exp(fast t)) / apart, with factors that do not overflow.
    rising = np.exp(slow * times) * (times if apart == 0.0 else
                                     -np.expm1(-apart * times) / apart)
    return np.real(0.5 * (np.exp(slow * times) + np.exp(fast * times))
                   - 0.5 * (slow + fast) * rising)
