"""One piece of a way: straight, an arc, or a turn on the spot."""

import math
from typing import NamedTuple

from push_model.geometry import distance, Pose, wrap_angle

NO_LENGTH = 1e-9


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

    def at(self, way):
        """
        Find the pose after a way; outside the leg it goes on evenly.

        :param way: from the beginning [m].
        :return: (``Pose``, direction of motion [rad]).
        """
        length = self.length
        share = way / length if length else 1.0
        bend = share * self.bend
        first = self.directions[0]
        half = 0.5 * bend
        chord = way * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        return Pose(self.start.x + chord * math.cos(first + half),
                    self.start.y + chord * math.sin(first + half),
                    self.start.theta + share * self.turn), first + bend

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
