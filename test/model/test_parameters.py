"""Parameters of objects and robots: what is refused, and what follows where it is not given."""

import ast
import dataclasses
import math

from helpers.objects import box, square_outline
import numpy as np
from push_model.friction import friction_center
from push_model.parameters import GRAVITY, plate_inertia, PushedObject, RoundRobot, Support
import pytest

TRIANGLE = ((0.0, 0.0), (0.6, 0.1), (0.2, 0.5))


@pytest.mark.parametrize('change, words_expected', [
    ({'mass': float('nan')}, ('PushedObject.mass', 'nan', 'from 0.005', 'kg')),
    ({'mass': '2'}, ('PushedObject.mass', "'2'", 'finite number')),
    ({'mass': True}, ('PushedObject.mass', 'True')),
    ({'inertia': -0.1}, ('PushedObject.inertia', 'at least 0')),
    ({'supports': ()}, ('PushedObject.supports', 'at least one')),
    ({'supports': (1.0,)}, ('PushedObject.supports', '1.0', 'Support')),
    ({'outline': square_outline()[::-1]}, ('PushedObject.outline', 'convex')),
    ({'outline': square_outline()[:2]}, ('PushedObject.outline', '2 vertices')),
    ({'outline': ()}, ('PushedObject.outline', 'radius')),
    ({'radius': 0.2}, ('PushedObject.outline', 'not both')),
    ({'center_of_mass': (0.0,)}, ('PushedObject.center_of_mass', 'two numbers')),
    ({'center_of_mass': (0.0, math.inf)}, ('PushedObject.center_of_mass', 'inf')),
])
def test_object_refuses_bad_fields(change, words_expected):
    with pytest.raises(ValueError) as error:
        dataclasses.replace(box(), **change)
    for word in words_expected:
        assert word in str(error.value)


def test_star_is_not_convex():
    star = [(math.cos(a), math.sin(a)) for a in np.arange(5) * 4 * math.pi / 5]
    with pytest.raises(ValueError, match='convex'):
        dataclasses.replace(box(), outline=star)


@pytest.mark.parametrize('outline', [
    [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.0), (0.0, 0.0), (0.0, 0.3), (-0.3, 0.3)],  # an L
    [(-0.3, -0.3), (0.0, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)],  # a vertex on an edge
    square_outline()[::-1],
])
def test_what_is_not_convex_is_offered_its_hull(outline):
    with pytest.raises(ValueError) as error:
        dataclasses.replace(box(), outline=outline)
    hull = ast.literal_eval(str(error.value).partition('such as its hull ')[2])
    assert {tuple(vertex) for vertex in hull} <= set(outline)
    assert dataclasses.replace(box(), outline=hull).outline == tuple(map(tuple, hull))


def test_a_long_hull_is_not_listed():
    ring = [(0.2 * math.cos(a), 0.2 * math.sin(a)) for a in np.arange(40) * math.pi / 20]
    with pytest.raises(ValueError, match='hull of 40 vertices, push_model.convex_hull'):
        dataclasses.replace(box(), outline=[*ring, (0.0, 0.0)])


def test_robot_refuses_an_unknown_drive():
    with pytest.raises(ValueError, match=r"RoundRobot.drive: got 'tracked', expected one of diff"):
        RoundRobot(radius=0.17, drive='tracked')
    with pytest.raises(ValueError, match=r'RoundRobot.radius: got -1, expected .* at least 0'):
        RoundRobot(radius=-1)


def test_numbers_are_normalised():
    obj = box(mass=2)
    assert isinstance(obj.mass, float)
    assert dataclasses.replace(obj, outline=np.array(square_outline())).outline == obj.outline
    with pytest.raises(dataclasses.FrozenInstanceError):
        obj.mass = 3.0


def test_loads_carry_the_weight_and_follow_the_load_fractions():
    supports = [Support(0.1, 0, 0.3, 1.0), Support(-0.1, 0, 0.2, 3.0)]
    obj = PushedObject(mass=2.0, inertia=0.1, supports=supports, radius=0.2,
                       center_of_mass=(-0.05, 0.0))
    assert sum(obj.loads) == pytest.approx(2.0 * 9.81)
    assert obj.loads[1] == pytest.approx(3 * obj.loads[0])
    assert friction_center(obj)[0] == pytest.approx(0.1 * (0.3 - 0.6) / (0.3 + 0.6))


def on_supports(points, center, **fields):
    """Return a disc of 2 kg on supports at the points."""
    return PushedObject(mass=2.0, supports=[Support(x, y, 0.3) for x, y in points], radius=0.3,
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
    points = rng.uniform(-0.3, 0.3, (count, 2))
    fractions = rng.dirichlet(np.ones(count))
    center = fractions @ points
    loads = np.array(on_supports(points, center).loads)
    assert loads.sum() == pytest.approx(2.0 * GRAVITY, rel=1e-9) and loads.min() >= 0.0
    assert loads @ points == pytest.approx(2.0 * GRAVITY * center, abs=1e-6)
    if count <= 3:
        assert loads == pytest.approx(2.0 * GRAVITY * fractions, abs=1e-6)


def test_four_supports_bear_as_springs_under_a_plate():
    """Loads lie on a plane over the supports; one that would have to pull carries nothing."""
    square = np.array(square_outline())
    loads = np.array(on_supports(square, (0.05, 0.02)).loads)
    assert loads[0] + loads[2] == pytest.approx(loads[1] + loads[3])
    assert on_supports(square, (0.0, 0.0)).loads == pytest.approx([0.5 * GRAVITY] * 4)
    lifted = on_supports(square, (0.15, 0.15)).loads
    assert lifted[0] == 0.0 and lifted[1] == pytest.approx(lifted[3])


def test_given_load_fractions_are_kept_where_statics_leave_them_open():
    square = square_outline()
    given = 3.0, 1.0, 3.0, 1.0
    supports = [Support(x, y, 0.3, fraction) for (x, y), fraction in zip(square, given)]
    loads = dataclasses.replace(box(), supports=supports).loads
    assert loads == pytest.approx(np.array(given) * 2.0 * GRAVITY / 8.0)


@pytest.mark.parametrize('points, center', [
    ([(0.0, 0.0)], (0.01, 0.0)), ([(-0.1, 0.0), (0.1, 0.0)], (0.0, 0.01)),
    ([(-0.1, 0.0), (0.1, 0.0)], (0.11, 0.0)),
    ([(-0.1, 0.0), (0.1, 0.0), (0.0, 0.1)], (0.0, -0.01)),
    (square_outline(), (0.21, 0.0)), ([(0.0, 0.0), (0.1, 0.0), (0.2, 0.0)], (0.1, 0.01))])
def test_object_that_would_tip_is_refused(points, center):
    with pytest.raises(ValueError, match='PushedObject.supports: .* mass centre .* would tip'):
        on_supports(points, center)


@pytest.mark.parametrize('fractions, text', [((2, 1, 1, 1), 'balance about'),
                                             ((1, 0, 1, 0), 'for every support, or none')])
def test_load_fractions_that_cannot_be_are_refused(fractions, text):
    supports = [Support(x, y, 0.3, fraction)
                for (x, y), fraction in zip(square_outline(), fractions)]
    with pytest.raises(ValueError, match=text):
        dataclasses.replace(box(), supports=supports)
