"""Dubins paths with unequal radii arrive, mirror, and have known lengths."""

import math

import numpy as np
from push_model.dubins import dubins_paths
from push_model.geometry import Pose, wrap_angle
import pytest


def test_dubins_paths_arrive_and_mirror():
    rng = np.random.default_rng(1)
    for _ in range(300):
        start, goal = Pose(*rng.uniform(-3, 3, 3)), Pose(*rng.uniform(-3, 3, 3))
        left, right = rng.uniform(0.2, 1.5, 2)
        found = dubins_paths(start, goal, left, right)
        assert {'LSL', 'RSR'} <= {path.word for path in found}
        for path in found:
            end, _ = path.at(path.length)
            assert end[:2] == pytest.approx(goal[:2], abs=1e-9)
            assert wrap_angle(end.theta - goal.theta) == pytest.approx(0.0, abs=1e-9)
        flipped = dubins_paths(*(Pose(p.x, -p.y, -p.theta) for p in (start, goal)), right, left)
        assert flipped[0].length == pytest.approx(found[0].length, abs=1e-9)


def test_dubins_known_lengths():
    ahead = dubins_paths(Pose(0, 0, 0), Pose(5, 0, 0), 1.0, 0.5)[0]
    assert ahead.length == pytest.approx(5.0)
    u_turn = dubins_paths(Pose(0, 0, 0), Pose(0, 2, math.pi), 1.0, 1.0)[0]
    assert u_turn.length == pytest.approx(math.pi)
    with pytest.raises(ValueError, match='radius R'):
        dubins_paths(Pose(0, 0, 0), Pose(1, 0, 0), 1.0, 0.0)


def test_rounding_makes_no_circle_of_a_path_to_where_it_starts():
    """Only what is further off than any rounding is reached by a detour."""
    start = Pose(3.0, -2.0, 0.7)
    for bearing in np.linspace(0.0, 2.0 * math.pi, 13):
        goal = Pose(start.x + 1e-12 * math.cos(bearing), start.y + 1e-12 * math.sin(bearing), 0.7)
        assert dubins_paths(start, goal, 1.0, 0.5)[0].length < 1e-9
    aside = start @ Pose(0.0, 1e-3, 0.0)
    assert dubins_paths(start, aside, 1.0, 0.5)[0].length > math.pi
