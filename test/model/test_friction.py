"""Friction: Coulomb's law in the limit, and centres of friction that are shifted."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_model.friction import (
    c_squared, friction_center, friction_weight, MIN_FRICTION_RATIO, with_friction_center,
)
from push_model.parameters import PushedObject, Support
import pytest

pytestmark = pytest.mark.physics
UNEVEN = box(friction=(0.2, 0.4, 0.3, 0.25), center_of_mass=(0.02, -0.03))


def test_friction_weight_tends_to_coulomb():
    speeds = np.array([1e-3, 1e-2, 1.0])
    forces = friction_weight(5.0, speeds, 0.0 * speeds, 1e-5) * speeds
    assert forces == pytest.approx(5.0, rel=1e-4)
    assert (forces < 5.0).all()


@pytest.mark.parametrize('obj', [box(), UNEVEN, bin_()])
def test_a_shifted_center_of_friction_is_where_it_was_asked_for(obj):
    """All friction together stays; every support gets its part of the change."""
    x, y = friction_center(obj)
    for shift in ((0.02, 0.0), (-0.01, 0.03), (0.0, 0.0)):
        other = with_friction_center(obj, (x + shift[0], y + shift[1]))
        assert friction_center(other) == pytest.approx((x + shift[0], y + shift[1]), abs=1e-12)
        assert sum(other.capacities) == pytest.approx(sum(obj.capacities))
        assert other.loads == obj.loads


def test_no_smaller_change_of_friction_shifts_the_center():
    """Weighted least squares: changes that shift nothing only add to them."""
    other = with_friction_center(UNEVEN, (0.03, 0.01))
    before, after = np.array(UNEVEN.capacities), np.array(other.capacities)
    points = np.array([(support.x, support.y) for support in UNEVEN.supports])
    # Changes without sum and without moment, of four supports: a line.
    idle = np.linalg.svd(np.vstack([np.ones(4), points.T]))[2][3]
    cost = [np.sum((after + step * idle - before) ** 2 / before) for step in (-1e-3, 0.0, 1e-3)]
    assert cost[1] < cost[0] and cost[1] < cost[2]


def test_a_center_too_far_off_is_approached_without_supports_that_pull():
    other = with_friction_center(box(), (0.19, 0.19))
    ratios = np.divide(other.capacities, box().capacities)
    assert ratios.min() == pytest.approx(MIN_FRICTION_RATIO)
    x, y = friction_center(other)
    assert 0.0 < x < 0.19 and x == pytest.approx(y)


def test_supports_on_one_line_shift_their_center_along_it_only():
    obj = PushedObject(mass=1.0, supports=[Support(x, 0.0, 0.3) for x in (-0.1, 0.1)], radius=0.2)
    assert friction_center(with_friction_center(obj, (0.05, 0.08))) == pytest.approx((0.05, 0.0))


def test_c_squared_of_a_ring_is_the_same_all_round():
    """Half the squared radius of the supports, and their sum in every pair of directions."""
    ring = bin_(feet=8)
    for angle in (0.0, 0.4, 2.0):
        assert c_squared(ring, angle) == pytest.approx(0.5 * 0.16 ** 2)
    sums = [c_squared(UNEVEN, angle) + c_squared(UNEVEN, angle + 0.5 * math.pi)
            for angle in (0.0, 0.7, 1.9)]
    assert sums == pytest.approx([sums[0]] * 3)
