"""Walls beside a push: those of the map, which no object stands in."""

import math

from helpers.objects import box
import numpy as np
from push_control.behaviors.walls_beside import MAX_OVERLAP, wall_errors, walls_beside
from push_dynamics.walls import Wall
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.wall_segments import map_walls
import pytest

# A room of 2 m, its inner walls at 0 and 2 m; the box has sides of 0.4 m.
ROOM = OccupancyMap(0.05, Pose(-0.05, -0.05, 0.0),
                    np.pad(np.zeros((40, 40), dtype=bool), 1, constant_values=True))
HALF = 0.2
# Standard deviation of walls about their cells, and that of both [m].
MAP_ERROR = 0.01
WALL_STD = math.hypot(ROOM.resolution / math.sqrt(12.0), MAP_ERROR)


def inner(walls: tuple[Wall, ...]) -> tuple[float, float]:
    """Return x of the inner wall behind the origin, and y of that beside it [m]."""
    long = [wall for wall in walls
            if 1.9 < abs(wall.end_x - wall.start_x) + abs(wall.end_y - wall.start_y) < 2.01]
    return (min(wall.start_x for wall in long if abs(wall.end_x - wall.start_x) < 1e-6),
            min(wall.start_y for wall in long if abs(wall.end_y - wall.start_y) < 1e-6))


@pytest.mark.parametrize('overlap', [-0.3, -0.001, 0.0])
def test_an_object_beside_walls_leaves_them_where_they_are(overlap: float) -> None:
    """Clear of them, or in touch within the rounding of the map."""
    pose = Pose(HALF - overlap, 1.0, 0.0)
    expected = np.array([(w.start_x, w.start_y, w.end_x, w.end_y) for w in map_walls(ROOM)])
    walls = np.array([(w.start_x, w.start_y, w.end_x, w.end_y)
                      for w in walls_beside(ROOM, box(), pose, 5.0)])
    np.testing.assert_allclose(walls, expected, atol=0.002)


@pytest.mark.parametrize('overlaps', [(0.02, 0.0), (0.0, 0.03), (0.025, 0.015)], ids=str)
def test_walls_are_moved_to_where_an_object_in_them_touches_them(
        overlaps: tuple[float, float]) -> None:
    """By the overlap with each of them, in a corner by both."""
    x, y = overlaps
    pose = Pose(HALF - x if x else 1.0, HALF - y if y else 1.0, 0.0)
    wall_x, wall_y = inner(walls_beside(ROOM, box(), pose, 5.0))
    assert wall_x == pytest.approx(-x, abs=0.004)
    assert wall_y == pytest.approx(-y, abs=0.004)


def test_an_object_far_inside_what_is_occupied_moves_no_wall() -> None:
    """No error of a map explains that."""
    pose = Pose(HALF - 1.5 * MAX_OVERLAP, 1.0, 0.0)
    assert walls_beside(ROOM, box(), pose, 5.0) == map_walls(ROOM, pose, 5.0)


@pytest.mark.parametrize('pose', [
    Pose(1.0, 1.0, 0.3), Pose(HALF, 1.0, 0.0), Pose(HALF - 0.02, HALF - 0.01, 0.0)], ids=str)
def test_walls_may_be_elsewhere_where_the_object_is_not_in_them(pose: Pose) -> None:
    """By what cells leave open; beside an object that touches them, away from it alone."""
    errors = wall_errors(ROOM, box(), pose, MAP_ERROR, 200)
    wall_x, wall_y = inner(walls_beside(ROOM, box(), pose, 5.0))
    for error, wall, at in zip(errors.T, (wall_x, wall_y), pose[:2]):
        assert error.max() < at - HALF - wall + 0.006 or at == 1.0
        std = math.sqrt(float((error[1::2] ** 2).mean()))
        assert std == pytest.approx(WALL_STD, rel=0.15)
    assert np.array_equal(errors, wall_errors(ROOM, box(), pose, MAP_ERROR, 200))


@pytest.mark.parametrize('gap', [-0.01, 0.0, 0.02, 0.04, 0.06])
def test_every_other_wall_that_is_near_touches_the_object(gap: float) -> None:
    """It may as well stand against it, up to some standard deviations of the wall."""
    pose = Pose(HALF + gap, 1.0, 0.0)
    wall_x, _ = inner(walls_beside(ROOM, box(), pose, 5.0))
    gaps = pose.x - HALF - wall_x - wall_errors(ROOM, box(), pose, MAP_ERROR, 200)[:, 0]
    touching = np.abs(gaps) < 0.003
    assert touching[::2].all() == (gap < 0.05)
    assert touching[1::2].mean() < 0.25


def test_there_are_none_on_open_floor() -> None:
    """Without a map nothing stands in the way."""
    assert walls_beside(None, box(), Pose(0.0, 0.0, 0.0), 5.0) == ()
