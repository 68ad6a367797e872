"""Push trajectories are checked, frozen, interpolated and kept in files."""

import math

import numpy as np
from push_model.trajectory import COLUMNS, PushStyle, PushTrajectory
import pytest


def arrays(count=3):
    """Return the arrays of a straight trajectory."""
    rows = np.linspace(0.0, 1.0, count)[:, None] * np.ones(3)
    return {'times': np.linspace(0.0, 2.0, count), **{name: rows.copy() for name in COLUMNS}}


def test_trajectory_is_checked_frozen_and_kept(tmp_path):
    trajectory = PushTrajectory(**arrays())
    with pytest.raises(ValueError):
        trajectory.object_poses[0, 0] = 1.0
    trajectory.save(tmp_path / 'push.npz')
    again = PushTrajectory.load(tmp_path / 'push.npz')
    for name in ('times',) + COLUMNS:
        assert np.array_equal(getattr(again, name), getattr(trajectory, name))
    assert again.style is trajectory.style is PushStyle.STEERED
    assert trajectory.at(1.0)['object_poses'] == pytest.approx([0.5] * 3)
    assert trajectory.at(9.0)['robot_poses'] == pytest.approx([1.0] * 3)
    assert trajectory.path_length == pytest.approx(math.sqrt(2))


@pytest.mark.parametrize('name, value, text', [
    ('object_poses', np.zeros((3, 2)), r'object_poses: got shape \(3, 2\), expected \(3, 3\)'),
    ('robot_twists', np.full((3, 3), np.nan), r'robot_twists: got a value that is not finite'),
    ('times', np.array([0.0, 1.0, 1.0]), 'increasing'),
    ('times', np.array([0.5, 1.0, 2.0]), 'from 0')])
def test_trajectory_refuses(name, value, text):
    with pytest.raises(ValueError, match=text):
        PushTrajectory(**{**arrays(), name: value})


@pytest.mark.parametrize('style', PushStyle)
def test_the_style_is_kept_in_a_file(style, tmp_path):
    PushTrajectory(**arrays(), style=style).save(tmp_path / 'push.npz')
    assert PushTrajectory.load(tmp_path / 'push.npz').style is style


def test_a_file_with_another_style_or_none_is_refused(tmp_path):
    np.savez(tmp_path / 'push.npz', **arrays(), style=np.array('wobbly'))
    with pytest.raises(ValueError, match="push.npz: got the style 'wobbly', expected one of"):
        PushTrajectory.load(tmp_path / 'push.npz')
    np.savez(tmp_path / 'push.npz', **arrays())
    with pytest.raises(ValueError, match='got no style'):
        PushTrajectory.load(tmp_path / 'push.npz')
