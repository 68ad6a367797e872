"""Distances of points from the footprint of an object, and of footprints from each other."""

import math

import numpy as np
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
    if len(vertices) == 1:
        return np.hypot(*(points - pose[:2]).T) - radius
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    local = (points - pose[:2]) @ np.array([[c, -s], [s, c]])
    squares = np.full(len(points), math.inf)
    is_inside = np.ones(len(points), dtype=np.bool_)
    for start, end in zip(vertices, np.roll(vertices, -1, axis=0)):
        edge, away = end - start, local - start
        is_inside &= edge[0] * away[:, 1] - edge[1] * away[:, 0] >= 0.0
        part = np.clip(away @ edge / (edge @ edge), 0.0, 1.0)
        away = away - part[:, None] * edge
        squares = np.minimum(squares, (away ** 2).sum(axis=1))
    distances = np.sqrt(squares)
    return np.where(is_inside, -distances, distances)


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
