"""Former poses: interpolated between their times, and dropped once nobody asks for them."""

import numpy as np
from push_control.perception.ensemble.pose_history import HISTORY_TIME, PoseHistory
import pytest

PERIOD = 0.02


def history(count):
    """Return a history whose poses are the time in every number, and its last time."""
    kept = PoseHistory()
    for k in range(count):
        kept.append(k * PERIOD, np.full((2, 6), k * PERIOD))
    return kept, (count - 1) * PERIOD


@pytest.mark.parametrize('ago', [0.0, 0.013, 0.1, 0.239])
def test_poses_are_interpolated(ago):
    """Before measurements of that time have come, and after: nothing that is dropped is missed."""
    kept, last = history(20)
    for _ in range(2):
        np.testing.assert_allclose(kept.at(last - ago), last - ago, atol=1e-12)
        kept.drop_before(last - ago)
    np.testing.assert_allclose(kept.at(last - 0.5 * ago), last - 0.5 * ago, atol=1e-12)
    assert len(kept.times) <= 2 + ago / PERIOD


def test_outside_of_its_times_the_ends_stand():
    kept, last = history(5)
    assert (kept.at(-1.0) == 0.0).all() and (kept.at(last + 1.0) == last).all()


def test_old_poses_are_dropped():
    """Without any measurement too; what stays is a copy."""
    kept, last = history(200)
    assert last - kept.times[0] <= HISTORY_TIME
    poses = np.zeros((2, 6))
    kept.restart(9.0, poses)
    poses[:] = 5.0
    assert kept.times == [9.0] and (kept.at(9.0) == 0.0).all()
