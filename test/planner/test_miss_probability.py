"""Probability that a push misses: what is harder misses more."""

import math

import numpy as np
from push_planner.sequence.miss_probability import miss_probability

ROTATIONS = np.linspace(0.0, 12.0, 25)[:, None, None, None]
STRAIGHTS = np.array([0.0, 0.05, 0.2, 0.35, 0.6, 3.0, math.inf])[:, None, None]
LENGTHS = np.array([0.0, 0.4, 0.7, 1.0, 1.4, 2.0, math.inf])[:, None]
ON_FACE = np.array([False, True])


def grid():
    """Return probabilities of all sorts of pushes, axes as the arrays above."""
    return miss_probability(ROTATIONS, STRAIGHTS, LENGTHS, ON_FACE)


def test_it_is_a_probability():
    """Between 0 and 1, never certain to hit, and for numbers the same as for arrays."""
    probabilities = grid()
    assert probabilities.min() > 0.0 and probabilities.max() == 1.0
    for i, j, k, m in ((0, 0, 0, 1), (1, 1, 2, 0), (3, 2, 3, 1), (13, 5, 6, 0)):
        one = miss_probability(float(ROTATIONS[i].item()), float(STRAIGHTS[j].item()),
                               float(LENGTHS[k].item()), bool(ON_FACE[m]))
        assert float(one) == probabilities[i, j, k, m]


def test_what_is_harder_misses_more():
    """It grows with the rotation, and falls with the straight end and with the path length."""
    probabilities = grid()
    assert np.all(np.diff(probabilities, axis=0) >= 0.0)
    assert np.all(probabilities[-1] > probabilities[0])
    assert np.all(np.diff(probabilities, axis=1) <= 0.0)
    assert np.all(np.diff(probabilities, axis=2) <= 0.0)
    # A rotation that is over long before the end does no harm, unless it goes nearly round.
    assert np.all(probabilities[0, -1] == probabilities[1, -1])
    assert np.all(probabilities[1, 0] > probabilities[1, -1])


def test_at_a_face_only_short_paths_miss_more():
    """There the place along the face matters; in the end a long path corrects for it."""
    probabilities = grid()[0, -1]
    assert probabilities[0, 1] > probabilities[0, 0]
    assert probabilities[-1, 1] == probabilities[-1, 0]
    assert np.all(np.diff(probabilities[:, 1] - probabilities[:, 0]) <= 0.0)
