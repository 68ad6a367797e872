"""Weights of friction samples, from what has been learned of it."""

from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray
from push_primitives.table import FrictionSamples

# Least deviations of the kernel about each sample, as there are few of them; chosen: of the centre
# of friction [m] about the distance between neighbours, and of the logarithm of contact friction.
CENTER_KERNEL = 0.015
CONTACT_KERNEL = 0.25
# Contact friction below which samples hardly differ in their effect; chosen.
FRICTION_OFFSET = 0.05
# The kernel is widened by this factor until at least so many samples share the weight; chosen: an
# expectation over fewer takes chance for knowledge.
WIDENING = 1.25
MIN_SHARING = 4.0


class FrictionBelief(NamedTuple):
    """
    Belief about friction: means and standard deviations.

    :param center: centre of friction in the object frame (x, y) [m].
    :param contact_friction: coefficient of contact friction.
    :param center_deviation: standard deviation of either coordinate of the centre [m].
    :param contact_friction_deviation: standard deviation of the contact friction.
    """

    center: tuple[float, float]
    contact_friction: float
    center_deviation: float
    contact_friction_deviation: float


def sample_weights(samples: FrictionSamples, belief: FrictionBelief) -> FloatArray:
    """
    Weigh friction samples by a Gaussian kernel about what is known.

    With centres of friction c_k and ``m_k = ln(mu_k + mu_0)``, the weight is

        exp(-|c_k - c|^2 / (2 (s_c^2 + h_c^2)) - (m_k - m)^2 / (2 (s_m^2 + h_m^2)))

    where s are the deviations of the belief and h those of the kernel, widened until four samples
    share the weight: ``(sum w)^2 / sum w^2 >= 4``.

    :return: weights, shape (K,), of sum 1.
    """
    away = ((samples.centers - np.array(belief.center)) ** 2).sum(axis=1)
    scale = belief.contact_friction + FRICTION_OFFSET
    ratio = np.log((samples.contact_frictions + FRICTION_OFFSET) / scale)
    exponents = 0.5 * (away / (belief.center_deviation ** 2 + CENTER_KERNEL ** 2)
                       + ratio ** 2 / ((belief.contact_friction_deviation / scale) ** 2
                                       + CONTACT_KERNEL ** 2))
    exponents -= exponents.min()
    sharing = min(MIN_SHARING, float(len(exponents)))
    while True:
        weights = np.exp(-exponents)
        weights /= weights.sum()
        # The last bits of equal weights are no reason to go on.
        if 1.0 / (weights ** 2).sum() >= sharing - 1e-9:
            return weights
        exponents /= WIDENING ** 2
