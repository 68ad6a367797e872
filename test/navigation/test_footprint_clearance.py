"""Clearances of objects in maps, against an independent computation, and their symmetries."""

import dataclasses
import math

from helpers.maps import scattered_cells
from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import convex_hull, Pose
from push_model.parameters import PushedObject
from push_navigation.floor import make_floor
from push_navigation.footprint_clearance import footprint_clearance
from push_navigation.occupancy_map import footprint, OccupancyMap
import pytest
from scipy.optimize import linprog, minimize

SIDE = 0.05
FLUSH = math.pi * np.arange(4) / 2.0


def random_polygon(rng):
    """Draw a convex outline about the origin; what lies on it is no matter."""
    points = [tuple(point) for point in rng.uniform(-0.3, 0.3, (7, 2))]
    return dataclasses.replace(box(), outline=tuple(convex_hull(points)))


def half_planes(corners):
    """Return A and b of A p <= b inside of a convex polygon, counter-clockwise."""
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(*edges.T)[:, None]
    return normals, (normals * corners).sum(axis=1)


def distance_by_projection(corners, low, high):
    """Distance of two convex sets: a quadratic program over one point of each."""
    normals, offsets = half_planes(corners)
    start = np.concatenate([corners.mean(axis=0), 0.5 * (low + high)])
    result = minimize(
        lambda z: ((z[:2] - z[2:]) ** 2).sum(), start, method='SLSQP',
        jac=lambda z: 2.0 * np.concatenate([z[:2] - z[2:], z[2:] - z[:2]]),
        bounds=[(None, None)] * 2 + list(zip(low, high)),
        constraints={'type': 'ineq', 'fun': lambda z: offsets - normals @ z[:2],
                     'jac': lambda z: np.column_stack([-normals, np.zeros_like(normals)])},
        options={'ftol': 1e-14, 'maxiter': 200})
    return math.sqrt(result.fun)


def overlaps(corners, low, high):
    """Tell by a linear program whether a polygon and a square have a point in common."""
    normals, offsets = half_planes(corners)
    return linprog([0.0, 0.0], A_ub=normals, b_ub=offsets - 1e-9,
                   bounds=list(zip(low, high))).status == 0


def test_it_is_the_distance_of_convex_sets():
    """A quadratic program for each square nearby; random outlines, maps and origins."""
    rng = np.random.default_rng(11)
    signs = set()
    for trial in range(12):
        origin = Pose(*rng.uniform(-2.0, 2.0, 2), rng.uniform(-3.0, 3.0))
        floor, obj = scattered_cells(trial, origin), random_polygon(rng)
        pose = Pose(rng.uniform(0.5, 2.5), rng.uniform(0.5, 1.5), rng.uniform(-3.0, 3.0))
        corners = np.array([pose.transform(corner) for corner in obj.outline])
        rows, columns = np.nonzero(floor.occupied)
        low = SIDE * np.column_stack([columns, rows])
        away = np.hypot(*(low + 0.5 * SIDE - pose[:2]).T)
        order = np.argsort(away)
        clearance = floor.object_clearance(obj, [origin @ pose])
        signs.add(clearance > 0.0)
        if any(overlaps(corners, square, square + SIDE) for square in low[order[:6]]):
            assert clearance < 0.0
            continue
        expected = min(corners.min(), *(np.array([3.0, 2.0]) - corners.max(axis=0)))
        extent = np.hypot(*(corners - pose[:2]).T).max() + SIDE
        for index in order:
            if away[index] - extent < expected:
                square = low[index]
                expected = min(expected, distance_by_projection(corners, square, square + SIDE))
        assert clearance == pytest.approx(expected, abs=2e-6)
    assert signs == {True, False}


@pytest.mark.parametrize('side', [0.02, 0.05, 0.1])
@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_an_object_at_a_wall_has_the_gap_that_it_has(obj, side):
    """Also one that touches it, or overlaps it by less than a cell; all along the wall."""
    cells = np.zeros((round(3.0 / side), round(3.0 / side)), dtype=bool)
    cells[:, :2] = True
    floor = OccupancyMap(side, Pose(1.0, -2.0, 0.7), cells)
    for gap in (-0.4 * side, 0.0, 0.003, 0.02, 0.3):
        for heading in FLUSH:
            places = [floor.origin @ Pose(2.0 * side + 0.2 + gap, y, heading)
                      for y in (1.0, 1.013, 1.6)]
            np.testing.assert_allclose(floor.object_clearances(obj, places), gap, atol=1e-9)
            assert floor.object_is_free(obj, places, 0.0) is (gap >= 0.0)
            assert floor.object_is_free(obj, places, gap)


def test_the_overlap_is_the_shortest_way_out():
    """An object over a single cell has to be moved by half of both."""
    cells = np.zeros((60, 60), dtype=bool)
    cells[30, 30] = True
    floor, middle = OccupancyMap(SIDE, Pose(0.0, 0.0, 0.0), cells), 30.5 * SIDE
    for heading in FLUSH:
        assert floor.object_clearance(box(), [Pose(middle, middle, heading)]) == pytest.approx(
            -0.2 - 0.5 * SIDE)
        assert floor.object_clearance(box(), [Pose(middle + 0.1, middle, heading)]) == (
            pytest.approx(-0.1 - 0.5 * SIDE))


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_a_margin_may_be_an_overlap(obj):
    """It is allowed up to the margin, in the middle of the map and at its border."""
    cells = np.zeros((60, 60), dtype=bool)
    cells[30, 30] = True
    floor, middle = OccupancyMap(SIDE, Pose(0.0, 0.0, 0.0), cells), 30.5 * SIDE
    for x in (middle, middle + 0.1, middle + 0.17, 0.05, 0.15, 0.9):
        pose = Pose(x, middle, 0.3)
        clearance = floor.object_clearance(obj, [pose])
        for margin in (-0.33, -0.12, -0.04, -0.02, 0.02, 0.12):
            assert floor.object_is_free(obj, [pose], margin) is bool(clearance > margin)


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_what_is_enough_is_never_less(obj: PushedObject) -> None:
    """Where there is more room, at least what is asked for comes back, whatever is rounded."""
    floor = make_floor(OccupancyMap(SIDE, Pose(0.0, 0.0, 0.0), np.zeros((60, 60), dtype=bool)))
    for enough in np.linspace(-0.1, 0.5, 301).tolist():
        assert footprint_clearance(floor.distances, floor.cells_per_metre, footprint(obj),
                                   (1.5, 1.5, 0.3), enough) >= enough
