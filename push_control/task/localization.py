"""
Localization of the robot from odometry that drifts, and from contacts with the object.

An extended Kalman filter with the state (x, y, theta, s, d): the pose of the robot in the world,
the relative error s of distances measured by odometry, and its heading error d per distance. A
step (dx, dy, dtheta) of odometry in the robot's axes, of length l, moves the robot by

    (x, y) += R(theta) (dx, dy) / (1 + s),    theta += dtheta - d l,

and a random walk adds to the covariance in proportion to l. Contacts and pushes tell errors of
the pose, from which the filter learns s and d as well.
"""

from collections import deque
import math
from typing import Sequence

import numpy as np
from push_control.task.settings import SupervisionSettings
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.signals import Odometry

# Time for which former poses are kept [s]; chosen: four times the age at which an object pose is
# stale by default.
HISTORY_TIME = 1.0
# Mahalanobis distance, per root of the dimension, beyond which no drift explains an error;
# chosen: an error of four standard deviations is one in 16 000.
GATE_SIGMAS = 4.0
POSE_SIZE, STATE_SIZE = 3, 5


class RobotLocalization:
    """Estimates the pose of the robot in the world."""

    def __init__(self, settings: SupervisionSettings) -> None:
        """
        Start without a pose; the first odometry gives it.

        :param settings: ``SupervisionSettings``.
        """
        self._settings = settings
        self._odometry: Odometry | None = None
        self._pose = Pose(0.0, 0.0, 0.0)
        self._scale_error = 0.0
        self._drift = 0.0
        self._covariance: FloatArray = np.diag(np.square(
            (0.0, 0.0, 0.0, settings.odometry_scale, settings.odometry_drift)))
        self._history: deque[tuple[float, Pose]] = deque()

    @property
    def is_initialized(self) -> bool:
        """Whether there was any odometry yet."""
        return self._odometry is not None

    @property
    def pose(self) -> Pose:
        """
        ``Pose`` of the robot at the last odometry.

        :raises RuntimeError: before the first odometry.
        """
        if self._odometry is None:
            raise RuntimeError('localization: got no odometry, expected some before its pose')
        return self._pose

    @property
    def standard_deviations(self) -> FloatArray:
        """Standard deviations of x, y [m] and heading [rad], shape (3,)."""
        return np.sqrt(np.diag(self._covariance)[:POSE_SIZE])

    @property
    def position_deviation(self) -> float:
        """Standard deviation of x or y, the greater one [m]."""
        return float(self.standard_deviations[:2].max())

    def pose_at(self, time: float) -> Pose:
        """
        Look up where the robot was, by linear interpolation.

        :param time: not more than about a second ago [s].
        :return: its ``Pose``, as estimated by now.
        """
        history = self._history
        after = next((i for i, (t, _) in enumerate(history) if t >= time), None)
        if after is None:
            return history[-1][1]
        if after == 0:
            return history[0][1]
        (begin, a), (end, b) = history[after - 1], history[after]
        ratio = (time - begin) / (end - begin)
        return Pose(a.x + ratio * (b.x - a.x), a.y + ratio * (b.y - a.y),
                    a.theta + ratio * wrap_angle(b.theta - a.theta))

    def predict(self, odometry: Odometry) -> None:
        """
        Move the robot by its odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        """
        if self._odometry is None:
            self._pose = odometry.pose
            self._history.append((odometry.time, odometry.pose))
        elif odometry.time > self._odometry.time:
            self._move(self._odometry.pose.inverse() @ odometry.pose)
            self._history.append((odometry.time, self._pose))
            while odometry.time - self._history[0][0] > HISTORY_TIME:
                self._history.popleft()
        else:
            return
        self._odometry = odometry

    def update_pose(self, error: Sequence[float], covariance: FloatArray,
                    is_certain: bool = True) -> None:
        """
        Correct the pose by a measured error.

        :param error: true minus estimated pose, (x, y, heading) [m, m, rad].
        :param covariance: of that measurement, shape (3, 3).
        :param is_certain: whether the measurement holds even where no drift explains the error;
            else it is rejected then.
        """
        rows = np.eye(POSE_SIZE, STATE_SIZE)
        innovation = np.array([*error[:2], wrap_angle(error[2])])
        if is_certain or not self._is_outlier(rows, innovation, covariance):
            self._update(rows, innovation, covariance)

    def update_along(self, direction: float, error: float, deviation: float,
                     is_certain: bool = True) -> None:
        """
        Correct the pose by an error that was measured along one direction, as by a contact.

        :param direction: world angle [rad].
        :param error: true minus estimated position along it [m].
        :param deviation: standard deviation of that measurement [m].
        :param is_certain: as of ``update_pose``.
        """
        rows = np.array([[math.cos(direction), math.sin(direction), 0.0, 0.0, 0.0]])
        innovation, noise = np.array([error]), np.array([[deviation ** 2]])
        if is_certain or not self._is_outlier(rows, innovation, noise):
            self._update(rows, innovation, noise)

    def inflate_covariance(self, deviation: float) -> None:
        """
        Add to the covariance of the position, as after a search in vain.

        :param deviation: standard deviation of x and of y that is added [m].
        """
        self._covariance[range(2), range(2)] += deviation ** 2

    def _move(self, step: Pose) -> None:
        """Move pose and covariance by a step of odometry, in the robot's axes."""
        length = math.hypot(step.x, step.y)
        x, y = Pose(0.0, 0.0, self._pose.theta).rotate((step.x / (1.0 + self._scale_error),
                                                        step.y / (1.0 + self._scale_error)))
        # Rows x, y, theta; columns theta, s, d; with 1 / (1 + s) taken as 1.
        jacobian = np.eye(STATE_SIZE)
        jacobian[:POSE_SIZE, 2:] = [(-y, -x, 0.0), (x, -y, 0.0), (1.0, 0.0, -length)]
        self._covariance = jacobian @ self._covariance @ jacobian.T
        position = self._settings.odometry_walk
        heading = self._settings.odometry_heading_walk
        diagonal = range(POSE_SIZE)
        self._covariance[diagonal, diagonal] += length * np.square((position, position, heading))
        self._pose = Pose(self._pose.x + x, self._pose.y + y,
                          self._pose.theta + wrap_angle(step.theta) - self._drift * length)

    def _is_outlier(self, rows: FloatArray, innovation: FloatArray, noise: FloatArray) -> bool:
        """Whether no drift explains an error: the wheels have spun, or the robot was moved."""
        spread = rows @ self._covariance @ rows.T + noise
        return bool(innovation @ np.linalg.solve(spread, innovation)
                    > GATE_SIGMAS ** 2 * len(innovation))

    def _update(self, rows: FloatArray, innovation: FloatArray, noise: FloatArray) -> None:
        if self._is_outlier(rows, innovation, noise):
            # The pose has jumped: the covariance takes the jump, so that the update follows it.
            jump = rows.T @ innovation
            self._covariance += np.outer(jump, jump)
        spread = rows @ self._covariance @ rows.T + noise
        gain = self._covariance @ rows.T @ np.linalg.inv(spread)
        x, y, theta, scale_error, drift = (gain @ innovation).tolist()
        self._covariance -= gain @ rows @ self._covariance
        self._pose = Pose(self._pose.x + x, self._pose.y + y, self._pose.theta + theta)
        self._scale_error += scale_error
        self._drift += drift
        # Former poses are those of the former estimate.
        assert self._odometry is not None
        self._history = deque([(self._odometry.time, self._pose)])
