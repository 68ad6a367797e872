"""Rigid motions of the plane, SE(2)."""

import math
from typing import NamedTuple


class Pose(NamedTuple):
    """Position (x, y) [m] and orientation theta [rad] of a frame in another frame."""

    x: float
    y: float
    theta: float

    def __matmul__(self, other):
        """
        Compose two poses, ``T_AC = T_AB @ T_BC``.

        :param other: pose of C in B.
        :return: pose of C in A.
        """
        x, y = self.transform((other.x, other.y))
        return Pose(x, y, self.theta + other.theta)

    def inverse(self):
        """Return the pose of the outer frame in this one."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        return Pose(-c * self.x - s * self.y, s * self.x - c * self.y, -self.theta)

    def transform(self, point):
        """
        Map a point from this frame to the outer frame.

        :param point: (x, y) in this frame [m].
        :return: (x, y) in the outer frame [m].
        """
        x, y = self.rotate(point)
        return self.x + x, self.y + y

    def rotate(self, vector):
        """
        Turn a vector from this frame into the outer frame.

        :param vector: (x, y) in this frame.
        :return: (x, y) in the outer frame, same unit.
        """
        c, s = math.cos(self.theta), math.sin(self.theta)
        return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]

    def is_finite(self):
        """Tell whether all three numbers are finite."""
        return all(math.isfinite(value) for value in self)


def wrap_angle(angle):
    """
    Bring an angle into [-pi, pi].

    :param angle: any finite angle [rad].
    """
    return math.remainder(angle, 2 * math.pi)


def distance(a, b):
    """
    Distance between the origins of two poses, or between two points [m].

    :param a: a pose or (x, y).
    :param b: a pose or (x, y).
    """
    return math.hypot(a[0] - b[0], a[1] - b[1])
