"""Straight pushes as sensors see them: rotation of the box over the driven distance."""

import contextlib
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray
from push_scenario.recordings.bag import Track

# The object moves once it is so far from where it stood [m]; chosen: above the noise of poses.
MIN_DISPLACEMENT = 0.01
# A push that is shorter says nothing [m].
MIN_LENGTH = 0.1
# The robot drives ahead above this speed [m/s], measured over this time to either side [s], and
# stands still for a part of a push at most so long [s]; chosen.
MIN_SPEED, WINDOW, MAX_PAUSE = 0.03, 0.2, 0.5
# Distances between samples [m].
SPACING = 0.02


class Trial(NamedTuple):
    """
    A straight push.

    :param distances: driven by the robot since the object began to move, from 0 on, ``SPACING``
        apart, shape (n,) [m].
    :param rotations: of the object from where it is straight ahead of the robot, shape (n,) [rad].
    """

    distances: FloatArray
    rotations: FloatArray


def sample_distances(count: int) -> FloatArray:
    """List the distances of the first samples of a trial, shape (count,) [m]."""
    return np.asarray(SPACING * np.arange(count), dtype=np.float64)


def read_trial(robot: Track, obj: Track) -> Trial:
    """
    Read a push from poses of robot and object.

    The object is straight ahead where its heading differs from that of the robot by quarter turns:
    its frame may have any of its sides in front.

    :param robot: poses of the robot, which drives along its heading.
    :param obj: poses of the object, from rest on.
    :raises ValueError: where the object was not pushed.
    """
    moved = np.hypot(*(obj.poses[:, :2] - obj.poses[0, :2]).T)
    start = int(np.argmax(moved > MIN_DISPLACEMENT))
    end = int(np.argmax(moved > moved.max() - MIN_DISPLACEMENT))
    if moved.max() < MIN_LENGTH or end <= start:
        raise ValueError(f'trial: got an object that was pushed by {moved.max():.3f} m, expected '
                         f'{MIN_LENGTH:g} m at least')
    times = obj.times[start:end + 1]
    x, y, heading = (np.interp(times, robot.times, column) for column in robot.poses.T)
    driven = np.hypot(x - x[0], y - y[0])
    difference = obj.poses[start:end + 1, 2] - heading
    quarter_turns = np.round(difference[0] / (0.5 * math.pi))
    rotations = difference - quarter_turns * 0.5 * math.pi
    distances = sample_distances(math.ceil(float(driven.max()) / SPACING))
    return Trial(distances, np.interp(distances, np.maximum.accumulate(driven), rotations))


def split_trials(robot: Track, obj: Track) -> list[Trial]:
    """
    Find the pushes of a recording: where the robot drives ahead, and the object moves with it.

    In between the robot may drive back, and somebody may carry the object.

    :param robot: poses of the robot.
    :param obj: poses of the object, in the same frame.
    """
    trials: list[Trial] = []
    for start, end in _drives(robot):
        parts = [_between(track, start - MAX_PAUSE, end) for track in (robot, obj)]
        if min(len(part.times) for part in parts) > 1:
            with contextlib.suppress(ValueError):
                trials.append(read_trial(*parts))
    return trials


def _drives(robot: Track) -> list[tuple[float, float]]:
    """List start and end of each drive ahead, short pauses bridged [s]."""
    before, after = (np.column_stack([np.interp(robot.times + shift, robot.times, column)
                                      for column in robot.poses.T]) for shift in (-WINDOW, WINDOW))
    velocities = (after - before) / (2.0 * WINDOW)
    heading = robot.poses[:, 2]
    speeds = velocities[:, 0] * np.cos(heading) + velocities[:, 1] * np.sin(heading)
    drives: list[tuple[float, float]] = []
    for time in robot.times[speeds > MIN_SPEED].tolist():
        if drives and time - drives[-1][1] <= MAX_PAUSE:
            drives[-1] = drives[-1][0], time
        else:
            drives.append((time, time))
    return drives


def _between(track: Track, start: float, end: float) -> Track:
    rows = (track.times >= start) & (track.times <= end)
    return Track(track.times[rows], track.poses[rows])
