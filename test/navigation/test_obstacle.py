"""Inflated outlines: distances, tangents and rays against points of a sampled outline."""

import math

from helpers.objects import square_outline
import numpy as np
from push_model.geometry import wrap_angle
from push_navigation.obstacle import inflate, points_on_outline
import pytest

PLANK = ((-0.6, -0.1), (0.5, -0.15), (0.7, 0.0), (0.5, 0.12), (-0.55, 0.1))
MARGIN = 0.22
BODIES = {'plank': inflate(PLANK, 0.0, MARGIN), 'box': inflate(square_outline(), 0.0, MARGIN),
          'disc': inflate((), 0.2, MARGIN)}
each = pytest.mark.parametrize('body', BODIES.values(), ids=BODIES)


def surface(body, count=20000):
    """Return points of the surface: the support points of the core, moved out by the radius."""
    angles = np.linspace(-math.pi, math.pi, count, endpoint=False)
    normals = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    core = np.array(body.core)
    corners = core[np.argmax(normals @ core.T, axis=1)] + body.radius * normals
    # Between the arcs round the corners, straight edges.
    steps = np.linspace(0.0, 1.0, 2000)[:, None]
    edges = []
    for (x0, y0), (x1, y1) in zip(core, np.roll(core, -1, axis=0)):
        length = math.hypot(x1 - x0, y1 - y0)
        if length:
            out = np.array((y1 - y0, x0 - x1)) / length * body.radius
            edges.append((x0, y0) + out + steps * (x1 - x0, y1 - y0))
    return np.concatenate([corners, *edges])


def outside(body, count, seed):
    """Return random points outside of a body."""
    points = np.random.default_rng(seed).uniform(-1.6, 1.6, (20 * count, 2))
    return points[body.distances(points) > 0.01][:count]


@each
def test_distances_are_those_to_the_sampled_surface(body):
    """Outside and inside; alone as well as many at a time, with the direction outwards."""
    points = np.random.default_rng(1).uniform(-1.2, 1.2, (150, 2))
    rim = surface(body)
    for point, found in zip(points, body.distances(points)):
        nearest = np.hypot(*(rim - point).T).min()
        if np.hypot(*point) > 0.05 or found > 0.0:
            distance, outward = body.nearest(*point)
            assert distance == pytest.approx(found, abs=1e-12)
            moved = point - distance * np.array((math.cos(outward), math.sin(outward)))
            assert body.nearest(*moved)[0] == pytest.approx(0.0, abs=1e-9)
        # Deep inside, the distance is that to the core, less the radius.
        assert abs(found) == pytest.approx(nearest, abs=2e-4)


@each
def test_distance_rises_with_the_margin_alone(body):
    """A body that is inflated by more is nearer by as much, everywhere."""
    larger = body._replace(radius=body.radius + 0.1)
    points = np.random.default_rng(2).uniform(-1.5, 1.5, (200, 2))
    assert body.distances(points) - larger.distances(points) == pytest.approx(0.1)


@each
def test_a_cone_occludes_what_a_ray_meets(body):
    """Rays in all directions, sampled finely: they meet the body in the cone, and only there."""
    reach = np.linspace(0.0, 4.0, 2001)[:, None]
    met = 0
    for x, y in outside(body, 25, 3):
        cone = body.cone(x, y)
        for angle in np.linspace(-math.pi, math.pi, 37):
            # A ray this near to a tangent is too close to tell by samples.
            if min(abs(wrap_angle(angle - cone.left)), abs(wrap_angle(angle - cone.right))) < 0.02:
                continue
            ray = (x, y) + reach * (math.cos(angle), math.sin(angle))
            meets = bool(body.distances(ray).min() < 0.0)
            assert cone.occludes(angle) == meets
            met += meets
    assert met > 50


@each
def test_the_edges_of_a_cone_are_tangents(body):
    """They come as near as the surface and no nearer, round the vertex that they name."""
    for x, y in outside(body, 25, 4):
        cone = body.cone(x, y)
        for angle, index, side in ((cone.left, cone.left_index, 1.0),
                                   (cone.right, cone.right_index, -1.0)):
            c, s = math.cos(angle), math.sin(angle)
            ray = np.array((x, y)) + np.linspace(0.0, 4.0, 40001)[:, None] * (c, s)
            assert body.distances(ray).min() == pytest.approx(0.0, abs=1e-6)
            v_x, v_y = body.core[index]
            assert side * (s * (v_x - x) - c * (v_y - y)) == pytest.approx(body.radius)


@each
def test_a_ray_from_inside_leaves_at_the_surface(body):
    """Within a quarter turn of the shortest direction, from places near the surface."""
    rng = np.random.default_rng(5)
    for _ in range(100):
        bearing = rng.uniform(-math.pi, math.pi)
        rim = surface(body, 720)
        point = rim[np.argmax(rim @ (math.cos(bearing), math.sin(bearing)))]
        _, outward = body.nearest(*point)
        depth = rng.uniform(0.0, 0.2)
        x, y = point - depth * np.array((math.cos(outward), math.sin(outward)))
        direction = outward + rng.uniform(-1.2, 1.2)
        length = body.ray_exit(x, y, direction)
        assert length >= -1e-9
        end = x + length * math.cos(direction), y + length * math.sin(direction)
        assert body.nearest(*end)[0] == pytest.approx(0.0, abs=1e-9)


def test_an_inflated_disc_is_a_larger_disc():
    disc = inflate((), 0.2, 0.1)
    assert disc.nearest(0.5, 0.0) == pytest.approx((0.2, 0.0))
    cone = disc.cone(0.6, 0.0)
    assert cone.left - cone.right == pytest.approx(2.0 * math.asin(0.5))
    assert cone.occludes(math.pi) and not cone.occludes(0.0)


@pytest.mark.parametrize('spacing', [0.01, 0.07, 3.0])
def test_points_on_an_outline_are_on_it_and_leave_no_gap(spacing):
    """Its vertices are among them."""
    points = points_on_outline(PLANK, spacing)
    assert np.abs(inflate(PLANK, 0.0, 0.0).distances(points)).max() < 1e-9
    gaps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    assert gaps.max() <= spacing + 1e-9
    assert set(PLANK) <= set(map(tuple, points.tolist()))
