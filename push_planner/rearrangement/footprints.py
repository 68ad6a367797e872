"""Distances of points from the footprint of an object, and of footprints from each other."""

import math
from typing import Any

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_navigation.obstacle import points_on_outline
from push_navigation.occupancy_map import footprint

# Spacing of points on an outline [m]; chosen: gaps of polygons are exact at vertices, so that
# nothing is missed.
OUTLINE_SPACING = 0.02


def placed_points(points: FloatArray, pose: Pose) -> FloatArray:
    """
    Transform points of the object frame.

    :param points: shape (n, 2) [m].
    :param pose: ``Pose`` of the object.
    :return: shape (n, 2) [m].
    """
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def distances_to_object(points: FloatArray, obj: PushedObject, pose: Pose) -> FloatArray:
    """
    Measure the distances of points from an object.

    :param points: shape (n, 2), in the frame of the pose [m].
    :return: shape (n,) [m], negative inside.
    """
    vertices, radius = footprint(obj)
    distances = np.empty(len(points))
    _measure(np.ascontiguousarray(points), pose, vertices, radius, distances)
    return distances


def object_gap(first: PushedObject, first_pose: Pose, second: PushedObject,
               second_pose: Pose) -> float:
    """
    Measure the gap between two objects [m]; negative where they overlap.

    :param first_pose: in the frame of ``second_pose``.
    """
    return min(_gap_of_outline(first, first_pose, second, second_pose),
               _gap_of_outline(second, second_pose, first, first_pose))


def faces_of(obj: PushedObject, count: int) -> tuple[FloatArray, FloatArray]:
    """
    List middles of faces and their outward normals.

    :param count: of points on a round outline.
    :return: points and normals in the object frame, shape (n, 2) each.
    """
    vertices, radius = footprint(obj)
    if len(vertices) == 1:
        angles = np.arange(count) * (2.0 * math.pi / count)
        normals = np.stack((np.cos(angles), np.sin(angles)), axis=1)
        return vertices + radius * normals, normals
    edges = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack((edges[:, 1], -edges[:, 0]), axis=1) / np.hypot(*edges.T)[:, None]
    return vertices + 0.5 * edges, normals


def _gap_of_outline(first: PushedObject, first_pose: Pose, second: PushedObject,
                    second_pose: Pose) -> float:
    """Measure the least distance of the outline of the first from the second object."""
    vertices, radius = footprint(first)
    points = vertices if len(vertices) == 1 else points_on_outline(first.outline, OUTLINE_SPACING)
    gaps = distances_to_object(placed_points(points, first_pose), second, second_pose)
    return float(gaps.min()) - radius


@compiled
def _measure(points: FloatArray, pose: Any, vertices: FloatArray, radius: float,
             distances: FloatArray) -> None:
    """Write the distances of points from a convex polygon, or from a disc: it has one vertex."""
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    count = len(vertices)
    for row in range(len(points)):
        d_x, d_y = points[row, 0] - pose.x, points[row, 1] - pose.y
        x, y = c * d_x + s * d_y, c * d_y - s * d_x
        square, is_inside = math.inf, count > 1
        for start in range(count):
            end = (start + 1) % count
            e_x, e_y = vertices[end, 0] - vertices[start, 0], vertices[end, 1] - vertices[start, 1]
            a_x, a_y = x - vertices[start, 0], y - vertices[start, 1]
            is_inside = is_inside and e_x * a_y - e_y * a_x >= 0.0
            length = e_x * e_x + e_y * e_y
            part = min(1.0, max(0.0, (a_x * e_x + a_y * e_y) / length)) if length > 0.0 else 0.0
            a_x, a_y = a_x - part * e_x, a_y - part * e_y
            square = min(square, a_x * a_x + a_y * a_y)
        distance = math.sqrt(square)
        distances[row] = -distance if is_inside else distance - radius
