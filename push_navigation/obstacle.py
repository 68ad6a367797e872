"""The object's outline grown by a distance, as an obstacle to the centre of the robot."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import closest_on_polygon, wrap_angle

ON_IT = 1e-6


class VisibilityCone(NamedTuple):
    """
    What an obstacle hides from a point: angles, and where the outermost rays touch.

    :param right: angle of the ray that passes it on its right [rad].
    :param right_index: number of the vertex that it passes.
    :param left: angle of the ray that passes it on its left [rad].
    :param left_index: number of the vertex that it passes.
    """

    right: float
    right_index: int
    left: float
    left_index: int

    def occludes(self, angle):
        """
        Tell whether a ray meets the obstacle.

        :param angle: of the ray [rad].
        """
        width = self.left - self.right
        return abs(wrap_angle(angle - self.right - 0.5 * width)) < 0.5 * width - 1e-6


class InflatedObstacle(NamedTuple):
    """
    All points nearer than a radius to a convex core, in the object frame.

    :param core: vertices, counter-clockwise, (x, y) [m]; a single point for a disc.
    :param radius: of the growth, that of a disc-shaped object included [m].
    :param center: a point inside (x, y) [m].
    """

    core: tuple
    radius: float
    center: tuple

    def nearest(self, x, y):
        """
        Find the way out to the surface.

        :param x: a point, x [m].
        :param y: the same, y [m].
        :return: distance from the surface [m], negative inside, and the outward direction [rad].
        """
        if len(self.core) == 1:
            away = math.hypot(x, y)
            return away - self.radius, math.atan2(y, x)
        _, _, n_x, n_y, away, _, _ = closest_on_polygon(self.core, x, y)
        return away - self.radius, math.atan2(-n_y, -n_x)

    def distances(self, points):
        """
        Distance of points from the surface.

        :param points: (x, y), shape (n, 2) [m].
        :return: distances [m], negative inside, shape (n,).
        """
        x, y = np.asarray(points, dtype=float).T
        away, inside = np.full(len(x), np.inf), np.ones(len(x), dtype=bool)
        for (x0, y0), (x1, y1) in zip(self.core, self.core[1:] + self.core[:1]):
            along, across = x1 - x0, y1 - y0
            square = along * along + across * across
            ahead = (x - x0) * along + (y - y0) * across
            share = np.clip(ahead / square, 0.0, 1.0) if square else 0.0
            away = np.minimum(away, np.hypot(x - x0 - share * along, y - y0 - share * across))
            inside &= along * (y - y0) - across * (x - x0) > 0.0
        return np.where(inside, -away, away) - self.radius

    def cone(self, x, y):
        """
        Find the rays from a point that just pass.

        :param x: the point, not inside, x [m].
        :param y: the same, y [m].
        :return: ``VisibilityCone``.
        """
        ahead = math.atan2(self.center[1] - y, self.center[0] - x)
        right, left, right_index, left_index = math.inf, -math.inf, 0, 0
        for i, (v_x, v_y) in enumerate(self.core):
            angle = wrap_angle(math.atan2(v_y - y, v_x - x) - ahead)
            away = math.hypot(v_x - x, v_y - y)
            # On the surface the root in the arcsine would make much of rounding.
            half = math.asin(self.radius / away) if away > self.radius + ON_IT else 0.5 * math.pi
            if angle - half < right:
                right, right_index = angle - half, i
            if angle + half > left:
                left, left_index = angle + half, i
        return VisibilityCone(ahead + right, right_index, ahead + left, left_index)

    def ray_exit(self, x, y, direction):
        """
        Find where a ray from inside leaves.

        :param x: the point, x [m].
        :param y: the same, y [m].
        :param direction: of the ray, away from the core [rad].
        :return: way to the surface [m].
        """
        c, s = math.cos(direction), math.sin(direction)
        way = 0.0
        # Newton's method: the distance is convex along the ray, and rises.
        for _ in range(20):
            depth, outward = self.nearest(x + way * c, y + way * s)
            if abs(depth) < 1e-13:
                break
            way -= depth / max(0.1, math.cos(direction - outward))
        return way


@functools.lru_cache(maxsize=64)
def inflate(outline, object_radius, growth):
    """
    Grow an outline.

    :param outline: vertices of a polygon, counter-clockwise; empty for a disc.
    :param object_radius: of a disc [m].
    :param growth: by how much [m].
    :return: ``InflatedObstacle``.
    """
    core = outline or ((0.0, 0.0),)
    center = tuple(sum(values) / len(core) for values in zip(*core))
    return InflatedObstacle(core, object_radius + growth, center)
