"""Vectors and angles in the plane, one or many at once."""

import math
from typing import Any

import numpy as np
from push_model.geometry import FloatArray


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


def wrapped(angles: FloatArray) -> FloatArray:
    """
    Wrap angles to [-pi, pi).

    :param angles: any finite angles [rad].
    """
    wrapped_angles: Any = np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi
    return wrapped_angles
