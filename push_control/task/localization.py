"""
Where the robot stands in the world, although its odometry drifts.

A Kalman filter of the robot's pose and of what is lastingly wrong with its odometry: the relative
error of distances, and the heading error per distance. It learns where the robot must be whenever
the object is touched.
"""

from collections import deque
import math

import numpy as np
from push_model.geometry import Pose, wrap_angle

MEMORY = 1.0
GATE = 4.0


class RobotLocalization:
    """Pose of the robot in the world, from odometry and touches."""

    def __init__(self, settings):
        """
        Begin anywhere; the first odometry is believed.

        :param settings: ``SupervisionSettings``.
        """
        self._scale_spread, self._drift_spread = settings.odometry_scale, settings.odometry_drift
        self._walk = settings.odometry_walk, settings.odometry_heading_walk
        self._last = self._pose = None

    def predict(self, odometry):
        """
        Take in the robot's motion.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        """
        if self._last is None:
            self._pose, self._wrong = odometry.pose, (0.0, 0.0)
            self._covariance = np.diag(np.square((0.0, 0.0, 0.0, self._scale_spread,
                                                  self._drift_spread)))
            self._seen = deque([(odometry.time, odometry.pose)])
        elif odometry.time > self._last.time:
            self._move(self._last.pose.inverse() @ odometry.pose)
            self._seen.append((odometry.time, self._pose))
            while odometry.time - self._seen[0][0] > MEMORY:
                self._seen.popleft()
        else:
            return
        self._last = odometry

    @property
    def pose(self):
        """``Pose`` of the robot at the last odometry; None before the first."""
        return self._pose

    @property
    def standard_deviations(self):
        """Standard deviations of x, y [m] and heading [rad]."""
        return np.sqrt(np.diag(self._covariance)[:3])

    def at(self, time):
        """
        Look up where the robot was.

        :param time: not more than about a second ago [s].
        :return: its ``Pose`` as now known.
        """
        after = next((i for i, (t, _) in enumerate(self._seen) if t >= time), None)
        if after is None or after == 0:
            return self._seen[-1 if after is None else 0][1]
        (begin, a), (end, b) = self._seen[after - 1], self._seen[after]
        share = (time - begin) / (end - begin)
        return Pose(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
                    a.theta + share * wrap_angle(b.theta - a.theta))

    def update_pose(self, error, covariance, sure=True):
        """
        Learn from a robot that is seen to be elsewhere.

        :param error: true pose less that believed, (x, y, heading) [m, m, rad].
        :param covariance: of these, shape (3, 3).
        :param sure: whether it is; else an error that no drift explains tells nothing.
        """
        rows, error = np.eye(3, 5), np.array([*error[:2], wrap_angle(error[2])])
        if sure or not self._is_odd(rows, error, covariance):
            self._learn(rows, error, covariance)

    def update_along(self, direction, error, deviation, sure=True):
        """
        Learn from a robot that is seen to be elsewhere along one direction, as where it touches.

        :param direction: world angle [rad].
        :param error: true place less that believed, along it [m].
        :param deviation: standard deviation of that [m].
        :param sure: as of ``update_pose``.
        """
        row = np.array([[math.cos(direction), math.sin(direction), 0.0, 0.0, 0.0]])
        error, noise = np.array([error]), np.array([[deviation ** 2]])
        if sure or not self._is_odd(row, error, noise):
            self._learn(row, error, noise)

    def inflate_covariance(self, distance):
        """
        Reckon with a robot that is elsewhere, after it has looked for the object in vain.

        :param distance: standard deviation of that, along x and y [m].
        """
        self._covariance[range(2), range(2)] += distance ** 2

    def _move(self, step):
        """Carry pose and covariance on by a motion as odometry tells it, in its own axes."""
        scale, drift = self._wrong
        way = math.hypot(step.x, step.y)
        x, y = Pose(0.0, 0.0, self._pose.theta).rotate((step.x / (1.0 + scale),
                                                        step.y / (1.0 + scale)))
        jacobian = np.eye(5)
        jacobian[:3, 2:] = [(-y, -x, 0.0), (x, -y, 0.0), (1.0, 0.0, -way)]
        self._covariance = jacobian @ self._covariance @ jacobian.T
        position, heading = self._walk
        self._covariance[range(3), range(3)] += way * np.square((position, position, heading))
        self._pose = Pose(self._pose.x + x, self._pose.y + y,
                          self._pose.theta + wrap_angle(step.theta) - drift * way)

    def _is_odd(self, rows, error, noise):
        """Whether no drift explains an error: the wheels have spun, or the robot was moved."""
        spread = rows @ self._covariance @ rows.T + noise
        return error @ np.linalg.solve(spread, error) > GATE ** 2 * len(error)

    def _learn(self, rows, error, noise):
        if self._is_odd(rows, error, noise):
            jump = rows.T @ error
            self._covariance += np.outer(jump, jump)
        spread = rows @ self._covariance @ rows.T + noise
        gain = self._covariance @ rows.T @ np.linalg.inv(spread)
        change = (gain @ error).tolist()
        self._covariance -= gain @ rows @ self._covariance
        self._pose = Pose(*(a + b for a, b in zip(self._pose, change[:3])))
        self._wrong = tuple(a + b for a, b in zip(self._wrong, change[3:]))
        self._seen = deque([(self._last.time, self._pose)])
