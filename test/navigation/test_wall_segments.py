"""Walls of grids: every face once, as long as can be."""

import numpy as np
from push_navigation.wall_segments import wall_segments


def faces_of(segments):
    """Return the middles of all faces of cells that segments cover."""
    faces = []
    for x_0, y_0, x_1, y_1 in segments.tolist():
        count = round(abs(x_1 - x_0) + abs(y_1 - y_0))
        for i in range(count):
            part = (i + 0.5) / count
            faces.append((x_0 + part * (x_1 - x_0), y_0 + part * (y_1 - y_0)))
    return faces


def test_every_face_between_occupied_and_free_cells_is_covered_once():
    rng = np.random.default_rng(0)
    for _ in range(10):
        occupied = rng.random(rng.integers(1, 9, 2)) < 0.4
        expected = [(column + 0.5, float(row)) for row in range(1, occupied.shape[0])
                    for column in range(occupied.shape[1])
                    if occupied[row, column] != occupied[row - 1, column]]
        expected += [(float(column), row + 0.5) for row in range(occupied.shape[0])
                     for column in range(1, occupied.shape[1])
                     if occupied[row, column] != occupied[row, column - 1]]
        assert sorted(faces_of(wall_segments(occupied))) == sorted(expected)


def test_faces_in_a_line_are_one_wall():
    occupied = np.zeros((6, 8), dtype=bool)
    occupied[2:4, 3:7] = True
    assert sorted(wall_segments(occupied).tolist()) == [
        [3.0, 2.0, 3.0, 4.0], [3.0, 2.0, 7.0, 2.0], [3.0, 4.0, 7.0, 4.0], [7.0, 2.0, 7.0, 4.0]]
