"""Maps of stable pushing regions: plant against closed form, and what the maps show."""

import dataclasses
import math

from helpers.objects import bin_, box
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
from push_study.framework.run import run_here
from push_study.framework.values import read_table, values_of
from push_study.maps import object_regions
from push_study.maps.perimeter import borders, ends, is_stable, places, push_through_center
from push_study.maps.tolerance_push import returns
import pytest

GROWING, MOVED = stable_regions.STUDIES
COARSE = {'places': 64}


def computed(study, **overrides):
    """Compute a study, with the values of the table but for some."""
    return study.compute(values_of(study, read_table(), {**COARSE, **overrides}), run_here)


@pytest.fixture(scope='module')
def growing():
    """Compute 2.28 once."""
    return computed(GROWING)


@pytest.fixture(scope='module')
def moved():
    """Compute 2.29 once."""
    return computed(MOVED)


def test_stable_share_grows_with_the_robot(growing):
    shares = growing.tables['shares']['stable_share']
    assert shares[0] == 0.0 and np.all(np.diff(shares) > 0.05)
    assert growing.findings['growth'].value == pytest.approx(np.diff(shares).min())


def test_stable_share_stays_where_the_cone_is_the_limit():
    """A larger robot gains nothing once friction at the contact, not stability, sets the end."""
    flat = computed(GROWING, robot_diameters=[1.0, 2.0], contact_friction=0.2)
    assert flat.findings['growth'].value == 0.0
    assert flat.findings['first'].value > 0.0


@pytest.mark.parametrize('name', ['growing', 'moved'])
def test_plant_agrees_with_the_closed_form(name, request):
    outcome = request.getfixturevalue(name)
    findings, table = outcome.findings, outcome.tables['map']
    borne = (table['tolerance_rad'] > 0.0) & (table['closed_tolerance_rad'] > 0.0)
    assert borne.sum() > 40
    for side in ('clockwise', 'counter'):
        assert table[f'{side}_rad'][borne] == pytest.approx(
            table[f'closed_{side}_rad'][borne], abs=0.012)
    assert findings['difference'].value < 0.0075
    assert findings['verdicts'].value <= 2 and findings['doubt'].value < 0.0075
    assert outcome.tables['shares']['stable_share'] == pytest.approx(
        outcome.tables['shares']['closed_stable_share'], abs=0.04)


def test_contact_slides_before_rho_leaves_the_cone(growing, moved):
    """The plain rule is an upper bound, and far off in places."""
    for outcome in (growing, moved):
        table = outcome.tables['map']
        assert np.all(table['tolerance_rad'] < table['rule_rad'] + 0.0075)
        assert outcome.findings['slide'].value > 0.1


def test_symmetric_box_has_a_symmetric_map(growing):
    table = growing.tables['map']
    x, y, borne = (np.round(table[name], 9) for name in ('x_m', 'y_m', 'tolerance_rad'))
    found = {(d, a, b): t for d, a, b, t in zip(table['diameter_m'], x, y, borne)}
    for (diameter, a, b), turn in found.items():
        assert found[diameter, -a, b] == pytest.approx(turn, abs=0.005)
        assert found[diameter, a, -b] == pytest.approx(turn, abs=0.005)


def test_region_of_a_side_grows_and_shrinks_as_the_friction_centre_comes_near():
    """Half of it is the smaller of sqrt(d (R - d)) and d mu_c."""
    outcome = computed(MOVED, places=224)
    value = {name: found.value for name, found in outcome.findings.items()}
    cell = 1.6 / 224
    for name in ('start', 'widest', 'nearest'):
        d = value[f'{name}_away']
        half = min(math.sqrt(d * (0.2 - d)), 0.8 * d)
        assert value[f'{name}_length'] == pytest.approx(2.0 * half, abs=2.0 * cell)
    assert value['nearest_length'] < value['start_length'] < value['widest_length']
    assert value['nearest_borne'] < value['widest_borne'] < value['start_borne']
    table = outcome.tables['map']
    right = np.equal(table['face'], 0) & (table['tolerance_rad'] > 0.0)
    assert not np.any(right & np.equal(table['center_y_m'], 0.0))
    assert np.any(right & np.equal(table['center_y_m'], -0.08))


@pytest.mark.parametrize('obj, contact', [
    (box(), Contact('face', 3, 0.06)),
    (bin_(center_of_mass=(-0.08, 0.02)), Contact('round', 0, 3.0))])
def test_places_through_the_centre_are_equilibria(obj, contact):
    location = push_through_center(obj, contact, 0.6)
    assert location.alpha(0.0) == pytest.approx(0.0, abs=1e-12)
    assert is_stable(obj, contact, 0.6)
    borne = [one.rotation for one in force_tolerances(obj, contact, location)]
    for turn in borne:
        assert returns(obj, contact, location, 0.02, 0.97 * turn, 1.0)
        assert not returns(obj, contact, location, 0.02, 1.03 * turn, 1.0)


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


def test_no_robot_pushes_a_disc_stably_whose_centre_is_the_friction_centre():
    location = push_through_center(bin_(), Contact('round', 0, 1.0), 1.0)
    assert min_robot_radius(bin_(), location) == math.inf
    assert borders(bin_(), 50.0, 60) == (0.0, [])


@pytest.mark.parametrize('obj, perimeter', [(box(), 1.6), (bin_(), 0.4 * math.pi)])
def test_places_cover_the_perimeter_end_to_end(obj, perimeter):
    found = places(obj, 50)
    assert sum(place.length for place in found) == pytest.approx(perimeter)
    for place, after in zip(found, found[1:] + found[:1]):
        assert ends(obj, place)[1] == pytest.approx(ends(obj, after)[0], abs=1e-12)
    assert np.all(np.diff([place.along for place in found]) > 0.0)


def mapped(object_name, robot_name, *speeds, **overrides):
    """Compute the map of an object and a robot that come with the package."""
    what = (object_name, read_object(config_file(f'objects/{object_name}.yaml')), robot_name,
            read_robot(config_file(f'robots/{robot_name}.yaml')))
    study = object_regions.study_of(*what)
    chosen = object_regions.choices(*what, speeds)
    table = {study.figure: {**read_table()[object_regions.NAME], **chosen}}
    return study.compute(values_of(study, table, {**COARSE, **overrides}), run_here)


def test_speed_narrows_the_stronger_side_only():
    """
    A fast object overshoots, and slides on the weaker side after a large turn to the other.

    Small turns do not: the smaller tolerance, and what is stable, stay those of a slow push.
    """
    outcome = mapped('carton', 'warehouse_035', 0.02, 1.5, accuracy=0.005)
    table = outcome.tables['map']
    slow, fast = (np.equal(table['speed_m_s'], speed) for speed in (0.02, 1.5))
    for rows in (slow, fast):
        assert table['tolerance_rad'][rows] == pytest.approx(
            table['closed_tolerance_rad'][rows], abs=0.015)
    for side in ('clockwise', 'counter'):
        assert np.all(table[f'{side}_rad'][fast] < table[f'{side}_rad'][slow] + 0.015)
    assert outcome.findings['change'].value > 0.3
    shares = outcome.tables['shares']['stable_share']
    assert shares[0] == shares[1] > 0.2


def test_table_is_too_large_for_a_small_robot():
    outcome = mapped('coffee_table', 'create3', places=24)
    assert outcome.findings['last'].value == 0.0
    assert 2.0 * 0.171 < outcome.findings['least_diameter'].value < 2.0 * 0.35
    assert mapped('coffee_table', 'warehouse_035', places=24).findings['last'].value > 0.1


def test_command_maps_an_object(tmp_path, capsys):
    words = ['stable-regions', '--object', 'box_04', '--robot', 'warehouse_035', '--speed', '0.1',
             '--set', 'places=12', '--out', str(tmp_path)]
    assert cli.main(words) == 0
    assert 'stable share' in capsys.readouterr().out
    name = 'stable-regions-box_04-warehouse_035'
    assert {path.name for path in tmp_path.iterdir()} == {
        f'{name}{end}' for end in ('.png', '.svg', '.json', '-map.csv', '-shares.csv',
                                   '-borders.csv')}
    assert cli.main(words) == 0
    assert '(kept)' in capsys.readouterr().out


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
    one, other = (object_regions.choices('bin', changed, 'create3', robot)
                  for changed in (obj, dataclasses.replace(obj, mass=4.0)))
    assert one['object'] != other['object'] and one['robot'] == other['robot']
    with pytest.raises(ValueError, match='infinite'):
        object_regions.study_of('bin', obj, 'fence', dataclasses.replace(robot, radius=math.inf))
