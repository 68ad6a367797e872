"""Paths of the robot on its own: straight lines, arcs and rotations in place, pose by pose."""

from collections.abc import Iterable, Sequence
import dataclasses
import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.events import Cause, Report
from push_model.geometry import Coordinates, distance, FloatArray, Pose, wrap_angle
from push_model.parameters import RoundRobot

# Two poses nearer than this are at the same place: a rotation in place. Chosen: far below the
# tolerances of any drive, far above rounding [m].
MIN_LENGTH = 1e-6
# A rotation in place by less than this is left out. Chosen: below the heading tolerance of the
# path follower, which corrects it on the way [rad].
MIN_ROTATION = 1e-3


class PathFailure(Cause):
    """Why there is no path."""

    START_IN_OBJECT = 'the start of the path lies {overlap:.3f} m inside the object'
    GOAL_IN_OBJECT = 'the goal of the path lies {overlap:.3f} m inside the object'
    START_IN_OBSTACLE = (
        'the robot at {x:.2f} m, {y:.2f} m is in an obstacle of the map, or too near to one')
    GOAL_NEAR_OBSTACLE = (
        'the goal of the path, {x:.2f} m, {y:.2f} m, is too near to an obstacle of the map')
    GOAL_TOO_UNCERTAIN = (
        'the place of the robot is too uncertain for the goal of its path, {x:.2f} m, {y:.2f} m, '
        'so near to an obstacle of the map')
    NO_ROUTE = 'obstacles of the map, or the object between them, are in the way'
    ROBOT_TOO_UNCERTAIN = (
        'obstacles of the map leave no room for a robot whose place is uncertain')
    NO_CLEARANCE = 'no clearance is allowed'


class NoPathFound(ValueError):
    """
    There is no path.

    :param report: ``Report`` of why.
    """

    def __init__(self, report: Report[PathFailure]) -> None:
        super().__init__(report)
        self.report = report


@dataclasses.dataclass(frozen=True)
class PathSegment:
    """
    Motion from one pose to the next, along a circle and with an even yaw rate.

    What follows from it is computed once: a robot that drives along it asks at every step.

    :param start: ``Pose`` at its beginning.
    :param end: ``Pose`` at its end.
    :param arc_angle: change of the direction of motion, positive to the left, 0 on a straight line
        [rad], below a full circle.
    """

    start: Pose
    end: Pose
    arc_angle: float = 0.0

    @functools.cached_property
    def length(self) -> float:
        """Length of the path of the robot's centre [m]; 0 for a rotation in place."""
        chord, half = distance(self.start, self.end), 0.5 * self.arc_angle
        if chord < MIN_LENGTH:
            return 0.0
        return chord * half / math.sin(half) if abs(half) > 1e-9 else chord

    @functools.cached_property
    def heading_change(self) -> float:
        """Change of the robot's heading, the short way round [rad]."""
        return wrap_angle(self.end.theta - self.start.theta)

    @functools.cached_property
    def directions(self) -> tuple[float, float]:
        """Directions of motion at the beginning and at the end [rad]."""
        chord = math.atan2(self.end.y - self.start.y, self.end.x - self.start.x)
        return chord - 0.5 * self.arc_angle, chord + 0.5 * self.arc_angle

    def direction(self, s: float) -> float:
        """
        Direction of motion at an arc length [rad].

        :param s: arc length from the beginning of a segment that has a length [m].
        """
        return self.directions[0] + self.arc_angle * s / self.length

    def heading(self, s: float) -> float:
        """
        Heading of the robot at an arc length [rad].

        :param s: arc length from the beginning of a segment that has a length [m].
        """
        return self.start.theta + self.heading_change * s / self.length

    def poses(self, fractions: FloatArray) -> FloatArray:
        """
        Find poses along the segment.

        :param fractions: of the segment, 0 at its beginning and 1 at its end, shape (n,).
        :return: (x, y, theta), shape (n, 3).
        """
        half = 0.5 * self.arc_angle * fractions
        chord = self.length * fractions * np.sinc(half / np.pi)
        direction = self.directions[0] + half
        return np.stack((self.start.x + chord * np.cos(direction),
                         self.start.y + chord * np.sin(direction),
                         self.start.theta + fractions * self.heading_change), axis=1)

    def project(self, point: Coordinates) -> tuple[float, float]:
        """
        Project a point onto the segment.

        :param point: (x, y) [m], near the segment.
        :return: (arc length from the beginning [m], below 0 or above the length outside; lateral
            offset to the left [m]).
        """
        first = self.directions[0]
        along, lateral = Pose(0.0, 0.0, -first).rotate((point[0] - self.start.x,
                                                        point[1] - self.start.y))
        if abs(self.arc_angle) < 1e-9:
            return along, lateral
        radius = self.length / self.arc_angle
        side = math.copysign(1.0, radius)
        middle = 0.5 * self.arc_angle
        # Measured from the middle of the arc, so that the cut of the angle is opposite to it.
        angle = middle + wrap_angle(side * math.atan2(along, side * (radius - lateral)) - middle)
        return radius * angle, radius - side * math.hypot(along, radius - lateral)


class Path(NamedTuple):
    """
    Path from pose to pose along straight lines, arcs and rotations in place.

    Between two poses at different places the heading changes evenly; two poses at the same place
    are a rotation in place. A differential drive moves along its heading, or backwards.

    :param poses: ``Pose`` sequence, start and goal included.
    :param arc_angles: of each segment, one less than poses: change of the direction of motion on
        it [rad]; empty where all segments are straight.
    """

    poses: tuple[Pose, ...]
    arc_angles: tuple[float, ...] = ()

    @property
    def segments(self) -> tuple[PathSegment, ...]:
        """``PathSegment`` between each two poses."""
        arc_angles = self.arc_angles or (0.0,) * (len(self.poses) - 1)
        return tuple(PathSegment(*ends) for ends in zip(self.poses, self.poses[1:], arc_angles))

    @property
    def length(self) -> float:
        """Length of the path of the robot's centre [m]."""
        return sum(segment.length for segment in self.segments)


class Waypoint(NamedTuple):
    """
    End of a segment of a path, before its headings are known.

    :param x: [m].
    :param y: [m].
    :param arc_angle: of the segment that leads there [rad].
    """

    x: float
    y: float
    arc_angle: float = 0.0


def sample_path(path: Path, robot: RoundRobot, spacing: float) -> FloatArray:
    """
    Sample a path densely.

    :param robot: the ``RoundRobot``, whose rim counts in rotations.
    :param spacing: largest distance between samples [m], above 0.
    :return: poses (x, y, theta), shape (n, 3), start and goal included.
    """
    if not (math.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f'spacing: got {spacing!r}, expected a finite distance above 0 [m]')
    rows = [np.array([path.poses[0]])]
    for segment in path.segments:
        swept = max(segment.length, robot.radius * abs(segment.heading_change))
        count = max(1, math.ceil(swept / spacing))
        rows += [segment.poses(np.arange(1, count) / count), np.array([segment.end])]
    return np.concatenate(rows)


def differential_path(start: Pose, goal: Pose, waypoints: Iterable[tuple[float, float, float]],
                      backwards: Iterable[bool]) -> Path:
    """
    Lead a differential drive along waypoints; where they make corners, it rotates in place.

    :param waypoints: ``Waypoint`` sequence, from behind the start to the goal.
    :param backwards: for each segment, whether the robot moves backwards.
    """
    poses: list[Pose] = [start]
    arc_angles: list[float] = []
    for (x, y, arc_angle), is_backwards in zip(waypoints, backwards):
        segment = PathSegment(poses[-1], Pose(x, y, 0.0), arc_angle)
        if not segment.length:
            continue
        reversal = math.pi if is_backwards else 0.0
        first, last = (direction + reversal for direction in segment.directions)
        _rotate_to(poses, arc_angles, first)
        before = poses[-1].theta
        poses.append(Pose(x, y, before + wrap_angle(last - before)))
        arc_angles.append(arc_angle)
    return _completed(poses, arc_angles, goal)


def holonomic_path(start: Pose, goal: Pose, waypoints: Sequence[tuple[float, float, float]],
                   keeps_heading: tuple[bool, bool] = (False, False)) -> Path:
    """
    Lead a holonomic base along waypoints; its heading changes evenly along the path.

    :param waypoints: ``Waypoint`` sequence, from behind the start to the goal.
    :param keeps_heading: whether the heading stays on the first segment, and on the last.
    """
    points = [start, *(Pose(x, y, 0.0) for x, y, _ in waypoints)]
    arc_angles = [arc_angle for _, _, arc_angle in waypoints]
    lengths = [PathSegment(*ends).length for ends in zip(points, points[1:], arc_angles)]
    # The rotation is spread over these lengths.
    rotating = list(lengths)
    for end, keeps in zip((0, -1), keeps_heading):
        if keeps:
            rotating[end] = 0.0
    total, heading_change = sum(rotating), wrap_angle(goal.theta - start.theta)
    poses, passed = [start], 0.0
    for point, length, part in zip(points[1:], lengths, rotating):
        passed += part
        if length:
            fraction = passed / total if total else 0.0
            poses.append(point._replace(theta=start.theta + fraction * heading_change))
    arc_angles = [arc_angle for arc_angle, length in zip(arc_angles, lengths) if length]
    return _completed(poses, arc_angles, goal)


def _completed(poses: list[Pose], arc_angles: list[float], goal: Pose) -> Path:
    """Rotate to the heading of the goal, and end exactly there."""
    _rotate_to(poses, arc_angles, goal.theta)
    if len(poses) == 1:
        poses.append(goal)
        arc_angles.append(0.0)
    poses[-1] = goal
    return Path(tuple(poses), tuple(arc_angles))


def _rotate_to(poses: list[Pose], arc_angles: list[float], heading: float) -> None:
    """Append a rotation in place, where one is needed."""
    heading_change = wrap_angle(heading - poses[-1].theta)
    if abs(heading_change) > MIN_ROTATION:
        poses.append(poses[-1]._replace(theta=poses[-1].theta + heading_change))
        arc_angles.append(0.0)
