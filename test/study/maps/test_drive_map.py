"""Maps of what a drive can steer round an object."""

import dataclasses
import functools

from helpers.study_outcomes import numbers, run_in_memory
import numpy as np
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
from push_study.cli import main
from push_study.framework.parameters import read_chosen_values
from push_study.maps import drive_map
import pytest


@functools.lru_cache(maxsize=None)
def outcome(robot='disc_017', object_name='box_04', contacts=12, **changes):
    """Compute the map for a robot of ``config/robots``, some of its fields changed."""
    obj = read_object(config_file(f'objects/{object_name}.yaml'))
    robot = dataclasses.replace(read_robot(config_file(f'robots/{robot}.yaml')), **changes)
    study = drive_map.drive_study(object_name, obj, 'robot', robot)
    given = {'object': object_name, 'robot': 'robot'}
    chosen = {study.figure: {**read_chosen_values()[drive_map.NAME], **given}}
    found = study.compute(study.values(chosen, {**given, 'contacts': contacts}), run_in_memory)
    assert study.caption(found.findings)
    return found


def found(*arguments, **options):
    """Compute the map; return its findings as numbers."""
    return numbers(outcome(*arguments, **options))


@pytest.mark.slow
def test_differential_drive_steers_at_a_vertex_a_holonomic_one_anywhere():
    differential, holonomic = (found(robot, contacts=28)
                               for robot in ('disc_017', 'holonomic_017'))
    assert 0.6 < differential['vertex_radius'] < 1.0
    assert differential['side_radius'] > 3.0 * differential['vertex_radius']
    assert holonomic['side_radius'] < 0.5 * differential['vertex_radius']
    assert holonomic['both_percent'] > differential['both_percent'] > 0.0


@pytest.mark.slow
@pytest.mark.parametrize('radius', [0.1, 0.4])
def test_face_steers_the_worst_for_a_robot_as_large_as_the_friction_center_is_far(radius):
    """The centre of friction of this box is 0.2 m ahead of each face."""
    same, other = found(radius=0.2), found(radius=radius)
    assert same['side_radius'] > 3.0 * other['side_radius']
    assert same['vertex_radius'] < 1.5 * other['vertex_radius']


@pytest.mark.slow
@pytest.mark.parametrize('robot', ['disc_017', 'holonomic_017'])
def test_map_of_a_square_has_its_symmetries(robot):
    table = outcome(robot).tables['contacts']
    right, left = table['right_per_m'], table['left_per_m']
    assert np.all(left > right)
    assert left[:4] == pytest.approx(left[4:8], rel=1e-6)
    # Seen in a mirror, the contacts run the other way and left is right.
    assert left[1:4] == pytest.approx(-right[3:0:-1], rel=1e-6)
    assert left[0] == pytest.approx(-right[0], rel=1e-6)
    assert np.all(np.diff(left[1:4]) > 0.0)
    sharpest = np.maximum(np.abs(left), np.abs(right))
    assert table['smallest_radius_m'] * sharpest == pytest.approx(np.ones(16))


@pytest.mark.slow
def test_one_side_only_where_the_friction_center_is_out_of_the_cone():
    """A face of 0.4 m, 0.2 m from it, can be pushed straight where ``|offset| < 0.2 mu_c``."""
    table = outcome('holonomic_017', contacts=40).tables['contacts']
    face = np.equal(table['kind'], 'face')
    inside = np.abs(np.array(table['offset_m'])[face]) < 0.2 * 0.6
    both = (table['left_per_m'][face] > 0.0) & (table['right_per_m'][face] < 0.0)
    assert np.array_equal(both, inside)
    assert 0 < inside.sum() < len(inside)


@pytest.mark.slow
def test_round_object():
    bin_ = outcome(object_name='bin')
    assert 'vertex_radius' not in bin_.findings
    assert 'offset_rad' in bin_.tables['contacts']
    assert bin_.findings['both_percent'].value == 100.0


def test_command_makes_the_map_and_keeps_it(tmp_path, capsys):
    words = ['drive-map', '--object', 'box_04', '--robot', 'create3', '--set', 'contacts=4',
             '--jobs', '1', '--out', str(tmp_path)]
    assert main(words) == 0
    assert '(up to date)' not in capsys.readouterr().out
    names = {path.name for path in tmp_path.iterdir()}
    figure = 'drive-map-box_04-create3'
    assert names == {f'{figure}{end}' for end in ('.png', '.svg', '.json', '-contacts.csv')}
    lines = (tmp_path / f'{figure}-contacts.csv').read_text(encoding='utf-8').splitlines()
    assert sum(not line.startswith('#') for line in lines) == 1 + 8
    assert main(words) == 0
    assert '(up to date)' in capsys.readouterr().out


@pytest.mark.parametrize('words, message', [
    (['--object', 'box_05'], 'expected a path or one of bin'),
    (['--robot', 'tractor'], 'create3'),
    (['--set', 'object=bin'], 'the options --object'),
    (['--set', 'speed=0.5'], 'at most 0.306'),
    (['--set', 'wheels=3'], 'wheels')])
def test_command_refuses_what_does_not_fit(tmp_path, capsys, words, message):
    given = ['drive-map', '--object', 'box_04', '--robot', 'create3', '--out', str(tmp_path)]
    assert main(given + words) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.glob('*.png'))
