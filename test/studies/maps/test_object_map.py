"""The command stable-regions: maps of any object and robot, and what it refuses."""

import dataclasses
import math

from helpers.study_outcomes import numbers, run_in_memory
import numpy as np
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
import pytest
from studies import __main__ as cli
from studies.framework.parameters import read_chosen_values
from studies.maps import object_map

COARSE = {'locations': 64}


def mapped(object_name, robot_name, *speeds, **overrides):
    """Compute the map of an object and a robot that come with the package."""
    subject = (object_name, read_object(config_file(f'objects/{object_name}.yaml')), robot_name,
               read_robot(config_file(f'robots/{robot_name}.yaml')))
    study = object_map.object_study(*subject)
    given = object_map.identifying_values(*subject, speeds)
    chosen = {study.figure: {**read_chosen_values()[object_map.NAME], **given}}
    return study.compute(study.values(chosen, {**COARSE, **overrides}), run_in_memory)


@pytest.mark.slow
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


@pytest.mark.slow
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
