"""A casadi function without allocations in its calls."""

import threading
from typing import Any, Union

import numpy as np
from push_model.geometry import FloatArray


class BufferedFunction:
    """
    A casadi function of dense values, evaluated in memory that is allocated once.

    Arrays are transposed against casadi's matrices, which are stored by columns: one row for each
    column of those.

    :param function: the ``casadi.Function``.
    """

    def __init__(self, function: Any) -> None:
        """Allocate what the function reads and writes."""
        self._buffer, self._evaluate = function.buffer()
        self._lock = threading.Lock()
        self._inputs = [np.zeros(function.size_in(i)[::-1]) for i in range(function.n_in())]
        self._outputs = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, array in enumerate(self._inputs):
            self._buffer.set_arg(i, array.data)
        for i, array in enumerate(self._outputs):
            self._buffer.set_res(i, array.data)

    def __call__(self, *inputs: Union[float, FloatArray]) -> list[FloatArray]:
        """
        Evaluate the function.

        :param inputs: arrays or numbers; those of fewer rows are repeated.
        """
        with self._lock:
            for array, value in zip(self._inputs, inputs):
                array[...] = value
            self._evaluate()
            return [array.copy() for array in self._outputs]
