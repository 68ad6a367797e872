"""Values of one step of a push, and the coefficients of its integration."""

import functools
from typing import Any, NamedTuple

import casadi as ca
import numpy as np


class Node(NamedTuple):
    """
    State between two steps.

    :param w: object's yaw rate over the pushing speed [1/m].
    :param rho: pushing angle [rad].
    :param theta: turn of the object since the start [rad].
    :param q_x: followed point [m]: the contact where it stays in place on the object, else the
        robot's centre; it moves along the push.
    :param q_y: the same, y.
    :param phi: turn of a differential drive since the start [rad]; 0 for others.
    """

    w: Any
    rho: Any
    theta: Any
    q_x: Any
    q_y: Any
    phi: Any = 0.0


class Step(NamedTuple):
    """
    What a step is given.

    :param length: h, way of the contact [m].
    :param change: change of the pushing angle over the step [rad], or its jump at the begin.
    :param square: V at the begin [m^2/s^2].
    :param slope: dV/ds [m/s^2].
    :param jumps: whether the change is a jump.
    :param smoothing: sliding speed below which supports turn viscous, per pushing speed.
    """

    length: Any
    change: Any
    square: Any
    slope: Any
    jumps: bool
    smoothing: Any


class Outcome(NamedTuple):
    """
    What comes of a step.

    :param samples: ``Node`` at the points; the last is the end.
    :param residuals: of the moment equation at the points [N m].
    :param forces: (F_n, F_t) at the points [N].
    """

    samples: list
    residuals: list
    forces: list

    @property
    def node(self):
        """The ``Node`` at the end."""
        return self.samples[-1]


@functools.lru_cache(maxsize=8)
def radau(points):
    """
    Coefficients of the Radau IIA scheme: points, integration matrix A and its inverse.

    The last point is the end of the step; the last row of A holds the weights.

    :param points: K, number of points.
    """
    places = np.array(ca.collocation_points(points, 'radau'))
    powers = np.arange(points)
    values = places[:, None] ** powers
    integrals = places[:, None] ** (powers + 1) / (powers + 1)
    matrix = integrals @ np.linalg.inv(values)
    return places, matrix, np.linalg.inv(matrix)
