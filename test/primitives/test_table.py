"""Laws of contact places and of the table of primitives."""

import collections
import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import wrap_angle
from push_model.parameters import PushedObject
from push_primitives.contact_places import contact_places
from push_primitives.placement_errors import placement_derivatives
from push_primitives.table import build_table, draw_friction, FrictionDraws
import pytest

RADIUS = 0.17
BOX = box(foot=0.17)
BIN = bin_()


def nominal(obj):
    """Return the single guess that friction is as the object states."""
    return FrictionDraws(*(array[:1] for array in draw_friction(obj)))


def polygon(count, radius=0.2):
    """Return a regular polygon on the supports of the bin, its first face about the x axis."""
    angles = [math.tau * (i - 0.5) / count for i in range(count)]
    return PushedObject(mass=BIN.mass, supports=tuple(
        dataclasses.replace(support, x=0.5 * support.x, y=0.5 * support.y)
        for support in BIN.supports),
        outline=tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles))


@pytest.fixture(scope='module', params=['box', 'bin'])
def pushed(request):
    """Return an object and its table for the stated friction."""
    obj = {'box': BOX, 'bin': BIN}[request.param]
    return obj, build_table(obj, RADIUS, draws=nominal(obj))


def test_places_lie_on_the_outline_with_their_normal_inwards():
    """Touching there, the robot's centre is one radius away, against the normal."""
    for obj in (BOX, BIN):
        for place in contact_places(obj):
            x, y = place.point
            inward = (math.cos(place.normal), math.sin(place.normal))
            reach = obj.radius or 0.2
            assert max(abs(x), abs(y)) == pytest.approx(reach) or math.hypot(x, y) == \
                pytest.approx(reach)
            assert x * inward[0] + y * inward[1] < 0.0
    assert [place.face for place in contact_places(BOX)] == [i // 15 for i in range(60)]
    assert [place.face for place in contact_places(BIN)] == [i // 12 for i in range(48)]


def test_places_keep_from_the_vertices():
    """The outermost are 15 mm beside them, the middle one has offset 0."""
    face = contact_places(BOX)[:15]
    assert face[0].point == pytest.approx((-0.185, -0.2))
    assert face[7].offset == pytest.approx(0.0, abs=1e-12)
    assert face[14].point == pytest.approx((0.185, -0.2))


def test_an_object_of_short_faces_is_pushed_all_round():
    """Its places lie on the outline at equal distances, each in a sector."""
    places = contact_places(polygon(6, 0.14))
    assert [place.face for place in places] == [i // 12 for i in range(36)]
    apart = [math.dist(one.point, other.point) for one, other in zip(places, places[1:])]
    assert max(apart) == pytest.approx(6 * 0.14 / 36)
    assert min(apart) > 0.8 * max(apart)
    assert len({round(place.normal, 9) for place in places}) == 6


def test_a_tiny_object_is_refused():
    """The error names the field and the length."""
    with pytest.raises(ValueError, match=r'PushedObject\.outline: got 0\.12 m all round'):
        contact_places(polygon(6, 0.02))


def test_short_faces_that_turn_little_make_a_curve():
    """Its sectors count as faces; a long face in it, and corners, remain what they are."""
    places = contact_places(polygon(40))
    assert [place.face for place in places] == [i // 12 for i in range(48)]
    turns = np.diff(np.unwrap([place.normal for place in places]))
    assert (turns > -1e-9).all() and turns.max() < math.radians(20.0)
    # A stadium: two faces, and two half circles of two sectors each.
    half = [(0.3 + 0.2 * math.cos(angle), 0.2 * math.sin(angle))
            for angle in np.linspace(-0.5 * math.pi, 0.5 * math.pi, 21).tolist()]
    stadium = dataclasses.replace(
        polygon(40), outline=tuple(half + [(-x, -y) for x, y in half]), inertia=1.0)
    counts = collections.Counter(place.face for place in contact_places(stadium))
    assert sorted(counts.values()) == [12, 12, 12, 12, 15, 15]
    # A barrel: two straight and two curved sides, between four corners.
    side = [(0.4 * math.cos(angle) - 0.15, 0.4 * math.sin(angle))
            for angle in np.linspace(-0.6, 0.6, 9).tolist()]
    barrel = dataclasses.replace(
        polygon(40), outline=tuple(side + [(-x, -y) for x, y in side]), inertia=1.0)
    counts = collections.Counter(place.face for place in contact_places(barrel))
    assert sorted(counts.values()) == [12, 12, 15, 15]


def test_a_finely_sampled_disc_is_pushed_like_the_disc():
    """Effects of straight pushes, and their derivatives, differ by some percent."""
    disc = dataclasses.replace(polygon(48), outline=(), radius=0.2, inertia=0.1)
    fine = dataclasses.replace(polygon(48), inertia=0.1)
    tables = [build_table(obj, RADIUS, lengths=(0.0, 0.01, 0.03, 0.06), draws=nominal(obj))
              for obj in (disc, fine)]
    straight = [table.curvatures == 0.0 for table in tables]
    for values in zip(*((table.starts, table.displacements, *placement_derivatives(table))
                        for table in tables)):
        round_ones, fine_ones = (value[chosen] for value, chosen in zip(values, straight))
        if round_ones.ndim == 2:
            assert wrap_angle(np.abs(fine_ones - round_ones).max()) < 1e-3
        else:
            # Those that are one-sided, at the ends of a sector, are less alike.
            errors = np.abs(fine_ones - round_ones).max(axis=(1, 2))
            assert (np.quantile(errors, 0.8, axis=0)
                    < 0.08 * np.abs(round_ones).max(axis=(0, 1, 2))).all()


def test_no_length_no_displacement(pushed):
    """At length 0 nothing has moved, and further on every push moves the object."""
    _, table = pushed
    assert not table.displacements[:, :, 0].any()
    moved = np.hypot(table.displacements[..., 0], table.displacements[..., 1])
    assert np.isfinite(moved).all()
    assert (moved[..., 1:] > 0.1 * table.lengths[1:]).all()


def test_the_mirrored_push_has_the_mirrored_effect(pushed):
    """Both objects are symmetric about their x axis."""
    _, table = pushed
    for number in range(len(table.tilts)):
        x, y, phi = table.starts[number]
        mirrored = np.flatnonzero(
            np.isclose(table.starts[:, 0], x) & np.isclose(table.starts[:, 1], -y)
            & np.isclose(np.cos(table.starts[:, 2]), math.cos(phi))
            & np.isclose(np.sin(table.starts[:, 2]), -math.sin(phi))
            & np.isclose(table.curvatures, -table.curvatures[number]))
        assert len(mirrored) == 1
        # What is symmetric itself may roll to either side, by rounding.
        unstable = abs(y) < 1e-9 and abs(math.sin(phi)) < 1e-9
        if not unstable:
            np.testing.assert_allclose(table.displacements[mirrored[0]] * (1.0, -1.0, -1.0),
                                       table.displacements[number], atol=2e-4)


def test_level_of_friction_and_mass_do_not_matter():
    """Only how friction is spread decides where a slow push leads."""
    supports = tuple(
        dataclasses.replace(support, friction_coefficient=1.7 * support.friction_coefficient)
        for support in BIN.supports)
    heavy = dataclasses.replace(BIN, mass=3.0 * BIN.mass, inertia=3.0 * BIN.inertia,
                                supports=supports)
    lengths = (0.0, 0.03, 0.1)
    tables = [build_table(obj, RADIUS, draws=nominal(obj), lengths=lengths)
              for obj in (BIN, heavy)]
    np.testing.assert_allclose(tables[0].displacements, tables[1].displacements, atol=2e-3)


def test_infinite_radius_is_refused():
    """A flat pusher has no place of contact."""
    with pytest.raises(ValueError, match='robot_radius: got inf'):
        build_table(BIN, math.inf)
