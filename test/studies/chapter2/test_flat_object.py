"""Flat objects on a curved pusher: stable, marginal, unstable."""

import math

from helpers.study_outcomes import by_figure, numbers, outcome_of
import numpy as np
import pytest
from scipy.optimize import brentq
from studies.chapter2.rolling import flat_object

STUDIES = by_figure(flat_object)


def found(figure, **overrides):
    """Compute a figure, some of its values overridden; return tables and findings."""
    outcome = outcome_of(STUDIES[figure], **overrides)
    return outcome.tables, numbers(outcome)


@pytest.mark.parametrize('figure, sign', [('2.11', -1.0), ('2.12', 0.0), ('2.13', 1.0)])
def test_slope_at_the_middle_decides_stability(figure, sign):
    """The object rotates back where alpha falls with rho, by the slope of the array itself."""
    tables, findings = found(figure)
    rho, alpha = tables['alpha']['rho_rad'], tables['alpha']['alpha_rad']
    assert np.sign(-findings['margin']) == sign
    slope = np.gradient(alpha, rho)[len(rho) // 2]
    if sign:
        assert np.sign(slope) == sign and abs(slope) > 0.2
    else:
        assert abs(slope) < 1e-3
        assert (alpha[rho > 0.05] > 0.0).all() and (alpha[rho < -0.05] < 0.0).all()
    assert len(tables['basin']['rho_rad']) == (2 if sign < 0.0 else 0)


def test_the_basin_ends_where_the_face_has_rolled_as_far_as_the_friction_center_swings():
    """There R_p rho = n_fc tan(rho)."""
    edge = brentq(lambda rho: 0.5 * rho - 0.3 * math.tan(rho), 0.5, 1.4)
    assert found('2.11')[1]['basin'] == pytest.approx(edge)
    assert found('2.11', ahead=0.49)[1]['basin'] < 0.3
    assert found('2.11', ahead=0.5)[1]['basin'] == found('2.13')[1]['basin'] == 0.0


def test_a_wider_robot_stabilizes_what_a_narrow_one_does_not():
    """What is unstable on this robot is stable on a wider one."""
    assert found('2.13', robot_radius=0.8)[1]['margin'] == pytest.approx(0.1)
    assert found('2.11', robot_radius=0.2)[1]['margin'] == pytest.approx(-0.1)
    assert found('2.13')[1]['beyond'] == pytest.approx(0.2) and found('2.11')[1]['beyond'] == 0.0
