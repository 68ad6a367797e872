"""Ways of the robot on its own: poses one after the other."""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_navigation.speed_profile import total_time

NO_LENGTH = 1e-6


class PathSegment(NamedTuple):
    """
    The motion from one pose to the next, along a circle and with an even turn.

    :param start: ``Pose`` at its beginning.
    :param end: ``Pose`` at its end.
    :param arc_angle: change of the direction of motion, positive to the left, 0 on a straight line
        [rad], below a full turn.
    """

    start: Pose
    end: Pose
    arc_angle: float = 0.0

    @property
    def length(self):
        """Length of the way of the robot's centre [m]; 0 for a turn on the spot."""
        chord, half = distance(self.start, self.end), 0.5 * self.arc_angle
        if chord < NO_LENGTH:
            return 0.0
        return chord * half / math.sin(half) if abs(half) > 1e-9 else chord

    @property
    def heading_change(self):
        """Change of the robot's heading, the short way round [rad]."""
        return wrap_angle(self.end.theta - self.start.theta)

    @property
    def directions(self):
        """Directions of motion at the beginning and at the end [rad]."""
        chord = math.atan2(self.end.y - self.start.y, self.end.x - self.start.x)
        return chord - 0.5 * self.arc_angle, chord + 0.5 * self.arc_angle

    def direction(self, way):
        """
        Direction of motion after a way [rad].

        :param way: from the beginning of a leg that has a length [m].
        """
        return self.directions[0] + self.arc_angle * way / self.length

    def heading(self, way):
        """
        Heading of the robot after a way [rad].

        :param way: from the beginning of a leg that has a length [m].
        """
        return self.start.theta + self.heading_change * way / self.length

    def poses(self, shares):
        """
        Find poses along the leg.

        :param shares: of the leg, 0 at its beginning and 1 at its end, shape (n,).
        :return: (x, y, theta), shape (n, 3).
        """
        half = 0.5 * self.arc_angle * shares
        chord = self.length * shares * np.sinc(half / np.pi)
        toward = self.directions[0] + half
        return np.stack((self.start.x + chord * np.cos(toward),
                         self.start.y + chord * np.sin(toward),
                         self.start.theta + shares * self.heading_change), axis=1)

    def project(self, point):
        """
        Find how far along the leg a point is, and how far beside it.

        :param point: (x, y) [m], near the leg.
        :return: (way from the beginning [m], below 0 or above the length outside; distance to
            the left [m]).
        """
        first = self.directions[0]
        ahead, aside = Pose(0.0, 0.0, -first).rotate((point[0] - self.start.x,
                                                      point[1] - self.start.y))
        if abs(self.arc_angle) < 1e-9:
            return ahead, aside
        radius = self.length / self.arc_angle
        side = math.copysign(1.0, radius)
        middle = 0.5 * self.arc_angle
        angle = middle + wrap_angle(side * math.atan2(ahead, side * (radius - aside)) - middle)
        return radius * angle, radius - side * math.hypot(ahead, radius - aside)


NO_TURN = 1e-3


class Path(NamedTuple):
    """
    From pose to pose along lines, arcs and turns on the spot.

    Between two poses at different places the heading turns evenly; two poses at the same place
    are a turn on the spot. A differential drive goes along its heading, or backwards.

    :param poses: ``Pose`` sequence, start and goal included.
    :param arc_angles: of each leg, one less than poses: change of the direction of motion on it [rad];
        empty where all legs are straight.
    """

    poses: tuple
    arc_angles: tuple = ()

    @property
    def segments(self):
        """``PathSegment`` between each two poses."""
        arc_angles = self.arc_angles or (0.0,) * (len(self.poses) - 1)
        return tuple(PathSegment(*ends) for ends in zip(self.poses, self.poses[1:], arc_angles))

    @property
    def length(self):
        """Length of the way of the robot's centre [m]."""
        return sum(segment.length for segment in self.segments)


def travel_time(way, robot, settings):
    """
    Time that a robot takes for a way, from rest to rest [s].

    :param way: the ``Path``.
    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    """
    return total_time(way.segments, settings.limited_to(robot), robot.time_constant)


def sample_path(way, robot, spacing):
    """
    Sample a way densely.

    :param way: the ``Path``.
    :param robot: the ``RoundRobot``, whose rim counts in turns.
    :param spacing: largest distance between samples [m], above 0.
    :return: poses (x, y, theta), shape (n, 3), start and goal included.
    """
    if not (math.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f'spacing: got {spacing!r}, expected a finite distance above 0 [m]')
    rows = [np.array([way.poses[0]])]
    for segment in way.segments:
        swept = max(segment.length, robot.radius * abs(segment.heading_change))
        count = max(1, math.ceil(swept / spacing))
        rows += [segment.poses(np.arange(1, count) / count), np.array([segment.end])]
    return np.concatenate(rows)


def differential_path(start, goal, waypoints, backwards):
    """
    Lead a differential drive along a track: it turns on the spot where the track has corners.

    :param start: ``Pose``.
    :param goal: ``Pose``.
    :param waypoints: (x, y, bend of the leg that leads there [rad]) sequence, from behind the start
        to the goal.
    :param backwards: for each leg, whether the robot goes backwards.
    :return: ``Path``.
    """
    poses, arc_angles = [start], []
    for (x, y, arc_angle), back in zip(waypoints, backwards):
        here = poses[-1]
        segment = PathSegment(here, Pose(x, y, 0.0), arc_angle)
        if not segment.length:
            continue
        first, last = (angle + math.pi * back for angle in segment.directions)
        _turn_to(poses, arc_angles, first)
        before = poses[-1].theta
        poses.append(Pose(x, y, before + wrap_angle(last - before)))
        arc_angles.append(arc_angle)
    return _ended(poses, arc_angles, goal)


def holonomic_path(start, goal, waypoints, kept=(False, False)):
    """
    Lead a holonomic base along a track: it turns evenly all the way.

    :param start: ``Pose``.
    :param goal: ``Pose``.
    :param waypoints: (x, y, bend of the leg that leads there [rad]) sequence, from behind the start
        to the goal.
    :param kept: whether the heading stays on the first leg, and on the last.
    :return: ``Path``.
    """
    places = [start, *(Pose(x, y, 0.0) for x, y, _ in waypoints)]
    arc_angles = [arc_angle for _, _, arc_angle in waypoints]
    lengths = [PathSegment(*ends).length for ends in zip(places, places[1:], arc_angles)]
    counted = list(lengths)
    for number, is_kept in zip((0, -1), kept):
        if is_kept:
            counted[number] = 0.0
    total, heading_change = sum(counted), wrap_angle(goal.theta - start.theta)
    poses, passed = [start], 0.0
    for place, length, counts in zip(places[1:], lengths, counted):
        passed += counts
        if length:
            share = passed / total if total else 0.0
            poses.append(place._replace(theta=start.theta + share * heading_change))
    arc_angles = [arc_angle for arc_angle, length in zip(arc_angles, lengths) if length]
    return _ended(poses, arc_angles, goal)


def _ended(poses, arc_angles, goal):
    _turn_to(poses, arc_angles, goal.theta)
    if len(poses) == 1:
        poses.append(goal)
        arc_angles.append(0.0)
    poses[-1] = goal
    return Path(tuple(poses), tuple(arc_angles))


def _turn_to(poses, arc_angles, heading):
    heading_change = wrap_angle(heading - poses[-1].theta)
    if abs(heading_change) > NO_TURN:
        poses.append(poses[-1]._replace(theta=poses[-1].theta + heading_change))
        arc_angles.append(0.0)
