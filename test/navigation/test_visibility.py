"""Laws of visibility among obstacles and the object."""

from helpers.maps import scattered_cells
from helpers.objects import square_outline
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_navigation.map_clearance import MapClearance, MapContext, PositionUncertainty
from push_navigation.obstacle import inflate, InflatedObstacle
from push_navigation.visibility import last_seen, make_visibility, see_points, Visibility
import pytest

SPACING = 0.02
BODY = inflate(square_outline(), 0.0, 0.1)
DISC = inflate((), 0.2, 0.1)
FLOOR = scattered_cells(2, Pose(0.3, -0.2, 0.7))
EXTENT = np.array(FLOOR.occupied.shape[::-1]) * FLOOR.resolution
MIDDLE_X, MIDDLE_Y = FLOOR.from_map([0.5 * EXTENT])[0].tolist()
MIDDLE = Pose(MIDDLE_X, MIDDLE_Y, 0.4)
UNCERTAIN = PositionUncertainty(0.01, 0.02, 0.05)


def _points(count: int, seed: int) -> FloatArray:
    """Draw points of the floor, in the frame of the map."""
    return np.random.default_rng(seed).uniform(0.1, 0.9, (count, 2)) * EXTENT


def _margins(start: FloatArray, counts_drift: bool) -> MapClearance:
    x, y = FLOOR.from_map([start])[0].tolist()
    return MapClearance(MapContext(FLOOR, UNCERTAIN), 0.05, (x, y), 0.01, 0.5, counts_drift)


def _gaps(margins: MapClearance, body: InflatedObstacle, points: FloatArray) -> FloatArray:
    """Measure what the robot has beyond what it needs, by the functions for many points."""
    world = FLOOR.from_map(points)
    to_object = MIDDLE.inverse()
    away = body.distances([to_object.transform(point) for point in world.tolist()])
    return np.minimum(FLOOR.clearance(world) - margins.required(world), away)


@pytest.mark.parametrize('counts_drift', [True, False])
@pytest.mark.parametrize('body', [BODY, DISC])
def test_a_point_is_seen_where_the_robot_may_be_all_along_the_line(
        body: InflatedObstacle, counts_drift: bool) -> None:
    """As by distances, clearances and needs that are computed for many points at once."""
    start, points = _points(1, 3)[0], _points(300, 4)
    margins = _margins(start, counts_drift)
    seen = see_points(make_visibility(margins, body, MIDDLE), start, points, np.zeros(300),
                      SPACING)
    count = 2 + int(np.hypot(*(points - start).T).max() / SPACING)
    parts = np.linspace(0.0, 1.0, count)[:, None]
    least = np.array([_gaps(margins, body, start + parts * (point - start)).min()
                      for point in points])
    is_sure = np.abs(least) > 1e-5
    assert np.array_equal(seen[is_sure], least[is_sure] > 0.0)
    assert 10 < seen.sum() < 200


def _visibility(start: FloatArray) -> Visibility:
    return make_visibility(_margins(start, True), BODY, MIDDLE)


def test_the_last_point_seen_is_the_last_of_those_seen() -> None:
    start = _points(1, 3)[0]
    for seed in range(5, 25):
        points = _points(8, seed)
        seen = np.flatnonzero(see_points(_visibility(start), start, points, np.zeros(8), SPACING))
        assert last_seen(_visibility(start), start, points, np.zeros(8), SPACING) == max(
            seen.tolist(), default=-1)


def test_lines_keep_the_clearance_that_is_asked_for() -> None:
    start, points = _points(1, 3)[0], _points(300, 4)
    seen = [see_points(_visibility(start), start, points, np.full(300, least), SPACING)
            for least in (0.0, 0.1, 0.2, 0.4)]
    counts = [int(each.sum()) for each in seen]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > counts[2] >= counts[3] == 0
