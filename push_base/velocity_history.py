"""Velocities on a grid of time, the newest of them."""

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import FloatArray
from push_model.signals import Twist


class VelocityHistory:
    """The newest velocities of a base that has stood before the oldest of them."""

    def __init__(self, length: int) -> None:
        """
        Start without a velocity.

        :param length: number of velocities that are kept.
        """
        self._length = length
        # The rows that are kept lie side by side, and move to the front when the end is reached.
        self._buffer: FloatArray = np.zeros((4 * length, 3))
        self._end = 0
        self._count = 0

    def __len__(self) -> int:
        """Return the number of velocities that are there."""
        return self._count

    def append(self, velocity: Twist | FloatArray) -> None:
        """
        Add the newest velocity; the oldest one goes where there are too many.

        :param velocity: ``Twist``, or the same as an array, shape (3,) [m/s, m/s, rad/s].
        """
        if self._end == len(self._buffer):
            self._buffer[:self._count] = self._rows
            self._end = self._count
        self._buffer[self._end] = velocity
        self._end += 1
        self._count = min(self._count + 1, self._length)

    def at(self, places: NDArray[np.int_]) -> FloatArray:
        """
        Look velocities up.

        :param places: 0 is the oldest one that is there. Before it the base stands; behind the
            newest one it goes on like that. Any shape (...).
        :return: shape (..., 3) [m/s, m/s, rad/s].
        """
        if not self._count:
            return np.zeros((*places.shape, 3))
        velocities = self._rows[np.clip(places, 0, self._count - 1)]
        velocities[places < 0] = 0.0
        return velocities

    def transform(self, matrix: FloatArray) -> None:
        """
        Apply a matrix to all velocities.

        :param matrix: shape (3, 3).
        """
        self._rows[:] = self._rows @ matrix.T

    @property
    def _rows(self) -> FloatArray:
        return self._buffer[self._end - self._count:self._end]
