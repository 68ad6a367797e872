"""What is known of a base beside its limits: how late, from which speed on, how fast it moves."""

import dataclasses
import math
from typing import NamedTuple

from push_model.parameters import RoundRobot

# Duration of a pulse [s]; chosen: the wheels of a base reach 0.07 m/s in it at 0.9 m/s^2.
PULSE = 0.08
# Part of a known acceleration that commands keep to; chosen: known ones may be a fifth too high.
ACCELERATION_MARGIN = 0.85


class BaseKnowledge(NamedTuple):
    """
    What is known of a base.

    :param dead_time: from a command until the base begins to follow it [s].
    :param min_speed: least speed of a wheel (differential) or of the translation (holonomic) that
        is not 0 [m/s].
    :param min_yaw_rate: least yaw rate of a holonomic base that is not 0 [rad/s].
    :param pulse: duration of the pulses that move it more slowly [s].
    :param max_acceleration: greatest acceleration; infinite for as stated [m/s^2].
    :param max_yaw_acceleration: greatest yaw acceleration, likewise [rad/s^2].
    """

    dead_time: float = 0.0
    min_speed: float = 0.0
    min_yaw_rate: float = 0.0
    pulse: float = PULSE
    max_acceleration: float = math.inf
    max_yaw_acceleration: float = math.inf

    @classmethod
    def stated(cls, robot: RoundRobot) -> 'BaseKnowledge':
        """
        Take what the parameters of a robot state.

        :param robot: the ``RoundRobot``, nominal.
        """
        return cls(robot.dead_time, robot.min_speed, robot.min_yaw_rate)

    def limited(self, robot: RoundRobot) -> RoundRobot:
        """
        Limit the accelerations of a robot to what commands may ask of its base.

        :param robot: the ``RoundRobot``, nominal; itself where it reaches what is stated.
        """
        acceleration = min(robot.max_acceleration, ACCELERATION_MARGIN * self.max_acceleration)
        yaw_acceleration = min(robot.max_yaw_acceleration,
                               ACCELERATION_MARGIN * self.max_yaw_acceleration)
        if (acceleration, yaw_acceleration) == (robot.max_acceleration,
                                                robot.max_yaw_acceleration):
            return robot
        return dataclasses.replace(robot, max_acceleration=acceleration,
                                   max_yaw_acceleration=yaw_acceleration)
