"""A push without feedback: the baseline that the steering laws are measured against."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.execution import PushExecution
from push_control.steered.laws.command import contact_speed
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_model.trajectory import PushTrajectory

# Window over which the planned motion is averaged [s]; chosen: one period of odometry at 50 Hz.
AVERAGING_WINDOW = 0.02


class OpenLoopPush(PushExecution):
    """Plays the planned robot motion in the robot's own axes, slowed down at both ends."""

    def __init__(self, robot: RoundRobot, settings: ControlSettings, target: PushTrajectory):
        """Start at the start of the plan."""
        self._is_differential = robot.drive == 'differential'
        self._settings = settings
        self._target = target
        self._plan_time = 0.0
        self._elapsed = 0.0
        self._speeds = np.hypot(*target.contact_twists[:, :2].T)
        steps = np.diff(target.times) * 0.5 * (self._speeds[1:] + self._speeds[:-1])
        self._distances = np.concatenate([[0.0], np.cumsum(steps)])

    def continue_with(self, target: PushTrajectory, observation: Observation) -> bool:
        """
        Refuse another target: without measurements only the start of a plan is known.

        :param target: the ``PushTrajectory``; not used.
        :param observation: ``Observation``; not used.
        :return: False.
        """
        return False

    def observe(self, observation: Observation) -> None:
        """
        Ignore the measurements.

        :param observation: ``Observation``; not used.
        """

    def pause(self, odometry: Odometry | None) -> None:
        """
        Stand still; the next ``advance`` sets out from rest.

        :param odometry: ``Odometry``; not used.
        """
        self._elapsed = 0.0

    def advance(self, time: float, dt: float) -> Twist:
        """
        Play the plan on.

        :param time: now [s]; not used.
        :return: ``Twist`` in the robot's axes; STOP at the end of the plan.
        """
        target = self._target
        self._elapsed += dt
        planned_speed = float(np.interp(self._plan_time, target.times, self._speeds))
        covered = float(np.interp(self._plan_time, target.times, self._distances))
        rate = 1.0
        if planned_speed != 0.0:
            speed = contact_speed(self._elapsed, self._distances[-1] - covered, planned_speed,
                                  self._settings)
            rate = speed / planned_speed
        self._plan_time = min(self._plan_time + rate * dt, target.duration)
        return STOP if self.finished else self._planned_twist(rate)

    @property
    def finished(self) -> bool:
        """Tell whether the plan has been played to its end."""
        return self._plan_time >= self._target.duration

    def _planned_twist(self, rate: float) -> Twist:
        """Average the planned motion over the next moment, so that no jump of it gets lost."""
        start = self._robot_pose(self._plan_time)
        end = self._robot_pose(self._plan_time + AVERAGING_WINDOW)
        v_x, v_y, omega = ((b - a) * rate / AVERAGING_WINDOW for a, b in zip(start, end))
        phi = 0.5 * (start.theta + end.theta)
        cosine, sine = math.cos(phi), math.sin(phi)
        forward, sideways = cosine * v_x + sine * v_y, cosine * v_y - sine * v_x
        return Twist(forward, 0.0 if self._is_differential else sideways, omega)

    def _robot_pose(self, time: float) -> Pose:
        """Interpolate the planned pose of the robot; its angle is not wrapped."""
        return Pose(*(float(np.interp(time, self._target.times, column))
                      for column in self._target.robot_poses.T))
