"""Laws of simplified objects: what is left out hardly matters, and nothing else changes."""

import dataclasses
import math

from helpers.objects import box
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import boundary_point
from push_model.parameters import PushedObject, Support
from push_primitives.simplification import MAX_SUPPORTS, MAX_VERTICES, simplified_object
import pytest

BOX = box(foot=0.17)


def oval(count, radius=0.3, squash=0.7, friction=0.3):
    """Return a finely sampled oval on as many supports, which do not slide alike."""
    ring = [(math.cos(math.tau * i / count), squash * math.sin(math.tau * i / count))
            for i in range(count)]
    return PushedObject(
        mass=5.0, outline=tuple((radius * x, radius * y) for x, y in ring),
        supports=tuple(Support(0.8 * radius * x, 0.8 * radius * y, friction * (1.0 + 0.3 * x))
                       for x, y in ring))


def sampled(obj, count, bulge):
    """Return a polygon with points on each face, which bulges by so much at its middle."""
    vertices = []
    for (x_0, y_0), (x_1, y_1) in zip(obj.outline, (*obj.outline[1:], obj.outline[0])):
        length = math.hypot(x_1 - x_0, y_1 - y_0)
        for i in range(count):
            part = i / count
            out = 4.0 * bulge * part * (1.0 - part) / length
            vertices.append((x_0 + part * (x_1 - x_0) + out * (y_1 - y_0),
                             y_0 + part * (y_1 - y_0) - out * (x_1 - x_0)))
    return dataclasses.replace(obj, outline=tuple(vertices))


@pytest.mark.parametrize('count', [60, 200, 500])
@pytest.mark.parametrize('radius', [0.05, 0.3, 2.0])
def test_what_is_left_is_the_same_object(count, radius):
    """Outline and centre of friction within some millimetres, load and friction exactly."""
    obj = oval(count, radius)
    simple = simplified_object(obj)
    assert 12 <= len(simple.outline) <= MAX_VERTICES and len(simple.supports) == MAX_SUPPORTS
    assert set(simple.outline) <= set(obj.outline)
    away = [abs(boundary_point(simple.outline, *vertex).signed_distance)
            for vertex in obj.outline]
    assert max(away) < 0.005 * radius + 0.001
    assert sum(simple.loads) == pytest.approx(sum(obj.loads))
    assert sum(simple.capacities) == pytest.approx(sum(obj.capacities))
    assert friction_center(simple) == pytest.approx(friction_center(obj), abs=0.005 * radius)
    assert simple.inertia == obj.inertia
    # How friction resists a rotation: within some percent.
    arms, simple_arms = (np.dot(each.capacities, [math.hypot(s.x, s.y) for s in each.supports])
                         for each in (obj, simple))
    assert simple_arms == pytest.approx(arms, rel=0.05)


def test_simplifying_twice_changes_nothing():
    """Planner and controller may both do it."""
    simple = simplified_object(oval(300))
    assert simplified_object(simple) is simple
    assert simplified_object(BOX) is BOX


@pytest.mark.parametrize('bulge', [1e-6, 4e-4])
def test_a_finely_sampled_box_is_the_box(bulge):
    """So is everything that is planned for it."""
    assert simplified_object(sampled(BOX, 25, bulge)) == BOX
    assert len(simplified_object(sampled(BOX, 25, 0.01)).outline) > 8


def test_supports_without_load_are_left_out():
    """A plate that rests on 3 of 30 supports rests on them still."""
    resting = tuple(Support(x, y, 0.3, load_fraction=0.0) for x, y in (
        (-0.1, -0.1), (0.1, -0.1), (0.0, 0.15)))
    others = tuple(Support(0.01 * i, 0.3, 0.3) for i in range(-13, 14))
    obj = PushedObject(mass=5.0, supports=(*resting, *others), radius=0.35,
                       center_of_mass=(0.0, -0.1))
    simple = simplified_object(obj)
    assert len(simple.supports) <= MAX_SUPPORTS
    assert friction_center(simple) == pytest.approx((0.0, -0.1), abs=1e-9)
