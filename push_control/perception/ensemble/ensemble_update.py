"""
Compiled steps of the ensemble filter: motion by odometry, moments of poses, Kalman update.

The update needs the anomalies B of what is measured (columns of n members), its covariance
S = B' B / (n - 1) + R as the Cholesky factor L, S = L L', and the innovation v. A block of numbers
x of the members with anomalies A moves by

    x <- x + (v - B / 2)' S^-1 B' A / (n - 1),

which shifts the mean by the gain times the innovation, and the anomalies by half as much.
Arrays are written in place.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_dynamics.layout import (
    COM_X, COM_Y, ROBOT_THETA, ROBOT_X, ROBOT_Y, THETA, X, Y,
)
from push_model.geometry import FloatArray


class InnovationTest(NamedTuple):
    """
    Test of an innovation against its covariance S.

    :param squared_distance: squared Mahalanobis distance, v' S^-1 v.
    :param log_determinant: logarithm of the determinant of S.
    """

    squared_distance: float
    log_determinant: float


@compiled
def center(samples: Any, means: Any) -> None:
    """
    Subtract the means over the members.

    :param samples: shape (n, k), is written.
    :param means: of the columns, shape (k,), is written.
    """
    for j in range(samples.shape[1]):
        total = 0.0
        for i in range(len(samples)):
            total += samples[i, j]
        means[j] = total / len(samples)
        for i in range(len(samples)):
            samples[i, j] -= means[j]


@compiled
def add_odometry(increments: Any, parameters: Any, walks: Any, step: Any) -> None:
    """
    Turn random numbers into the motion of each robot, by odometry and its errors.

    :param increments: standard normal numbers, shape (n, 3); motion (x, y, theta) of each robot in
        its own axes is written.
    :param parameters: of all members; first the relative errors of distances and of rotations, and
        the heading error per distance.
    :param walks: random walks per root of the distance, (x, y, theta).
    :param step: motion by odometry (x, y, theta) [m, m, rad].
    """
    x, y, rotation = step
    length = math.sqrt(x * x + y * y)
    root = math.sqrt(length)
    for i in range(len(increments)):
        scale, yaw_scale, drift = parameters[i, 0], parameters[i, 1], parameters[i, 2]
        increments[i, 0] = root * increments[i, 0] * walks[0] + x / (1.0 + scale)
        increments[i, 1] = root * increments[i, 1] * walks[1] + y / (1.0 + scale)
        increments[i, 2] = (root * increments[i, 2] * walks[2]
                            + ((1.0 + yaw_scale) * rotation - drift * length))


@compiled
def read_poses(states: Any, bodies: Any, poses: Any, moments: Any) -> None:
    """
    Read the poses of all members, with their means and standard deviations.

    :param states: shape (n, 34).
    :param bodies: shape (n, 13).
    :param poses: of robots and object frames (x, y, theta each), shape (n, 6), is written.
    :param moments: mean and standard deviation of each column, shape (2, 6), is written.
    """
    count = len(states)
    for i in range(count):
        theta = states[i, THETA]
        c, s = math.cos(theta), math.sin(theta)
        com_x, com_y = bodies[i, COM_X], bodies[i, COM_Y]
        poses[i, 0] = states[i, ROBOT_X]
        poses[i, 1] = states[i, ROBOT_Y]
        poses[i, 2] = states[i, ROBOT_THETA]
        poses[i, 3] = states[i, X] - (c * com_x - s * com_y)
        poses[i, 4] = states[i, Y] - (s * com_x + c * com_y)
        poses[i, 5] = theta
    for j in range(6):
        total = 0.0
        for i in range(count):
            total += poses[i, j]
        mean = total / count
        squares = 0.0
        for i in range(count):
            squares += (poses[i, j] - mean) ** 2
        moments[0, j] = mean
        moments[1, j] = math.sqrt(squares / count)


@compiled
def write_poses(states: Any, bodies: Any, poses: Any, first: int) -> None:
    """
    Place robots and objects.

    :param states: shape (n, 34), is written.
    :param bodies: shape (n, 13).
    :param poses: as ``read_poses`` writes them.
    :param first: 0 for both, 3 for the objects alone.
    """
    for i in range(len(states)):
        if first == 0:
            states[i, ROBOT_X] = poses[i, 0]
            states[i, ROBOT_Y] = poses[i, 1]
            states[i, ROBOT_THETA] = poses[i, 2]
        theta = poses[i, 5]
        c, s = math.cos(theta), math.sin(theta)
        com_x, com_y = bodies[i, COM_X], bodies[i, COM_Y]
        states[i, X] = poses[i, 3] + (c * com_x - s * com_y)
        states[i, Y] = poses[i, 4] + (s * com_x + c * com_y)
        states[i, THETA] = theta


@compiled
def disturb_objects(poses: Any, before: Any, samples: Any, walks: Any) -> None:
    """
    Add a random walk to what each object has moved.

    :param poses: of robots and objects, shape (n, 6), is written.
    :param before: the same before they moved.
    :param samples: standard normal, shape (n, 3).
    :param walks: per root of the distance (x, y, theta).
    """
    for i in range(len(poses)):
        d_x, d_y = poses[i, 3] - before[i, 3], poses[i, 4] - before[i, 4]
        root = math.sqrt(math.sqrt(d_x * d_x + d_y * d_y))
        for j in range(3):
            poses[i, 3 + j] += root * (samples[i, j] * walks[j])


@compiled
def innovation_test(deviations: Any, noise: Any, innovation: Any,
                    factor: Any) -> tuple[float, float]:
    """
    Factorize the covariance S of an innovation, and compare the two.

    :param deviations: anomalies B of what is measured, shape (n, m).
    :param noise: covariance R of the measurement, shape (m, m).
    :param innovation: v, measured minus mean, shape (m,).
    :param factor: L, shape (m + 1, m), is written; its last row is scratch.
    :return: the numbers of an ``InnovationTest``.
    """
    size = deviations.shape[1]
    squared_distance, log_determinant = 0.0, 0.0
    for j in range(size):
        for k in range(j + 1):
            total = 0.0
            for i in range(len(deviations)):
                total += deviations[i, j] * deviations[i, k]
            total = total / (len(deviations) - 1) + noise[j, k]
            for m in range(k):
                total -= factor[j, m] * factor[k, m]
            factor[j, k] = math.sqrt(total) if j == k else total / factor[k, k]
        # Forward substitution of the innovation, row by row.
        part = innovation[j]
        for m in range(j):
            part -= factor[j, m] * factor[size, m]
        factor[size, j] = part / factor[j, j]
        squared_distance += factor[size, j] ** 2
        log_determinant += 2.0 * math.log(factor[j, j])
    return squared_distance, log_determinant


@compiled
def update_block(block: Any, first: int, deviations: Any, innovation: Any, factor: Any) -> None:
    """
    Move numbers of all members by the update.

    :param block: shape (n, k), is written from the column ``first`` on.
    :param first: number of the first column that the measurement tells of.
    :param deviations: B, shape (n, m), its mean over the members 0.
    :param innovation: v, shape (m,).
    :param factor: L, as ``innovation_test`` wrote it; its last row is scratch.
    """
    count, size = deviations.shape
    gain = factor[size]
    for k in range(first, block.shape[1]):
        # As B has no mean, A may be taken from any origin; from a near one it is exact.
        origin = block[0, k]
        for j in range(size):
            covariance = 0.0
            for i in range(count):
                covariance += deviations[i, j] * (block[i, k] - origin)
            gain[j] = covariance / (count - 1)
        for j in range(size):
            for m in range(j):
                gain[j] -= factor[j, m] * gain[m]
            gain[j] /= factor[j, j]
        for j in range(size - 1, -1, -1):
            for m in range(j + 1, size):
                gain[j] -= factor[m, j] * gain[m]
            gain[j] /= factor[j, j]
        for i in range(count):
            for j in range(size):
                block[i, k] += (innovation[j] - 0.5 * deviations[i, j]) * gain[j]


@compiled
def update_blocks(blocks: Any, first: int, deviations: Any, innovation: Any, factor: Any) -> None:
    """
    Move several blocks of numbers, as ``update_block`` does.

    :param blocks: shape (b, n, k), is written from the column ``first`` on.
    :param first: as of ``update_block``.
    :param deviations: as of ``update_block``.
    :param innovation: as of ``update_block``.
    :param factor: as of ``update_block``.
    """
    for b in range(len(blocks)):
        update_block(blocks[b], first, deviations, innovation, factor)


class EnsembleUpdate:
    """
    Update of all members by one measurement.

    ``mean``: of what is measured, as the members expect it, shape (m,).
    """

    def __init__(self, expected: FloatArray, noise: FloatArray) -> None:
        """
        Take what the members expect.

        :param expected: what is measured, by each member, shape (n, m).
        :param noise: covariance R of the measurement, shape (m, m).
        """
        # Compiled functions are compiled anew for arrays in another order or read-only.
        self._deviations: FloatArray = np.array(expected, dtype=float, order='C')
        self._noise: FloatArray = np.array(noise, dtype=float, order='C')
        size = self._deviations.shape[1]
        self.mean: FloatArray = np.empty(size)
        self._innovation: FloatArray = np.zeros(size)
        self._factor: FloatArray = np.zeros((size + 1, size))
        center(self._deviations, self.mean)

    def test(self, innovation: FloatArray) -> InnovationTest:
        """
        Compare an innovation with its covariance.

        :param innovation: measured minus mean, shape (m,).
        """
        self._innovation[:] = innovation
        return InnovationTest(*innovation_test(self._deviations, self._noise, self._innovation,
                                               self._factor))

    def apply(self, block: FloatArray, first: int = 0) -> None:
        """
        Move numbers of all members by the innovation that was tested.

        :param block: shape (n, k), is written.
        :param first: number of the first column that the measurement tells of.
        """
        update_block(block, first, self._deviations, self._innovation, self._factor)

    def apply_to_all(self, blocks: FloatArray, first: int = 0) -> None:
        """
        Move several blocks of numbers, as ``apply`` does.

        :param blocks: shape (b, n, k), is written.
        :param first: as of ``apply``.
        """
        update_blocks(blocks, first, self._deviations, self._innovation, self._factor)

    def resample(self, samples: FloatArray) -> FloatArray:
        """
        Draw anew what is measured, by the innovation that was tested, independent of all else.

        With the covariance P of what the members expect and its gain K = P (P + R)^-1, the mean
        moves by K times the innovation, and (I - K) P is the covariance.

        :param samples: standard normal numbers, shape (n, m).
        :return: what is measured, by each member, shape (n, m).
        """
        deviations = self._deviations
        covariance = deviations.T @ deviations / (len(deviations) - 1)
        gain = np.linalg.solve(covariance + self._noise, covariance).T
        factor = np.linalg.cholesky(covariance - gain @ covariance)
        return self.mean + gain @ self._innovation + samples @ factor.T

    def jump(self, robots: FloatArray) -> FloatArray:
        """
        Explain the innovation that was tested by a jump of all robots.

        :param robots: their poses, shape (n, 3).
        :return: jump (x, y, theta), shape (3,).
        """
        deviations = self._deviations
        gain = deviations.T @ (robots - robots.mean(axis=0))
        return np.linalg.solve(deviations.T @ deviations, gain).T @ self._innovation
