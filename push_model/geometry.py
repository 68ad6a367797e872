"""
Geometry of the plane: poses in SE(2), angles, and points of convex polygons.

The functions on polygons are plain scalar code, which the kernel of the simulation compiles as it
stands.
"""

from collections.abc import Sequence
import math
from typing import Any, NamedTuple, TypeAlias, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
BoolArray: TypeAlias = NDArray[np.bool_]
IntArray: TypeAlias = NDArray[np.int_]
# The coordinates (x, y) of a point, or of a pose, which has a third one.
Coordinates: TypeAlias = Union[Sequence[float], FloatArray]
# Angles, a number or an array of any shape [rad].
Angles = TypeVar('Angles', float, FloatArray)
Polygon: TypeAlias = Sequence[tuple[float, float]]


class Pose(NamedTuple):
    """Position (x, y) [m] and orientation theta [rad] of a frame in another frame."""

    x: float
    y: float
    theta: float

    def __matmul__(self, other: 'Pose') -> 'Pose':
        """
        Compose two poses, ``T_AC = T_AB @ T_BC``.

        :param other: pose of C in B.
        :return: pose of C in A.
        """
        x, y = self.transform((other.x, other.y))
        return Pose(x, y, self.theta + other.theta)

    def inverse(self) -> 'Pose':
        """Return the pose of the outer frame in this one."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        return Pose(-c * self.x - s * self.y, s * self.x - c * self.y, -self.theta)

    def transform(self, point: Coordinates) -> tuple[float, float]:
        """
        Transform a point from this frame to the outer frame.

        :param point: (x, y) in this frame [m].
        :return: (x, y) in the outer frame [m].
        """
        x, y = self.rotate(point)
        return self.x + x, self.y + y

    def rotate(self, vector: Coordinates) -> tuple[float, float]:
        """
        Rotate a vector from this frame to the outer frame.

        :param vector: (x, y) in this frame.
        :return: (x, y) in the outer frame, same unit.
        """
        c, s = math.cos(self.theta), math.sin(self.theta)
        return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]

    def is_finite(self) -> bool:
        """Tell whether all three numbers are finite."""
        return math.isfinite(self.x) and math.isfinite(self.y) and math.isfinite(self.theta)


def wrap_angle(angle: float) -> float:
    """
    Wrap an angle to [-pi, pi].

    :param angle: any finite angle [rad].
    """
    return math.remainder(angle, 2 * math.pi)


def wrap_angles(angles: Angles) -> Angles:
    """
    Wrap a number or an array of them to [-pi, pi), in arithmetic that can be compiled.

    :param angles: any finite angles [rad].
    """
    wrapped: Any = angles - 2.0 * math.pi * np.floor((angles + math.pi) / (2.0 * math.pi))
    return wrapped


def distance(a: Coordinates, b: Coordinates) -> float:
    """
    Distance between two points, or between the origins of two poses [m].

    :param a: a pose or (x, y).
    :param b: a pose or (x, y).
    """
    return math.hypot(a[0] - b[0], a[1] - b[1])


def convex_hull(points: Sequence[Coordinates]) -> list[tuple[float, float]]:
    """
    Find the convex hull of points, by Andrew's monotone chain.

    :param points: (x, y) each [m], at least one.
    :return: vertices, counter-clockwise, without any on a straight edge.
    """
    ordered = sorted({(float(point[0]), float(point[1])) for point in points})
    hull: list[tuple[float, float]] = []
    for side in (ordered, ordered[::-1]):
        half: list[tuple[float, float]] = []
        for x, y in side:
            while len(half) > 1:
                (x_0, y_0), (x_1, y_1) = half[-2:]
                if (x_1 - x_0) * (y - y_0) - (y_1 - y_0) * (x - x_0) > 0.0:
                    break
                half.pop()
            half.append((x, y))
        hull += half[:-1]
    return hull or ordered


class BoundaryPoint(NamedTuple):
    """
    The point on the boundary of a convex polygon that is closest to a given point.

    :param x: of the closest point [m].
    :param y: of the closest point [m].
    :param normal_x: of the unit normal into the polygon there.
    :param normal_y: of the unit normal into the polygon there.
    :param signed_distance: from the given point, negative where that is inside [m].
    :param face: number of the face that the closest point lies on.
    :param fraction: of the face from its first vertex, 0 to 1.
    """

    x: float
    y: float
    normal_x: float
    normal_y: float
    signed_distance: float
    face: int
    fraction: float


def boundary_point(outline: Polygon, x: float, y: float) -> BoundaryPoint:
    """
    Find the point on the boundary of a convex polygon that is closest to a given point.

    :param outline: vertices, counter-clockwise, shape (k, 2) [m].
    :param x: of the given point [m].
    :param y: of the given point [m].
    """
    return BoundaryPoint(*closest_on_polygon(outline, x, y))


def closest_on_polygon(
        outline: Polygon, x: float, y: float,
) -> tuple[float, float, float, float, float, int, float]:
    """
    Find the same as ``boundary_point``, in a form that the kernel can be compiled from.

    :param outline: vertices, counter-clockwise, shape (k, 2) [m].
    :param x: of the given point [m].
    :param y: of the given point [m].
    :return: the fields of ``BoundaryPoint``.
    """
    best, face, along = math.inf, 0, 0.0
    closest_x, closest_y = 0.0, 0.0
    inside = True
    count = len(outline)
    for i in range(count):
        x0, y0 = outline[i]
        x1, y1 = outline[(i + 1) % count]
        ex, ey = x1 - x0, y1 - y0
        if ex * (y - y0) - ey * (x - x0) < 0.0:
            inside = False
        u = ((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey)
        u = min(1.0, max(0.0, u))
        px, py = x0 + u * ex, y0 + u * ey
        squared = (px - x) * (px - x) + (py - y) * (py - y)
        if squared < best:
            best, face, along, closest_x, closest_y = squared, i, u, px, py
    away = math.sqrt(best)
    sign = -1.0 if inside else 1.0
    # Outside a corner the normal points to the point itself, unless rounding decides (1 nm).
    if away > 1e-9 and (along == 0.0 or along == 1.0):
        nx, ny = sign * (closest_x - x) / away, sign * (closest_y - y) / away
        return closest_x, closest_y, nx, ny, sign * away, face, along
    # The normal of the face is exact however near the point is: a point robot needs that.
    x0, y0 = outline[face]
    x1, y1 = outline[(face + 1) % count]
    length = math.hypot(x1 - x0, y1 - y0)
    return closest_x, closest_y, (y0 - y1) / length, (x1 - x0) / length, sign * away, face, along


def lowest_vertex(outline: Polygon, n_x: float, n_y: float) -> int:
    """
    Find the vertex that lies lowest along a direction.

    :param outline: vertices, shape (k, 2) [m].
    :param n_x: of the direction.
    :param n_y: of the direction.
    :return: number of the vertex.
    """
    lowest_index, lowest = 0, math.inf
    for i in range(len(outline)):
        height = n_x * outline[i][0] + n_y * outline[i][1]
        if height < lowest:
            lowest_index, lowest = i, height
    return lowest_index
