"""Relations of many robots and objects: poses of the one in the axes of the other."""

import numpy as np
from push_control.perception.ensemble.ensemble_update import EnsembleUpdate
from push_model.geometry import FloatArray


def relative_poses(frames: FloatArray, poses: FloatArray) -> FloatArray:
    """
    Express poses in the axes of frames.

    :param frames: (x, y, theta) in the world, shape (n, 3).
    :param poses: likewise.
    :return: (x, y, theta), angles not wrapped, shape (n, 3).
    """
    x, y, theta = (poses - frames).T
    c, s = np.cos(frames[:, 2]), np.sin(frames[:, 2])
    return np.stack((c * x + s * y, c * y - s * x, theta), axis=1)


def composed_poses(frames: FloatArray, poses: FloatArray) -> FloatArray:
    """
    Express poses in the world that are given in the axes of frames.

    :param frames: (x, y, theta) in the world, shape (n, 3).
    :param poses: in the axes of these, likewise.
    :return: (x, y, theta), angles not wrapped, shape (n, 3).
    """
    x, y, theta = poses.T
    c, s = np.cos(frames[:, 2]), np.sin(frames[:, 2])
    return np.stack((frames[:, 0] + c * x - s * y, frames[:, 1] + s * x + c * y,
                     frames[:, 2] + theta), axis=1)


def correct_related(update: EnsembleUpdate, poses: FloatArray) -> FloatArray:
    """
    Correct robots and objects by a measured relation of them, wherever both are.

    Robots move in their own axes, and relations as they are. So a correction does not depend on
    where a member has the world: were it along the axes of the world, relations would come to
    depend on it, and the next measurement would seem to tell of it.

    :param update: ``EnsembleUpdate`` by the relation, its innovation tested.
    :param poses: (x, y, theta) of robots and objects, shape (n, 6).
    :return: the same, corrected.
    """
    robots, relations = poses[:, :3], relative_poses(poses[:, :3], poses[:, 3:])
    mean = np.broadcast_to(robots.mean(axis=0), robots.shape)
    before = -relative_poses(robots, mean)
    after = before.copy()
    update.apply(after)
    update.apply(relations)
    corrected = composed_poses(robots, after - before)
    return np.hstack((corrected, composed_poses(corrected, relations)))
