"""Ranges over loads that statics leaves open."""

from helpers.objects import bin_, box
from helpers.study_outcomes import by_figure, numbers, outcome_of
import numpy as np
from push_model.quasi_static import vehicle
import pytest
from scipy.optimize import linprog
from studies.analysis.unknown_loads import extreme_objects, unknown_loads
from studies.primitives import unknown_loads as study

SHIFTED = box(center_of_mass=(0.06, -0.03))
CORNER = (-0.2, -0.2)


def test_square_at_a_vertex_stands_on_either_diagonal():
    ranges = unknown_loads(box(), CORNER)
    arm = 0.2 * 2.0 ** 0.5
    assert ranges.wheelbase == pytest.approx((arm, 2.0 * arm))
    assert ranges.center_x == pytest.approx((0.0, 0.0), abs=1e-12)
    assert unknown_loads(box(), (-0.2, 0.0)).wheelbase == pytest.approx((0.4, 0.4))


@pytest.mark.parametrize('point', [CORNER, (-0.2, 0.05), (0.2, 0.2)])
def test_range_of_c_squared_is_that_of_the_linear_program(point):
    """Loads of at least 0 that sum up to the weight and balance about the mass centre."""
    places = np.array([(support.x, support.y) for support in SHIFTED.supports])
    ahead = SHIFTED.center_of_mass - np.array(point)
    along = (places - SHIFTED.center_of_mass) @ ahead / np.linalg.norm(ahead)
    balance = np.vstack([np.ones(4), places.T])
    ends = [linprog(sign * along ** 2, A_eq=balance, b_eq=[1.0, *SHIFTED.center_of_mass])
            for sign in (1.0, -1.0)]
    assert unknown_loads(SHIFTED, point).c_squared == pytest.approx((ends[0].fun, -ends[1].fun))


def test_three_supports_leave_nothing_open():
    assert extreme_objects(bin_()) == (bin_(),)
    ranges = unknown_loads(bin_(), (-0.2, 0.0))
    assert ranges.wheelbase == pytest.approx([vehicle(bin_(), (-0.2, 0.0)).wheelbase] * 2)


def test_study_finds_vertices_wide_and_middles_of_faces_sure():
    found = numbers(outcome_of(by_figure(study)['P.11']))
    assert found['least'] < found['nominal'] < found['greatest']
    assert found['narrowest'] == pytest.approx(0.0, abs=0.1)
    assert (found['least_ratio'], found['greatest_ratio']) == pytest.approx((0.0, 2.0))
    assert found['turn_least'] > found['turn_nominal'] > found['turn_greatest']
