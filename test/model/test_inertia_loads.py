"""What an object's inertia and loads follow from, where they are not given."""

import dataclasses
import math

from helpers.objects import box, square_outline
import numpy as np
from push_model.parameters import GRAVITY, plate_inertia, PushedObject, Support
import pytest

pytestmark = pytest.mark.physics
TRIANGLE = ((0.0, 0.0), (0.6, 0.1), (0.2, 0.5))


def on_feet(places, center, **fields):
    """Return a disc of 2 kg on feet at the places."""
    return PushedObject(mass=2.0, supports=[Support(x, y, 0.3) for x, y in places], radius=0.3,
                        center_of_mass=center, **fields)


def inside(outline, points):
    """Tell which points lie inside a convex outline."""
    edges = np.roll(outline, -1, axis=0) - outline
    away = points[:, None] - outline
    return (edges[:, 0] * away[..., 1] - edges[:, 1] * away[..., 0] > 0.0).all(axis=1)


@pytest.mark.parametrize('outline', [TRIANGLE, square_outline(),
                                     ((1, 1), (3, 1), (2.5, 2), (1, 2))])
def test_inertia_of_a_polygon_is_that_of_its_points(outline):
    """A million points are drawn evenly over the outline."""
    corners = np.array(outline, dtype=float)
    points = np.random.default_rng(0).uniform(corners.min(0), corners.max(0), (10 ** 6, 2))
    points = points[inside(corners, points)]
    assert plate_inertia(2.0, outline) == pytest.approx(2.0 * points.var(axis=0).sum(), rel=5e-3)


def test_inertia_of_many_corners_tends_to_that_of_the_disc():
    circle = [(0.3 * math.cos(a), 0.3 * math.sin(a)) for a in np.arange(720) * math.pi / 360]
    assert plate_inertia(3.0, circle) == pytest.approx(plate_inertia(3.0, (), 0.3), rel=1e-4)
    assert plate_inertia(3.0, (), 0.3) == pytest.approx(0.5 * 3.0 * 0.3 ** 2)


def test_inertia_does_not_depend_on_frame_or_mass_centre():
    moved = tuple((x + 5.0, y - 2.0) for x, y in TRIANGLE)
    assert plate_inertia(1.0, moved) == pytest.approx(plate_inertia(1.0, TRIANGLE), rel=1e-9)
    objects = [dataclasses.replace(box(), inertia=0.0, center_of_mass=c)
               for c in ((0.0, 0.0), (0.1, 0.05))]
    assert objects[0].inertia == objects[1].inertia == pytest.approx(2.0 * 0.4 ** 2 / 6.0)
    assert dataclasses.replace(box(), inertia=0.5).inertia == 0.5


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('count', [1, 2, 3, 4, 7])
def test_loads_balance_about_the_mass_centre(seed, count):
    rng = np.random.default_rng(seed)
    places = rng.uniform(-0.3, 0.3, (count, 2))
    shares = rng.dirichlet(np.ones(count))
    center = shares @ places
    loads = np.array(on_feet(places, center).loads)
    assert loads.sum() == pytest.approx(2.0 * GRAVITY, rel=1e-9) and loads.min() >= 0.0
    assert loads @ places == pytest.approx(2.0 * GRAVITY * center, abs=1e-6)
    if count <= 3:
        assert loads == pytest.approx(2.0 * GRAVITY * shares, abs=1e-6)


def test_four_feet_share_as_springs_under_a_plate():
    """Loads lie on a plane over the feet; a foot that would have to pull carries nothing."""
    square = np.array(square_outline())
    loads = np.array(on_feet(square, (0.05, 0.02)).loads)
    assert loads[0] + loads[2] == pytest.approx(loads[1] + loads[3])
    assert on_feet(square, (0.0, 0.0)).loads == pytest.approx([0.5 * GRAVITY] * 4)
    lifted = on_feet(square, (0.15, 0.15)).loads
    assert lifted[0] == 0.0 and lifted[1] == pytest.approx(lifted[3])


def test_given_shares_are_kept_where_statics_leave_them_open():
    square = square_outline()
    feet = [Support(x, y, 0.3, share) for (x, y), share in zip(square, (3.0, 1.0, 3.0, 1.0))]
    loads = dataclasses.replace(box(), supports=feet).loads
    assert loads == pytest.approx(np.array([3.0, 1.0, 3.0, 1.0]) * 2.0 * GRAVITY / 8.0)


@pytest.mark.parametrize('places, center', [
    ([(0.0, 0.0)], (0.01, 0.0)), ([(-0.1, 0.0), (0.1, 0.0)], (0.0, 0.01)),
    ([(-0.1, 0.0), (0.1, 0.0)], (0.11, 0.0)),
    ([(-0.1, 0.0), (0.1, 0.0), (0.0, 0.1)], (0.0, -0.01)),
    (square_outline(), (0.21, 0.0)), ([(0.0, 0.0), (0.1, 0.0), (0.2, 0.0)], (0.1, 0.01))])
def test_object_that_would_tip_is_refused(places, center):
    with pytest.raises(ValueError, match='PushedObject.supports: .* mass centre .* would tip'):
        on_feet(places, center)


@pytest.mark.parametrize('shares, text', [((2, 1, 1, 1), 'balance about'),
                                          ((1, 0, 1, 0), 'for every support, or none')])
def test_shares_that_cannot_be_are_refused(shares, text):
    feet = [Support(x, y, 0.3, share) for (x, y), share in zip(square_outline(), shares)]
    with pytest.raises(ValueError, match=text):
        dataclasses.replace(box(), supports=feet)
