"""Cosine and sine of whatever an equation is evaluated with."""

import math
from typing import Any

import numpy as np


def cos_and_sin(angle: Any) -> tuple[Any, Any]:
    """
    Compute cosine and sine of a number, an array or a casadi symbol.

    casadi itself is not needed for it: its symbols have both functions as methods.

    :param angle: [rad].
    :return: both, of the kind of the angle.
    """
    if isinstance(angle, (float, int)):
        return math.cos(angle), math.sin(angle)
    if hasattr(angle, 'cos'):
        return angle.cos(), angle.sin()
    return np.cos(angle), np.sin(angle)
