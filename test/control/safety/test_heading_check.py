"""Headings that a tracker confuses are told from motions."""

import dataclasses
import math

from helpers.objects import box
from push_control.safety.heading_check import HeadingCheck, rotational_symmetry
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose
import pytest

SQUARE = box()
CARTON = dataclasses.replace(SQUARE, outline=((-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)))
WEDGE = dataclasses.replace(SQUARE, outline=((-0.3, -0.2), (0.3, -0.2), (0.1, 0.2), (-0.3, 0.2)))


@pytest.mark.parametrize('obj, count', [(SQUARE, 4), (CARTON, 2), (WEDGE, 1)])
def test_an_outline_looks_the_same_in_some_headings(obj, count):
    """As often as it is symmetric about its origin."""
    assert rotational_symmetry(obj) == count


def headings(check, measured, step=0.05, motion=0.0):
    """Measure headings one after the other; return those that are believed."""
    return [check.believed(ObjectPose(step * i, Pose(motion * i, 0.0, wrap_angle(heading))))
            .pose.theta for i, heading in enumerate(measured)]


@pytest.mark.parametrize('multiple', [1, 2, 3])
def test_a_flip_is_taken_back_for_as_long_as_it_lasts(multiple):
    """While the object is rotated slowly; and nothing is left of it in the end."""
    true = [0.02 * i for i in range(60)]
    seen = [heading + (0.5 * math.pi * multiple if 20 <= i < 40 else 0.0)
            for i, heading in enumerate(true)]
    assert headings(HeadingCheck(SQUARE), seen) == pytest.approx(true)
    assert headings(HeadingCheck(SQUARE, heading_count=1), seen) == pytest.approx(
        [wrap_angle(heading) for heading in seen])


@pytest.mark.parametrize('rotation', [0.3, 0.8, 1.2])
def test_an_object_that_is_rotated_otherwise_has_been_moved(rotation):
    """No tracker confuses these headings."""
    seen = [0.0, 0.0, rotation, rotation]
    assert headings(HeadingCheck(SQUARE), seen) == pytest.approx(seen)


def test_an_object_that_is_elsewhere_has_been_moved():
    """Somebody has carried it, and put it down with another heading."""
    seen = [0.0, 0.5 * math.pi]
    assert headings(HeadingCheck(SQUARE), seen, motion=0.3) == pytest.approx(seen)
