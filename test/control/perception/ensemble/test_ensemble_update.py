"""Update of the ensemble: the Kalman gain, computed another way."""

import numpy as np
from push_control.perception.ensemble.ensemble_update import EnsembleUpdate
import pytest

COUNT = 30


def case(size, seed):
    """Draw what members expect, a block of their numbers, noise and an innovation."""
    rng = np.random.default_rng(seed)
    block = rng.normal(5.0, 2.0, (COUNT, 4))
    expected = block[:, :size] + 0.3 * rng.standard_normal((COUNT, size))
    root = rng.standard_normal((size, size))
    return expected, block, root @ root.T + 0.1 * np.eye(size), rng.standard_normal(size)


@pytest.mark.parametrize('size', [1, 3])
@pytest.mark.parametrize('seed', range(3))
def test_the_update_is_that_of_the_filter(size, seed):
    """The mean by the gain times the innovation, the anomalies by half as much."""
    expected, block, noise, innovation = case(size, seed)
    spread = expected - expected.mean(axis=0)
    anomalies = block - block.mean(axis=0)
    covariance = np.cov(spread.T).reshape(size, size) + noise
    gain = anomalies.T @ spread / (COUNT - 1) @ np.linalg.inv(covariance)
    update = EnsembleUpdate(expected, noise)
    np.testing.assert_allclose(update.mean, expected.mean(axis=0))
    test = update.test(innovation)
    assert test.squared_distance == pytest.approx(
        innovation @ np.linalg.inv(covariance) @ innovation)
    assert test.log_determinant == pytest.approx(np.log(np.linalg.det(covariance)))
    moved = block.copy()
    update.apply(moved, first=1)
    after = block.mean(axis=0) + gain @ innovation + anomalies - 0.5 * spread @ gain.T
    np.testing.assert_allclose(moved[:, 1:], after[:, 1:], atol=1e-10)
    assert np.array_equal(moved[:, 0], block[:, 0])


@pytest.mark.parametrize('size', [1, 3])
def test_what_is_measured_is_drawn_anew_as_the_filter_leaves_it(size):
    """With its mean and covariance, those of precisions that add up; no member keeps its own."""
    expected, _, noise, innovation = case(size, 0)
    update = EnsembleUpdate(expected, noise)
    update.test(innovation)
    center, factor = update.resample(np.zeros((1, size)))[0], np.eye(size)
    columns = update.resample(factor) - center
    prior = np.cov(expected.T).reshape(size, size)
    precisions = np.linalg.inv(prior) + np.linalg.inv(noise)
    np.testing.assert_allclose(columns.T @ columns, np.linalg.inv(precisions), atol=1e-10)
    weighted = (np.linalg.inv(prior) @ update.mean
                + np.linalg.inv(noise) @ (update.mean + innovation))
    np.testing.assert_allclose(precisions @ center, weighted, atol=1e-8)


def test_a_jump_of_all_members_explains_the_innovation():
    """Where the poses themselves are measured it is the innovation."""
    robots = np.random.default_rng(1).standard_normal((COUNT, 3))
    update = EnsembleUpdate(robots, np.eye(3))
    update.test(np.array([3.0, -2.0, 0.5]))
    np.testing.assert_allclose(update.jump(robots), (3.0, -2.0, 0.5), atol=1e-12)
