"""Pushes under control: what the figures on goals and disturbances found, and laws they keep."""

import functools
import math

from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_control.settings import ControlSettings
from push_model.friction import friction_center
from push_study.chapter4 import disturbances, goals, random_friction
from push_study.chapter4.setup import FEEDBACK, OPEN_LOOP, planned_input, push
from push_study.chapter4.support_friction import (
    angle_to_friction_center, box_at, friction_interval, friction_table, gaussian_friction,
    SUPPORTS,
)
import pytest

pytestmark = [pytest.mark.physics, pytest.mark.slow]
STUDIES = by_figure(goals, random_friction, disturbances)
TEMPORARY = [study.figure for study in disturbances.TEMPORARY]
SUSTAINED = [study.figure for study in disturbances.SUSTAINED]
SETTINGS = ControlSettings()
COLUMNS = ('y_m', 'theta_rad', 'rho_rad')


def values(figure, **overrides):
    """Return the values of a figure, some of them overridden."""
    return values_of(STUDIES[figure], **overrides)


@functools.lru_cache(maxsize=None)
def outcome(figure):
    """Compute a figure with the values of config/studies.yaml."""
    return outcome_of(STUDIES[figure])


def findings(figure, **overrides):
    """Return the findings of a figure as numbers."""
    return numbers(outcome_of(STUDIES[figure], **overrides) if overrides else outcome(figure))


def test_both_laws_reach_every_goal_without_mismatch():
    found, ends = findings('four-goals'), outcome('four-goals').tables['ends']
    assert found['open_loop'] < 10.0 and found['feedback'] < 5.0
    assert (ends['feedback_position_error_m'] < ends['open_loop_position_error_m']).all()
    for law in (OPEN_LOOP, FEEDBACK):
        # A fifth of the error with which a push may end.
        assert np.abs(ends[f'{law}_heading_error_rad']).max() < 0.2 * SETTINGS.heading_tolerance
    assert 0.0 < found['delay'] < 8.0 and found['difference'] < 0.5


@pytest.mark.parametrize('figure', ['4.1', '4.2'])
def test_the_input_of_feedback_is_near_the_planned_one(figure):
    found = findings(figure)
    assert found['relative_difference'] < 4.0 and found['span'] > 0.5
    assert found['difference_open_loop'] < 0.5 * found['difference']
    assert found['early'] > 50.0
    # That depends on the goal: the input to another one is far from it.
    given = values(figure)
    other = push(given, [2.5, 0.0, 0.0], FEEDBACK)
    planned = planned_input(push(given, given.goal, FEEDBACK).planned)
    assert goals.input_difference(other.path, planned) > 5.0 * found['difference']


@pytest.mark.parametrize('law', [OPEN_LOOP, FEEDBACK])
def test_a_mirrored_push_follows_a_mirrored_path(law):
    given = values('4.9')
    left, right = (push(given, [2.4, side * 0.5, side * 0.3], law,
                        friction_interval(name, 1.5, 4.0, 6.0)).path
                   for side, name in ((1.0, 'left'), (-1.0, 'right')))
    for name in COLUMNS:
        np.testing.assert_allclose(left[name], -right[name], atol=1e-4)
    assert np.abs(left['theta_rad']).max() > 0.1


@pytest.mark.parametrize('figure', ['4.8', '4.12'])
def test_feedback_tolerates_what_open_loop_does_not(figure):
    found = findings(figure)
    assert found['open_loop'] > 0.4 and found['heading_open_loop'] > 1.0
    assert found['feedback'] < 1000.0 * SETTINGS.position_tolerance and (
        found['heading_feedback'] < SETTINGS.heading_tolerance)
    assert found['ratio'] > 30.0 and found['delay'] < 2.0
    assert 3.0 < found['deviation'] < 20.0 and found['peak'] < 0.9 < found['peak_open_loop']
    # Without the disturbance both arrive.
    found = findings(figure, factor=1.0)
    assert found['open_loop'] < 0.01 and found['feedback'] < 1.0 and found['shift'] == 0.0


@pytest.mark.parametrize('figures', [TEMPORARY, SUSTAINED])
def test_the_four_figures_of_a_disturbance_show_one_push(figures):
    found = [findings(figure) for figure in figures]
    assert all(one == found[0] for one in found)


def test_open_loop_errors_grow_with_the_disturbance_and_those_of_feedback_do_not():
    factors = (1.05, 1.1, 1.3, 1.5)
    found = [findings('4.12', factor=factor) for factor in factors]
    assert (np.diff([one['open_loop'] for one in found]) > 0.05).all()
    assert max(one['feedback'] for one in found) < 10.0
    assert (np.diff([one['rolled'] for one in found]) > 0.2).all()


def test_feedback_ends_its_push_through_the_friction_center():
    """It rolls the contact behind that centre, 4 cm aside while friction is changed."""
    sustained, temporary = findings('4.15'), findings('4.11')
    assert sustained['final_rho'] == pytest.approx(sustained['aim'], abs=0.03)
    assert sustained['rolled'] == pytest.approx(4.0, abs=0.5)
    assert abs(sustained['aim']) < 0.03 and abs(temporary['aim']) < 0.03
    assert abs(temporary['final_rho']) < 0.03 and abs(temporary['rolled']) < 0.5
    other = findings('4.15', side='right')
    assert other['rolled'] == pytest.approx(-sustained['rolled'], abs=0.01)


def test_a_robot_wider_than_the_box_is_deep_is_stable_in_open_loop():
    """The curved pusher: the centre of friction is 0.2 m from the contact."""
    narrow, wide = (findings('4.8', robot_radius=radius, interval=0.5) for radius in (0.1, 0.4))
    assert wide['open_loop'] < 0.2 * narrow['open_loop']
    assert abs(wide['heading_open_loop']) < 0.2 < 0.5 < narrow['heading_open_loop']


def test_random_friction_costs_several_times_as_much_in_open_loop():
    found = findings('4.7')
    assert found == findings('4.5') == findings('4.6')
    assert found['open_loop'] > 5.0 * found['feedback'] and found['worst'] < 10.0
    assert found['wins'] >= found['pushes'] - 2.0
    assert found['feedback_low'] < found['feedback'] < found['feedback_high'] < (
        found['open_loop_low']) < found['open_loop'] < found['open_loop_high']
    assert found['heading'] > 10.0 * found['heading_feedback']
    assert found['variation'] > 5.0 * found['variation_open_loop']
    # Each coefficient moves the centre by an eighth of the width, of its own relative size.
    assert found['shift'] == pytest.approx(100.0 * 0.2 * 0.2 / 2.0, rel=0.15)


def test_less_random_friction_costs_less_and_none_nothing():
    some, little, none = (findings('4.7', deviation=deviation, seeds=3)
                          for deviation in (0.2, 0.1, 0.0))
    assert some['open_loop'] > 1.5 * little['open_loop'] > 5.0 * none['open_loop']
    assert none['open_loop'] < 0.5 and none['feedback'] < 0.2 and none['shift'] == 0.0


def test_random_friction_depends_on_its_seed_alone():
    first, again, other = (gaussian_friction(seed, 0.2, 0.5, 5.0) for seed in (3, 3, 4))
    assert first == again != other
    factors = np.array([one.factor for one in gaussian_friction(0, 0.2, 0.1, 400.0)])
    assert factors.mean() == pytest.approx(1.0, abs=0.01)
    assert factors.std() == pytest.approx(0.2, abs=0.01)
    assert min(one.factor for one in gaussian_friction(0, 2.0, 0.1, 40.0)) == 0.0


def test_the_friction_table_holds_what_the_box_has():
    given = values('4.8')
    table = outcome('4.8').tables['friction']
    changes = disturbances.disturbance(disturbances.temporary_end, given)
    rough = box_at(given, changes, 5.0)
    assert [support.friction_coefficient for support in rough.supports] == [0.3, 0.3, 0.6, 0.6]
    row = list(table['time_s']).index(4.0)
    assert [table[name][row] for name in SUPPORTS] == [0.3, 0.3, 0.6, 0.6]
    assert table['center_y_m'][row] == pytest.approx(friction_center(rough)[1])
    assert table['center_y_m'][row] == pytest.approx(0.2 * (2.0 - 1.0) / (2.0 + 1.0))
    assert table['center_y_m'][[0, -1]] == pytest.approx(0.0, abs=1e-12)
    sides = {'left': 1.0, 'right': -1.0}
    for side, sign in sides.items():
        obj = box_at(given, friction_interval(side, 1.5, 0.0, 1.0), 0.5)
        friction = {support.y * sign > 0.0: support.friction_coefficient
                    for support in obj.supports}
        assert friction[True] == pytest.approx(1.5 * friction[False])
    with pytest.raises(ValueError, match='side'):
        friction_interval('top', 1.5, 0.0, 1.0)


def test_the_friction_center_is_straight_ahead_of_the_contact_until_it_moves():
    given, path = values('4.12'), outcome('4.12').tables[FEEDBACK]
    table = friction_table(given, (), 30.0)
    ahead = angle_to_friction_center(path, table)
    before = path['time_s'] < given.start_time
    assert np.abs(path['aim_rad'][before]).max() < 0.01
    # The face is flat: the middle of the box is half its length ahead.
    shifted = path['aim_rad'] - ahead
    assert shifted[~before] == pytest.approx(math.atan2(0.04, 0.2), abs=0.01)
