"""Case study 3: a pushed box swings back where its centre of friction is near enough."""

import functools
import math

from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
import pytest
from studies.chapter2.side_push import friction_center_distance, setup
from studies.chapter2.side_push.friction_center_distance import (
    DISTURBED, starts, UNDISTURBED,
)
from studies.chapter2.side_push.setup import simulate, Start

STUDIES = by_figure(friction_center_distance)
ROTATED = Start(0.0873, 0.0)


def values(**overrides):
    """Return the values of a figure, some of them overridden."""
    return values_of(STUDIES['2.32'], **overrides)


@functools.cache
def outcome():
    """Compute the figure once."""
    return outcome_of(STUDIES['2.32'])


@pytest.mark.parametrize('name', [UNDISTURBED, DISTURBED])
def test_boxes_settle_below_the_radius_and_tip_over_beyond(name):
    table, given = outcome().tables[name], values()
    start = starts(given)[name]
    for distance in given.distances:
        rotation = np.abs(table[f'rotation_{1e3 * distance:.0f}_mm_rad'])
        late = rotation[-40:]
        # An offset contact settles at offset / (R_p - h), a rotated box at 0.
        rest = abs(start.lateral_offset) / abs(given.robot_radius - distance)
        if distance < given.robot_radius:
            assert rotation.max() <= 1.02 * max(start.rotation, rest)
            assert abs(late[-1] - rest) <= 0.1 * max(start.rotation, rest)
            assert abs(late[-1] - rest) <= abs(late[0] - rest) + 1e-5
        else:
            assert late[-1] > 0.5
            assert np.all(np.diff(rotation[1:40]) > 0.0)


def test_disturbed_boxes_return_the_slower_the_further_their_friction_center():
    table = outcome().tables[DISTURBED]
    after = [abs(table[f'rotation_{distance}_mm_rad'][12]) for distance in (50, 100, 150, 200)]
    assert np.all(np.diff(after) > 0.01)


def test_simulation_follows_the_equations_and_an_exact_start_stays_straight():
    found = numbers(outcome())
    assert 0.0 < found['difference'] < 3e-4
    assert found['exact'] < 1e-12


def test_rates_are_the_poles_of_the_linear_motion():
    rates = outcome().tables['rates']
    assert np.array(rates['simulated_rate_per_s']) == pytest.approx(
        np.array(rates['predicted_rate_per_s']), rel=0.01)
    assert np.sign(rates['predicted_rate_per_s']).tolist() == [-1, -1, -1, 1]


@pytest.mark.parametrize('changes', [{}, {'mass': 0.5}, {'mass': 12.0},
                                     {'friction_coefficient': 0.6}, {'speed': 0.1},
                                     {'robot_radius': 0.12}, {'box_width': 0.7}])
def test_stability_limit_is_the_radius_of_the_robot(changes):
    """The closed form, ``R_p cos(rho)`` with rho = 0, whatever the mass."""
    changed = values(**changes)
    assert setup.stability_limit(changed) == pytest.approx(changed.robot_radius, abs=1e-3)


def test_no_stability_limit_where_the_box_is_too_short_for_it():
    assert math.isnan(setup.stability_limit(values(robot_radius=0.6)))


def test_mass_changes_nothing_but_the_first_instant():
    light, heavy = (simulate(values(mass=mass), 0.15, ROTATED).rotations for mass in (0.5, 12.0))
    assert light == pytest.approx(heavy, abs=1e-12)
    slippery = simulate(values(friction_coefficient=0.15), 0.15, ROTATED).rotations
    assert np.abs(slippery - light).max() > 1e-5


def test_the_radius_decides_whether_the_box_is_held():
    """A small robot loses the box that this one holds; a large one holds the one it loses."""
    assert setup.simulated_growth_rate(values(robot_radius=0.12), 0.15) > 0.0
    assert setup.simulated_growth_rate(values(robot_radius=0.25), 0.2) < 0.0
