"""Ways of the robot on its own: poses one after the other."""

import math
from typing import NamedTuple

import numpy as np
from push_drive.leg import Leg
from push_drive.pace import total_time
from push_model.geometry import Pose, wrap_angle

NO_TURN = 1e-3


class Way(NamedTuple):
    """
    From pose to pose along lines, arcs and turns on the spot.

    Between two poses at different places the heading turns evenly; two poses at the same place
    are a turn on the spot. A differential drive goes along its heading, or backwards.

    :param poses: ``Pose`` sequence, start and goal included.
    :param bends: of each leg, one less than poses: change of the direction of motion on it [rad];
        empty where all legs are straight.
    """

    poses: tuple
    bends: tuple = ()

    @property
    def legs(self):
        """``Leg`` between each two poses."""
        bends = self.bends or (0.0,) * (len(self.poses) - 1)
        return tuple(Leg(*ends) for ends in zip(self.poses, self.poses[1:], bends))

    @property
    def length(self):
        """Length of the way of the robot's centre [m]."""
        return sum(leg.length for leg in self.legs)


def travel_time(way, robot, settings):
    """
    Time that a robot takes for a way, from rest to rest [s].

    :param way: the ``Way``.
    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    """
    return total_time(way.legs, settings.capped(robot), robot.time_constant)


def sampled(way, robot, spacing):
    """
    Sample a way densely.

    :param way: the ``Way``.
    :param robot: the ``RoundRobot``, whose rim counts in turns.
    :param spacing: largest distance between samples [m], above 0.
    :return: poses (x, y, theta), shape (n, 3), start and goal included.
    """
    if not (math.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f'spacing: got {spacing!r}, expected a finite distance above 0 [m]')
    rows = [np.array([way.poses[0]])]
    for leg in way.legs:
        swept = max(leg.length, robot.radius * abs(leg.turn))
        count = max(1, math.ceil(swept / spacing))
        rows += [leg.poses(np.arange(1, count) / count), np.array([leg.end])]
    return np.concatenate(rows)


def driven_way(start, goal, track, backwards):
    """
    Lead a differential drive along a track: it turns on the spot where the track has corners.

    :param start: ``Pose``.
    :param goal: ``Pose``.
    :param track: (x, y, bend of the leg that leads there [rad]) sequence, from behind the start
        to the goal.
    :param backwards: for each leg, whether the robot goes backwards.
    :return: ``Way``.
    """
    poses, bends = [start], []
    for (x, y, bend), back in zip(track, backwards):
        here = poses[-1]
        leg = Leg(here, Pose(x, y, 0.0), bend)
        if not leg.length:
            continue
        first, last = (angle + math.pi * back for angle in leg.directions)
        _turn_to(poses, bends, first)
        before = poses[-1].theta
        poses.append(Pose(x, y, before + wrap_angle(last - before)))
        bends.append(bend)
    return _ended(poses, bends, goal)


def turned_way(start, goal, track, kept=(False, False)):
    """
    Lead a holonomic base along a track: it turns evenly all the way.

    :param start: ``Pose``.
    :param goal: ``Pose``.
    :param track: (x, y, bend of the leg that leads there [rad]) sequence, from behind the start
        to the goal.
    :param kept: whether the heading stays on the first leg, and on the last.
    :return: ``Way``.
    """
    places = [start, *(Pose(x, y, 0.0) for x, y, _ in track)]
    bends = [bend for _, _, bend in track]
    lengths = [Leg(*ends).length for ends in zip(places, places[1:], bends)]
    counted = list(lengths)
    for number, is_kept in zip((0, -1), kept):
        if is_kept:
            counted[number] = 0.0
    total, turn = sum(counted), wrap_angle(goal.theta - start.theta)
    poses, passed = [start], 0.0
    for place, length, counts in zip(places[1:], lengths, counted):
        passed += counts
        if length:
            share = passed / total if total else 0.0
            poses.append(place._replace(theta=start.theta + share * turn))
    bends = [bend for bend, length in zip(bends, lengths) if length]
    return _ended(poses, bends, goal)


def _ended(poses, bends, goal):
    _turn_to(poses, bends, goal.theta)
    if len(poses) == 1:
        poses.append(goal)
        bends.append(0.0)
    poses[-1] = goal
    return Way(tuple(poses), tuple(bends))


def _turn_to(poses, bends, heading):
    turn = wrap_angle(heading - poses[-1].theta)
    if abs(turn) > NO_TURN:
        poses.append(poses[-1]._replace(theta=poses[-1].theta + turn))
        bends.append(0.0)
