"""Split a recording into pushes: from rest to rest of the object."""

import numpy as np
from numpy.typing import NDArray
from push_control.identification.recorded_push import RecordedPush, touching_path
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, RoundRobot
from push_scenario.recordings.bag import Track

# Poses are compared over this time [s]. Chosen: ten poses of a camera, whose noise it averages.
WINDOW = 0.5
# The object moves above this speed of a point at the lever of its size [m/s]. Chosen: below slow
# pushes of 2 cm/s, and above what averaged noise of 2 mm suggests.
MOVING = 0.008
# A shorter rest belongs to the push [s]; a smaller displacement is none [m]. Chosen.
MAX_PAUSE = 0.5
MIN_DISPLACEMENT = 0.02
# Rest over which the pose before and after is averaged [s]. Chosen: twenty poses or more.
REST_DURATION = 1.0


def split_pushes(obj: PushedObject, robot: RoundRobot, robot_track: Track,
                 object_track: Track) -> list[RecordedPush]:
    """
    Find the pushes of a recording.

    :param obj: the pushed object.
    :param robot: the robot.
    :param robot_track: poses of the robot, in the frame of the object's.
    :param object_track: poses of the object.
    :return: pushes in their order; the robot's path is shifted along the contact normal so that
        it touches where the object comes to rest.
    """
    shape, size = Shape.of(obj), _size(obj)
    moving = _is_moving(object_track, size)
    pushes: list[RecordedPush] = []
    for begun, ended in _intervals(object_track.times, moving):
        start = _rest_pose(object_track, begun - REST_DURATION, begun)
        last = _rest_pose(object_track, ended, ended + REST_DURATION)
        displacement = np.hypot(*(last - start)[:2]) + size * abs(last[2] - start[2])
        if displacement < MIN_DISPLACEMENT:
            continue
        path = _between(robot_track, begun - WINDOW, ended)
        pushes.append(RecordedPush(start, last,
                                   touching_path(shape, robot.radius, last, path, -1)))
    return pushes


def _size(obj: PushedObject) -> float:
    """Lever that makes rotations displacements: half the greatest extent [m]."""
    return obj.radius or float(max(np.hypot(x, y) for x, y in obj.outline))


def _is_moving(track: Track, size: float) -> NDArray[np.bool_]:
    """Compare mean poses before and after each time."""
    times, poses = track
    sums = np.vstack([np.zeros(3), np.cumsum(poses, axis=0)])
    low, high = (np.searchsorted(times, times + shift) for shift in (-WINDOW, WINDOW))
    middle = np.arange(len(times))
    before = (sums[middle] - sums[low]) / np.maximum(middle - low, 1)[:, None]
    after = (sums[high] - sums[middle]) / np.maximum(high - middle, 1)[:, None]
    change = after - before
    speed = (np.hypot(change[:, 0], change[:, 1]) + size * np.abs(change[:, 2])) / WINDOW
    return (speed > MOVING) & (middle > low)


def _intervals(times: FloatArray, moving: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """List start and end of each motion, pauses bridged [s]."""
    intervals: list[tuple[float, float]] = []
    for time in times[moving]:
        if intervals and time - intervals[-1][1] <= MAX_PAUSE:
            intervals[-1] = intervals[-1][0], float(time)
        else:
            intervals.append((float(time), float(time)))
    return intervals


def _rest_pose(track: Track, start: float, end: float) -> FloatArray:
    rows = (track.times >= start) & (track.times <= end)
    if not rows.any():
        return track.poses[int(np.argmin(np.abs(track.times - end)))]
    return np.median(track.poses[rows], axis=0)


def _between(track: Track, start: float, end: float) -> FloatArray:
    """Return the poses between two times, with those at the times themselves."""
    rows = (track.times > start) & (track.times < end)
    times = np.concatenate([[start], track.times[rows], [end]])
    return np.column_stack([np.interp(times, track.times, column) for column in track.poses.T])
