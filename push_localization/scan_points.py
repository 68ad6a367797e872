"""
Points of a scan at one time.

A lidar that turns measures its beams one after the other, while the robot moves: at 1.5 rad/s a
scan of 0.1 s is bent by 9 degrees. Beam i was measured at ``t + i dt``; odometry, interpolated to
that time, tells where the robot was relative to the middle of the scan.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.signals import LidarScan, Odometry


class LidarMount(NamedTuple):
    """
    Mounting of a lidar.

    :param pose: ``Pose`` in the frame of the robot.
    :param is_upside_down: whether its axis points down, so that it turns the other way round.
    """

    pose: Pose = Pose(0.0, 0.0, 0.0)
    is_upside_down: bool = False


class ScanPoints(NamedTuple):
    """
    Points of a scan in the frame of the robot at one time.

    :param time: the middle of the scan [s].
    :param points: ends of the beams (x, y), shape (n, 2) [m].
    :param lenses: where the lidar was for each of them (x, y), shape (n, 2) [m].
    :param spacings: distance of the ends of neighbouring beams, across them, shape (n,) [m].
    """

    time: float
    points: FloatArray
    lenses: FloatArray
    spacings: FloatArray

    def selected(self, is_used: BoolArray) -> 'ScanPoints':
        """
        Select some points.

        :param is_used: whether each of them is, shape (n,).
        """
        return ScanPoints(self.time, self.points[is_used], self.lenses[is_used],
                          self.spacings[is_used])


class UnexplainedPoints(NamedTuple):
    """
    What a scan shows that is neither a wall of the map nor the pushed object.

    :param time: of the scan [s].
    :param points: (x, y) in the frame of the robot, shape (n, 2) [m].
    """

    time: float
    points: FloatArray


class MotionBuffer:
    """
    Odometry of the last moments.

    ``newest``: time of the newest [s]; -inf without any.
    """

    def __init__(self) -> None:
        """Start without odometry."""
        self._times: list[float] = []
        self._poses: list[Pose] = []

    @property
    def newest(self) -> float:
        """Time of the newest odometry [s]; -inf before the first."""
        return self._times[-1] if self._times else -math.inf

    @property
    def oldest(self) -> float:
        """Time of the oldest odometry that is kept [s]; inf before the first."""
        return self._times[0] if self._times else math.inf

    def append(self, odometry: Odometry) -> None:
        """
        Add odometry; one that is not newer than the last is ignored.

        :param odometry: finite ``Odometry``.
        """
        if odometry.time <= self.newest:
            return
        pose = odometry.pose
        if self._poses:
            # Angles are interpolated: they are not to be wrapped.
            before = self._poses[-1].theta
            pose = pose._replace(
                theta=before + math.remainder(pose.theta - before, 2.0 * math.pi))
        self._times.append(odometry.time)
        self._poses.append(pose)

    def drop_before(self, time: float) -> None:
        """
        Forget what is older than a time, but for the last before it.

        :param time: [s].
        """
        while len(self._times) > 1 and self._times[1] <= time:
            del self._times[0], self._poses[0]

    def poses_at(self, times: FloatArray) -> FloatArray:
        """
        Interpolate linearly; the first and the last pose hold before and after.

        :param times: shape (n,) [s].
        :return: (x, y, theta), angles not wrapped, shape (n, 3).
        """
        known, poses = np.array(self._times), np.array(self._poses)
        return np.stack([np.interp(times, known, column) for column in poses.T], axis=1)

    def step(self, start: float, end: float) -> Pose:
        """
        Compute the motion between two times.

        :param start: [s].
        :param end: [s].
        :return: ``Pose`` at the end in the axes at the start, its angle not wrapped.
        """
        first, last = (Pose(*row) for row in self.poses_at(np.array([start, end])).tolist())
        return first.inverse() @ last


def scan_points(scan: LidarScan, mount: LidarMount, motion: MotionBuffer,
                count: int) -> ScanPoints:
    """
    Bring a scan to the robot's frame at its middle; beams without a range are left out.

    :param motion: ``MotionBuffer`` that covers the scan.
    :param count: of beams that are used at most.
    """
    stride = max(1, math.ceil(len(scan.ranges) / count))
    index = np.array(range(0, len(scan.ranges), stride), dtype=float)
    ranges = np.asarray(scan.ranges, dtype=float)[::stride]
    with np.errstate(invalid='ignore'):
        is_valid = np.isfinite(ranges) & (ranges > scan.range_min) & (ranges < scan.range_max)
    index, ranges = index[is_valid], ranges[is_valid]
    sense = -1.0 if mount.is_upside_down else 1.0
    angles = sense * (scan.angle_min + scan.angle_increment * index) + mount.pose.theta
    poses = motion.poses_at(scan.time + scan.time_increment * index)
    middle = Pose(*motion.poses_at(np.array([scan.middle]))[0].tolist())
    c, s = math.cos(middle.theta), math.sin(middle.theta)
    robots = (poses[:, :2] - middle[:2]) @ np.array([[c, -s], [s, c]])
    turns = poses[:, 2] - middle.theta
    lenses = robots + _rotated(turns, *mount.pose[:2])
    points = lenses + _rotated(turns + angles, ranges, 0.0)
    return ScanPoints(scan.middle, points, lenses,
                      ranges * abs(scan.angle_increment) * stride)


def _rotated(angles: FloatArray, x: FloatArray | float, y: FloatArray | float) -> FloatArray:
    c, s = np.cos(angles), np.sin(angles)
    return np.stack((c * x - s * y, s * x + c * y), axis=1)
