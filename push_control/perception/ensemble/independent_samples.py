"""
Random numbers of the members of an ensemble that are not correlated with what they have already.

Numbers that n members draw have, by chance, correlations of about 1 / sqrt(n) with their state. A
filter takes these for knowledge. Images of an object at rest come one after another. Each would
tell a little of what it cannot know, such as where both are in the world. The ensemble becomes too
sure, and wanders off. Numbers whose correlations are 0 leave nothing to take for knowledge
(second-order exact sampling: Pham, Monthly Weather Review 129 (2001)).
"""

import math

import numpy as np
from push_model.geometry import FloatArray


def independent_samples(samples: FloatArray, state: FloatArray) -> FloatArray:
    """
    Take off what random numbers have in common with a state by chance.

    :param samples: standard normal numbers, shape (n, k).
    :param state: numbers of the members, shape (n, m), n > m + k.
    :return: numbers of mean 0 and variance 1 over the members, not correlated with the state nor
        with each other, shape (n, k).
    """
    count, size = samples.shape
    columns = np.column_stack((np.ones(count), state - state.mean(axis=0), samples))
    basis, factor = np.linalg.qr(columns)
    # A column of the basis has the sign of what it was made of.
    signs = np.sign(np.diag(factor)[-size:])
    return np.asarray(math.sqrt(count - 1) * signs * basis[:, -size:], dtype=np.float64)
