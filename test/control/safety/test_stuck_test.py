"""A base that is stuck at a command: known by what does not vary, whatever else is not known."""

import math

import numpy as np
from numpy.typing import NDArray
from push_control.safety.close_following import LEVER
from push_control.safety.stuck_test import add_sample, COVARIANCE, MEMORY, StuckTest, VARIANCE
import pytest

PERIOD = 0.02
ALL_COUNT = np.zeros(1)
TIMES = np.arange(0.0, 2.0, PERIOD)
# A command that varies by 20 mm/s, and by 0.1 rad/s.
MODEL = np.stack([0.15 + 0.02 * np.sin(4.0 * TIMES), 0.0 * TIMES, 0.1 * np.cos(4.0 * TIMES)],
                 axis=1)


def found_stuck(measured: NDArray[np.float64], model: NDArray[np.float64] = MODEL) -> list[bool]:
    """Tell after each sample whether the base is stuck, with one model."""
    test, found = StuckTest(1), []
    for velocity, sample in zip(model, measured):
        test.add(velocity[None], sample, PERIOD)
        found.append(test.is_stuck(ALL_COUNT, 0.0))
    return found


def test_integrals_are_those_of_weighted_samples() -> None:
    """Computed anew from all samples, with steps of any duration."""
    rng = np.random.default_rng(1)
    durations = rng.uniform(0.01, 0.1, 40)
    models, measured = rng.normal(0.0, 0.1, (40, 2, 3)), rng.normal(0.0, 0.1, (40, 3))
    means, integrals, weight = np.zeros((3, 3)), np.zeros((3, 2)), 0.0
    for model, sample, dt in zip(models, measured, durations):
        weight = add_sample(model, sample, means, integrals, weight, dt)
    ends = np.cumsum(durations)
    weights = durations * np.exp((ends - ends[-1]) / MEMORY)
    assert weight == pytest.approx(weights.sum())
    units = np.array((1.0, 1.0, LEVER))
    values = np.concatenate([models, measured[:, None]], axis=1) * units
    deviations = values - np.average(values, axis=0, weights=weights)
    for i in range(3):
        products = (deviations[:, i] * deviations[:, i], deviations[:, i] * deviations[:, 2])
        variance, covariance = (float(weights @ product.sum(axis=1)) for product in products)
        assert integrals[i, VARIANCE] == pytest.approx(variance)
        assert integrals[i, COVARIANCE] == pytest.approx(covariance)


@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_a_base_that_keeps_a_velocity_is_stuck(noise: float) -> None:
    """Whichever it keeps, with noise as well; it is not where nothing is commanded to vary."""
    draws = noise * np.random.default_rng(2).standard_normal(MODEL.shape) * (1.0, 1.0, 2.0)
    for velocity in ((0.15, 0.0, 0.1), (0.0, 0.0, 0.0)):
        measured = np.broadcast_to(velocity, MODEL.shape) + draws
        found = found_stuck(measured)
        assert any(found) and found.index(True) * PERIOD < 0.5
        assert not any(found_stuck(measured, np.broadcast_to(MODEL[0], MODEL.shape)))


@pytest.mark.parametrize('ratio', [0.42, 1.0, 1.5])
@pytest.mark.parametrize('offset', [-0.1, 0.0, 0.1])
def test_a_base_that_follows_in_some_measure_is_not_stuck(ratio: float, offset: float) -> None:
    """With wheels of another size, and driven by something else besides."""
    draws = 0.005 * np.random.default_rng(3).standard_normal(MODEL.shape) * (1.0, 1.0, 2.0)
    assert not any(found_stuck(ratio * MODEL + offset + draws))


@pytest.mark.parametrize('step', [0.005, 0.01])
def test_a_base_whose_speeds_come_in_steps_is_not_stuck(step: float) -> None:
    """As it keeps each of them for a while only."""
    for slope in (0.02, 0.05, 0.1, 0.3):
        model = np.stack([0.1 + slope * TIMES, 0.0 * TIMES, 0.0 * TIMES], axis=1)
        assert not any(found_stuck(step * np.round(model / step), model))


def test_a_model_that_does_not_count_explains_nothing() -> None:
    """One that does is enough; none says nothing."""
    test = StuckTest(2)
    for velocity in MODEL:
        test.add(np.stack([velocity, MODEL[0]]), MODEL[0], PERIOD)
    assert not test.is_stuck(np.zeros(2), 0.0)
    assert test.is_stuck(np.array((0.0, 1.0)), 0.5)
    assert not test.is_stuck(np.full(2, math.inf), 0.5)
    test.clear()
    assert not test.is_stuck(np.zeros(2), 0.0)
