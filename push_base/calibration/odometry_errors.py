"""
Scale and drift of odometry against poses of the robot that are measured in the world.

Both are averaged wherever the robot rests. From one rest to the next odometry states a distance
and a rotation, and the world another:

    |d_odometry| = s |d_world|,    heading_odometry = s_yaw heading_world + k path + constant
"""

from typing import NamedTuple

import numpy as np
from push_base.calibration.recording import Purpose, Recording
from push_model.geometry import FloatArray
from push_model.interval import Interval
from scipy.stats import t as student

# Time at the end of a rest that is averaged [s]; chosen: what precedes it may still move.
AVERAGED_TIME = 0.5
# Measurements that an average needs.
MIN_AVERAGED = 5
# Distance between rests from which on it tells of the scale [m].
MIN_DISTANCE = 0.1
# Least half widths of the intervals of scales, relative, and of the drift [rad/m]; measured on
# drawn bases: what averages at rest leave.
MIN_WIDTH, MIN_DRIFT_WIDTH = 2e-4, 5e-4
CONFIDENCE = 0.95
# Variance of what is fitted over that of independent distances: a line there and one back share
# the rest between them, whose errors add up.
SHARED_VARIANCE = 1.5


class OdometryErrors(NamedTuple):
    """
    Errors of odometry.

    :param scale: relative error of distances.
    :param yaw_scale: relative error of rotations.
    :param heading_drift: heading error per distance [rad/m].
    :param heading_offset: direction of motion in the world minus the measured heading, when the
        robot drives ahead [rad].
    """

    scale: Interval
    yaw_scale: Interval
    heading_drift: Interval
    heading_offset: float


def odometry_errors(recording: Recording) -> OdometryErrors | None:
    """
    Compare odometry with poses of the robot in the world.

    :return: ``OdometryErrors``; None where too few poses were measured.
    """
    world = _pose_rows([(item.measured.time, item.measured.pose)
                        for item in recording.robot_poses])
    odometry = _pose_rows([(item.odometry.time, item.odometry.pose)
                           for item in recording.odometry])
    if len(world) < MIN_AVERAGED or len(odometry) < MIN_AVERAGED:
        return None
    rests: list[tuple[FloatArray, FloatArray, float]] = []
    path = _path_length(odometry)
    for end in _rest_ends(recording):
        averages = _averages(odometry, world, end)
        if averages is not None:
            rests.append((*averages, float(np.interp(end, odometry[:, 0], path))))
    if len(rests) < 4:
        return None
    return _compare(np.array([rest[0] for rest in rests]), np.array([rest[1] for rest in rests]),
                    np.array([rest[2] for rest in rests]))


def _compare(odometry: FloatArray, world: FloatArray, path: FloatArray) -> OdometryErrors | None:
    moved, lengths = np.diff(world, axis=0), np.hypot(*np.diff(world[:, :2], axis=0).T)
    lengths_odometry = np.hypot(*np.diff(odometry[:, :2], axis=0).T)
    far = lengths > MIN_DISTANCE
    if far.sum() < 3 or (np.abs(moved[:, 2]) > 1.0).sum() < 2:
        return None
    scale = _regression(lengths[far][:, None], lengths_odometry[far], SHARED_VARIANCE)[0]
    yaw_scale, drift, _ = _regression(
        np.column_stack([world[:, 2], path, np.ones(len(path))]), odometry[:, 2])
    # Along lines that are driven ahead, or backwards, the heading is that of the motion.
    directions = np.arctan2(moved[far, 1], moved[far, 0]) - world[:-1][far][:, 2]
    offset = 0.5 * float(np.angle(np.mean(np.exp(2j * directions))))
    return OdometryErrors(_shifted(scale), _shifted(yaw_scale), _widened(drift), offset)


def _regression(inputs: FloatArray, outputs: FloatArray,
                factor: float = 1.0) -> list[Interval]:
    """Fit outputs = inputs @ factors by least squares."""
    factors, *_ = np.linalg.lstsq(inputs, outputs, rcond=None)
    degrees = max(1, len(outputs) - len(factors))
    variance = factor * float(np.square(outputs - inputs @ factors).sum()) / degrees
    deviations = np.sqrt(variance * np.diag(np.linalg.pinv(inputs.T @ inputs)))
    quantile = float(student.ppf(0.5 + 0.5 * CONFIDENCE, degrees))
    widths = np.maximum(MIN_WIDTH, quantile * deviations)
    return [Interval(value, value - width, value + width)
            for value, width in zip(factors.tolist(), widths.tolist())]


def _widened(drift: Interval) -> Interval:
    return Interval(drift.value, min(drift.low, drift.value - MIN_DRIFT_WIDTH),
                    max(drift.high, drift.value + MIN_DRIFT_WIDTH))


def _shifted(factor: Interval) -> Interval:
    return Interval(*(value - 1.0 for value in factor))


def _pose_rows(poses: list[tuple[float, tuple[float, float, float]]]) -> FloatArray:
    """Lay poses out, headings unwrapped, shape (n, 4)."""
    rows = np.array([(time, *pose) for time, pose in poses]).reshape(-1, 4)
    rows = rows[np.argsort(rows[:, 0], kind='stable')]
    rows[:, 3] = np.unwrap(rows[:, 3])
    return rows


def _path_length(rows: FloatArray) -> FloatArray:
    """Sum up the distance travelled, without what noise adds at rest, shape (n,)."""
    steps = np.hypot(np.diff(rows[:, 1]), np.diff(rows[:, 2]))
    return np.concatenate([[0.0], np.cumsum(steps)])


def _rest_ends(recording: Recording) -> list[float]:
    """List the times at which a segment ends in which the robot was to rest."""
    resting = {Purpose.SETTLE, Purpose.REST}
    commands = recording.commands
    return [now.time for now, after in zip(commands, commands[1:])
            if now.purpose in resting and after.segment != now.segment]


def _averages(odometry: FloatArray, world: FloatArray,
              end: float) -> tuple[FloatArray, FloatArray] | None:
    """Average both at the same times: the robot may still creep."""
    rows = world[(world[:, 0] > end - AVERAGED_TIME) & (world[:, 0] <= end)]
    if len(rows) < MIN_AVERAGED:
        return None
    paired = [np.interp(rows[:, 0], odometry[:, 0], odometry[:, k]).mean() for k in (1, 2, 3)]
    return np.array(paired), rows[:, 1:].mean(axis=0)
