"""Case study 3 as an experiment: what is read from tracks, and what repeated pushes show."""

import math
from pathlib import Path

from helpers.bags import write_bag
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import RoundRobot
from push_scenario.recordings.bag import Track
import pytest
from rosbags.rosbag2 import StoragePlugin
from studies.__main__ import main
from studies.experiment.recorded import PICTURE
from studies.experiment.side_push import PARAMETERS
from studies.experiment.simulated import SimulatedPush
from studies.experiment.trial import read_trial, split_trials, Trial
from studies.framework.box import box
from studies.framework.parameters import read_chosen_values, resolve

LENGTH, SPEED = 0.6, 0.15
TIMES: FloatArray = np.linspace(0.0, 5.0, 101).astype(np.float64)


def push(frame: Pose = Pose(0.0, 0.0, 0.0), quarter_turns: int = 0) -> tuple[Track, Track]:
    """Drive a second after the start; the object turns by 0.5 rad per metre from then on."""
    driven = np.maximum(0.0, SPEED * (TIMES - 1.0))
    robot = [frame @ Pose(x, 0.0, 0.0) for x in driven.tolist()]
    obj = [frame @ Pose(0.4 + x, 0.0, 0.1 + 0.5 * x + 0.5 * math.pi * quarter_turns)
           for x in driven.tolist()]
    return Track(TIMES, _unwrapped(robot)), Track(TIMES, _unwrapped(obj))


def _unwrapped(poses: list[Pose]) -> FloatArray:
    rows = np.array(poses)
    rows[:, 2] = np.unwrap(rows[:, 2])
    return rows


@pytest.mark.parametrize('frame, quarter_turns', [
    (Pose(0.0, 0.0, 0.0), 0), (Pose(3.0, -1.0, 2.5), 1), (Pose(0.0, 5.0, -3.0), -2)])
def test_rotations_depend_neither_on_the_frame_nor_on_the_side_in_front(
        frame: Pose, quarter_turns: int) -> None:
    """They begin where the object does, and grow as it turns."""
    trial = read_trial(*push(frame, quarter_turns))
    assert trial.distances[-1] == pytest.approx(LENGTH, abs=0.05)
    rates = np.diff(trial.rotations) / np.diff(trial.distances)
    assert rates == pytest.approx(0.5, abs=1e-6)
    assert trial.rotations[0] == pytest.approx(0.1, abs=0.5 * 0.03)


def carried_back(tracks: tuple[Track, Track]) -> tuple[Track, Track]:
    """Push, drive backwards while somebody carries the object, and push again."""
    parts: list[Track] = []
    for track in tracks:
        back = np.arange(0.05, 3.0, 0.05)
        shares = (back / back[-1])[:, None]
        way = track.poses[-1] + shares * (track.poses[0] - track.poses[-1])
        end = track.times[-1] + back
        parts.append(Track(np.concatenate([track.times, end, end[-1] + 0.05 + track.times]),
                           np.vstack([track.poses, way, track.poses])))
    return parts[0], parts[1]


def test_pushes_of_a_recording_are_told_from_what_is_between_them(tmp_path: Path) -> None:
    """The way back is none; two pushes of a bag, each as if it were alone, are drawn."""
    tracks = carried_back(push(Pose(1.0, 2.0, 0.7)))
    trials = split_trials(*tracks)
    single = read_trial(*push())
    assert len(trials) == 2
    for trial in trials:
        assert abs(len(trial.rotations) - len(single.rotations)) <= 1
        count = min(len(trial.rotations), len(single.rotations))
        assert trial.rotations[:count] == pytest.approx(single.rotations[:count], abs=0.01)
    write_bag(tmp_path / 'bag', tracks, StoragePlugin.MCAP)
    assert main(['experiment', f'near={tmp_path / "bag"}', '--out', str(tmp_path)]) == 0
    assert (tmp_path / PICTURE).stat().st_size > 0
    assert main(['experiment', str(tmp_path / 'bag')]) == 2


def simulated(distance: float, seed: int) -> Trial:
    """Push the box of the study, without what is drawn but for its rotation."""
    values = resolve('side-push-experiment', PARAMETERS, read_chosen_values(), {})
    obj = box(values, center_of_mass=(distance - 0.5 * values.box_length, 0.0))
    return SimulatedPush(obj, RoundRobot(radius=values.robot_radius), values.speed, 1.5, 0.15, 0.0,
                         0.0, 0.0, seed).run()


def test_a_rotation_dies_out_where_the_centre_is_near_and_grows_where_it_is_far() -> None:
    """As case study 3 has it; the robot's radius is between both."""
    near, far = (simulated(distance, seed=1) for distance in (0.05, 0.3))
    assert abs(near.rotations[-5:].mean()) < 0.7 * abs(near.rotations[:5].mean())
    assert abs(far.rotations[-5:].mean()) > 2.0 * abs(far.rotations[:5].mean())
    assert np.abs(far.rotations).max() > 2.0 * np.abs(near.rotations).max()
