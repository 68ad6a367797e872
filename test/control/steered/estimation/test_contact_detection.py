"""Detection of slip and loss of contact: from geometry, neither from noise nor late."""

import math

from helpers.contact_sites import SITES
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.contact_detection import (
    ContactDetector, ContactState, TwoHypothesisFilter)
from push_control.steered.estimation.contact_site import ContactOffset
from push_control.steered.estimation.cusum import CusumTest
import pytest

SETTINGS = ControlSettings()


def repeated(detector, offset, count):
    """Give a detector the same offset at one place; return what it tells each time."""
    return [detector.update(ContactOffset(*offset), 0.5) for _ in range(count)]


def make_detector():
    """Detect slip and loss of a contact at the corner of a box."""
    return ContactDetector(SETTINGS, 0.17, SITES['vertex'])


def test_the_cusum_test_sums_up_what_lasts_and_no_single_error():
    """Page's test: sooner for more, on either side, not for one wild error among small ones."""
    def delay(score):
        cusum = CusumTest(5.0)
        return next(k for k in range(1, 1000) if cusum.update(score))

    assert 1 < delay(3.0) < delay(2.0) < delay(1.0)
    assert CusumTest(5.0).update(1e9) == 0
    cusum = CusumTest(5.0)
    assert [cusum.update(-3.0) for _ in range(3)] == [0, 0, -1]
    assert not any(CusumTest(5.0).update(0.7) for _ in range(1000))


def joint_filter(slip_std, noise_std, drift_walk):
    """Make the same filter with matrices: state (slip, drift), measurement slip + drift."""
    covariance = np.diag((slip_std ** 2, (0.5 * noise_std) ** 2))
    h = np.ones((1, 2))

    def update(distance, offset):
        nonlocal covariance
        covariance = covariance + np.diag((0.0, distance * drift_walk ** 2))
        variance = (h @ covariance @ h.T).item() + noise_std ** 2
        gain = covariance @ h.T / variance
        covariance = covariance - gain @ h @ covariance
        return math.sqrt(variance), gain.ravel() * offset, covariance

    return update


def test_the_two_hypothesis_filter_is_a_kalman_filter():
    """Deviation, attribution and covariance at every step, against the matrix form."""
    rng = np.random.default_rng(0)
    filter_, reference = TwoHypothesisFilter(7e-3, 2e-3, 6e-3), joint_filter(7e-3, 2e-3, 6e-3)
    for distance, offset in zip(rng.uniform(0.0, 0.05, 50), rng.normal(0.0, 5e-3, 50)):
        deviation = filter_.predict(distance)
        found = filter_.attribute(offset)
        expected_deviation, parts, covariance = reference(distance, offset)
        assert deviation == pytest.approx(expected_deviation, rel=1e-9)
        assert found == pytest.approx(parts, rel=1e-9)
        slip, cross, drift = filter_.covariance
        assert np.array([[slip, cross], [cross, drift]]) == pytest.approx(covariance, rel=1e-6)
        assert slip > 0.0 and drift > 0.0 and slip * drift > cross ** 2


def test_an_offset_goes_to_the_hypothesis_that_explains_it():
    """At rest it is slip as far as that is expected; after a long path it is drift."""
    placed = TwoHypothesisFilter(0.01, 1e-3, 6e-3).attribute(5e-3)
    assert placed.slip > 0.9 * 5e-3 and abs(placed.drift) < 0.1 * 5e-3
    driven = TwoHypothesisFilter(1e-3, 1e-3, 6e-3)
    driven.predict(4.0)
    found = driven.attribute(5e-3)
    assert found.drift > 0.9 * 5e-3 and found.slip < 0.1 * 5e-3
    driven.expect_slip(0.1)
    assert driven.attribute(5e-3).slip > 0.9 * 5e-3


def test_noise_and_drift_are_no_slip_and_no_loss():
    """Over 20 m in all, with the noise of the settings and a heading error of 0.02 rad."""
    for seed in range(4):
        rng, detector = np.random.default_rng(seed), make_detector()
        noise = math.hypot(SETTINGS.pose_noise, 0.28 * SETTINGS.heading_noise)
        drift, slid = np.zeros(2), 0.0
        for k in range(500):
            drift += (2e-4, 2e-4)
            seen = drift + rng.normal(0.0, noise, 2) - (0.0, slid)
            found = detector.update(ContactOffset(*seen), 0.01 * (k + 1))
            drift -= found.drift
            slid += found.slip
        assert (detector.slips, detector.contact_losses) == (0, 0)
        assert detector.state is not ContactState.LOST
        assert abs(slid) < 0.5 * SETTINGS.push_direction_std * 0.17 + 2e-3


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_slip_is_detected_within_a_few_poses_and_followed(side):
    """From one pose to the next the contact has moved by 15 mm, and stays there."""
    detector = make_detector()
    repeated(detector, (0.0, 0.0), 20)
    slid, seen = 0.0, None
    for k in range(10):
        left = side * 0.015 - slid
        found = detector.update(ContactOffset(0.0, left), 0.5 + 0.01 * (k + 1))
        slid += found.slip + found.drift.slip
        seen = k if seen is None and detector.state is ContactState.SLIDING else seen
    assert detector.slips == 1 and seen <= 3
    assert slid == pytest.approx(side * 0.015, abs=2e-3)


def test_a_gap_is_detected_within_a_few_poses_and_its_end_too():
    """While it is open nothing is told about slip; an overlap is no gap."""
    detector = make_detector()
    repeated(detector, (0.0, 0.0), 20)
    found = repeated(detector, (0.03, 0.02), 6)
    assert detector.state is ContactState.LOST
    assert (detector.slips, detector.contact_losses) == (0, 1)
    assert found[-1] == (0.0, ContactOffset(0.0, 0.0))
    repeated(detector, (0.001, 0.0), 6)
    assert detector.state is not ContactState.LOST and detector.contact_losses == 1
    repeated(detector, (-0.05, 0.02), 6)
    assert detector.state is not ContactState.LOST and detector.slips == 0
