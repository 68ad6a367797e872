"""Identification of the object: what pushes tell of its centre of friction."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_control.settings import ControlSettings
from push_control.task.object_model import ObjectModelEstimator
from push_model.friction import friction_center, with_friction_center
from push_model.geometry import Pose
import pytest

CONTROL = ControlSettings()


@pytest.mark.parametrize('obj', [box(), box(friction=(0.2, 0.4, 0.3, 0.5)), bin_()])
def test_friction_is_shifted_and_not_changed(obj):
    """The centre is where it was asked for, and all supports together rub as much as before."""
    shifted = with_friction_center(obj, (0.03, -0.02))
    assert friction_center(shifted) == pytest.approx((0.03, -0.02))
    assert sum(shifted.capacities) == pytest.approx(sum(obj.capacities))
    assert with_friction_center(obj, friction_center(obj)).capacities == pytest.approx(
        obj.capacities)


def test_no_support_pulls():
    """A centre beyond the supports is approached only as far as they go."""
    shifted = with_friction_center(box(), (0.5, 0.0))
    assert min(shifted.capacities) > 0.0
    assert 0.1 < friction_center(shifted)[0] < 0.2


def test_pushes_from_two_sides_identify_the_centre():
    """What a push cannot see, along its line, does no harm."""
    true, estimator = np.array((0.03, -0.02)), ObjectModelEstimator(box(), CONTROL)
    for corner, along in (((-0.2, -0.2), 0.05), ((0.2, -0.2), -0.03)) * 3:
        line = (true - corner) / np.hypot(*(true - corner))
        before = estimator.relative_deviation(corner)
        estimator.update(corner, tuple(true + along * line))
        assert estimator.relative_deviation(corner) < before
    assert friction_center(estimator.obj) == pytest.approx(tuple(true), abs=2e-3)


def test_a_push_from_an_uncertain_contact_tells_less():
    """What it saw is taken for an offset of the contact rather than of the centre."""
    shifts = []
    for deviation in (0.0, 0.03, 0.3):
        estimator = ObjectModelEstimator(box(), CONTROL)
        estimator.update((-0.2, 0.0), (0.0, 0.03), deviation)
        shifts.append(friction_center(estimator.obj)[1])
    assert 0.03 > shifts[0] > shifts[1] > 5.0 * shifts[2] > 0.0


@pytest.mark.parametrize('angle', [0.0, 1.0, -2.2])
def test_the_innovation_is_lateral(angle):
    """To the left of the push, however far along it sees the centre; nothing once identified."""
    estimator, frame = ObjectModelEstimator(box(), CONTROL), Pose(0.0, 0.0, angle)
    point = frame.rotate((-0.25, 0.0))
    before = estimator.lateral_innovation(point, (0.0, 0.0)).deviation
    for along, left in ((-0.04, 0.02), (0.0, 0.02), (0.05, -0.03)):
        seen = estimator.lateral_innovation(point, frame.rotate((along, left)))
        assert (math.cos(seen.direction), math.sin(seen.direction)) == pytest.approx(
            frame.rotate((0.0, 1.0)))
        assert seen.offset == pytest.approx(left)
    for _ in range(20):
        estimator.update(point, frame.rotate((0.0, 0.02)))
    after = estimator.lateral_innovation(point, frame.rotate((0.0, 0.02)))
    assert abs(after.offset) < 1e-3 and after.deviation < 0.1 * before
    crossing = frame.rotate((0.0, -0.25))
    assert estimator.lateral_innovation(crossing, (0.0, 0.0)).deviation > 0.9 * before
