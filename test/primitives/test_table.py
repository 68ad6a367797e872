"""Laws of face points and of the table of primitives."""

import collections
import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import wrap_angle
from push_model.parameters import PushedObject
from push_primitives.face_points import face_points
from push_primitives.placement_errors import contact_derivatives
from push_primitives.table import build_table, FrictionSamples, sample_friction
import pytest

RADIUS = 0.17
BOX = box(foot=0.17)
BIN = bin_()


def nominal(obj):
    """Return the single guess that friction is as the object states."""
    return FrictionSamples(*(array[:1] for array in sample_friction(obj)))


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
    return obj, build_table(obj, RADIUS, friction_samples=nominal(obj))


def test_points_lie_on_the_outline_with_their_normal_inwards():
    """Touching there, the robot's centre is one radius away, against the normal."""
    for obj in (BOX, BIN):
        for point in face_points(obj):
            x, y = point.position
            inward = (math.cos(point.normal), math.sin(point.normal))
            reach = obj.radius or 0.2
            assert max(abs(x), abs(y)) == pytest.approx(reach) or math.hypot(x, y) == \
                pytest.approx(reach)
            assert x * inward[0] + y * inward[1] < 0.0
    assert [point.face for point in face_points(BOX)] == [i // 15 for i in range(60)]
    assert [point.face for point in face_points(BIN)] == [i // 12 for i in range(48)]


def test_points_keep_from_the_vertices():
    """The outermost are 15 mm beside them, the middle one has offset 0."""
    face = face_points(BOX)[:15]
    assert face[0].position == pytest.approx((-0.185, -0.2))
    assert face[7].offset == pytest.approx(0.0, abs=1e-12)
    assert face[14].position == pytest.approx((0.185, -0.2))


def test_an_object_of_short_faces_is_pushed_all_round():
    """Its points lie on the outline at equal distances, each in a sector."""
    points = face_points(polygon(6, 0.14))
    assert [point.face for point in points] == [i // 12 for i in range(36)]
    apart = [math.dist(one.position, other.position) for one, other in zip(points, points[1:])]
    assert max(apart) == pytest.approx(6 * 0.14 / 36)
    assert min(apart) > 0.8 * max(apart)
    assert len({round(point.normal, 9) for point in points}) == 6


def test_a_tiny_object_is_refused():
    """The error names the field and the length."""
    with pytest.raises(ValueError, match=r'PushedObject\.outline: got 0\.12 m all round'):
        face_points(polygon(6, 0.02))


def test_short_faces_that_turn_little_make_a_curve():
    """Its sectors count as faces; a long face in it, and corners, remain what they are."""
    points = face_points(polygon(40))
    assert [point.face for point in points] == [i // 12 for i in range(48)]
    turns = np.diff(np.unwrap([point.normal for point in points]))
    assert (turns > -1e-9).all() and turns.max() < math.radians(20.0)
    # A stadium: two faces, and two half circles of two sectors each.
    half = [(0.3 + 0.2 * math.cos(angle), 0.2 * math.sin(angle))
            for angle in np.linspace(-0.5 * math.pi, 0.5 * math.pi, 21).tolist()]
    stadium = dataclasses.replace(
        polygon(40), outline=tuple(half + [(-x, -y) for x, y in half]), inertia=1.0)
    counts = collections.Counter(point.face for point in face_points(stadium))
    assert sorted(counts.values()) == [12, 12, 12, 12, 15, 15]
    # A barrel: two straight and two curved sides, between four corners.
    side = [(0.4 * math.cos(angle) - 0.15, 0.4 * math.sin(angle))
            for angle in np.linspace(-0.6, 0.6, 9).tolist()]
    barrel = dataclasses.replace(
        polygon(40), outline=tuple(side + [(-x, -y) for x, y in side]), inertia=1.0)
    counts = collections.Counter(point.face for point in face_points(barrel))
    assert sorted(counts.values()) == [12, 12, 15, 15]


def test_a_finely_sampled_disc_is_pushed_like_the_disc():
    """Effects of straight pushes, and their derivatives, differ by some percent."""
    disc = dataclasses.replace(polygon(48), outline=(), radius=0.2, inertia=0.1)
    fine = dataclasses.replace(polygon(48), inertia=0.1)
    lengths = (0.0, 0.01, 0.03, 0.06)
    tables = [build_table(obj, RADIUS, lengths=lengths, friction_samples=nominal(obj))
              for obj in (disc, fine)]
    straight = [table.curvatures == 0.0 for table in tables]
    for values in zip(*((table.starts, table.displacements, *contact_derivatives(table))
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
    for index in range(len(table.approach_angles)):
        x, y, phi = table.starts[index]
        mirrored = np.flatnonzero(
            np.isclose(table.starts[:, 0], x) & np.isclose(table.starts[:, 1], -y)
            & np.isclose(np.cos(table.starts[:, 2]), math.cos(phi))
            & np.isclose(np.sin(table.starts[:, 2]), -math.sin(phi))
            & np.isclose(table.curvatures, -table.curvatures[index]))
        assert len(mirrored) == 1
        # What is symmetric itself may roll to either side, by rounding.
        unstable = abs(y) < 1e-9 and abs(math.sin(phi)) < 1e-9
        if not unstable:
            np.testing.assert_allclose(table.displacements[mirrored[0]] * (1.0, -1.0, -1.0),
                                       table.displacements[index], atol=2e-4)


def test_level_of_friction_and_mass_do_not_matter():
    """Only how friction is spread decides where a slow push leads."""
    supports = tuple(
        dataclasses.replace(support, friction_coefficient=1.7 * support.friction_coefficient)
        for support in BIN.supports)
    heavy = dataclasses.replace(BIN, mass=3.0 * BIN.mass, inertia=3.0 * BIN.inertia,
                                supports=supports)
    lengths = (0.0, 0.03, 0.1)
    tables = [build_table(obj, RADIUS, friction_samples=nominal(obj), lengths=lengths)
              for obj in (BIN, heavy)]
    np.testing.assert_allclose(tables[0].displacements, tables[1].displacements, atol=2e-3)


def test_progress_is_stated_for_each_primitive():
    """In equal parts, up to the whole."""
    parts = []
    table = build_table(BIN, RADIUS, friction_samples=nominal(BIN), lengths=(0.0, 0.03),
                        progress=parts.append)
    count = len(table.starts)
    assert parts == pytest.approx(np.arange(1, count + 1) / count)


def test_infinite_radius_is_refused():
    """A flat pusher has no place of contact."""
    with pytest.raises(ValueError, match='robot_radius: got inf'):
        build_table(BIN, math.inf)
