"""Predict a push by the most similar other one of its set: no physics at all."""

import numpy as np
from push_control.identification.recorded_push import gap_at
from push_model.analysis.planar import rotated
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray
from studies.recordings.block import BlockPush, ROD_RADIUS

# Lengths that make a difference of 1 one of similarity: of the place of the contact [m], of the
# direction of the push [rad]. Chosen: both ranges, halved some three times.
CONTACT_SCALE = 0.02
DIRECTION_SCALE = 0.3


def nearest_ends(shape: Shape, pushes: tuple[BlockPush, ...]) -> FloatArray:
    """
    Predict each push by the nearest other one, in proportion to the travel of the rod.

    :param shape: of the object.
    :param pushes: of one set.
    :return: poses in the end, shape (n, 3) [m, rad].
    """
    features = np.array([_features(shape, push) for push in pushes])
    distances = np.linalg.norm(features[:, None] - features, axis=2)
    np.fill_diagonal(distances, np.inf)
    rates = np.array([_displacement(push) / _travel(push) for push in pushes])
    return np.array([_moved(push, _travel(push) * rates[nearest])
                     for push, nearest in zip(pushes, distances.argmin(axis=1))])


def _travel(push: BlockPush) -> float:
    """Distance between start and end of the rod's path [m]."""
    return float(np.hypot(*(push.motion.path[-1] - push.motion.path[0])[:2]))


def _features(shape: Shape, push: BlockPush) -> FloatArray:
    """Place of the contact and direction of the push, object frame, in their scales."""
    start, path = push.motion.start, push.motion.path
    _, normal = gap_at(shape, ROD_RADIUS, start, path[0])
    contact = path[0, :2] + ROD_RADIUS * normal - start[:2]
    travel = (path[-1] - path[0])[:2] / _travel(push)
    return np.concatenate([np.array(rotated(-start[2], *contact)) / CONTACT_SCALE,
                           np.array(rotated(-start[2], *travel)) / DIRECTION_SCALE])


def _displacement(push: BlockPush) -> FloatArray:
    """Displacement in the object frame at the start, shape (3,) [m, rad]."""
    start, end = push.motion.start, push.motion.end
    turn = np.arctan2(np.sin(end[2] - start[2]), np.cos(end[2] - start[2]))
    return np.array([*rotated(-start[2], *(end - start)[:2]), turn])


def _moved(push: BlockPush, displacement: FloatArray) -> FloatArray:
    start = push.motion.start
    return start + np.array([*rotated(start[2], *displacement[:2]), displacement[2]])
