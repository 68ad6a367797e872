"""Velocities on a grid of time, the newest of them."""

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import FloatArray
from push_model.signals import Twist


class VelocityHistory:
    """The newest velocities of bases that have stood before the oldest of them."""

    def __init__(self, length: int, bases: int = 1) -> None:
        """
        Start without a velocity.

        :param length: number of velocities that are kept.
        :param bases: number of bases that are followed side by side, b.
        """
        self._length = length
        # The rows that are kept lie side by side behind one of a base that stands, and move to
        # the front when the end is reached.
        self._buffer: FloatArray = np.zeros((4 * length + 1, bases, 3))
        self._end = 1
        self._count = 0

    def __len__(self) -> int:
        """Return the number of velocities that are there."""
        return self._count

    def append(self, velocities: Twist | FloatArray) -> None:
        """
        Add the newest velocities; the oldest ones go where there are too many.

        :param velocities: ``Twist`` of all bases, or shape (b, 3) [m/s, m/s, rad/s].
        """
        if self._end == len(self._buffer):
            self._buffer[1:1 + self._count] = self._rows
            self._buffer[0] = 0.0
            self._end = 1 + self._count
        self._buffer[self._end] = velocities
        self._end += 1
        if self._count < self._length:
            self._count += 1
        else:
            self._buffer[self._end - self._count - 1] = 0.0

    def at(self, places: NDArray[np.int_], base: int = 0) -> FloatArray:
        """
        Look velocities up.

        :param places: 0 is the oldest one that is there. Before it the base stands; behind the
            newest one it goes on like that. Any shape (...).
        :param base: which one, from 0.
        :return: shape (..., 3) [m/s, m/s, rad/s].
        """
        standing_first = self._buffer[self._end - self._count - 1:self._end, base]
        return standing_first.take(places + 1, axis=0, mode='clip')

    def transform(self, matrix: FloatArray) -> None:
        """
        Apply a matrix to all velocities.

        :param matrix: shape (3, 3).
        """
        self._rows[:] = self._rows @ matrix.T

    @property
    def _rows(self) -> FloatArray:
        return self._buffer[self._end - self._count:self._end]
