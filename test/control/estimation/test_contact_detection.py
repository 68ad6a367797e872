"""Detection of slip and loss of contact: from geometry, neither from noise nor late."""

import math

import numpy as np
from push_control.estimation.contact_detection import ContactDetector, ContactState, CusumTest
from push_control.estimation.contact_site import ContactOffset, ContactSite
from push_control.settings import ControlSettings
import pytest

SETTINGS = ControlSettings()
UNLIMITED = (-math.inf, math.inf)
SITES = {
    'vertex': ContactSite('vertex', 0.0, 0.17, 0.0, (-0.2, -0.2), 0.8, 0.6, (0.0, math.pi / 2)),
    'face': ContactSite('face', 1.0, 0.17, math.inf, (-0.2, 0.03), 0.0, 0.1, UNLIMITED),
    'round': ContactSite('round', 0.6, 0.17, 0.255, (-0.255, 0.0), 0.0, 0.1, UNLIMITED)}


def looks(watch, offset, count):
    """Show a watch the same offset at one place; return what it finds each time."""
    return [watch.update(ContactOffset(*offset), 0.5) for _ in range(count)]


def make_watch():
    """Watch a contact at the corner of a box."""
    return ContactDetector(SETTINGS, 0.17, SITES['vertex'])


def test_the_alarm_sums_up_what_lasts_and_no_single_error():
    """Page's test: sooner for more, on either side, not for one wild error among small ones."""
    def delay(score):
        alarm = CusumTest(5.0)
        return next(k for k in range(1, 1000) if alarm.update(score))

    assert 1 < delay(3.0) < delay(2.0) < delay(1.0)
    assert CusumTest(5.0).update(1e9) == 0
    alarm = CusumTest(5.0)
    assert [alarm.update(-3.0) for _ in range(3)] == [0, 0, -1]
    assert not any(CusumTest(5.0).update(0.7) for _ in range(1000))


def test_noise_and_drift_are_no_slip_and_no_loss():
    """Over 20 m in all, with the noise that is reckoned with and a heading error of 0.02 rad."""
    for seed in range(4):
        rng, watch = np.random.default_rng(seed), make_watch()
        noise = math.hypot(SETTINGS.pose_noise, 0.28 * SETTINGS.heading_noise)
        drift, slid = np.zeros(2), 0.0
        for k in range(500):
            drift += (2e-4, 2e-4)
            seen = drift + rng.normal(0.0, noise, 2) - (0.0, slid)
            found = watch.update(ContactOffset(*seen), 0.01 * (k + 1))
            drift -= found.drift
            slid += found.slip
        assert (watch.slips, watch.contact_losses) == (0, 0)
        assert watch.state is not ContactState.LOST
        assert abs(slid) < 0.5 * SETTINGS.push_direction_std * 0.17 + 2e-3


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_slip_is_told_within_a_few_poses_and_followed(side):
    """From one pose to the next the contact has moved by 15 mm, and stays there."""
    watch = make_watch()
    looks(watch, (0.0, 0.0), 20)
    slid, seen = 0.0, None
    for k in range(10):
        left = side * 0.015 - slid
        found = watch.update(ContactOffset(0.0, left), 0.5 + 0.01 * (k + 1))
        slid += found.slip + found.drift.slip
        seen = k if seen is None and watch.state is ContactState.SLIDING else seen
    assert watch.slips == 1 and seen <= 3
    assert slid == pytest.approx(side * 0.015, abs=2e-3)


def test_a_gap_is_told_within_a_few_poses_and_its_end_too():
    """While it is open nothing is said about slip; an overlap is no gap."""
    watch = make_watch()
    looks(watch, (0.0, 0.0), 20)
    found = looks(watch, (0.03, 0.02), 6)
    assert watch.state is ContactState.LOST and watch.contact_losses == 1 and watch.slips == 0
    assert found[-1] == (0.0, ContactOffset(0.0, 0.0))
    looks(watch, (0.001, 0.0), 6)
    assert watch.state is not ContactState.LOST and watch.contact_losses == 1
    looks(watch, (-0.05, 0.02), 6)
    assert watch.state is not ContactState.LOST and watch.slips == 0
