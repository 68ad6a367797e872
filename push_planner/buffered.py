"""Calls of casadi functions on arrays, without turning every number into a Python object."""

import threading

import numpy as np


class Buffered:
    """
    A casadi function of dense values.

    Arrays are transposed against casadi's matrices: one row per column of those.

    :param function: the ``casadi.Function``.
    """

    def __init__(self, function):
        """Take the memory that the function reads and writes."""
        self.function = function
        self._buffer, self._evaluate = function.buffer()
        self._lock = threading.Lock()
        self._given = [np.zeros(function.size_in(i)[::-1]) for i in range(function.n_in())]
        self._found = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, array in enumerate(self._given):
            self._buffer.set_arg(i, memoryview(array))
        for i, array in enumerate(self._found):
            self._buffer.set_res(i, memoryview(array))

    def __call__(self, *given):
        """
        Evaluate.

        :param given: arrays or numbers; those of fewer rows are repeated.
        :return: list of arrays.
        """
        return self.with_stats(*given)[0]

    def with_stats(self, *given):
        """Evaluate; return the arrays and what casadi says of the call."""
        with self._lock:
            for array, value in zip(self._given, given):
                array[...] = value
            self._evaluate()
            return [array.copy() for array in self._found], self._buffer.stats()
