"""Page's test: detects a small lasting change of a mean."""

# Largest deviation that a single measurement may add to the CUSUM test, and what it is reduced by,
# both in standard deviations. Chosen: one wild error raises nothing; three of them do.
CUSUM_CLIP = 3.0
CUSUM_SLACK = 0.75


class CusumTest:
    """Page's cumulative sum test: sums up what exceeds noise, so small lasting changes count."""

    def __init__(self, threshold: float):
        """
        Start with empty sums.

        :param threshold: sum at which the test detects a change, in standard deviations.
        """
        self._threshold = threshold
        self._above = self._below = 0.0

    def update(self, score: float) -> int:
        """
        Add an error; one wild error alone is no change.

        :param score: the error over its standard deviation.
        :return: 1 or -1 for the side of a change, which resets the test; else 0.
        """
        score = min(CUSUM_CLIP, max(-CUSUM_CLIP, score))
        self._above = max(0.0, self._above + score - CUSUM_SLACK)
        self._below = max(0.0, self._below - score - CUSUM_SLACK)
        above, below = self._above, self._below
        if max(above, below) <= self._threshold:
            return 0
        self._above = self._below = 0.0
        return 1 if above > self._threshold else -1
