"""Recorded pushes of a block, where the environment names the folder of the recordings."""

import lzma
import os
from pathlib import Path

import numpy as np
from push_model.friction import friction_center
import pytest
from studies.recordings.block import read_recordings
from studies.recordings.prediction import FITTED, QUASI_STATIC, report, UNFITTED

# See docs/reports/real_pushes.md for the public source.
VARIABLE = 'PUSH_BLOCK_RECORDINGS'
# One push of two force rows and three rows of the rod, at rest, then touching the left face.
ROWS = ['1', '0 0 10 1 0 0 0', '5 0 10 1 0 0 0', '120',
        *[f'{0.01 * row:.2f} 0 0' for row in range(60)],
        *[f'{0.01 * row:.2f} -2.12132 -2.12132' for row in range(60, 120)], '3',
        '0 -8 40 20 1 0 0 0', '0.6 -2 40 20 1 0 0 0', '1.19 3.9 40 20 1 0 0 0']


@pytest.fixture(scope='module')
def recordings():
    """Read the recordings, or skip."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        pytest.skip(f'{VARIABLE} names no folder with the recordings of the block')
    return read_recordings(Path(folder))


@pytest.mark.parametrize('packed', [False, True])
def test_a_file_is_read_in_metres_and_world_axes(packed, tmp_path):
    text = '\n'.join(ROWS)
    name = 'wood_10_130_10_10_10_130.txt'
    if packed:
        (tmp_path / f'{name}.xz').write_bytes(lzma.compress(text.encode()))
    else:
        (tmp_path / name).write_text(text, encoding='utf-8')
    recording, = read_recordings(tmp_path)
    assert recording.floor == 'wood'
    assert friction_center(recording.object) == pytest.approx((0.05, 0.05))
    push, = recording.pushes
    assert push.motion.end == pytest.approx((0.005, 0.0, 0.0))
    # It touches where the force begins, 2 mm (the rod's radius) before the face, and pushes ahead.
    assert push.motion.path[0] == pytest.approx((-0.002, 0.04, 0.0), abs=1e-9)
    assert push.motion.path[-1] == pytest.approx((0.0039, 0.04, 0.0), abs=1e-9)
    assert push.force == pytest.approx((3.0, 0.0), abs=1e-4)
    assert push.duration == pytest.approx(0.59)


@pytest.mark.parametrize('suffix', ['.txt', '.txt.xz'])
def test_the_places_of_feet_have_decimals(suffix, tmp_path):
    """The name of a file ends with its suffix, not at the first dot."""
    opener = lzma.open if suffix == '.txt.xz' else open
    with opener(tmp_path / f'wood_10.5_130_10_10_10_130.25{suffix}', 'wt') as stream:
        stream.write('\n'.join(ROWS))
    recording, = read_recordings(tmp_path)
    assert recording.name == 'wood_10.5_130_10_10_10_130.25'
    assert [support.x for support in recording.object.supports] == pytest.approx(
        [0.0105, 0.13, 0.01])
    assert recording.object.supports[-1].y == pytest.approx(0.13025)


def test_other_files_are_refused(tmp_path):
    with pytest.raises(ValueError, match='expected the recordings of the block'):
        read_recordings(tmp_path)
    (tmp_path / 'glass_1_2_3_4_5_6.txt').write_text('0')
    with pytest.raises(ValueError, match='glass_1_2_3_4_5_6.txt: expected FLOOR_x1'):
        read_recordings(tmp_path)
    (tmp_path / 'glass_1_2_3_4_5_6.txt').unlink()
    (tmp_path / 'wood_10_130_10_10_10_130.txt').write_text('2\n1 2')
    with pytest.raises(ValueError, match='expected pushes with poses, forces'):
        read_recordings(tmp_path)


@pytest.mark.slow
@pytest.mark.physics
def test_real_pushes_end_where_they_are_predicted(recordings):
    """One set: what the page states of it, with a tenth in reserve."""
    recording, = (one for one in recordings if one.name.startswith('hardboard_10_90'))
    found = report(recording)
    for errors in found.errors:
        assert len(errors.position) == 45
        bound = {UNFITTED: 1.8e-3, FITTED: 1.2e-3}[errors.parameters]
        assert np.median(errors.position) < bound
        assert np.degrees(np.median(errors.heading)) < 0.7
    fitted, = (errors for errors in found.errors
               if (errors.model, errors.parameters) == (QUASI_STATIC, FITTED))
    assert np.degrees(np.median(fitted.force_direction)) < 5.0
    assert 0.8 < np.median(fitted.force_ratio) < 1.25
    assert found.identification.friction_center_x.covers(0.05)
    assert found.identification.friction_center_y.covers(0.05)
