"""Plays a plan without looking: what feedback is measured against."""

import math

import numpy as np
from push_control.laws.curvature_limits import contact_speed
from push_model.signals import STOP, Twist

MOMENT = 0.02


class OpenLoopPush:
    """The planned robot motion, in the robot's own axes, slowed at both ends."""

    def __init__(self, obj, robot, settings, target, observation):
        """
        Begin at the start of the plan.

        :param obj: the ``PushedObject``; not used, the object is not looked at.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param target: the ``PushTrajectory``.
        :param observation: first ``Observation``; not used.
        """
        self._settings, self._target = settings, target
        self._differential = robot.drive == 'differential'
        self._clock = self._elapsed = 0.0
        speeds = np.hypot(*target.contact_twists[:, :2].T)
        steps = np.diff(target.times) * 0.5 * (speeds[1:] + speeds[:-1])
        self._ways = np.concatenate([[0.0], np.cumsum(steps)])
        self._speeds = speeds
        self.failure, self.notice, self.report = '', '', {}

    def continue_with(self, target, observation):
        """
        Refuse to take up another target: only its start is known.

        :param target: the ``PushTrajectory``; not used.
        :param observation: ``Observation``; not used.
        :return: False.
        """
        return False

    def observe(self, observation):
        """
        Look away.

        :param observation: ``Observation``; not used.
        """

    def pause(self, odometry):
        """
        Stand still; the next advance sets out anew.

        :param odometry: ``Odometry``; not used.
        """
        self._elapsed = 0.0

    def advance(self, time, dt):
        """
        Play on.

        :param time: now [s]; not used.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP at the end of the plan.
        """
        target = self._target
        self._elapsed += dt
        speed = float(np.interp(self._clock, target.times, self._speeds))
        left = self._ways[-1] - float(np.interp(self._clock, target.times, self._ways))
        rate = 1.0 if speed == 0.0 else contact_speed(self._elapsed, left, speed,
                                                      self._settings) / speed
        self._clock = min(self._clock + rate * dt, target.duration)
        if self.finished:
            return STOP
        return self._planned(rate)

    @property
    def finished(self):
        """Whether the plan has been played to its end."""
        return self._clock >= self._target.duration

    def _planned(self, rate):
        """Mean motion over the next moment; it sums up to the planned way across any jump."""
        start, end = (self._robot_pose(self._clock + ahead) for ahead in (0.0, MOMENT))
        v_x, v_y, omega = ((b - a) * rate / MOMENT for a, b in zip(start, end))
        phi = 0.5 * (start[2] + end[2])
        cosine, sine = math.cos(phi), math.sin(phi)
        forward, aside = cosine * v_x + sine * v_y, cosine * v_y - sine * v_x
        return Twist(forward, 0.0 if self._differential else aside, omega)

    def _robot_pose(self, time):
        return [float(np.interp(time, self._target.times, column))
                for column in self._target.robot_poses.T]
