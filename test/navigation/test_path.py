"""Geometry of paths: projections, samples, and the headings of both drives."""

import math

from helpers.paths import CURVE, curved_path
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.path import differential_path, PathSegment, sample_path
import pytest

ROBOT = RoundRobot(0.17, time_constant=0.0)


def test_a_point_on_an_arc_is_projected_to_where_it_is():
    """Segments of any curvature and side, points beside them."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        arc_angle, chord = rng.uniform(-3.0, 3.0), rng.uniform(0.2, 2.0)
        start = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
        toward = rng.uniform(-math.pi, math.pi)
        end = Pose(start.x + chord * math.cos(toward), start.y + chord * math.sin(toward),
                   start.theta + arc_angle)
        segment = PathSegment(start, end, arc_angle)
        path = rng.uniform(0.0, segment.length)
        aside = rng.uniform(-0.4, 0.4) * min(1.0, segment.length / max(abs(arc_angle), 1e-9))
        (x, y, heading), end = segment.poses(np.array([path / segment.length, 1.0]))
        direction = segment.direction(path)
        point = (x - aside * math.sin(direction), y + aside * math.cos(direction))
        assert segment.project(point) == pytest.approx((path, aside), abs=1e-9)
        assert distance(end, segment.end) < 1e-9
        assert heading == pytest.approx(segment.heading(path))


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_samples_are_dense_and_begin_and_end_where_the_path_does(drive):
    """No two are farther apart than asked for, at the rim of the robot."""
    path = curved_path(drive)
    rows = sample_path(path, ROBOT, 0.02)
    assert tuple(rows[0]) == path.poses[0] and tuple(rows[-1]) == path.poses[-1]
    steps = np.diff(rows, axis=0)
    assert np.hypot(steps[:, 0], steps[:, 1]).max() <= 0.02 + 1e-12
    rotations = np.abs([wrap_angle(heading_change) for heading_change in steps[:, 2]])
    assert ROBOT.radius * rotations.max() <= 0.02 + 1e-12
    assert np.hypot(steps[:, 0], steps[:, 1]).sum() == pytest.approx(path.length, rel=1e-3)


def test_a_differential_drive_goes_along_its_heading():
    """All along the path, arcs included: a wheel never slips sideways."""
    rows = sample_path(curved_path(), ROBOT, 1e-3)
    for before, after in zip(rows, rows[1:]):
        x, y = after[:2] - before[:2]
        middle = before[2] + 0.5 * wrap_angle(after[2] - before[2])
        assert abs(-math.sin(middle) * x + math.cos(middle) * y) < 1e-9


def test_backwards_is_the_same_path_with_the_heading_reversed():
    """The places are the same; between the ends the headings differ by 180 degrees."""
    start, goal = Pose(0.0, 0.0, 0.4), Pose(0.5, 1.5, -2.0)
    ahead, back = (differential_path(start, goal, CURVE, [flag] * 4) for flag in (False, True))
    moving = [[segment for segment in path.segments if segment.length] for path in (ahead, back)]
    for one, other in zip(*moving):
        assert one.start[:2] == other.start[:2] and one.directions == other.directions
        assert abs(wrap_angle(one.start.theta - other.start.theta)) == pytest.approx(math.pi)


def test_samples_need_a_spacing():
    """Zero, negative and nan are refused by name."""
    for spacing in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match='spacing: got'):
            sample_path(curved_path(), ROBOT, spacing)
