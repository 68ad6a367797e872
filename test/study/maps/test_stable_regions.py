"""Maps of stable pushing regions: plant against closed form, and what the maps show."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.study_outcomes import numbers, outcome_of
import numpy as np
from push_model.analysis.rolling_limits import (
    force_tolerances, min_robot_radius, quasi_static_force,
)
from push_model.analysis.stability import equilibrium_at, tolerances
from push_model.analysis.steady_turn import steady_force
from push_model.contact import contact_point, normal_range
from push_model.parameters import Contact
from push_scenario.definition.data import config_file
from push_scenario.definition.loader import read_object, read_robot
from push_study import cli
from push_study.chapter2 import stable_regions
from push_study.framework.parameters import read_chosen_values
from push_study.framework.runner import run_in_memory
from push_study.maps import object_map
from push_study.maps.perimeter import (
    is_stable, perimeter_locations, push_through_center, section_ends, stable_borders,
)
from push_study.maps.tolerance import returns
import pytest

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
        assert found[f'{name}_length'] == pytest.approx(2.0 * half, abs=2.0 * section)
    assert found['nearest_length'] < found['start_length'] < found['widest_length']
    assert found['nearest_tolerance'] < found['widest_tolerance'] < found['start_tolerance']
    table = outcome.tables['map']
    right = np.equal(table['face'], 0) & (table['tolerance_rad'] > 0.0)
    assert not np.any(right & np.equal(table['center_y_m'], 0.0))
    assert np.any(right & np.equal(table['center_y_m'], -0.08))


@pytest.mark.parametrize('obj, contact', [
    (box(), Contact('face', 3, 0.06)),
    (bin_(center_of_mass=(-0.08, 0.02)), Contact('round', 0, 3.0))])
def test_pushes_through_the_center_are_equilibria(obj, contact):
    location = push_through_center(obj, contact, 0.6)
    assert location.alpha(0.0) == pytest.approx(0.0, abs=1e-12)
    assert is_stable(obj, contact, 0.6)
    for tolerance in force_tolerances(obj, contact, location):
        for factor, expected in ((0.97, True), (1.03, False)):
            assert returns(obj, contact, location, 0.02, rotation=factor * tolerance.rotation,
                           distance=1.0) == expected


def test_force_tolerances_are_those_of_rho_where_the_cone_is_wide():
    obj, contact = box(contact_friction_coefficient=8.0), Contact('face', 3, 0.05)
    location = push_through_center(obj, contact, 0.3)
    assert force_tolerances(obj, contact, location) == tolerances(
        location, equilibrium_at(location, 0.0), 8.0)


def test_force_of_a_slow_push_is_that_of_a_steady_turn():
    obj, contact = box(friction=(0.2, 0.3, 0.5, 0.3)), Contact('face', 3, 0.03)
    place, normal = contact_point(obj, contact), normal_range(obj, contact)[0]
    force = quasi_static_force(obj, place, math.cos(0.2), math.sin(0.2))
    assert normal == 0.0
    assert force == pytest.approx(steady_force(obj, place, 0.2, 1e-4, normal), rel=1e-5)


@pytest.mark.parametrize('obj, contact', [
    (box(), Contact('face', 3, 0.06)),
    (bin_(center_of_mass=(-0.08, 0.02)), Contact('round', 0, 3.0))])
def test_least_radius_is_where_stability_begins(obj, contact):
    least = min_robot_radius(obj, push_through_center(obj, contact, 1.0))
    assert is_stable(obj, contact, 1.001 * least)
    assert not is_stable(obj, contact, 0.999 * least)


def test_no_robot_pushes_a_centred_disc_stably():
    location = push_through_center(bin_(), Contact('round', 0, 1.0), 1.0)
    assert min_robot_radius(bin_(), location) == math.inf
    assert stable_borders(bin_(), 50.0, 60) == (0.0, [])


@pytest.mark.parametrize('obj, perimeter', [(box(), 1.6), (bin_(), 0.4 * math.pi)])
def test_locations_cover_the_perimeter_end_to_end(obj, perimeter):
    found = perimeter_locations(obj, 50)
    assert sum(location.length for location in found) == pytest.approx(perimeter)
    for location, following in zip(found, found[1:] + found[:1]):
        assert section_ends(obj, location)[1] == pytest.approx(section_ends(obj, following)[0],
                                                               abs=1e-12)
    assert np.all(np.diff([location.s for location in found]) > 0.0)


def mapped(object_name, robot_name, *speeds, **overrides):
    """Compute the map of an object and a robot that come with the package."""
    subject = (object_name, read_object(config_file(f'objects/{object_name}.yaml')), robot_name,
               read_robot(config_file(f'robots/{robot_name}.yaml')))
    study = object_map.object_study(*subject)
    given = object_map.identifying_values(*subject, speeds)
    chosen = {study.figure: {**read_chosen_values()[object_map.NAME], **given}}
    return study.compute(study.values(chosen, {**COARSE, **overrides}), run_in_memory)


def test_speed_narrows_the_stronger_side_only():
    """
    A fast object overshoots, and slides on the weaker side after a large rotation to the other.

    Small rotations do not: the smaller tolerance, and what is stable, stay those of a slow push.
    """
    outcome = mapped('carton', 'warehouse_035', 0.02, 1.5, accuracy=0.005)
    table = outcome.tables['map']
    slow, fast = (np.equal(table['speed_m_s'], speed) for speed in (0.02, 1.5))
    for rows in (slow, fast):
        assert table['tolerance_rad'][rows] == pytest.approx(
            table['closed_tolerance_rad'][rows], abs=0.015)
    for side in ('clockwise', 'counter'):
        assert np.all(table[f'{side}_rad'][fast] < table[f'{side}_rad'][slow] + 0.015)
    assert numbers(outcome)['change'] > 0.3
    fractions = outcome.tables['fractions']['stable_fraction']
    assert fractions[0] == fractions[1] > 0.2


def test_table_is_too_large_for_a_small_robot():
    found = numbers(mapped('coffee_table', 'create3', locations=24))
    assert found['last'] == 0.0
    assert 2.0 * 0.171 < found['least_diameter'] < 2.0 * 0.35
    assert numbers(mapped('coffee_table', 'warehouse_035', locations=24))['last'] > 0.1


def test_command_maps_an_object(tmp_path, capsys):
    words = ['stable-regions', '--object', 'box_04', '--robot', 'warehouse_035', '--speed', '0.1',
             '--set', 'locations=12', '--out', str(tmp_path)]
    assert cli.main(words) == 0
    assert 'stable fraction' in capsys.readouterr().out
    name = 'stable-regions-box_04-warehouse_035'
    assert {path.name for path in tmp_path.iterdir()} == {
        f'{name}{end}' for end in ('.png', '.svg', '.json', '-map.csv', '-fractions.csv',
                                   '-borders.csv')}
    assert cli.main(words) == 0
    assert '(up to date)' in capsys.readouterr().out


@pytest.mark.parametrize('words, message', [
    (['--object', 'sofa', '--robot', 'create3'],
     "object: got 'sofa', expected a path or one of bin, box_04, carton, coffee_table"),
    (['--object', 'bin', '--robot', 'c3po'], "robot: got 'c3po', expected a path or one of cr"),
    (['--object', 'bin', '--robot', 'create3', '--speed', '0'], 'speed: got'),
    (['--object', 'bin', '--robot', 'create3', '--set', 'robot=x'], '--set robot: got'),
    (['--object', 'bin', '--robot', 'create3', '--set', 'mass=1'], '--set: got mass')])
def test_command_refuses_with_what_there_is(words, message, capsys, tmp_path):
    assert cli.main(['stable-regions', *words, '--out', str(tmp_path)]) == 2
    assert message in capsys.readouterr().err


def test_a_changed_object_is_another_study():
    obj = read_object(config_file('objects/bin.yaml'))
    robot = read_robot(config_file('robots/create3.yaml'))
    one, other = (object_map.identifying_values('bin', changed, 'create3', robot)
                  for changed in (obj, dataclasses.replace(obj, mass=4.0)))
    assert one['object'] != other['object'] and one['robot'] == other['robot']
    with pytest.raises(ValueError, match='infinite'):
        object_map.object_study('bin', obj, 'fence', dataclasses.replace(robot, radius=math.inf))
