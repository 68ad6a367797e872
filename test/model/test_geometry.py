"""Poses form the group SE(2); points of polygons are what a dense search finds."""

import math

from helpers.objects import square_outline
import numpy as np
from push_model.geometry import (
    boundary_point, distance, lowest_vertex, Pose, wrap_angle, wrap_angles,
)
import pytest

TRIANGLE = ((0.0, 0.0), (0.6, 0.1), (0.2, 0.5))


def random_poses(count, seed=0):
    """Return poses anywhere."""
    return [Pose(*row) for row in np.random.default_rng(seed).uniform(-4.0, 4.0, (count, 3))]


def test_poses_compose_as_a_group():
    for a, b, c in zip(random_poses(50), random_poses(50, 1), random_poses(50, 2)):
        assert a @ (b @ c) == pytest.approx((a @ b) @ c, abs=1e-12)
        assert a @ a.inverse() == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
        assert (a @ b).transform((0.3, -0.7)) == pytest.approx(
            a.transform(b.transform((0.3, -0.7))), abs=1e-12)


def test_a_pose_keeps_distances_and_directions():
    for pose in random_poses(50):
        one, two = (0.3, 0.1), (-0.4, 1.2)
        assert distance(pose.transform(one), pose.transform(two)) == pytest.approx(
            distance(one, two))
        x, y = pose.rotate((1.0, 0.0))
        assert wrap_angle(math.atan2(y, x) - pose.theta) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize('angle', [-7.0, -math.pi, -0.1, 0.0, 3.0, 100.0])
def test_wrapped_angles_are_the_same_direction(angle):
    wrapped = wrap_angle(angle)
    assert abs(wrapped) <= math.pi
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-12)
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-12)


def test_many_angles_wrap_as_one_does():
    """At half a turn alone, where both signs mean the same, the conventions differ."""
    angles = np.random.default_rng(1).uniform(-20.0, 20.0, 200)
    assert wrap_angles(angles) == pytest.approx([wrap_angle(angle) for angle in angles],
                                                abs=1e-12)
    assert wrap_angles(math.pi) == wrap_angles(-math.pi) == -math.pi


@pytest.mark.parametrize('outline', [TRIANGLE, square_outline()])
def test_the_boundary_point_is_the_nearest_of_many(outline):
    """Against points every 0.05 mm of the boundary; the normal leads from outside to inside."""
    corners = np.array(outline)
    fractions = np.linspace(0.0, 1.0, 12001)[:, None]
    faces = [a + fractions * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    for x, y in np.random.default_rng(4).uniform(-0.6, 0.8, (100, 2)):
        away = [np.hypot(*(face - (x, y)).T) for face in faces]
        found = boundary_point(outline, x, y)
        assert abs(found.signed_distance) == pytest.approx(min(map(np.min, away)), abs=1e-7)
        assert away[found.face].min() == pytest.approx(min(map(np.min, away)), abs=1e-12)
        first, last = corners[found.face], corners[(found.face + 1) % len(corners)]
        assert (found.x, found.y) == pytest.approx(first + found.fraction * (last - first))
        assert math.hypot(found.normal_x, found.normal_y) == pytest.approx(1.0)
        assert (x + found.signed_distance * found.normal_x,
                y + found.signed_distance * found.normal_y) == pytest.approx(
                    (found.x, found.y), abs=1e-9)


def test_a_point_on_the_boundary_has_the_normal_of_its_face():
    found = boundary_point(square_outline(), -0.2, 0.05)
    assert (found.normal_x, found.normal_y) == pytest.approx((1.0, 0.0))
    assert found.face == 3 and found.fraction == pytest.approx(0.375)


def test_the_lowest_vertex_is_the_one_that_a_flat_pusher_meets():
    assert lowest_vertex(TRIANGLE, 1.0, 0.0) == 0
    assert lowest_vertex(TRIANGLE, -1.0, 0.0) == 1
    assert lowest_vertex(TRIANGLE, 0.0, -1.0) == 2
