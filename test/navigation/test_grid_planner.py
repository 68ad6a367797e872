"""Grid planner: waypoints that are clear, short and pulled straight."""

import math

from helpers.maps import (
    RESOLUTION, room_with_door, scattered_cells, true_distances, walled_room)
from helpers.objects import square_outline
import numpy as np
from push_model.geometry import Pose
from push_navigation.grid_planner import COMFORTABLE_GAP, grid_graph, grid_waypoints
from push_navigation.map_clearance import MapClearance, MapContext
from push_navigation.obstacle import inflate
from push_navigation.path import NoPathFound, PathFailure
import pytest

RADIUS, CLEARANCE = 0.17, 0.22
BODY = inflate(square_outline(), 0.0, 0.22)
ASIDE = Pose(-2.2, -2.2, 0.4)


def corners(occupancy_map, start, goal, object_pose=ASIDE):
    """Return start and waypoints, shape (n, 2)."""
    kept = MapClearance(MapContext(occupancy_map), RADIUS, start, CLEARANCE - RADIUS, 1.0)
    waypoints = grid_waypoints(kept, BODY, object_pose, start, goal)
    assert all(waypoint.arc_angle == 0.0 for waypoint in waypoints)
    return np.array([start, *(waypoint[:2] for waypoint in waypoints)])


def samples(points):
    """Sample the straight segments between points every few millimetres."""
    fractions = np.linspace(0.0, 1.0, 800)[:, None]
    return np.concatenate([a + fractions * (b - a) for a, b in zip(points, points[1:])])


def length(points):
    """Length of straight segments between points."""
    return np.hypot(*np.diff(points, axis=0).T).sum()


def test_with_nothing_between_the_route_is_the_straight_line():
    found = corners(walled_room(), (-1.5, 0.5), (1.5, -0.2))
    assert found.tolist() == [[-1.5, 0.5], [1.5, -0.2]]


@pytest.mark.parametrize('seed', range(6))
def test_a_route_keeps_clear_and_ends_where_it_should(seed):
    """Random blocks, the object among them."""
    rng = np.random.default_rng(seed)
    blocks = [(x, x + 0.4, y, y + 0.4) for x, y in rng.uniform(-1.6, 1.2, (5, 2))]
    occupancy_map, object_pose = walled_room(*blocks), Pose(*rng.uniform(-0.5, 0.5, 2), 0.7)
    start, goal = (-2.4, -0.3), (2.4, 0.4)
    found = corners(occupancy_map, start, goal, object_pose)
    assert tuple(found[0]) == start and tuple(found[-1]) == pytest.approx(goal)
    points = samples(found)
    assert true_distances(occupancy_map, points).min() > CLEARANCE - 1e-9
    local = np.array([object_pose.inverse().transform(point) for point in points])
    assert BODY.distances(local).min() > -1e-3


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_a_route_round_a_wall_is_little_longer_than_the_taut_one(side):
    """Round one corner taut lengths are known: two tangents, an arc; it leaves a passing gap."""
    wall = (-0.05, 0.05, -3.0, 0.0) if side > 0.0 else (-0.05, 0.05, 0.0, 3.0)
    start, goal = (-1.5, -side), (1.5, -side)
    found = corners(walled_room(wall), start, goal)
    tip = np.array((0.05, 0.0))
    away = math.hypot(1.5 - tip[0], 1.0)
    nearest, widest = (
        2.0 * math.sqrt(away ** 2 - gap ** 2) + 2.0 * tip[0] + 2.0 * gap * (
            math.atan2(1.0, 1.5 - tip[0]) + math.asin(gap / away))
        for gap in (CLEARANCE, RADIUS + COMFORTABLE_GAP))
    assert nearest - 1e-6 < length(found) < 1.04 * widest
    assert (side * found[1:-1, 1] > 0.0).all()


def test_no_waypoint_can_be_left_out():
    """Any two that follow with one between them do not see each other with a passing gap."""
    occupancy_map = room_with_door(0.8)
    found = corners(occupancy_map, (-1.5, -0.5), (1.5, -0.5))
    assert len(found) > 2
    for first, last in zip(found, found[2:]):
        assert occupancy_map.clearance(samples(np.array([first, last]))).min() < (
            RADIUS + COMFORTABLE_GAP)


def test_a_route_keeps_to_the_middle_of_a_door():
    """Where it can pass nearer to the posts it does not, as far as that is of concern."""
    occupancy_map = room_with_door(0.8)
    found = samples(corners(occupancy_map, (-1.5, -0.5), (1.5, -0.5)))
    gap = occupancy_map.clearance(found).min() - RADIUS
    assert gap > COMFORTABLE_GAP - 0.05 > CLEARANCE - RADIUS


def test_mirrored_rooms_have_mirrored_lengths():
    """The grid lies otherwise in the mirror image, so that lengths agree to its spacing."""
    blocks = [(-0.6, -0.2, -3.0, 0.5), (0.4, 0.8, -0.4, 3.0)]
    mirrored = [(x0, x1, -y1, -y0) for x0, x1, y0, y1 in blocks]
    one = corners(walled_room(*blocks), (-2.0, 0.0), (2.0, 0.0))
    other = corners(walled_room(*mirrored), (-2.0, 0.0), (2.0, 0.0), Pose(-2.2, 2.2, 0.4))
    assert length(one) == pytest.approx(length(other), rel=0.02)


def test_a_slit_or_the_object_in_the_door_lets_nothing_through():
    start, goal = (-1.5, 0.0), (1.5, 0.0)
    assert len(corners(room_with_door(0.8), start, goal)) > 2
    for occupancy_map, pose in ((room_with_door(0.4), ASIDE),
                                (room_with_door(0.8), Pose(0.0, 1.0, 0.0))):
        with pytest.raises(NoPathFound) as failure:
            corners(occupancy_map, start, goal, pose)
        assert failure.value.report.code is PathFailure.NO_ROUTE


def test_an_end_in_an_obstacle_is_refused():
    room = walled_room((1.0, 1.0 + 8 * RESOLUTION, -0.2, 0.2))
    with pytest.raises(NoPathFound):
        corners(room, (-1.5, 0.0), (1.2, 0.0))


@pytest.mark.parametrize('seed', range(3))
def test_clearances_of_a_grid_are_the_least_on_its_edges(seed: int) -> None:
    """
    Along rows and columns to rounding; along diagonals the least may lie beside the samples.

    There ``k t^2 + ...`` with ``|k| <= 2 resolution`` falls by ``|k| / 16`` between two samples.
    """
    occupancy_map = scattered_cells(seed, Pose(0.3, -0.2, 0.7))
    height, width = occupancy_map.occupied.shape
    grid = grid_graph(occupancy_map, 0.05, (3, 5, width, height))
    ends = grid.points[grid.edges]
    fractions = np.linspace(0.0, 1.0, 65)[:, None]
    sampled = np.array([occupancy_map.clearance(first + fractions * (last - first)).min()
                        for first, last in ends])
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    is_diagonal = lengths > 1.2 * grid.spacing
    assert is_diagonal.any() and (~is_diagonal).any()
    excess = grid.clearances - sampled
    np.testing.assert_allclose(excess[~is_diagonal], 0.0, atol=1e-6)
    assert -1e-6 < excess[is_diagonal].min()
    assert excess[is_diagonal].max() <= occupancy_map.resolution / 8


def test_a_route_does_not_depend_on_those_found_before() -> None:
    """Routes that start alike share their tree, but not with another object or start."""
    room = walled_room((-0.6, -0.2, -3.0, 0.5), (0.4, 0.8, -0.4, 3.0))
    questions = [(start, goal, pose)
                 for start in ((-2.0, 0.0), (-2.0, 0.5))
                 for goal in ((2.0, 0.0), (0.1, -2.0), (2.0, 0.0))
                 for pose in (ASIDE, Pose(-0.4, 1.2, 0.4))]
    routes = [corners(room, *question) for question in questions]
    for question, route in list(zip(questions, routes))[::-1]:
        # An equal map of its own shares nothing.
        other = walled_room((-0.6, -0.2, -3.0, 0.5), (0.4, 0.8, -0.4, 3.0))
        assert corners(other, *question).tolist() == route.tolist()
