"""Places of another localization: what they err more than they state shows beside odometry."""

import math

import numpy as np
from push_localization.place_noise import COMPARED_LENGTH, PlaceNoise
from push_model.geometry import Pose
from push_model.signals import Odometry, PlaceStatus, PoseCovariance, RobotPlace, STOP
import pytest

STATED = PoseCovariance.from_deviations(0.015, 0.01)
ORIGIN = Pose(0.0, 0.0, 0.0)


def placed(error: float, heading_error: float, seed: int = 0, world: Pose = ORIGIN,
           stated: PoseCovariance = STATED) -> PoseCovariance:
    """Drive curves of 15 m, and be placed every 0.25 m with independent errors."""
    noise, rng, pose, claim = PlaceNoise(), np.random.default_rng(seed), ORIGIN, ORIGIN
    covariance = stated
    for i in range(60):
        step = Pose(0.25, 0.0, 0.15 * math.cos(0.2 * i))
        # Odometry means more than is driven, and drifts.
        pose, claim = pose @ step, claim @ Pose(0.254, 0.0, step.theta + 0.003)
        noise.add_odometry(Odometry(float(i), claim, STOP))
        x, y, theta = (rng.standard_normal(3) * (error, error, heading_error)).tolist()
        place = world @ Pose(pose.x + x, pose.y + y, pose.theta + theta)
        covariance = noise.widened(
            RobotPlace(float(i), place, stated, PlaceStatus.TRACKED)).covariance
    return covariance


@pytest.mark.parametrize('error', [0.0, 0.005, 0.012])
def test_places_that_err_as_stated_are_left_alone(error: float) -> None:
    """Odometry that is wrong by some per cent does not make them worse, nor do good ones count."""
    means = np.mean([placed(error, 0.006, seed) for seed in range(10)], axis=0)
    assert means == pytest.approx(STATED, rel=0.25, abs=1e-9)


@pytest.mark.parametrize('error, heading_error', [(0.05, 0.01), (0.1, 0.03), (0.04, 0.05)])
def test_places_that_err_more_are_widened_to_that(error: float, heading_error: float) -> None:
    """Position and heading each by itself."""
    stds = np.sqrt(np.mean([placed(error, heading_error, seed) for seed in range(10)], axis=0))
    assert stds[0] == pytest.approx(error, rel=0.25) and stds[5] == pytest.approx(
        heading_error, rel=0.25)


@pytest.mark.parametrize('jump', [0.0, 0.05, 0.3])
def test_a_jump_puts_the_robot_where_the_new_place_has_it(jump: float) -> None:
    """It is hardly noise: those after it err a little more. What noise explains is no jump."""
    noise, statuses = PlaceNoise(), []
    for i in range(21):
        pose = Pose(0.25 * i, 0.0, 0.0)
        noise.add_odometry(Odometry(float(i), pose, STOP))
        place = noise.widened(RobotPlace(float(i), Pose(pose.x, jump * (i > 10), 0.0), STATED,
                                         PlaceStatus.TRACKED))
        statuses.append(place.status)
        assert math.sqrt(place.covariance.x_x) < 0.1 * max(jump, 0.2)
    regained = [i for i, status in enumerate(statuses) if status is PlaceStatus.REGAINED]
    assert regained == ([11] if jump == 0.3 else [])


@pytest.mark.parametrize('world', [Pose(3.0, -2.0, 2.0), Pose(0.0, 0.0, -1.0)])
def test_it_does_not_matter_where_the_map_has_its_axes(world: Pose) -> None:
    """As long as both axes are stated alike."""
    assert placed(0.05, 0.03, world=world) == pytest.approx(placed(0.05, 0.03), rel=0.3, abs=1e-3)


def test_correlations_that_are_stated_stay() -> None:
    """Both variances and what they share grow by the same."""
    matrix = np.array([[4.0, 1.0, 0.2], [1.0, 3.0, -0.1], [0.2, -0.1, 2.0]]) * 1e-4
    widened = placed(0.2, 0.2, stated=PoseCovariance.from_matrix(matrix)).matrix
    stds, before = np.sqrt(np.diag(widened)), np.sqrt(np.diag(matrix))
    assert widened / np.outer(stds, stds) == pytest.approx(matrix / np.outer(before, before))


def test_a_robot_that_stands_learns_nothing() -> None:
    """Errors that last would not show: it has to drive for a while."""
    noise = PlaceNoise()
    for i in range(50):
        noise.add_odometry(Odometry(float(i), Pose(0.01 * i, 0.0, 0.0), STOP))
        place = RobotPlace(float(i), Pose(0.06 * (i % 2), 0.0, 0.0), STATED, PlaceStatus.TRACKED)
        assert noise.widened(place).covariance == pytest.approx(STATED)
    assert 0.01 * 50 < COMPARED_LENGTH
