"""Relations of many robots and objects: poses of the one in the axes of the other."""

import numpy as np
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
