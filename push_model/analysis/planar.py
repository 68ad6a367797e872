"""Vectors in the plane, one or many at once."""

from typing import Any

import numpy as np


def rotated(angles: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """
    Rotate vectors.

    :param angles: [rad], number or shape (n,).
    :param x: of the vectors, number or shape (n,).
    :param y: of the vectors, number or shape (n,).
    :return: (x, y).
    """
    cosine, sine = np.cos(angles), np.sin(angles)
    return cosine * x - sine * y, sine * x + cosine * y
