"""Footprints in costmaps: marks of object and robot go, walls stay."""

from collections.abc import Iterator
import math

from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.footprint_clearing import FootprintClearing
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
import pytest

ROBOT = RoundRobot(0.17, 'holonomic')
SETTINGS = MapSettings(footprint_clearing_enabled=True)
SIDE = 120
ORIGIN = Pose(1.0, -2.0, 0.7)


def centers():
    """Cell centres in the world, shape (rows, columns, 2)."""
    rows, columns = np.indices((SIDE, SIDE))
    local = 0.05 * (np.stack((columns, rows), axis=-1) + 0.5)
    c, s = math.cos(ORIGIN.theta), math.sin(ORIGIN.theta)
    return local @ np.array([[c, s], [-s, c]]) + ORIGIN[:2]


def marked(cells, pose, half):
    """Mark the cells of a square at a pose, as a laser sees it: half a cell too far out."""
    local = centers() - pose[:2]
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return cells | (np.abs(local @ np.array([[c, -s], [s, c]])).max(axis=-1) < half + 0.03)


def in_map(x, y, theta=0.0):
    """Return a pose given in the axes of the map."""
    return ORIGIN @ Pose(x, y, theta)


def clearing(settings=SETTINGS):
    """Make one for the box of 0.4 m."""
    return FootprintClearing(settings, box(), ROBOT)


def recorded(places):
    """Make one for an object that has been at some places, ten of them per second."""
    footprints = clearing()
    for step, pose in enumerate(places):
        footprints.record(0.1 * step, pose, None)
    return footprints


def test_marks_go_wherever_the_object_has_been_since_the_map_was_made():
    """Also those of a costmap that lags behind a push; one that is older is forgotten."""
    places = [in_map(2.0 + 0.02 * step, 3.0, 0.4) for step in range(40)]
    cells = np.zeros((SIDE, SIDE), dtype=bool)
    for pose in places:
        cells = marked(cells, pose, 0.2)
    occupancy_map = OccupancyMap(0.05, ORIGIN, cells)
    cleared = recorded(places).clear(occupancy_map, stamp=0.5)
    assert not cleared.occupied.any()
    assert cleared.object_clearance(box(), places) > 1.0
    late = recorded(places).clear(occupancy_map, stamp=4.0)
    assert late.occupied.any() and late.object_clearance(box(), places[-1:]) < 0.3


@pytest.mark.parametrize('thickness', [1, 3])
def test_a_wall_beside_the_object_stays_whole(thickness):
    """However thin, and however near the object has been pushed to it."""
    cells = np.zeros((SIDE, SIDE), dtype=bool)
    cells[80:80 + thickness] = True
    occupancy_map = OccupancyMap(0.05, ORIGIN, cells)
    footprints = clearing()
    for step in range(50):
        footprints.record(0.1 * step, in_map(1.0 + 0.05 * step, 3.79), in_map(1.0, 1.0))
    assert footprints.clear(occupancy_map, stamp=0.0) is occupancy_map


def test_distances_of_a_cleared_map_are_those_of_the_map_without_the_marks():
    """Up to 2 m exactly, beyond it no longer than they are."""
    rng = np.random.default_rng(3)
    walls = rng.random((SIDE, SIDE)) < 0.002
    pose = in_map(2.9, 2.6, 1.1)
    walls &= ~marked(np.zeros_like(walls), pose, 0.4)
    expected = OccupancyMap(0.05, ORIGIN, walls).distances
    footprints = clearing()
    footprints.record(0.0, pose, None)
    found = footprints.clear(OccupancyMap(0.05, ORIGIN, marked(walls, pose, 0.2)), 0.0).distances
    assert (found <= expected + 1e-5).all()
    near = expected < 2.0
    np.testing.assert_allclose(found[near], expected[near], atol=1e-5)


def test_nothing_new_gives_the_same_map_and_nothing_is_cleared_unless_asked_for():
    """So that nobody plans again."""
    pose = in_map(2.0, 2.0)
    occupancy_map = OccupancyMap(0.05, ORIGIN, marked(np.zeros((SIDE, SIDE), bool), pose, 0.2))
    footprints = clearing()
    footprints.record(0.0, pose, None)
    cleared = footprints.clear(occupancy_map, 0.0)
    footprints.record(1.0, pose, None)
    assert footprints.clear(occupancy_map, 1.0) is cleared is not occupancy_map
    disabled = clearing(MapSettings())
    disabled.record(0.0, pose, None)
    assert disabled.clear(occupancy_map, 0.0) is occupancy_map


def moving_costmap(footprints: FootprintClearing, shift: int = 0) -> Iterator[OccupancyMap]:
    """
    Push the object for 8 s, in a costmap that shows it wherever it has been, as cleared.

    With a shift the costmap moves by as many cells after each map.
    """
    cells = np.zeros((SIDE, SIDE), dtype=bool)
    for step in range(80):
        pose = in_map(1.0 + 0.04 * step, 2.0 + 0.02 * step, 0.03 * step)
        cells = marked(cells, pose, 0.2)
        footprints.record(0.1 * step, pose, None)
        moved = step * shift
        seen = np.zeros_like(cells)
        seen[:, :SIDE - moved] = cells[:, moved:]
        yield footprints.clear(
            OccupancyMap(0.05, in_map(0.05 * moved, 0.0), seen), stamp=0.1 * step)


@pytest.mark.parametrize('shift', [0, 1])
def test_marks_that_stay_where_the_object_was_are_no_obstacles(shift: int) -> None:
    """However old they are, and where the costmap goes with the robot."""
    for cleared in moving_costmap(clearing(), shift):
        assert not cleared.occupied.any()


def test_an_obstacle_that_comes_where_the_object_was_is_one() -> None:
    """Once a map has shown the place free; it does not join what is still shown of the object."""
    footprints = clearing()
    *_, _ = moving_costmap(footprints)
    cells = np.zeros((SIDE, SIDE), dtype=bool)
    footprints.clear(OccupancyMap(0.05, ORIGIN, cells), stamp=8.0)
    cells[38:42, 18:22] = True
    obstacle = OccupancyMap(0.05, ORIGIN, cells)
    assert footprints.clear(obstacle, stamp=8.2) is obstacle


def test_an_object_is_an_obstacle_to_the_next_one() -> None:
    """What was cleared of it is shown again."""
    footprints = clearing()
    pose = in_map(2.0, 2.0)
    occupancy_map = OccupancyMap(0.05, ORIGIN, marked(np.zeros((SIDE, SIDE), bool), pose, 0.2))
    footprints.record(0.0, pose, None)
    assert not footprints.clear(occupancy_map, 0.0).occupied.any()
    footprints.set_object(box())
    footprints.record(1.0, in_map(4.0, 4.0), None)
    assert footprints.clear(occupancy_map, 1.0) is occupancy_map
