"""Maps of stable pushing regions, 2.28 and 2.29: simulation against closed form, and findings."""

import math

from helpers.study_outcomes import numbers, outcome_of
import numpy as np
import pytest
from studies.chapter2 import stable_regions

pytestmark = pytest.mark.slow
GROWING_ROBOT, MOVED_CENTER = stable_regions.STUDIES
COARSE = {'locations': 64}


@pytest.fixture(scope='module')
def growing():
    """Compute 2.28 once."""
    return outcome_of(GROWING_ROBOT, **COARSE)


@pytest.fixture(scope='module')
def moved():
    """Compute 2.29 once."""
    return outcome_of(MOVED_CENTER, **COARSE)


def test_stable_fraction_grows_with_the_robot(growing):
    fractions = growing.tables['fractions']['stable_fraction']
    assert fractions[0] == 0.0 and np.all(np.diff(fractions) > 0.05)
    assert numbers(growing)['growth'] == pytest.approx(np.diff(fractions).min())


def test_stable_fraction_is_constant_where_the_cone_is_the_limit():
    """A larger robot gains nothing once friction at the contact, not stability, sets the end."""
    found = numbers(outcome_of(GROWING_ROBOT, robot_diameters=[1.0, 2.0], contact_friction=0.2,
                               **COARSE))
    assert found['growth'] == 0.0 and found['first'] > 0.0


@pytest.mark.parametrize('name', ['growing', 'moved'])
def test_simulation_agrees_with_the_closed_form(name, request):
    outcome = request.getfixturevalue(name)
    found, table = numbers(outcome), outcome.tables['map']
    tolerated = (table['tolerance_rad'] > 0.0) & (table['closed_tolerance_rad'] > 0.0)
    assert tolerated.sum() > 40
    for side in ('clockwise', 'counter'):
        assert table[f'{side}_rad'][tolerated] == pytest.approx(
            table[f'closed_{side}_rad'][tolerated], abs=0.012)
    assert found['difference'] < 0.0075
    assert found['disagreements'] <= 2 and found['disagreement'] < 0.0075
    assert outcome.tables['fractions']['stable_fraction'] == pytest.approx(
        outcome.tables['fractions']['closed_stable_fraction'], abs=0.04)


def test_contact_slides_before_rho_leaves_the_cone(growing, moved):
    """The cone for rho is an upper bound, and far off at some locations."""
    for outcome in (growing, moved):
        table = outcome.tables['map']
        assert np.all(table['tolerance_rad'] < table['cone_rule_rad'] + 0.0075)
        assert numbers(outcome)['overestimate'] > 0.1


def test_symmetric_box_has_a_symmetric_map(growing):
    table = growing.tables['map']
    x, y, tolerance = (np.round(table[name], 9) for name in ('x_m', 'y_m', 'tolerance_rad'))
    found = {(d, a, b): t for d, a, b, t in zip(table['diameter_m'], x, y, tolerance)}
    for (diameter, a, b), expected in found.items():
        assert found[diameter, -a, b] == pytest.approx(expected, abs=0.005)
        assert found[diameter, a, -b] == pytest.approx(expected, abs=0.005)


def test_region_of_a_side_grows_and_shrinks_as_the_friction_center_approaches():
    """Half of it is the smaller of sqrt(d (R - d)) and d mu_c."""
    outcome = outcome_of(MOVED_CENTER, locations=224)
    found = numbers(outcome)
    section = 1.6 / 224
    for name in ('start', 'widest', 'nearest'):
        d = found[f'{name}_distance']
        half = min(math.sqrt(d * (0.2 - d)), 0.8 * d)
        assert found[f'{name}_length'] == pytest.approx(2.0 * half)
        assert found[f'{name}_sampled'] == pytest.approx(2.0 * half, abs=2.0 * section)
    assert found['nearest_length'] < found['start_length'] < found['widest_length']
    assert found['nearest_tolerance'] < found['widest_tolerance'] < found['start_tolerance']
    table = outcome.tables['map']
    right = np.equal(table['face'], 0) & (table['tolerance_rad'] > 0.0)
    assert not np.any(right & np.equal(table['center_y_m'], 0.0))
    assert np.any(right & np.equal(table['center_y_m'], -0.08))
