"""Plays a plan without looking: what feedback is measured against."""

import math
from types import MappingProxyType

import numpy as np

from push_control.feedback import contact_speed
from push_model.signals import STOP, Twist


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
        self._sideways = robot.drive == 'holonomic'
        self._clock = self._elapsed = 0.0
        speeds = np.hypot(*target.contact_twists[:, :2].T)
        steps = np.diff(target.times) * 0.5 * (speeds[1:] + speeds[:-1])
        self._ways = np.concatenate([[0.0], np.cumsum(steps)])
        self._speeds = speeds

    failure = ''
    report = MappingProxyType({})

    def observe(self, observation):
        """
        Look away.

        :param observation: ``Observation``; not used.
        """

    def pause(self):
        """Stand still for a while, without losing the place in the plan."""

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
        self._clock += rate * dt
        if self.finished:
            return STOP
        planned = target.at(self._clock)
        v_x, v_y, omega = (rate * float(value) for value in planned['robot_twists'])
        phi = float(planned['robot_poses'][2])
        cosine, sine = math.cos(phi), math.sin(phi)
        v_left = cosine * v_y - sine * v_x if self._sideways else 0.0
        return Twist(cosine * v_x + sine * v_y, v_left, omega)

    @property
    def finished(self):
        """Whether the plan has been played to its end."""
        return self._clock >= self._target.duration
