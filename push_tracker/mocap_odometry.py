"""
Odometry of a robot from the poses of a rigid body that motion capture follows.

The pose is that of the body, less its mounting. The velocity is the slope of the straight line
that fits the poses of a window best, turned into the axes of the robot in the middle of it:

    v = sum_i (t_i - t_m) (p_i - p_m) / sum_i (t_i - t_m)^2,    t_m, p_m: means

With n poses of the standard deviation sigma in the window T, that of a component of v is about
``sigma sqrt(12 / n) / T``. On an arc the line is shorter than the arc, by (omega T)^2 / 40 of it.
"""

from collections import deque
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.signals import Odometry, PoseCovariance, Twist
from push_tracker.mocap_settings import MocapSettings

# Standard deviations of both poses by which two of them may differ without motion; chosen.
GATE_SIGMAS = 6.0


class _Sample(NamedTuple):
    """Pose of the robot at a time [s]; its heading is not wrapped."""

    time: float
    pose: Pose


class MocapOdometry:
    """
    Turns poses of a rigid body into odometry of the robot.

    ``outliers``: poses in a row that the robot cannot have reached.
    """

    def __init__(self, settings: MocapSettings) -> None:
        """Start without a pose."""
        self._settings = settings
        self._from_body = settings.mounting.inverse()
        self._covariance = PoseCovariance.from_deviations(settings.position_noise,
                                                          settings.heading_noise)
        self.reset()

    def reset(self) -> None:
        """Forget all poses, as when time went back."""
        self._samples: deque[_Sample] = deque()
        self.outliers = 0

    def update(self, time: float, body: Pose) -> Odometry | None:
        """
        Take in a pose of the rigid body.

        A pose that the robot cannot have reached since the last one is an outlier, as where two
        bodies were mistaken for each other. After ``confirmations`` of them the robot was put
        elsewhere: odometry jumps there.

        :param time: of the pose [s].
        :param body: ``Pose`` in the world.
        :return: ``Odometry`` at that time; None for an outlier, for a pose that is not newer than
            the last one, and for the first one after a gap, with which no velocity is known.
        """
        samples, pose = self._samples, body @ self._from_body
        if samples and time <= samples[-1].time:
            return None
        if samples and not self._is_reachable(samples[-1], time, pose):
            self.outliers += 1
            if self.outliers < self._settings.confirmations:
                return None
            samples.clear()
        self.outliers = 0
        theta = pose.theta
        if samples:
            before = samples[-1].pose.theta
            theta = before + wrap_angle(theta - before)
        samples.append(_Sample(time, pose._replace(theta=theta)))
        # Window and stamps are decimal fractions, of which floats are none: half a nanosecond.
        while time - samples[0].time > self._settings.window + 5e-10:
            samples.popleft()
        if len(samples) < 2:
            return None
        return Odometry(time, pose._replace(theta=wrap_angle(theta)), self._twist(),
                        self._covariance)

    def _is_reachable(self, before: _Sample, time: float, pose: Pose) -> bool:
        settings, duration = self._settings, time - before.time
        return (distance(before.pose, pose)
                <= settings.max_speed * duration + GATE_SIGMAS * settings.position_noise
                and abs(wrap_angle(pose.theta - before.pose.theta))
                <= settings.max_yaw_rate * duration + GATE_SIGMAS * settings.heading_noise)

    def _twist(self) -> Twist:
        """Compute the mean velocity of the window, in the axes of the robot at its middle."""
        times: FloatArray = np.array([sample.time for sample in self._samples])
        poses: FloatArray = np.array([sample.pose for sample in self._samples])
        times -= times.mean()
        heading = float(poses[:, 2].mean())
        v_x, v_y, omega = (times @ poses / (times @ times)).tolist()
        return Twist(*Pose(0.0, 0.0, -heading).rotate((v_x, v_y)), omega)
