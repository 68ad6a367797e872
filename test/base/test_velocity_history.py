"""The newest velocities on a grid, against a list of all of them."""

import numpy as np
from push_base.velocity_history import VelocityHistory
from push_model.signals import Twist
import pytest

LENGTH = 7


@pytest.mark.parametrize('count', [0, 1, LENGTH, LENGTH + 1, 10 * LENGTH + 3])
def test_it_keeps_the_newest(count: int) -> None:
    """Before the oldest one that is kept the base stands; behind the newest it goes on."""
    history, rng = VelocityHistory(LENGTH), np.random.default_rng(1)
    everything = [Twist(*rng.normal(size=3)) for _ in range(count)]
    for velocity in everything:
        history.append(velocity)
    kept = everything[-LENGTH:]
    assert len(history) == len(kept)
    places = np.array([[-LENGTH, -1, 0], [len(kept) // 2, len(kept) - 1, len(kept) + 3]])
    expected = [[kept[min(place, len(kept) - 1)] if kept and place >= 0 else Twist(0.0, 0.0, 0.0)
                 for place in row] for row in places.tolist()]
    np.testing.assert_array_equal(history.at(places), expected)


def test_a_matrix_applies_to_all_that_are_kept() -> None:
    """And not to those that come later."""
    history, matrix = VelocityHistory(LENGTH), np.array([[2., 0., 1.], [0., 3., 0.], [0., 0., 4.]])
    history.append(Twist(1.0, 2.0, 3.0))
    history.transform(matrix)
    history.append(Twist(1.0, 2.0, 3.0))
    np.testing.assert_array_equal(history.at(np.arange(-1, 2)),
                                  [[0.0, 0.0, 0.0], [5.0, 6.0, 12.0], [1.0, 2.0, 3.0]])


def test_bases_are_kept_apart() -> None:
    """Each one's velocities are as in a history of its own."""
    both, rng = VelocityHistory(LENGTH, 2), np.random.default_rng(2)
    alone = VelocityHistory(LENGTH), VelocityHistory(LENGTH)
    for velocities in rng.normal(size=(5 * LENGTH, 2, 3)):
        both.append(velocities)
        for history, velocity in zip(alone, velocities):
            history.append(velocity)
    places = np.arange(-2, LENGTH + 2)
    for base, history in enumerate(alone):
        np.testing.assert_array_equal(both.at(places, base), history.at(places))
