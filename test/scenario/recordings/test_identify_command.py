"""The command ``push identify``: from a bag to an object file."""

import dataclasses

from benchmarks.identification.recording import record_pushes
from helpers.extras import import_extra
import numpy as np
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
from push_model.friction import friction_center, with_friction_center
from push_scenario.recordings import cli
import pytest

import_extra('rosbags', 'record')
from helpers.bags import write_bag  # noqa: E402, I100
from rosbags.rosbag2 import StoragePlugin  # noqa: E402

BOX = read_object(config_file('objects/box_04.yaml'))
ROBOT = read_robot(config_file('robots/holonomic_017.yaml'))


@pytest.mark.slow
def test_a_recording_becomes_an_object_file(tmp_path, capsys):
    true = with_friction_center(BOX, (0.02, -0.03))
    true = dataclasses.replace(true, contact_friction_coefficient=0.45)
    tracks = record_pushes(true, ROBOT, np.random.default_rng(1))
    for number, storage in enumerate((StoragePlugin.MCAP, StoragePlugin.SQLITE3)):
        write_bag(tmp_path / f'bag_{number}', tracks, storage)
    out = tmp_path / 'object.yaml'
    words = ['--object', 'box_04', '--robot', 'holonomic_017', '--out', str(out)]
    assert cli.main([str(tmp_path / 'bag_0'), *words]) == 0
    output = capsys.readouterr().out
    assert 'contact friction 0.4' in output and 'of 10 pushes' in output
    found = read_object(out)
    assert friction_center(found) == pytest.approx((0.02, -0.03), abs=0.003)
    assert found.contact_friction_coefficient == pytest.approx(0.45, abs=0.03)
    assert sum(found.capacities) == pytest.approx(sum(BOX.capacities), rel=1e-3)
    assert '# c^2 over the nominal one' in out.read_text(encoding='utf-8')
    # The other format holds the same.
    first = out.read_text(encoding='utf-8').splitlines()[1:]
    assert cli.main([str(tmp_path / 'bag_1'), *words]) == 0
    assert out.read_text(encoding='utf-8').splitlines()[1:] == first
    # What is wrong is named, and the file stays.
    assert cli.main([str(tmp_path / 'bag_0'), *words, '--odom', 'odometry']) == 2
    assert 'topic: got odometry, expected one of the recording: /object_pose, /odom' in (
        capsys.readouterr().err)
    assert cli.main([str(tmp_path / 'nowhere'), *words]) == 2
    assert 'expected a rosbag2 recording' in capsys.readouterr().err
    assert out.read_text(encoding='utf-8').splitlines()[1:] == first


def test_each_bag_has_an_object_and_a_file(tmp_path, capsys):
    assert cli.main([str(tmp_path / 'a'), str(tmp_path / 'b'), '--object', 'box_04', '--robot',
                     'holonomic_017']) == 2
    assert '--object: got 1, expected one for each of the 2 bags' in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_named_at_once(tmp_path, capsys):
    """The recording has not been looked at yet."""
    out = tmp_path / 'nowhere' / 'object.yaml'
    assert cli.main([str(tmp_path / 'no_bag'), '--object', 'box_04', '--robot', 'holonomic_017',
                     '--out', str(out)]) == 2
    assert f'--out: got {out}, expected a file' in capsys.readouterr().err
