"""
Hypothesis of a contact that is slippery, and not about as rough as its nominal friction.

Below the friction that a push needs the contact slides, above it nothing depends on friction.
"""

import numpy as np
from push_control.perception.ensemble.hypothesis_odds import HypothesisTest
from push_model.geometry import FloatArray

# Contact friction up to which a contact is slippery, over the nominal one; chosen: two deviations
# below it, where the other ensemble has hardly a member.
SLIPPERY_FRACTION = 0.4
# Standard deviations of the contact friction that keep a contact from being slippery; chosen.
ROUGH_SIGMAS = 3.0


class SlipDetector(HypothesisTest):
    """Odds of slippery over rough contact."""

    def is_needed(self, nominal: float, friction: FloatArray) -> bool:
        """
        Check whether a contact that is estimated as rough may be slippery.

        :param nominal: contact friction as it is stated.
        :param friction: contact friction of the members, shape (n,).
        """
        limit = SLIPPERY_FRACTION * nominal
        mean, deviation = float(friction.mean()), float(friction.std())
        return self.is_open and mean > limit > mean - ROUGH_SIGMAS * deviation


def slippery_friction(nominal: float, friction: FloatArray) -> FloatArray:
    """
    Spread contact friction evenly over that of slippery contacts, in the order of the members.

    :param nominal: contact friction as it is stated.
    :param friction: contact friction of the members, shape (n,).
    :return: contact friction, shape (n,).
    """
    ranks = np.argsort(np.argsort(friction))
    return SLIPPERY_FRACTION * nominal * (ranks + 0.5) / len(ranks)
