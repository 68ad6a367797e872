"""Recordings as numbers over time; the page on files names their columns, and those of tapes."""

import re

from helpers.architecture import ROOT
from helpers.extras import import_extra
import numpy as np
from push_scenario import read_recording
from push_scenario.recordings.series import READERS
from push_sim_node.tape_row import COLUMNS
import pytest

import_extra('rosbags', 'record')
from helpers.bags import write_bag  # noqa: E402, I100
from rosbags.rosbag2 import StoragePlugin  # noqa: E402

TIMES = 0.02 * np.arange(50)
ROBOT = np.stack([0.1 * TIMES, -TIMES, 3.0 + TIMES], axis=1)
BOX = np.stack([1.0 + TIMES, 0.5 * TIMES, -3.0 - TIMES], axis=1)
PAGE = (ROOT / 'docs' / 'files.md').read_text(encoding='utf-8')


@pytest.fixture(params=[StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def recording(request, tmp_path):
    """Write and read a robot and an object whose headings pass half a turn."""
    write_bag(tmp_path / 'bag', [(TIMES, ROBOT), (TIMES, BOX)], request.param)
    return read_recording(tmp_path / 'bag')


def test_what_was_written_is_read(recording):
    assert list(recording) == ['odom', 'object_pose']
    for series, poses in zip(recording.values(), (ROBOT, BOX)):
        assert np.allclose(series.times, TIMES) and np.allclose(series.values[:, :3], poses)
        assert series.frame == 'odom' and READERS[series.type][0] == series.columns
    assert np.array_equal(recording['odom']['omega'], 0.0 * TIMES)
    with pytest.raises(KeyError, match='mass: expected one of x, y, heading'):
        recording['object_pose']['mass']


def test_a_table_has_the_same_numbers(recording):
    import_extra('pandas', 'table')
    table = recording['object_pose'].to_pandas()
    assert list(table) == ['x', 'y', 'heading'] and table.index.name == 'time'
    assert np.allclose(table['x'], BOX[:, 0]) and np.allclose(table.index, TIMES)


def test_what_is_no_recording_is_refused(tmp_path):
    with pytest.raises(ValueError, match='expected a rosbag2 recording'):
        read_recording(tmp_path)
    with pytest.raises(ValueError, match='no folder, expected a rosbag2 recording'):
        read_recording(str(tmp_path / 'nothing'))


def listed(title):
    """Return the names in the first column, and in the second, of the table below a heading."""
    rows = re.findall(r'^\| (`[^|]*) \|([^|]*)\|', PAGE.partition(f'\n## {title}\n')[2],
                      re.MULTILINE)
    return [tuple(tuple(re.findall(r'`([^`]*)`', cell)) for cell in row) for row in rows]


def test_the_page_has_every_column_of_a_tape():
    names = [name for row in listed('Tape') for name in row[0] if '/' not in name]
    assert tuple(names) == COLUMNS


def test_the_page_has_every_type_and_its_columns():
    assert {row[0][0]: row[1] for row in listed('Recording')} == {
        kind: columns for kind, (columns, _) in READERS.items()}
