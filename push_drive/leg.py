"""One piece of a way: straight, an arc, or a turn on the spot."""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle

NO_LENGTH = 1e-6


class Leg(NamedTuple):
    """
    The motion from one pose to the next, along a circle and with an even turn.

    :param start: ``Pose`` at its beginning.
    :param end: ``Pose`` at its end.
    :param bend: change of the direction of motion, positive to the left, 0 on a straight line
        [rad], below a full turn.
    """

    start: Pose
    end: Pose
    bend: float = 0.0

    @property
    def length(self):
        """Length of the way of the robot's centre [m]; 0 for a turn on the spot."""
        chord, half = distance(self.start, self.end), 0.5 * self.bend
        if chord < NO_LENGTH:
            return 0.0
        return chord * half / math.sin(half) if abs(half) > 1e-9 else chord

    @property
    def turn(self):
        """Change of the robot's heading, the short way round [rad]."""
        return wrap_angle(self.end.theta - self.start.theta)

    @property
    def directions(self):
        """Directions of motion at the beginning and at the end [rad]."""
        chord = math.atan2(self.end.y - self.start.y, self.end.x - self.start.x)
        return chord - 0.5 * self.bend, chord + 0.5 * self.bend

    def direction(self, way):
        """
        Direction of motion after a way [rad].

        :param way: from the beginning of a leg that has a length [m].
        """
        return self.directions[0] + self.bend * way / self.length

    def heading(self, way):
        """
        Heading of the robot after a way [rad].

        :param way: from the beginning of a leg that has a length [m].
        """
        return self.start.theta + self.turn * way / self.length

    def poses(self, shares):
        """
        Find poses along the leg.

        :param shares: of the leg, 0 at its beginning and 1 at its end, shape (n,).
        :return: (x, y, theta), shape (n, 3).
        """
        half = 0.5 * self.bend * shares
        chord = self.length * shares * np.sinc(half / np.pi)
        toward = self.directions[0] + half
        return np.stack((self.start.x + chord * np.cos(toward),
                         self.start.y + chord * np.sin(toward),
                         self.start.theta + shares * self.turn), axis=1)

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
        if abs(self.bend) < 1e-9:
            return ahead, aside
        radius = self.length / self.bend
        side = math.copysign(1.0, radius)
        middle = 0.5 * self.bend
        angle = middle + wrap_angle(side * math.atan2(ahead, side * (radius - aside)) - middle)
        return radius * angle, radius - side * math.hypot(ahead, radius - aside)
