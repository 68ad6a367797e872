"""A recorded push: where the object was, how the robot moved, where the object ended."""

from typing import NamedTuple, Sequence

import numpy as np
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray


class RecordedPush(NamedTuple):
    """
    One push, from rest to rest.

    :param start: pose of the object frame before, world, shape (3,) [m, rad].
    :param end: pose after, world, shape (3,) [m, rad].
    :param path: poses of the robot from the first touch to the end, world, shape (m, 3) [m, rad].
    """

    start: FloatArray
    end: FloatArray
    path: FloatArray


def gap_at(shape: Shape, robot_radius: float, object_pose: FloatArray,
           robot_pose: FloatArray) -> tuple[float, FloatArray]:
    """
    Find the gap between robot and object, below 0 where they overlap.

    :param shape: of the object, a polygon or a disc.
    :param robot_radius: R_p [m].
    :param object_pose: world, shape (3,) [m, rad].
    :param robot_pose: world, shape (3,) or (2,) [m, rad].
    :return: gap [m], and the contact normal from robot to object, world, shape (2,).
    """
    cosine, sine = np.cos(object_pose[2]), np.sin(object_pose[2])
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    local = rotation.T @ (robot_pose[:2] - object_pose[:2])
    nearest, distances = shape.nearest(local[None])
    side = -1.0 if _is_inside(shape, local) else 1.0
    normal = side * (nearest[0] - local) / max(distances[0], 1e-12)
    return side * float(distances[0]) - robot_radius, rotation @ normal


def touching_path(shape: Shape, robot_radius: float, object_pose: FloatArray, path: FloatArray,
                  index: int) -> FloatArray:
    """
    Shift a path along the contact normal so that the robot touches at one of its points.

    Robot and object are measured separately, with errors that are a large part of a short push;
    that they touch at the beginning, or at the end, is certain.

    :param shape: of the object.
    :param robot_radius: R_p [m].
    :param object_pose: at that point, world, shape (3,) [m, rad].
    :param path: of the robot, shape (m, 3) [m, rad].
    :param index: of the point.
    :return: path, shape (m, 3) [m, rad].
    """
    gap, normal = gap_at(shape, robot_radius, object_pose, path[index])
    shifted = np.array(path, dtype=float)
    shifted[:, :2] += gap * normal
    return shifted


def resampled(path: FloatArray, count: int) -> FloatArray:
    """
    Sample a path at even distances.

    :param path: shape (m, 3) [m, rad].
    :param count: of the points.
    :return: path, shape (count, 3) [m, rad].
    """
    steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    # Standing still leaves equal distances, which np.interp does not take.
    keep = np.concatenate([[True], steps > 1e-9])
    at = np.linspace(0.0, travelled[-1], count)
    headings = np.unwrap(path[:, 2])
    return np.column_stack([np.interp(at, travelled[keep], column[keep])
                            for column in (path[:, 0], path[:, 1], headings)])


def stacked(pushes: Sequence[RecordedPush], count: int) -> tuple[FloatArray, FloatArray,
                                                                 FloatArray]:
    """
    Stack pushes for a common integration.

    :param pushes: n pushes.
    :param count: points of each path.
    :return: starts (n, 3), ends (n, 3) and paths (n, count, 3).
    """
    return (np.array([push.start for push in pushes]), np.array([push.end for push in pushes]),
            np.array([resampled(push.path, count) for push in pushes]))


def _is_inside(shape: Shape, point: FloatArray) -> bool:
    if not len(shape.outline):
        return bool(np.hypot(*point) < shape.radius)
    edges = np.roll(shape.outline, -1, axis=0) - shape.outline
    offsets = point - shape.outline
    return bool((edges[:, 0] * offsets[:, 1] - edges[:, 1] * offsets[:, 0] > 0.0).all())
