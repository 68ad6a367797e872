"""Paths of the flat output: end, curvature, projection and limits."""

import math

from helpers.contact_sites import arc_trajectory, VERTEX
from helpers.objects import box
import numpy as np
from push_control.steered.path.path import (
    CurvatureLimits, path_to_goal, project_on_path, SampledPath,
)
from push_model.geometry import Pose
from push_model.quasi_static import vehicle
import pytest

NOMINAL = box(foot=0.18)


def test_the_path_ends_at_the_goal_with_its_curvature():
    """An arc of z comes out as that arc, in the frame of its end."""
    trajectory = arc_trajectory(NOMINAL, VERTEX, 0.8, 1.5)
    path = SampledPath(vehicle(NOMINAL, VERTEX.point), trajectory)
    assert path.length == pytest.approx(1.5, abs=1e-4)
    assert path.at(path.length)[0] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    for s in (0.0, 0.31, 1.0, 1.49):
        pose, curvature = path.at(s)
        assert curvature == pytest.approx(0.8, abs=1e-3)
        assert pose.theta == pytest.approx(-0.8 * (1.5 - s), abs=1e-3)


@pytest.mark.parametrize('s', [0.05, 0.7, 1.4])
@pytest.mark.parametrize('lateral, rotation', [(0.03, 0.1), (-0.05, -0.2)])
def test_a_pose_is_projected_on_the_path(s, lateral, rotation):
    """Arc length, lateral error (left positive) and heading error, from a guess nearby."""
    path = SampledPath(vehicle(NOMINAL, VERTEX.point), arc_trajectory(NOMINAL, VERTEX, 0.8, 1.5))
    pose = path.at(s)[0] @ Pose(0.0, lateral, rotation)
    found = project_on_path(path, pose, np.array((s - 0.06, 0.0, 0.0, 0.0, 0.0)))
    assert found[:3] == pytest.approx((s, lateral, rotation), abs=1e-3)


def test_a_new_path_leads_from_here_to_the_goal_within_its_limits():
    """It starts at the pose, ends straight at the goal, and turns no tighter than allowed."""
    start = Pose(-1.5, 0.7, 2.0)
    path = path_to_goal(start, CurvatureLimits(-0.5, 0.9), 0.4)
    assert path.at(0.0)[0] == pytest.approx(start)
    x, y, theta = path.at(path.length)[0]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert math.remainder(theta, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    curvatures = [path.at(s)[1] for s in np.linspace(0.0, path.length, 200)]
    assert min(curvatures) >= -0.5 - 1e-9 and max(curvatures) <= 0.9 + 1e-9
    assert all(path.at(s)[1] == 0.0 for s in np.linspace(path.length - 0.39, path.length, 9))


def test_limits_clip_and_narrow():
    """Clipping keeps what is inside; narrowing is the intersection."""
    limits = CurvatureLimits(-0.5, 0.8)
    assert [limits.clip(value) for value in (-2.0, 0.1, 2.0)] == [-0.5, 0.1, 0.8]
    assert limits.intersection(CurvatureLimits(-1.0, 0.3)) == (-0.5, 0.3)
