"""Case study 3: a pushed box swings back where its friction centre is nearer than the radius."""

import functools
import math

import numpy as np
from push_study.catalogue import select
from push_study.chapter2.side_push import scene as side_push
from push_study.framework.run import run_here
from push_study.framework.values import read_table, values_of
import pytest


def values(figure='2.33', **overrides):
    return values_of(select([figure])[0], read_table(), overrides)


@functools.cache
def outcome(figure):
    study, = select([figure])
    return study.compute(values(figure), run_here)


@pytest.mark.parametrize('figure', ['2.32', '2.33'])
def test_boxes_settle_below_the_radius_and_tip_over_beyond(figure):
    table, held = outcome(figure).tables['turn'], values(figure)
    for distance in held.distances:
        turn = np.abs(table[f'turn_{1e3 * distance:.0f}_mm_rad'])
        late = turn[-40:]
        # An offset contact settles at the turn aside / (R_p - h), a turned box at 0.
        rest = abs(held.aside) / abs(held.robot_radius - distance)
        if distance < held.robot_radius:
            assert turn.max() <= 1.02 * max(held.turned, rest)
            assert abs(late[-1] - rest) <= 0.1 * max(held.turned, rest)
            assert abs(late[-1] - rest) <= abs(late[0] - rest) + 1e-5
        else:
            assert late[-1] > 0.5
            assert np.all(np.diff(turn[1:40]) > 0.0)


def test_disturbed_boxes_return_the_slower_the_further_their_friction_centre():
    table = outcome('2.33').tables['turn']
    after = [abs(table[f'turn_{millimetres}_mm_rad'][12]) for millimetres in (50, 100, 150, 200)]
    assert np.all(np.diff(after) > 0.01)


@pytest.mark.parametrize('figure', ['2.32', '2.33'])
def test_simulation_follows_the_equations_and_an_exact_start_stays_straight(figure):
    findings = outcome(figure).findings
    assert 0.0 < findings['difference'].value < 3e-4
    assert findings['exact'].value < 1e-12


def test_rates_are_the_poles_of_the_linear_motion():
    rates = outcome('2.33').tables['rates']
    assert np.array(rates['measured_rate_per_s']) == pytest.approx(
        np.array(rates['predicted_rate_per_s']), rel=0.01)
    assert np.sign(rates['predicted_rate_per_s']).tolist() == [-1, -1, -1, 1]


@pytest.mark.parametrize('changes', [{}, {'mass': 0.5}, {'mass': 12.0},
                                     {'friction_coefficient': 0.6}, {'speed': 0.1},
                                     {'robot_radius': 0.12}, {'box_width': 0.7}])
def test_switch_lies_at_the_radius_of_the_robot(changes):
    """The closed form, ``R_p cos(rho)`` with rho = 0, whatever the mass."""
    changed = values(**changes)
    assert side_push.switch(changed) == pytest.approx(changed.robot_radius, abs=1e-3)


def test_no_switch_where_the_box_is_too_short_for_it():
    assert math.isnan(side_push.switch(values(robot_radius=0.6)))


def test_mass_changes_nothing_but_the_first_instant():
    turns = [side_push.simulate(values(mass=mass), 0.15, 0.0873, 0.0)[1] for mass in (0.5, 12.0)]
    assert turns[0] == pytest.approx(turns[1], abs=1e-12)
    heavy = side_push.simulate(values(friction_coefficient=0.15), 0.15, 0.0873, 0.0)[1]
    assert np.abs(heavy - turns[0]).max() > 1e-5


def test_other_robot_other_fate():
    """A small robot loses the box that this one holds; a large one holds the one it loses."""
    assert side_push.measured_rate(values(robot_radius=0.12), 0.15) > 0.0
    assert side_push.measured_rate(values(robot_radius=0.25), 0.2) < 0.0
