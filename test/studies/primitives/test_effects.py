"""Effects of single pushes: seen from the place, and over all primitives."""

from helpers.study_outcomes import by_figure, numbers, outcome_of
import numpy as np
import pytest
from studies.primitives import contact_friction, place_and_tilt, reachable_poses
from studies.primitives.setup import effects_at, find_primitives, named_primitives

STUDIES = by_figure(place_and_tilt, reachable_poses, contact_friction)
NOMINAL = slice(0, 1)
LENGTHS = np.array([0.0, 0.1, 0.3])
PLACES = 15


@pytest.fixture(scope='module')
def table():
    return named_primitives('box_04', 'disc_017').table


def nominal_effects(table, tilt, face=0):
    """Effects of the pushes with one tilt at a face, as if friction were known."""
    numbers_ = find_primitives(table, tilt)
    return effects_at(table, numbers_[table.faces[numbers_] == face], LENGTHS, NOMINAL)


def test_a_push_without_length_does_nothing(table):
    effects = effects_at(table, np.arange(len(table.approach_angles)), LENGTHS[:1])
    assert not effects.means.any() and not effects.deviations.any()


@pytest.mark.parametrize('tilt', [0.0, 0.15, 0.3, 0.45])
def test_mirrored_pushes_at_the_box_have_mirrored_effects(table, tilt):
    """The box is symmetric about the middle of a face."""
    means = nominal_effects(table, tilt).means
    mirrored = nominal_effects(table, -tilt).means[::-1] * [-1.0, 1.0, -1.0]
    assert means == pytest.approx(mirrored, abs=1e-6)


def test_faces_of_the_box_are_alike(table):
    """Effects are in axes of the face, so that a quarter turn of the box changes nothing."""
    for face in range(1, 4):
        assert nominal_effects(table, 0.3, face).means == pytest.approx(
            nominal_effects(table, 0.3).means, abs=1e-6)


def test_a_push_in_the_middle_moves_the_box_straight_ahead(table):
    means = nominal_effects(table, 0.0).means[PLACES // 2]
    assert means == pytest.approx(np.outer(LENGTHS, [0.0, 1.0, 0.0]), abs=5e-4)


def test_a_tilt_that_is_not_in_the_table_is_refused(table):
    with pytest.raises(ValueError, match='tilt: got 0.2 rad .* expected one of -0.45, -0.3'):
        find_primitives(table, 0.2)


def test_pushes_beside_the_middle_turn_more_and_more_surely():
    outcome = outcome_of(STUDIES['P.1'], lengths=[0.0, 0.3, 1.0])
    found = numbers(outcome)
    assert found['balance_offset'] == pytest.approx(0.0, abs=30.0)
    # The largest rotation is near the end of the face, by a push that leans outwards.
    assert found['turn_offset'] > 100.0 and found['turn_tilt'] == pytest.approx(17.2, abs=0.1)
    assert found['turn_spread'] < 0.5 * found['balance_spread'] < found['long_spread']
    effects = outcome.tables['effects']
    at_start = effects['length_m'] == 0.0
    assert not effects['turn_rad'][at_start].any()
    # A push to the right of the middle turns the box to the left.
    beside = (np.isclose(effects['length_m'], 0.3) & (effects['tilt_rad'] == 0.0)
              & (np.abs(effects['offset_m']) > 0.02))
    assert (np.sign(effects['turn_rad']) == np.sign(effects['offset_m']))[beside].all()


def test_a_bin_is_pushed_straight_ahead_but_not_for_long():
    found = numbers(outcome_of(STUDIES['P.4']))
    assert found['long_spread'] > 5.0 * found['balance_spread']
    assert found['long_turn'] > 60.0


def test_spread_grows_with_the_length_of_pushes():
    outcome = outcome_of(STUDIES['P.5'], objects=['box_04'], lengths=[0.0, 0.1, 0.3, 1.0])
    table = outcome.tables['box_04']
    by_length = [table['spread_m'][np.isclose(table['length_m'], length)]
                 for length in (0.0, 0.1, 0.3, 1.0)]
    assert not by_length[0].any()
    medians = [float(np.median(spreads)) for spreads in by_length]
    assert medians == sorted(medians)
    assert (table['major_deviation_m'] >= table['minor_deviation_m']).all()
    assert np.hypot(table['major_deviation_m'], table['minor_deviation_m']) == pytest.approx(
        table['spread_m'], abs=1e-9)
    # The four faces reach the same to all sides; and turns are far tighter than at a vertex.
    moved = np.hypot(table['x_m'], table['y_m'])
    farthest = [moved[table['face'] == face].max() for face in range(4)]
    assert farthest == pytest.approx([farthest[0]] * 4, rel=0.01)
    assert numbers(outcome)['tightest_radius'] < 0.3


def test_without_contact_friction_the_force_is_along_the_normal():
    """Then the sense of the tilt hardly changes where the box goes; with friction it does."""
    outcome = outcome_of(STUDIES['P.10'], frictions=[0.0, 0.5], guesses=1)
    found = numbers(outcome)
    low = abs(found['inward_aside_low'] - found['outward_aside_low'])
    high = abs(found['inward_aside_high'] - found['outward_aside_high'])
    assert low < 0.15 * high
    assert found['outward_high'] > found['outward_low'] + 2.0
    middle = outcome.tables['middle']
    assert middle['turn_rad'] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert middle['ahead_m'] == pytest.approx([0.3, 0.3], abs=1e-3)
    assert not middle['turn_deviation_rad'].any()
