"""Distances from occupied squares, against all of them one by one."""

import numpy as np
from push_navigation.distance_field import distance_field, INSIDE


def test_distances_are_those_of_the_nearest_square():
    """Of grids with few obstacles and with many; without any they are far."""
    rng = np.random.default_rng(0)
    for density in (0.01, 0.05, 0.4):
        occupied = rng.uniform(size=(23, 31)) < density
        occupied[5, 7] = True
        rows, columns = np.nonzero(occupied)
        i, j = np.indices(occupied.shape)
        apart = [np.maximum(np.abs(index[..., None] - other) - 0.5, 0.0)
                 for index, other in ((i, rows), (j, columns))]
        expected = np.hypot(*apart).min(axis=-1)
        found = distance_field(occupied)
        np.testing.assert_allclose(found[~occupied], expected[~occupied], atol=1e-5)
        assert (found[occupied] == np.float32(INSIDE)).all()
    assert distance_field(np.zeros((3, 4), dtype=bool)).min() > 1e6
