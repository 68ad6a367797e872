"""
Identification of the object from its pushes: its centre of friction.

A push sees well on which side of its line the centre lies, and badly how far along it; pushes
from several sides see both. So each push is one measurement of the lateral coordinate

    e = t . (F_seen - F),    t: unit vector to the left of the line from the contact to F,

in a Kalman filter with the two coordinates of F in the object frame as its state.
"""

import math
from typing import NamedTuple

import numpy as np
from push_control.settings import ControlSettings
from push_model.friction import friction_center, with_friction_center
from push_model.geometry import Coordinates, FloatArray
from push_model.parameters import PushedObject

# Standard deviation of what one push sees across its line [m], and of the random walk of the
# centre from one push to the next [m], as no floor is the same everywhere; chosen.
PUSH_STD = 0.004
WALK_STD = 0.002


class LateralInnovation(NamedTuple):
    """
    Centre of friction as seen by a push, across its line and relative to the estimate.

    :param direction: of the lateral axis, to the left of the push, object frame [rad].
    :param offset: of the seen centre from the estimated one along it [m].
    :param deviation: standard deviation of the estimate along it [m].
    """

    direction: float
    offset: float
    deviation: float


class _PushLine(NamedTuple):
    """The line of a push: estimated centre, unit vector to its left, length to the centre."""

    center: FloatArray
    lateral: FloatArray
    length: float


class ObjectModelEstimator:
    """
    Estimates the centre of friction of an object.

    ``obj``: the ``PushedObject`` with the friction of its supports shifted to the estimate.
    """

    def __init__(self, obj: PushedObject, control: ControlSettings) -> None:
        """
        Start from the nominal object.

        :param obj: the nominal ``PushedObject``.
        :param control: ``ControlSettings``, for the standard deviation of its centre.
        """
        self._nominal = obj
        self.obj = obj
        extent = max([obj.radius, *(math.hypot(*point) for point in obj.outline)])
        self._covariance: FloatArray = (control.center_std_ratio * extent) ** 2 * np.eye(2)

    def update(self, point: Coordinates, seen: Coordinates, deviation: float = 0.0) -> None:
        """
        Correct the estimate by a push.

        :param point: contact of the push, object frame (x, y) [m].
        :param seen: centre of friction that it saw, object frame (x, y) [m].
        :param deviation: standard deviation of the contact across the push [m].
        """
        center, lateral, _ = self._line(point)
        self._covariance += WALK_STD ** 2 * np.eye(2)
        cross = self._covariance @ lateral
        gain = cross / (lateral @ cross + PUSH_STD ** 2 + deviation ** 2)
        self._covariance -= np.outer(gain, cross)
        center = center + gain * (lateral @ (np.array(seen) - center))
        self.obj = with_friction_center(self._nominal, center)

    def lateral_innovation(self, point: Coordinates, seen: Coordinates) -> LateralInnovation:
        """
        Compare the centre of friction that a push sees with the estimate, across the push.

        :param point: contact of the push, object frame (x, y) [m].
        :param seen: centre of friction that it sees, object frame (x, y) [m].
        :return: ``LateralInnovation``.
        """
        center, lateral, _ = self._line(point)
        return LateralInnovation(math.atan2(lateral[1], lateral[0]),
                                 float(lateral @ (np.array(seen) - center)),
                                 math.sqrt(lateral @ self._covariance @ lateral))

    def relative_deviation(self, point: Coordinates) -> float:
        """
        Relate the lateral standard deviation of the estimate to its distance from a contact.

        :param point: contact of a push, object frame (x, y) [m].
        :return: standard deviation over distance, about that of the direction to it [rad].
        """
        _, lateral, length = self._line(point)
        return math.sqrt(lateral @ self._covariance @ lateral) / length

    def _line(self, point: Coordinates) -> _PushLine:
        center = np.array(friction_center(self.obj))
        line = center - point
        length = float(np.hypot(*line))
        return _PushLine(center, np.array((-line[1], line[0])) / length, length)
