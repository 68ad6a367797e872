"""Push trajectories are checked, frozen, interpolated and kept in files."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.trajectory import COLUMNS, PushLine, PushStyle, PushTrajectory
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


LINE = PushLine(Pose(0.5, -0.2, 2.0), -1.5, 0.3, 2)


def straight_arrays(line=LINE, count=3):
    """Return the arrays of a push along a line, and the line."""
    values = arrays(count)
    values['robot_poses'] = line.robot_poses(Pose(*values['object_poses'][0]),
                                             np.linspace(0.0, line.length, count))
    return {**values, 'line': line}


@pytest.mark.parametrize('curvature', [-2.0, -1e-9, 0.0, 0.7])
def test_the_robot_drives_an_arc_from_the_start_of_a_line(curvature):
    """In the direction of its heading, which turns by the curvature with the distance."""
    line = LINE._replace(curvature=curvature)
    object_pose = Pose(1.0, -2.0, 0.7)
    distances = np.linspace(0.0, line.length, 2001)
    poses = line.robot_poses(object_pose, distances)
    assert poses[0] == pytest.approx(object_pose @ line.start, abs=1e-12)
    steps = np.diff(poses, axis=0) / np.diff(distances)[:, None]
    middles = 0.5 * (poses[1:, 2] + poses[:-1, 2])
    assert steps[:, 0] == pytest.approx(np.cos(middles), abs=1e-7)
    assert steps[:, 1] == pytest.approx(np.sin(middles), abs=1e-7)
    assert steps[:, 2] == pytest.approx(curvature, abs=1e-9)


@pytest.mark.parametrize('style', PushStyle)
def test_style_and_line_are_kept_in_a_file(style, tmp_path):
    values = straight_arrays() if style.is_straight else arrays()
    PushTrajectory(**values, style=style).save(tmp_path / 'push.npz')
    again = PushTrajectory.load(tmp_path / 'push.npz')
    assert again.style is style
    assert again.line == (LINE if style.is_straight else None)


@pytest.mark.parametrize('style, line, text', [
    (PushStyle.STRAIGHT, None, 'got none, expected one, as the push is straight'),
    (PushStyle.WAYPOINT, None, 'got none, expected one, as the push is waypoint'),
    (PushStyle.STEERED, LINE, 'got one, expected none, as the push is steered'),
    (PushStyle.STRAIGHT, LINE._replace(length=0.0), 'a length above 0'),
    (PushStyle.STRAIGHT, LINE._replace(length=math.nan), 'finite values'),
    (PushStyle.STRAIGHT, LINE._replace(curvature=math.inf), 'finite values'),
    (PushStyle.STRAIGHT, LINE._replace(start=Pose(math.nan, 0.0, 0.0)), 'finite values'),
    (PushStyle.STRAIGHT, LINE._replace(face=-1), 'a face from 0 on'),
    (PushStyle.STRAIGHT, LINE._replace(length=0.31), 'got ends 0.01 m beside those of'),
    (PushStyle.STRAIGHT, LINE._replace(curvature=1.5), 'got ends 0.1.* m beside those of'),
    (PushStyle.STRAIGHT, LINE._replace(start=Pose(0.5, -0.21, 2.0)), 'got ends 0.01 m beside')])
def test_a_line_that_is_not_that_of_the_push_is_refused(style, line, text):
    """A push has the line that it is driven along, and only then."""
    with pytest.raises(ValueError, match=f'PushTrajectory.line: .*{text}'):
        PushTrajectory(**{**straight_arrays(), 'line': line}, style=style)


def test_only_a_push_that_is_not_steered_has_a_line_to_ask_for():
    assert PushTrajectory(**straight_arrays(), style=PushStyle.STRAIGHT).straight_line() == LINE
    with pytest.raises(ValueError, match='PushTrajectory.line: got none'):
        PushTrajectory(**arrays()).straight_line()


def test_a_file_without_a_line_is_refused(tmp_path):
    np.savez(tmp_path / 'push.npz', **arrays(), style=np.array('steered'))
    with pytest.raises(ValueError, match='push.npz: got no line, expected a PushTrajectory'):
        PushTrajectory.load(tmp_path / 'push.npz')
    np.savez(tmp_path / 'push.npz', **arrays(), style=np.array('steered'), line=np.ones(5))
    with pytest.raises(ValueError, match='push.npz: got a line of 5 values, expected 6'):
        PushTrajectory.load(tmp_path / 'push.npz')


def test_a_file_with_another_style_or_none_is_refused(tmp_path):
    np.savez(tmp_path / 'push.npz', **arrays(), style=np.array('wobbly'), line=np.array([]))
    with pytest.raises(ValueError, match="push.npz: got the style 'wobbly', expected one of"):
        PushTrajectory.load(tmp_path / 'push.npz')
    np.savez(tmp_path / 'push.npz', **arrays(), line=np.array([]))
    with pytest.raises(ValueError, match='got no style'):
        PushTrajectory.load(tmp_path / 'push.npz')
