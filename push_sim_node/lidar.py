"""
Lidar of the simulator: beams to walls and to the object, each at its own time.

A lidar that turns measures its beams one after the other while robot and object move. Beams end at
walls, or at the outline of the object; all is in the plane of the lidar.
"""

import dataclasses
import math
from typing import NamedTuple, Sequence

import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_model.quantity import check, quantity
from push_model.signals import LidarScan

# Corners of the polygon by which a round object is seen; chosen: it is wrong by a thousandth of
# the radius.
ROUND_CORNERS = 48
# Walls that beams look at together, the nearest first; chosen: those of a room and its furniture.
GROUP = 128
# Time for which poses are kept beyond a scan [s]; chosen: more than a step between measurements.
RESERVE = 0.1
FULL_TURN = 2.0 * math.pi


@dataclasses.dataclass(frozen=True)
class LidarSensorSettings:
    """Mounting, rate and errors of the simulated lidar, which turns counter-clockwise."""

    rate: float = quantity('scans per second; 0: there is no lidar', 'Hz', 0.0, 100.0, default=0.0)
    beams: int = quantity('beams of a scan, all round', '', 40, 10_000, default=360)
    mount_x: float = quantity('position on the robot, robot frame', 'm', -10.0, 10.0, default=0.0)
    mount_y: float = quantity('the same, y', 'm', -10.0, 10.0, default=0.0)
    mount_heading: float = quantity('direction of its angle 0 in the same frame', 'rad', -math.pi,
                                    math.pi, default=0.0)
    range_min: float = quantity('least range that is measured', 'm', 0.0, 100.0, default=0.15)
    range_max: float = quantity('largest range that is measured', 'm', above=0.0, high=1000.0,
                                default=12.0)
    noise: float = quantity('std of ranges', 'm', 0.0, 1.0, default=0.02)
    outlier_probability: float = quantity('probability that a beam ends anywhere before its wall',
                                          '', 0.0, 1.0, default=0.01)
    sees_object: bool = quantity('the object is as high as the lidar', default=True)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.range_min >= self.range_max:
            raise ValueError(f'LidarSensorSettings.range_min: got {self.range_min:g}, expected '
                             f'less than range_max, {self.range_max:g} [m]')

    @property
    def mount(self) -> Pose:
        """``Pose`` of the lidar in the frame of the robot."""
        return Pose(self.mount_x, self.mount_y, self.mount_heading)


class BodyPoses(NamedTuple):
    """
    Poses of robot and object at a time.

    :param time: [s].
    :param robot: ``Pose`` in the world, its angle not wrapped.
    :param object: likewise.
    """

    time: float
    robot: Pose
    object: Pose


class Lidar:
    """Measures scans; it is told where robot and object are, as often as that is known."""

    def __init__(self, settings: LidarSensorSettings, obj: PushedObject, walls: Sequence[Wall],
                 noise: np.random.Generator) -> None:
        """
        Start without poses.

        :param settings: ``LidarSensorSettings``, with a rate above 0.
        :param obj: the true ``PushedObject``.
        :param walls: ``Wall`` sequence.
        :param noise: ``numpy.random.Generator`` of noise and outliers.
        """
        self._settings = settings
        self._outline = np.array(obj.outline or _circle(obj.radius))
        self.set_walls(walls)
        self._noise = noise
        self._visitor: FloatArray = np.zeros((0, 4))
        self._poses: list[BodyPoses] = []

    @property
    def period(self) -> float:
        """Time from one scan to the next [s]."""
        return 1.0 / self._settings.rate

    def observe(self, poses: BodyPoses) -> None:
        """
        Take note of where robot and object are.

        :param poses: ``BodyPoses``, later than the last.
        """
        self._poses.append(poses)
        oldest = poses.time - self.period - RESERVE
        while len(self._poses) > 1 and self._poses[1].time < oldest:
            del self._poses[0]

    def set_walls(self, walls: Sequence[Wall]) -> None:
        """
        Replace the walls.

        :param walls: ``Wall`` sequence.
        """
        self._walls = np.array([(wall.start_x, wall.start_y, wall.end_x, wall.end_y)
                                for wall in walls]).reshape(-1, 4)

    def show(self, outline: FloatArray) -> None:
        """
        Let something stand or walk about that no map has.

        :param outline: its corners (x, y), shape (k, 2) [m]; in place of those of before.
        """
        self._visitor = np.concatenate((outline, np.roll(outline, -1, axis=0)), axis=1)

    def measure(self, time: float) -> LidarScan:
        """
        Measure a scan that is over by now.

        :param time: of its first beam [s].
        """
        settings = self._settings
        increment = FULL_TURN / settings.beams
        time_increment = self.period / settings.beams
        index = np.array(range(settings.beams), dtype=float)
        times = time + time_increment * index
        robots, objects = self._poses_at(times)
        lenses = robots[:, :2] + _rotated(np.array([settings.mount[:2]]), robots[:, 2])
        angles = robots[:, 2] + settings.mount_heading - math.pi + increment * index
        rays = np.stack((np.cos(angles), np.sin(angles)), axis=1)
        ranges = np.minimum(self._distances(lenses, rays, objects),
                            distances_to_segments(lenses, rays, self._visitor))
        return LidarScan(time, _single(self._measured(ranges)), *_single(np.array((
            -math.pi, increment, time_increment, settings.range_min,
            settings.range_max))).tolist())

    def _poses_at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Interpolate the poses of robot and object, shape (n, 3) each."""
        known = np.array([poses.time for poses in self._poses])
        robots = np.array([poses.robot for poses in self._poses])
        objects = np.array([poses.object for poses in self._poses])
        return _interpolated(times, known, robots), _interpolated(times, known, objects)

    def _distances(self, lenses: FloatArray, rays: FloatArray,
                   objects: FloatArray) -> FloatArray:
        """
        Find how far beams go before they meet a wall or the object.

        :param lenses: where they start (x, y), shape (n, 2) [m].
        :param rays: their unit directions, shape (n, 2).
        :param objects: pose of the object at the time of each, shape (n, 3).
        :return: shape (n,) [m]; infinite where they meet none.
        """
        ranges = self._distances_to_walls(lenses, rays)
        if self._settings.sees_object:
            ranges = np.minimum(ranges, self._distances_to_object(lenses, rays, objects))
        return ranges

    def _distances_to_walls(self, lenses: FloatArray, rays: FloatArray) -> FloatArray:
        """Cast beams to the nearest walls first; those that end there look no farther."""
        ranges = np.full(len(lenses), math.inf)
        walls, gaps = self._near_walls(lenses)
        for first in range(0, len(walls), GROUP):
            beams = np.flatnonzero(ranges > gaps[first])
            ranges[beams] = np.minimum(ranges[beams], distances_to_segments(
                lenses[beams], rays[beams], walls[first:first + GROUP]))
        return ranges

    def _near_walls(self, lenses: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Select the walls that beams may reach, nearest first, and bound their ranges."""
        walls, middle = self._walls, lenses.mean(axis=0)
        motion = float(np.abs(lenses - middle).max())
        reach = self._settings.range_max + motion
        low, high = np.minimum(walls[:, :2], walls[:, 2:]), np.maximum(walls[:, :2], walls[:, 2:])
        # Along columns and rows, of which no distance is less than the larger one.
        away = np.maximum(low - middle, middle - high).max(axis=1)
        gaps = away - motion
        near = np.flatnonzero(away < reach)
        near = near[np.argsort(gaps[near], kind='stable')]
        return walls[near], gaps[near]

    def _distances_to_object(self, lenses: FloatArray, rays: FloatArray,
                             objects: FloatArray) -> FloatArray:
        """Cast beams in the frame of the object, where its outline stands."""
        turns = -objects[:, 2]
        outline = self._outline
        sides = np.concatenate((outline, np.roll(outline, -1, axis=0)), axis=1)
        return distances_to_segments(_rotated(lenses - objects[:, :2], turns),
                                     _rotated(rays, turns), sides)

    def _measured(self, ranges: FloatArray) -> FloatArray:
        """Add noise and outliers; what is out of range measures nothing."""
        settings, count = self._settings, len(ranges)
        fractions = self._noise.uniform(0.0, 1.0, count)
        is_outlier = self._noise.uniform(0.0, 1.0, count) < settings.outlier_probability
        noise = settings.noise * self._noise.standard_normal(count)
        end = np.minimum(ranges, settings.range_max)
        measured = np.where(is_outlier, fractions * end, ranges + noise)
        is_measured = (measured >= settings.range_min) & (measured <= settings.range_max)
        return np.where(is_measured, measured, math.inf)


def distances_to_segments(starts: FloatArray, rays: FloatArray,
                          segments: FloatArray) -> FloatArray:
    """
    Find how far beams go before they meet a segment.

    :param starts: of the beams (x, y), shape (n, 2) [m].
    :param rays: their unit directions, shape (n, 2).
    :param segments: ends (x, y, x, y), shape (k, 4) [m].
    :return: shape (n,) [m]; infinite where they meet none.
    """
    if not len(segments):
        return np.full(len(starts), math.inf)
    sides = segments[:, 2:] - segments[:, :2]
    x = segments[:, 0] - starts[:, :1]
    y = segments[:, 1] - starts[:, 1:]
    determinants = rays[:, :1] * sides[:, 1] - rays[:, 1:] * sides[:, 0]
    with np.errstate(divide='ignore', invalid='ignore'):
        along = (x * sides[:, 1] - y * sides[:, 0]) / determinants
        fractions = (x * rays[:, 1:] - y * rays[:, :1]) / determinants
        is_hit = (along > 0.0) & (fractions >= 0.0) & (fractions <= 1.0)
    return np.where(is_hit, along, math.inf).min(axis=1)


def _single(values: FloatArray) -> FloatArray:
    """Round to single precision, as drivers of lidars and their messages do."""
    return values.astype(np.float32).astype(np.float64)


def _circle(radius: float) -> list[tuple[float, float]]:
    return [(radius * math.cos(angle), radius * math.sin(angle))
            for angle in np.linspace(0.0, FULL_TURN, ROUND_CORNERS, endpoint=False).tolist()]


def _interpolated(times: FloatArray, known: FloatArray, poses: FloatArray) -> FloatArray:
    return np.stack([np.interp(times, known, column) for column in poses.T], axis=1)


def _rotated(vectors: FloatArray, angles: FloatArray) -> FloatArray:
    c, s = np.cos(angles), np.sin(angles)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=1)
