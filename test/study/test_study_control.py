"""Pushes under control: what the figures on goals and disturbances found, and laws they keep."""

import functools
import math

import numpy as np
from push_control.settings import ControlSettings
from push_model.friction import friction_center
from push_study.chapter4 import (
    goals as control_goals, intervals as control_spells, noise as control_noise,
)
from push_study.chapter4.floor import (
    center_in_sight, changed, friction_table, gaussian, spell, SUPPORTS,
)
from push_study.chapter4.scene import FEEDBACK, OPTIMISER, planned_input, push
from push_study.framework.run import run_here
from push_study.framework.values import read_table, values_of
import pytest

pytestmark = pytest.mark.physics
STUDIES = {study.figure: study for module in (control_goals, control_noise, control_spells)
           for study in module.STUDIES}
TEMPORARY, SUSTAINED = [f'4.{number}' for number in range(8, 12)], [
    f'4.{number}' for number in range(12, 16)]
SETTINGS = ControlSettings()
COLUMNS = ('y_m', 'theta_rad', 'rho_rad')


def values(figure, **changes):
    """Return the values of a figure, with others where wanted."""
    return values_of(STUDIES[figure], read_table(), changes)


@functools.lru_cache(maxsize=None)
def outcome(figure):
    """Compute a figure with the values of config/studies.yaml."""
    found = STUDIES[figure].compute(values(figure), run_here)
    assert STUDIES[figure].sentences(found.findings)
    return found


def findings(figure, **changes):
    """Return the findings of a figure as numbers."""
    found = outcome(figure) if not changes else STUDIES[figure].compute(
        values(figure, **changes), run_here)
    return {name: one.value for name, one in found.findings.items()}


def test_both_laws_arrive_at_every_goal_where_all_is_as_believed():
    found, ends = findings('4.1'), outcome('4.1').tables['ends']
    assert found['optimiser'] < 10.0 and found['feedback'] < 5.0
    assert (ends['feedback_position_error_m'] < ends['open_loop_position_error_m']).all()
    for law in (OPTIMISER, FEEDBACK):
        # A fifth of the error with which a push may end.
        assert np.abs(ends[f'{law}_heading_error_rad']).max() < 0.2 * SETTINGS.heading_tolerance
    assert 0.0 < found['time'] < 8.0 and found['apart'] < 0.5


@pytest.mark.parametrize('figure', ['4.3', '4.5'])
def test_the_input_of_feedback_is_near_that_of_the_optimiser(figure):
    found = findings(figure)
    assert found['share'] < 4.0 and found['span'] > 0.5
    assert found['near_optimiser'] < 0.5 * found['near']
    assert found['early'] > 50.0
    # It is the goal that makes it so: the input to another one is far from it.
    given = values(figure)
    other = push(given, [2.5, 0.0, 0.0], FEEDBACK)
    planned = planned_input(push(given, given.goal, FEEDBACK).planned)
    assert control_goals.input_distance(other.path, planned) > 5.0 * found['near']


@pytest.mark.parametrize('law', [OPTIMISER, FEEDBACK])
def test_a_mirrored_push_goes_a_mirrored_way(law):
    given = values('4.9')
    left, right = (push(given, [2.4, side * 0.5, side * 0.3], law, spell(name, 1.5, 4.0, 6.0)).path
                   for side, name in ((1.0, 'left'), (-1.0, 'right')))
    for name in COLUMNS:
        np.testing.assert_allclose(left[name], -right[name], atol=1e-4)
    assert np.abs(left['theta_rad']).max() > 0.1


@pytest.mark.parametrize('figure', ['4.8', '4.12'])
def test_feedback_bears_what_open_loop_does_not(figure):
    found = findings(figure)
    assert found['optimiser'] > 0.4 and found['turn'] > 1.0
    assert found['feedback'] < 1000.0 * SETTINGS.position_tolerance and (
        found['turned'] < SETTINGS.heading_tolerance)
    assert found['times'] > 30.0 and found['more'] < 2.0
    assert 3.0 < found['aside'] < 20.0 and found['peak'] < 0.9 < found['steepest']
    # Without the disturbance both arrive.
    found = findings(figure, factor=1.0)
    assert found['optimiser'] < 0.01 and found['feedback'] < 1.0 and found['shift'] == 0.0


@pytest.mark.parametrize('figures', [TEMPORARY, SUSTAINED])
def test_the_four_figures_of_a_disturbance_show_one_push(figures):
    found = [findings(figure) for figure in figures]
    assert all(one == found[0] for one in found)


def test_open_loop_errors_grow_with_the_disturbance_and_those_of_feedback_do_not():
    factors = (1.05, 1.1, 1.3, 1.5)
    found = [findings('4.12', factor=factor) for factor in factors]
    assert (np.diff([one['optimiser'] for one in found]) > 0.05).all()
    assert max(one['feedback'] for one in found) < 10.0
    assert (np.diff([one['rolled'] for one in found]) > 0.2).all()


def test_feedback_ends_its_push_through_the_friction_centre():
    """It rolls the contact behind the centre, which lies 4 cm aside while friction is changed."""
    sustained, temporary = findings('4.15'), findings('4.11')
    assert sustained['held'] == pytest.approx(sustained['aim'], abs=0.03)
    assert sustained['rolled'] == pytest.approx(4.0, abs=0.5)
    assert abs(sustained['aim']) < 0.03 and abs(temporary['aim']) < 0.03
    assert abs(temporary['held']) < 0.03 and abs(temporary['rolled']) < 0.5
    other = findings('4.15', side='right')
    assert other['rolled'] == pytest.approx(-sustained['rolled'], abs=0.01)


def test_a_robot_wider_than_the_box_is_deep_is_stable_without_looking():
    """The curved fence: the friction centre is 0.2 m from the contact."""
    narrow, wide = (findings('4.8', robot_radius=radius, lasting=0.5) for radius in (0.1, 0.4))
    assert wide['optimiser'] < 0.2 * narrow['optimiser']
    assert abs(wide['turn']) < 0.2 < 0.5 < narrow['turn']


def test_random_friction_costs_the_optimiser_several_times_as_much():
    found = findings('4.7')
    assert found == findings('4.6')
    assert found['optimiser'] > 5.0 * found['feedback'] and found['worst'] < 5.0
    assert found['wins'] >= found['pushes'] - 1.0
    assert found['turn'] > 10.0 * found['turn_feedback']
    assert found['swing'] > 5.0 * found['swing_optimiser']
    # Each coefficient moves the centre by an eighth of the width, of its own relative size.
    assert found['shift'] == pytest.approx(100.0 * 0.2 * 0.2 / 2.0, rel=0.15)


def test_less_random_friction_costs_less_and_none_nothing():
    some, little, none = (findings('4.7', deviation=deviation, seeds=3)
                          for deviation in (0.2, 0.1, 0.0))
    assert some['optimiser'] > 1.5 * little['optimiser'] > 5.0 * none['optimiser']
    assert none['optimiser'] < 0.5 and none['feedback'] < 0.2 and none['shift'] == 0.0


def test_random_friction_depends_on_its_seed_alone():
    assert gaussian(3, 0.2, 0.5, 5.0) == gaussian(3, 0.2, 0.5, 5.0) != gaussian(4, 0.2, 0.5, 5.0)
    factors = np.array([one.factor for one in gaussian(0, 0.2, 0.1, 400.0)])
    assert factors.mean() == pytest.approx(1.0, abs=0.01)
    assert factors.std() == pytest.approx(0.2, abs=0.01)
    assert min(one.factor for one in gaussian(0, 2.0, 0.1, 40.0)) == 0.0


def test_the_friction_table_holds_what_the_box_has():
    given = values('4.8')
    table = outcome('4.8').tables['friction']
    rough = changed(given, control_spells.disturbance(given), 5.0)
    assert [support.friction_coefficient for support in rough.supports] == [0.3, 0.3, 0.6, 0.6]
    row = list(table['time_s']).index(4.0)
    assert [table[name][row] for name in SUPPORTS] == [0.3, 0.3, 0.6, 0.6]
    assert table['center_y_m'][row] == pytest.approx(friction_center(rough)[1])
    assert table['center_y_m'][row] == pytest.approx(0.2 * (2.0 - 1.0) / (2.0 + 1.0))
    assert table['center_y_m'][[0, -1]] == pytest.approx(0.0, abs=1e-12)
    sides = {'left': 1.0, 'right': -1.0}
    for side, sign in sides.items():
        obj = changed(given, spell(side, 1.5, 0.0, 1.0), 0.5)
        rub = {support.y * sign > 0.0: support.friction_coefficient for support in obj.supports}
        assert rub[True] == pytest.approx(1.5 * rub[False])
    with pytest.raises(ValueError, match='side'):
        spell('top', 1.5, 0.0, 1.0)


def test_the_contact_sees_the_friction_centre_straight_ahead_until_it_moves():
    given, path = values('4.12'), outcome('4.12').tables[FEEDBACK]
    table = friction_table(given, (), 30.0)
    ahead = center_in_sight(path, table)
    before = path['time_s'] < given.begin
    assert np.abs(path['aim_rad'][before]).max() < 0.01
    # The face is flat: the middle of the box is half its length ahead.
    shifted = path['aim_rad'] - ahead
    assert shifted[~before] == pytest.approx(math.atan2(0.04, 0.2), abs=0.01)
