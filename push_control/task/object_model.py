"""
The object as learnt from its pushes: its friction centre.

A push tells well on which side of its line the friction centre lies, and badly how far along it;
pushes from several sides tell both.
"""

import math

import numpy as np
from push_model.friction import friction_center, with_friction_center

# Of what one push tells across its line, and how far the centre may wander until the next [m].
DEVIATION, WALK = 0.004, 0.002


class ObjectModelEstimator:
    """A believed object, and where its friction centre has been seen since."""

    def __init__(self, obj, control):
        """
        Begin with what is believed.

        :param obj: the ``PushedObject`` as believed.
        :param control: ``ControlSettings``, for how wrong that may be.
        """
        self._believed, self.obj = obj, obj
        reach = max([obj.radius, *(math.hypot(*point) for point in obj.outline)])
        self._covariance = (control.center_std_ratio * reach) ** 2 * np.eye(2)

    def learn(self, point, seen, unsure=0.0):
        """
        Take in what a push has told.

        :param point: where it pushed, object frame (x, y) [m].
        :param seen: friction centre that it saw, object frame (x, y) [m].
        :param unsure: standard deviation of where it pushed [m].
        """
        center, across, _ = self._line(point)
        self._covariance += WALK ** 2 * np.eye(2)
        told = self._covariance @ across
        gain = told / (across @ told + DEVIATION ** 2 + unsure ** 2)
        self._covariance -= np.outer(gain, told)
        center = center + gain * (across @ (np.array(seen) - center))
        self.obj = with_friction_center(self._believed, center)

    def lateral_innovation(self, point, seen):
        """
        Compare a friction centre as a push sees it with what is known, across the push.

        :param point: where it pushes, object frame (x, y) [m].
        :param seen: friction centre that it sees, object frame (x, y) [m].
        :return: direction across, to the left of the push, object frame [rad]; how far to that
            side the centre is seen of what is known [m]; standard deviation of what is known [m].
        """
        center, across, _ = self._line(point)
        return (math.atan2(across[1], across[0]), float(across @ (np.array(seen) - center)),
                math.sqrt(across @ self._covariance @ across))

    def spread(self, point):
        """
        Tell how well it is known from where its centre is, across the line to it.

        :param point: where it is pushed, object frame (x, y) [m].
        :return: standard deviation over the distance.
        """
        _, across, length = self._line(point)
        return math.sqrt(across @ self._covariance @ across) / length

    def _line(self, point):
        center = np.array(friction_center(self.obj))
        line = center - point
        length = float(np.hypot(*line))
        return center, np.array((-line[1], line[0])) / length, length
