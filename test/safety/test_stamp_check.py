"""Stamps that are off are refused, one by one; time that has changed is believed."""

import numpy as np
from push_safety.stamp_check import StampCheck, StampVerdict
import pytest

ACCEPTED, REFUSED, BACK, AHEAD = StampVerdict


def running(check, start, count, now=0.0):
    """Let odometry come at 50 Hz."""
    return [check.check_odometry(start + 0.02 * i, now + 0.02 * i) for i in range(count)]


@pytest.mark.parametrize('off', [-1e9, -5.0, -1.2, 1.5, 5.0, 1e9])
def test_a_lone_stamp_that_is_off_changes_nothing(off):
    """Neither of odometry nor of a pose; what comes after it is as before."""
    check = StampCheck()
    assert set(running(check, 100.0, 50)) == {ACCEPTED}
    assert check.check_odometry(101.0 + off, 1.0) is REFUSED
    assert check.check_pose(101.0 + off, 1.0) is REFUSED
    assert set(running(check, 101.0, 50, 1.0)) == {ACCEPTED}
    assert check.check_pose(101.9, 2.0) is ACCEPTED


@pytest.mark.parametrize('start', [0.0, 0.5, 99.9])
def test_a_clock_that_begins_again_is_believed_at_once(start):
    """As of a simulator that was started again, at zero or where it has begun."""
    check = StampCheck()
    running(check, 100.0, 150)
    assert running(check, start, 5, 3.0) == [REFUSED, REFUSED, BACK, ACCEPTED, ACCEPTED]


@pytest.mark.parametrize('start', [0.0, 0.5])
def test_the_clock_of_a_computer_does_not_begin_again_at_zero(start: float) -> None:
    """Stamps there are of somebody without a clock: who gets it back has never been away."""
    first, check = 1.8e9, StampCheck()
    running(check, first, 50)
    assert set(running(check, start, 100, 1.0)) == {REFUSED}
    assert set(running(check, first + 3.0, 50, 3.0)) == {ACCEPTED}
    found = running(check, start, 200, 4.0)
    assert found.index(BACK) == 150 and found[-1] is ACCEPTED


@pytest.mark.parametrize('pace', [1.0, 0.1])
@pytest.mark.parametrize('off', [-97.0, -30.0, -1.2, 1.4, 1000.0])
def test_a_clock_that_comes_back_has_never_been_away(off, pace):
    """However fast simulated time passes; one that stays there is believed after a while."""
    check = StampCheck()
    running(check, 100.0, 250, 0.0)
    jumped = [check.check_odometry(105.0 + 0.02 * i + off, 5.0 + 0.02 * pace * i)
              for i in range(100)]
    assert set(jumped) == {REFUSED}
    now = 5.0 + 2.0 * pace
    assert set(running(check, 107.0, 100, now)) == {ACCEPTED}
    found = running(check, 109.0 + off, 200, now + 2.0)
    assert found.index(BACK if off < 0.0 else AHEAD) == 150 and found[-1] is ACCEPTED
    # At any pace time has passed meanwhile, too.
    assert off < 0.0 or off - 0.02 <= check.ahead <= off + 3.1


def test_a_clock_that_begins_again_and_catches_up_has_gone_back():
    """It was first seen some time after its beginning: nothing of before is left all the same."""
    check = StampCheck()
    running(check, 0.0, 250)
    found = running(check, 2.0, 200, 5.0)
    assert REFUSED in found and BACK in found
    assert ACCEPTED not in found[:found.index(BACK)]


def test_a_clock_that_stands_elsewhere_is_never_believed():
    """No time passes on it, however often the same stamp comes."""
    check = StampCheck()
    running(check, 100.0, 50)
    assert {check.check_odometry(0.0, 1.0 + 0.02 * i) for i in range(500)} == {REFUSED}


def test_poses_of_another_clock_never_change_the_time():
    """However many agree."""
    check = StampCheck()
    running(check, 100.0, 50)
    assert {check.check_pose(90.0 + 0.05 * i, 1.0 + 0.05 * i) for i in range(50)} == {REFUSED}
    assert check.check_odometry(101.0, 3.5) is ACCEPTED


def test_a_pause_of_all_messages_is_no_change_of_time():
    """The steady clock has gone on as well."""
    check = StampCheck()
    running(check, 100.0, 50)
    assert check.check_odometry(160.0, 60.0) is ACCEPTED


@pytest.mark.parametrize('seed', range(20))
def test_outliers_among_good_stamps_are_all_refused(seed):
    """At random, but never three in a row that agree."""
    rng, check = np.random.default_rng(seed), StampCheck()
    for i in range(500):
        time = 0.02 * i
        assert check.check_odometry(50.0 + time, time) is ACCEPTED
        for _ in range(rng.integers(3)):
            off = rng.uniform(1.1, 100.0) * rng.choice([-1.0, 3.0])
            assert check.check_odometry(50.0 + time + off, time) is REFUSED
