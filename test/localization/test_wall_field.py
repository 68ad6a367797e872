"""Laws of the signed distance from walls."""

import math

from helpers.lidar_rooms import field_of, RESOLUTION, room_cells
import numpy as np
from push_localization.wall_field import MAX_DISTANCE
from push_model.geometry import Pose
import pytest

CELLS = room_cells(3.0, 2.0, [(20, 12, 28, 20)])
ORIGIN = Pose(-1.3, 0.4, 0.7)


def test_the_distance_beside_straight_walls_is_exact():
    """Along a line across a room, but for its middle: the distance to the nearer face."""
    y = np.concatenate([np.linspace(0.1, 1.04, 25), np.linspace(1.16, 2.1, 25)])
    cells = room_cells(6.0, 2.0)
    sample = field_of(cells).sample(np.column_stack([np.full(y.shape, 3.1), y]))
    expected = np.minimum(y - 0.1, 2.1 - y)
    assert np.allclose(sample.distances, np.minimum(expected, MAX_DISTANCE), atol=1e-6)


def test_a_wall_that_lies_deeper_is_farther():
    """By the offset, everywhere within the greatest distance."""
    points = np.random.default_rng(0).uniform((0.3, 0.3), (2.8, 1.8), (50, 2))
    exact = field_of(CELLS).sample(points).distances
    deeper = field_of(CELLS, offset=0.25).sample(points).distances
    assert np.allclose(deeper, np.minimum(exact + 0.25 * RESOLUTION, MAX_DISTANCE), atol=1e-6)


def test_distances_are_those_of_the_nearest_cells_wherever_they_are_asked_for_first():
    """Compared cell by cell, in a map of several tiles, for walls that lie across their edges."""
    rng = np.random.default_rng(3)
    cells = rng.random((150, 210)) < 0.003
    cells[80:97, 60:190] = True
    rows, columns = (rng.integers(0, size, 400) for size in cells.shape)
    centers = np.column_stack([columns, rows])
    walls, free = (np.argwhere(cells == value)[:, ::-1] for value in (True, False))
    to_wall, to_free = (np.hypot(*(centers[:, None] - others).T).min(axis=0)
                        for others in (walls, free))
    expected = RESOLUTION * np.where(cells[rows, columns], 0.5 - to_free, to_wall - 0.5)
    field = field_of(cells)
    for part in np.array_split(np.arange(len(centers)), 40):
        distances = field.sample(RESOLUTION * (centers[part] + 0.5)).distances
        assert np.allclose(distances, np.clip(expected[part], -MAX_DISTANCE, MAX_DISTANCE),
                           atol=1e-6)


def test_gradients_are_those_of_the_distances():
    """Central differences within cells agree, in a map at an angle."""
    field = field_of(CELLS, ORIGIN)
    inner = np.random.default_rng(1).uniform((0.2, 0.2), (3.0, 2.0), (200, 2))
    # Half-way between grid lines of the interpolation, where it is smooth.
    inner = RESOLUTION * (np.floor(inner / RESOLUTION) + 0.01 + 0.24)
    points = np.array([ORIGIN.transform(point) for point in inner])
    gradients = field.sample(points).gradients
    step = 1e-4
    for axis, offset in enumerate(np.eye(2) * step):
        slope = (field.sample(points + offset).distances
                 - field.sample(points - offset).distances) / (2.0 * step)
        assert np.allclose(slope, gradients[:, axis], atol=2e-3)


def test_the_field_moves_with_its_map():
    """A moved map has the same distances at moved points."""
    points = np.random.default_rng(2).uniform(0.0, 2.5, (50, 2))
    moved = np.array([ORIGIN.transform(point) for point in points])
    field = field_of(CELLS)
    expected = field.sample(points)
    for other in (field.moved(ORIGIN), field_of(CELLS, ORIGIN)):
        sample = other.sample(moved)
        assert np.allclose(sample.distances, expected.distances, atol=1e-9)
        rotated = [Pose(0.0, 0.0, ORIGIN.theta).rotate(row) for row in expected.gradients]
        assert np.allclose(sample.gradients, rotated, atol=1e-9)


@pytest.mark.parametrize('cells', [np.zeros((10, 12), dtype=bool), CELLS])
def test_far_from_all_walls_nothing_is_told(cells):
    """Beyond the map the greatest distance holds, without slope."""
    far = np.array([[50.0, 3.0], [-20.0, -20.0], [1.0, 1e3]])
    sample = field_of(cells).sample(far)
    assert np.allclose(sample.distances, MAX_DISTANCE)
    assert np.allclose(sample.gradients, 0.0)
    assert np.allclose(field_of(cells).nearest_distances(far), MAX_DISTANCE)


def test_distances_have_the_sign_of_the_side():
    """Negative in walls, positive beside them."""
    field = field_of(CELLS)
    rows, columns = np.nonzero(CELLS)
    centers = RESOLUTION * (np.column_stack([columns, rows]) + 0.5)
    assert (field.sample(centers).distances < 0.0).all()
    rows, columns = np.nonzero(~CELLS)
    centers = RESOLUTION * (np.column_stack([columns, rows]) + 0.5)
    assert (field.sample(centers).distances > 0.0).all()
    assert math.isclose(field.sample(centers).distances.min(), 0.5 * RESOLUTION, abs_tol=1e-6)
