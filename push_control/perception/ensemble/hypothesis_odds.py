"""
Test of a hypothesis against what is stated, by the object poses during contacts.

A linear filter cannot hold both: so ``contact_hypotheses`` follows another ensemble, in which the
hypothesis holds, from the touch on. Object poses with the innovations y_i and covariances S_i of
an ensemble give its likelihood

    ln L = sum over i of -(y_i' S_i^-1 y_i + ln det S_i) / 2,

and the odds of the hypothesis are those before the push times the ratio of likelihoods.
"""

import enum
import math

# Odds before any push; chosen.
PRIOR_ODDS = 0.05
# Odds at which the test ends during a contact; chosen: ensembles are somewhat too sure.
ACCEPTED_ODDS = 1e3
REJECTED_ODDS = 1e-3


class Verdict(enum.Enum):
    """Verdict on a hypothesis."""

    OPEN = 'open'
    REJECTED = 'rejected'
    ACCEPTED = 'accepted'


class HypothesisTest:
    """Odds of a hypothesis over what is stated."""

    def __init__(self) -> None:
        """Start with the odds before any push."""
        # Infinite once the hypothesis is accepted.
        self._log_odds = math.log(PRIOR_ODDS)

    @property
    def is_open(self) -> bool:
        """Tell whether the next contact may decide it."""
        return math.log(REJECTED_ODDS) < self._log_odds < math.inf

    def evaluate(self, log_likelihood_ratio: float) -> Verdict:
        """
        Decide during a contact, where that is certain.

        :param log_likelihood_ratio: of the hypothesis, of all poses of this contact.
        """
        log_odds = self._log_odds + log_likelihood_ratio
        if math.log(REJECTED_ODDS) <= log_odds <= math.log(ACCEPTED_ODDS):
            return Verdict.OPEN
        return self.evaluate_after_contact(log_likelihood_ratio)

    def evaluate_after_contact(self, log_likelihood_ratio: float) -> Verdict:
        """
        Choose what is likelier; the odds count in the next contact too.

        :param log_likelihood_ratio: of the hypothesis, of all poses of this contact.
        :return: ``Verdict``, not open.
        """
        self._log_odds += log_likelihood_ratio
        if self._log_odds <= 0.0:
            return Verdict.REJECTED
        self._log_odds = math.inf
        return Verdict.ACCEPTED
