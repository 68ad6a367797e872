"""Laws of the fusion of measurements whose errors last."""

import numpy as np
from push_localization.fusion import fused_covariance, lasting_correction, lasting_noise
import pytest

RNG = np.random.default_rng(0)
FACTORS = [RNG.standard_normal((3, 3)) for _ in range(4)]
COVARIANCES = [factor @ factor.T + 0.1 * np.eye(3) for factor in FACTORS]


def smallest(matrix):
    """Return the smallest eigenvalue of a symmetric matrix."""
    return np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min()


@pytest.mark.parametrize('covariance', COVARIANCES)
def test_no_number_of_measurements_is_more_certain_than_one(covariance):
    """A hundred scans leave at least the covariance of one scan alone."""
    information = np.linalg.inv(0.01 * COVARIANCES[0])
    present = covariance
    for _ in range(100):
        present = fused_covariance(present, information)
        assert smallest(present - np.linalg.inv(information)) > -1e-12
    assert np.allclose(present, np.linalg.inv(information), rtol=0.2)


@pytest.mark.parametrize('covariance', COVARIANCES)
def test_what_knows_less_changes_nothing(covariance):
    """A measurement of half the information, or of none along a direction, leaves what is."""
    half = 0.5 * np.linalg.inv(covariance)
    assert np.allclose(fused_covariance(covariance, half), covariance)
    assert np.allclose(fused_covariance(covariance, np.zeros((3, 3))), covariance)
    direction = np.linalg.cholesky(np.linalg.inv(covariance))[:, 0]
    along = fused_covariance(covariance, 1e4 * np.outer(direction, direction))
    assert smallest(covariance - along) > -1e-12
    assert np.linalg.matrix_rank(covariance - along, tol=1e-9) == 1


@pytest.mark.parametrize('covariance', COVARIANCES)
def test_an_estimate_is_corrected_where_it_becomes_surer_only(covariance):
    """By all of it, or by nothing; a weak measurement that comes again and again moves nothing."""
    correction = np.array([0.3, -0.2, 0.1])
    known = np.linalg.inv(covariance)
    assert np.allclose(lasting_correction(covariance, 2.0 * known, correction), correction)
    assert np.allclose(lasting_correction(covariance, 0.5 * known, correction), 0.0)
    direction = np.linalg.cholesky(known)[:, 0]
    along = lasting_correction(covariance, 9.0 * np.outer(direction, direction), correction)
    # Of the correction that is what the measurement sees, and it sees nothing of what is left.
    assert direction @ along == pytest.approx(direction @ correction)
    assert np.linalg.matrix_rank(np.column_stack([along, covariance @ direction]), tol=1e-9) == 1


@pytest.mark.parametrize('covariance', COVARIANCES)
def test_the_noise_of_an_independent_measurement_has_the_same_effect(covariance):
    """Kalman's covariance with that noise is the fused one."""
    information = 5.0 * np.linalg.inv(COVARIANCES[1])
    noise = lasting_noise(covariance, information)
    kalman = covariance - covariance @ np.linalg.solve(covariance + noise, covariance)
    assert np.allclose(kalman, fused_covariance(covariance, information), rtol=1e-6, atol=1e-9)


def test_axes_are_of_no_matter():
    """Covariance and information in other axes lead to the same covariance there."""
    basis = FACTORS[2]
    inverse = np.linalg.inv(basis)
    information = 30.0 * np.linalg.inv(COVARIANCES[1])
    fused = fused_covariance(COVARIANCES[0], information)
    moved = fused_covariance(basis @ COVARIANCES[0] @ basis.T, inverse.T @ information @ inverse)
    assert np.allclose(moved, basis @ fused @ basis.T)
