"""Occupancy maps: clearances that are never too long, and collisions of robot and object."""

import math

from helpers.maps import RESOLUTION, room_with_door, scattered_cells, true_distances
from helpers.objects import bin_, box
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.occupancy_map import OccupancyMap
import pytest

ROBOT = RoundRobot(0.17, 'holonomic')


def test_clearance_is_never_too_long_and_hardly_too_short():
    """Against the distance to every square; a map that lies askew too."""
    rng = np.random.default_rng(1)
    for origin in (Pose(0.0, 0.0, 0.0), Pose(2.0, -1.0, 2.2)):
        occupancy_map = scattered_cells(2, origin)
        local = rng.uniform(0.0, 1.0, (2000, 2)) * (3.0, 2.0)
        points = np.array([origin.transform(point) for point in local])
        distances = true_distances(occupancy_map, points)
        short = distances - occupancy_map.clearance(points)
        # In single precision.
        assert short.min() >= -1e-7
        assert short[distances > RESOLUTION].max() < 0.7 * RESOLUTION


def test_outside_the_map_is_an_obstacle():
    """However far."""
    points = [(-0.01, 1.0), (1.0, 2.01), (-50.0, 3.0), (4.0, 90.0)]
    assert np.all(scattered_cells(3).clearance(points) < 0.0)


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_a_free_object_keeps_the_margin_and_a_clear_one_is_free(obj):
    """Against the distance from the outline to all occupied cells."""
    occupancy_map, rng, margin = scattered_cells(4), np.random.default_rng(5), 0.05
    rows, columns = np.nonzero(occupancy_map.occupied)
    centers = np.stack((columns + 0.5, rows + 0.5), axis=1) * RESOLUTION
    seen = set()
    for _ in range(150):
        pose = Pose(*rng.uniform(0.2, 1.8, 2), rng.uniform(-3.0, 3.0))
        away = min(find_contact(obj, pose, center, 0.0).gap for center in centers)
        corners = obj.outline or [(obj.radius * math.cos(a), obj.radius * math.sin(a))
                                  for a in np.linspace(0.0, 6.3, 40)]
        border = min(min(x, y, 3.0 - x, 2.0 - y) for x, y in map(pose.transform, corners))
        free = occupancy_map.object_is_free(obj, [pose], margin)
        seen.add(free)
        if free:
            assert min(away - 0.5 * RESOLUTION, border) >= margin - 1e-3
        if min(away, border) > margin + 1.6 * RESOLUTION:
            assert free
    assert seen == {True, False}


def test_an_object_over_an_obstacle_is_not_free():
    """A single cell under its middle is seen, although its edge is far away."""
    occupied = np.zeros((60, 60), dtype=bool)
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    assert occupancy_map.object_is_free(box(0.8), [Pose(1.5, 1.5, 0.3)], 0.0)
    occupied[30, 30] = True
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    assert not occupancy_map.object_is_free(box(0.8), [Pose(1.5, 1.5, 0.3)], 0.0)


def test_the_first_collision_is_found():
    """The robot and the object drive at a wall; it is the first pose that is too near."""
    occupancy_map = room_with_door(0.8)
    poses = [(x, -1.0, 0.0) for x in np.arange(-2.0, 0.0, 0.02)]
    for number, size in ((occupancy_map.first_robot_collision(ROBOT, poses, 0.05), 0.17),
                         (occupancy_map.first_object_collision(box(), poses, 0.05), 0.2),
                         (occupancy_map.first_object_collision(bin_(), poses, 0.05), 0.2)):
        assert -0.05 - size - 0.05 - 0.7 * RESOLUTION < poses[number][0] < -0.079 - size
    assert occupancy_map.first_robot_collision(ROBOT, poses[:20], 0.05) is None
    assert occupancy_map.first_object_collision(box(), poses[:20], 0.05) is None


def test_what_is_no_map_is_refused_by_name():
    """Resolution, origin and cells."""
    cells, origin = np.zeros((3, 4), dtype=bool), Pose(0.0, 0.0, 0.0)
    for wrong in (0.0, -1.0, 1e-9, 1e30, math.nan):
        with pytest.raises(ValueError, match='resolution: got'):
            OccupancyMap(wrong, origin, cells)
    with pytest.raises(ValueError, match='origin: got'):
        OccupancyMap(0.05, Pose(math.inf, 0.0, 0.0), cells)
    for wrong in (cells.astype(float), cells[0], cells[:0]):
        with pytest.raises(ValueError, match='occupied: got'):
            OccupancyMap(0.05, origin, wrong)


def test_a_map_cannot_be_changed_behind_its_back():
    """What it was made of may change; the map does not."""
    cells = np.zeros((30, 30), dtype=bool)
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), cells)
    before = occupancy_map.clearance([(0.7, 0.7)])
    cells[:] = True
    assert occupancy_map.clearance([(0.7, 0.7)]) == before and not occupancy_map.occupied.any()
    with pytest.raises(ValueError, match='read-only'):
        occupancy_map.occupied[0, 0] = True
