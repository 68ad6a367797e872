"""
Outline of the object, inflated: an obstacle to the centre of the robot.

All points nearer than a radius to the outline are a Minkowski sum of outline and disc, so that
distances and tangents to it are those to the outline, or to one of its vertices, less the radius.
"""

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from push_model.geometry import boundary_point, FloatArray, wrap_angle
from push_model.parameters import Outline

# A point is taken to be on the surface within this distance: far above rounding, far below a
# clearance [m].
SURFACE_TOLERANCE = 1e-6
# A ray that touches the surface does not meet it, rounding included [rad].
GRAZING_ANGLE = 1e-6


class VisibilityCone(NamedTuple):
    """
    Directions in which an obstacle occludes the view from a point, and where the cone touches it.

    :param right: angle of the ray that passes it on its right [rad].
    :param right_index: number of the vertex that it passes.
    :param left: angle of the ray that passes it on its left [rad].
    :param left_index: number of the vertex that it passes.
    """

    right: float
    right_index: int
    left: float
    left_index: int

    def occludes(self, angle: float) -> bool:
        """
        Tell whether a ray meets the obstacle.

        :param angle: of the ray [rad].
        """
        width = self.left - self.right
        return abs(wrap_angle(angle - self.right - 0.5 * width)) < 0.5 * width - GRAZING_ANGLE


class InflatedObstacle(NamedTuple):
    """
    Set of points nearer than a radius to a convex core, in the object frame.

    :param core: vertices, counter-clockwise, (x, y) [m]; a single point for a disc.
    :param radius: of the inflation, that of a disc-shaped object included [m].
    :param center: a point inside (x, y) [m].
    """

    core: Outline
    radius: float
    center: tuple[float, float]

    def nearest(self, x: float, y: float) -> tuple[float, float]:
        """
        Find the shortest line to the surface.

        :param x: of a point [m].
        :param y: of a point [m].
        :return: distance from the surface [m], negative inside, and the outward direction [rad].
        """
        if len(self.core) == 1:
            away = math.hypot(x, y)
            return away - self.radius, math.atan2(y, x)
        closest = boundary_point(self.core, x, y)
        outward = math.atan2(-closest.normal_y, -closest.normal_x)
        return closest.signed_distance - self.radius, outward

    def distances(self, points: ArrayLike) -> FloatArray:
        """
        Distance of points from the surface.

        :param points: (x, y), shape (n, 2) [m].
        :return: distances [m], negative inside, shape (n,).
        """
        x, y = np.asarray(points, dtype=float).T
        away, inside = np.full(len(x), np.inf), np.ones(len(x), dtype=bool)
        for (x0, y0), (x1, y1) in zip(self.core, self.core[1:] + self.core[:1]):
            edge_x, edge_y = x1 - x0, y1 - y0
            length_squared = edge_x * edge_x + edge_y * edge_y
            projection = (x - x0) * edge_x + (y - y0) * edge_y
            fraction = np.clip(projection / length_squared, 0.0, 1.0) if length_squared else 0.0
            away = np.minimum(away, np.hypot(x - x0 - fraction * edge_x,
                                             y - y0 - fraction * edge_y))
            inside &= edge_x * (y - y0) - edge_y * (x - x0) > 0.0
        return np.where(inside, -away, away) - self.radius

    def cone(self, x: float, y: float) -> VisibilityCone:
        """
        Find the tangents to the obstacle from a point.

        :param x: of the point, which is not inside [m].
        :param y: of the point [m].
        """
        bearing = math.atan2(self.center[1] - y, self.center[0] - x)
        right, left, right_index, left_index = math.inf, -math.inf, 0, 0
        for i, (v_x, v_y) in enumerate(self.core):
            angle = wrap_angle(math.atan2(v_y - y, v_x - x) - bearing)
            away = math.hypot(v_x - x, v_y - y)
            # On the surface the root in the arcsine would magnify rounding.
            on_surface = away <= self.radius + SURFACE_TOLERANCE
            half = 0.5 * math.pi if on_surface else math.asin(self.radius / away)
            if angle - half < right:
                right, right_index = angle - half, i
            if angle + half > left:
                left, left_index = angle + half, i
        return VisibilityCone(bearing + right, right_index, bearing + left, left_index)

    def ray_exit(self, x: float, y: float, direction: float) -> float:
        """
        Find where a ray from inside leaves.

        :param x: of the point [m].
        :param y: of the point [m].
        :param direction: of the ray, away from the core [rad].
        :return: length of the ray to the surface [m].
        """
        c, s = math.cos(direction), math.sin(direction)
        length = 0.0
        # Newton's method: the distance is convex along the ray, and rises.
        for _ in range(20):
            depth, outward = self.nearest(x + length * c, y + length * s)
            if abs(depth) < 1e-13:
                break
            length -= depth / max(0.1, math.cos(direction - outward))
        return length


# The few objects of a task, each with the few margins that planner and controller use.
@functools.lru_cache(maxsize=64)
def inflate(outline: Outline, object_radius: float, margin: float) -> InflatedObstacle:
    """
    Inflate an outline.

    :param outline: vertices of a polygon, counter-clockwise; empty for a disc.
    :param object_radius: of a disc [m].
    :param margin: distance by which it grows [m].
    """
    core = outline or ((0.0, 0.0),)
    count = len(core)
    center = sum(x for x, _ in core) / count, sum(y for _, y in core) / count
    return InflatedObstacle(core, object_radius + margin, center)


def points_on_outline(outline: Outline, spacing: float) -> FloatArray:
    """
    Sample the outline of a polygon evenly, edge by edge.

    :param outline: vertices (x, y) [m].
    :param spacing: distance of neighbouring points, at most [m].
    :return: points, all vertices among them, shape (n, 2) [m].
    """
    vertices = np.array(outline, dtype=float)
    edges = np.roll(vertices, -1, axis=0) - vertices
    points: list[FloatArray] = []
    for vertex, edge in zip(vertices, edges):
        count = math.ceil(float(np.linalg.norm(edge)) / spacing)
        # Without the end of the edge, at which the next one begins.
        points.append(vertex + edge * np.linspace(0.0, 1.0, 1 + count)[:-1, None])
    return np.concatenate(points)
