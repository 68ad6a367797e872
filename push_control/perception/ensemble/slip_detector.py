"""
Test of two hypotheses of a contact: about as rough as its nominal friction, or slippery.

A linear filter cannot hold both: below the friction that a push needs the contact slides, above it
nothing depends on friction. So ``contact_hypotheses`` follows a second ensemble, with a slippery
contact, from the first contact on. Object poses with the innovations y_i and covariances S_i of an
ensemble give its likelihood

    ln L = sum over i of -(y_i' S_i^-1 y_i + ln det S_i) / 2,

and the odds of slippery over rough are those before the push times the ratio of likelihoods.
"""

import enum
import math

import numpy as np
from push_model.geometry import FloatArray

# Contact friction up to which a contact is slippery, over the nominal one; chosen: two deviations
# below it, where the other ensemble has hardly a member.
SLIPPERY_FRACTION = 0.4
# Odds of slippery over rough before any push; chosen.
PRIOR_ODDS = 0.05
# Odds at which the test ends during a contact; chosen: ensembles are somewhat too sure.
SLIPPERY_ODDS = 1e3
ROUGH_ODDS = 1e-3
# Standard deviations of the contact friction that keep a contact from being slippery; chosen.
ROUGH_SIGMAS = 3.0


class SlipVerdict(enum.Enum):
    """Verdict which of both hypotheses is followed further."""

    BOTH = 'both'
    ROUGH = 'rough'
    SLIPPERY = 'slippery'


class SlipDetector:
    """Odds of slippery over rough contact."""

    def __init__(self) -> None:
        """Start with the odds before any push."""
        # Infinite once the contact is known to be slippery.
        self._log_odds = math.log(PRIOR_ODDS)

    def is_needed(self, nominal: float, friction: FloatArray) -> bool:
        """
        Check whether a contact that is estimated as rough may be slippery.

        :param nominal: contact friction as it is stated.
        :param friction: contact friction of the members, shape (n,).
        """
        if not math.log(ROUGH_ODDS) < self._log_odds < math.inf:
            return False
        limit = SLIPPERY_FRACTION * nominal
        mean, deviation = float(friction.mean()), float(friction.std())
        return mean > limit > mean - ROUGH_SIGMAS * deviation

    def evaluate(self, log_likelihood_ratio: float) -> SlipVerdict:
        """
        Choose a hypothesis during a contact, if one is certain.

        :param log_likelihood_ratio: of slippery over rough, of all poses of this contact.
        """
        log_odds = self._log_odds + log_likelihood_ratio
        if math.log(ROUGH_ODDS) <= log_odds <= math.log(SLIPPERY_ODDS):
            return SlipVerdict.BOTH
        return self.evaluate_after_contact(log_likelihood_ratio)

    def evaluate_after_contact(self, log_likelihood_ratio: float) -> SlipVerdict:
        """
        Choose the likelier hypothesis; the odds count in the next contact too.

        :param log_likelihood_ratio: of slippery over rough, of all poses of this contact.
        :return: ``SlipVerdict``, one of them.
        """
        self._log_odds += log_likelihood_ratio
        if self._log_odds <= 0.0:
            return SlipVerdict.ROUGH
        self._log_odds = math.inf
        return SlipVerdict.SLIPPERY


def slippery_friction(nominal: float, friction: FloatArray) -> FloatArray:
    """
    Spread contact friction evenly over that of slippery contacts, in the order of the members.

    :param nominal: contact friction as it is stated.
    :param friction: contact friction of the members, shape (n,).
    :return: contact friction, shape (n,).
    """
    ranks = np.argsort(np.argsort(friction))
    return SLIPPERY_FRACTION * nominal * (ranks + 0.5) / len(ranks)
