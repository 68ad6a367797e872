"""
Bias of object poses: errors that averaging does not reduce.

Marks are not quite where they should be on the object, and a camera errs in another manner at
every angle. With the bearing phi of the robot in the object frame, a pose is measured with the
error

    b(phi) = c_0 + sum over k of (c_k cos(k phi) + s_k sin(k phi))

in that frame, of position and heading each; the variances of c_k and s_k are in proportion to
1 / k. Every member has coefficients of its own, so that poses of an object at rest from several
sides, and contacts with it, reveal them.
"""

import numpy as np
from push_model.geometry import BoolArray, FloatArray

# Part of the variance that is the same from all sides; chosen: marks are put on with more care
# than a camera has at all angles.
CONSTANT_PART = 0.3
# Number of harmonics; chosen: with four, a side is told from the next one.
HARMONICS = 4
# Standard deviation of what differs between one pose and the next, over that of the bias; chosen:
# no bias is quite as smooth as a few harmonics.
ROUGHNESS = 0.3
# Standard deviations of the bias by which it changes at most as another mark is seen; chosen.
JUMP_SIGMAS = 4.0
AXES = 3


class PoseBias:
    """
    Biases of all members.

    ``coefficients``: shape (n, (1 + 2 k) 3), by harmonics, then axes (x, y, heading); n by 0 where
    there is no bias. ``roughness``: covariance of what differs from pose to pose (x, y, heading),
    shape (3, 3).
    """

    def __init__(self, deviation: float, heading_deviation: float, count: int,
                 rng: np.random.Generator) -> None:
        """
        Draw the coefficients.

        :param deviation: standard deviation of the bias of the position, along each axis [m].
        :param heading_deviation: the same of the heading [rad].
        :param count: number of members.
        :param rng: ``numpy.random.Generator`` of the coefficients.
        """
        self.exists = deviation > 0.0 or heading_deviation > 0.0
        self._deviations = np.array((deviation, deviation, heading_deviation))
        self._rng = rng
        self.roughness: FloatArray = np.diag((ROUGHNESS * self._deviations) ** 2)
        self.coefficients: FloatArray = np.zeros((count, 0))
        self.forget()

    def forget(self) -> None:
        """Draw the coefficients again, as if nothing had been seen."""
        if not self.exists:
            return
        parts = 1.0 / np.arange(1, HARMONICS + 1)
        parts *= (1.0 - CONSTANT_PART) / parts.sum()
        parts = np.concatenate(([CONSTANT_PART], np.repeat(parts, 2)))
        deviations = (np.sqrt(parts)[:, None] * self._deviations).ravel()
        samples = self._rng.standard_normal((len(self.coefficients), len(deviations)))
        self.coefficients = (samples - samples.mean(axis=0)) * deviations

    def explains(self, displacement: FloatArray) -> bool:
        """
        Check whether an object may seem displaced only because another mark is seen.

        :param displacement: of the measured pose (x, y, heading), shape (3,).
        """
        is_within: BoolArray = abs(displacement) < JUMP_SIGMAS * self._deviations
        return self.exists and bool(is_within.all())

    def errors(self, robots: FloatArray, objects: FloatArray) -> FloatArray:
        """
        Compute how the measured poses differ from the true ones.

        :param robots: poses (x, y, theta) of the members' robots, shape (n, 3).
        :param objects: poses of their objects, shape (n, 3).
        :return: errors (x, y, heading) in the world, shape (n, 3).
        """
        if not self.exists:
            return np.zeros_like(objects)
        headings = objects[:, 2]
        x, y = (robots - objects)[:, :2].T
        bearings = np.arctan2(y, x) - headings
        angles = bearings[:, None] * np.arange(1, HARMONICS + 1)
        basis = np.ones((len(objects), 1 + 2 * HARMONICS))
        basis[:, 1::2], basis[:, 2::2] = np.cos(angles), np.sin(angles)
        errors = np.einsum('nk,nka->na', basis,
                           self.coefficients.reshape(len(objects), -1, AXES))
        c, s = np.cos(headings), np.sin(headings)
        return np.stack((c * errors[:, 0] - s * errors[:, 1],
                         s * errors[:, 0] + c * errors[:, 1], errors[:, 2]), axis=1)
