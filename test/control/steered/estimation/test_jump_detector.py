"""Jumps of the centre of friction: detected soon, and not by noise, however large that is."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.jump_detector import JumpDetector
from push_model.geometry import FloatArray
import pytest

THRESHOLD = ControlSettings().jump_threshold


def alarms(innovations: FloatArray, std: float = 1.0) -> list[int]:
    """List the innovations at which a detector that expects a deviation detects a jump."""
    detector = JumpDetector(THRESHOLD)
    return [k for k, one in enumerate(innovations.tolist()) if detector.update(one, std ** 2)]


@pytest.mark.parametrize('factor', [0.5, 1.0, 2.0])
def test_white_noise_is_no_jump_whatever_poses_state_of_it(factor: float) -> None:
    """In a hundred pushes of 20 s there is no false alarm."""
    white = factor * np.random.default_rng(0).standard_normal((100, 400))
    assert not any(alarms(row) for row in white)


@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_a_mean_of_two_deviations_is_detected_within_two_seconds(side: float) -> None:
    noise = np.random.default_rng(1).standard_normal((50, 70))
    first = [alarms(row + side * 2.0 * (np.arange(70) > 40)) for row in noise]
    assert all(one and 40 < one[0] < 70 for one in first)


def test_a_larger_mean_is_detected_sooner_and_a_single_error_never() -> None:
    def delay(mean: float) -> float:
        return next(iter(alarms(np.full(100, mean))), math.inf)

    assert 3 <= delay(4.0) <= delay(2.0) < delay(1.0) < delay(0.5) == math.inf
    assert alarms(np.where(np.arange(100) == 50, 1e3, 0.0)) == []


def test_a_detection_depends_on_no_unit_and_no_side() -> None:
    rows = np.random.default_rng(2).standard_normal(300) + 1.5
    assert alarms(rows) == alarms(-rows) == alarms(1e-3 * rows, 1e-3) != []


def test_what_was_summed_up_before_a_restart_is_forgotten() -> None:
    detector = JumpDetector(THRESHOLD)
    for _ in range(100):
        assert not detector.update(3.0, 1.0)
        detector.restart()
