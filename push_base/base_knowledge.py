"""What is known of a base beside its limits: how late it follows, and from which speed on."""

from typing import NamedTuple

from push_model.parameters import RoundRobot

# Duration of a pulse [s]; chosen: the wheels of a base reach 0.07 m/s in it at 0.9 m/s^2.
PULSE = 0.08


class BaseKnowledge(NamedTuple):
    """
    What is known of a base.

    :param dead_time: from a command until the base begins to follow it [s].
    :param min_speed: least speed of a wheel (differential) or of the translation (holonomic) that
        is not 0 [m/s].
    :param min_yaw_rate: least yaw rate of a holonomic base that is not 0 [rad/s].
    :param pulse: duration of the pulses that move it more slowly [s].
    """

    dead_time: float = 0.0
    min_speed: float = 0.0
    min_yaw_rate: float = 0.0
    pulse: float = PULSE

    @classmethod
    def stated(cls, robot: RoundRobot) -> 'BaseKnowledge':
        """
        Take what the parameters of a robot state.

        :param robot: the ``RoundRobot``, nominal.
        """
        return cls(robot.dead_time, robot.min_speed, robot.min_yaw_rate)
