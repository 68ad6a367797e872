"""What is known of a base beside its limits: how late, from which speed on, how fast it moves."""

from collections.abc import Mapping
import dataclasses
import hashlib
import json
import math
from typing import Any, NamedTuple

from push_model.parameters import RoundRobot

# Duration of a pulse [s]; chosen: the wheels of a base reach 0.07 m/s in it at 0.9 m/s^2.
PULSE = 0.08
# Part of a known acceleration that commands keep to; chosen: known ones may be a fifth too high.
ACCELERATION_MARGIN = 0.85
# Hexadecimal digits of a key; chosen: no two robots of a file have the same.
KEY_DIGITS = 16
# Greatest values that are read, by field [s, m/s, rad/s, s]; chosen: beyond what is ever learned.
MAX_VALUES = {'dead_time': 1.0, 'min_speed': 0.5, 'min_yaw_rate': 2.0, 'pulse': 0.5,
              'first_gain': 3.0, 'second_gain': 3.0, 'gain_deviation': 1.0}
# Values that may be 0.
ZERO_VALUES = 'dead_time', 'min_speed', 'min_yaw_rate', 'gain_deviation'


class BaseKnowledge(NamedTuple):
    """
    Knowledge of a base.

    :param dead_time: from a command until the base begins to follow it [s].
    :param min_speed: least speed of a wheel (differential) or of the translation (holonomic) that
        is not 0 [m/s].
    :param min_yaw_rate: least yaw rate of a holonomic base that is not 0 [rad/s].
    :param pulse: duration of the pulses that move it more slowly [s].
    :param max_acceleration: greatest acceleration; infinite for as stated [m/s^2].
    :param max_yaw_acceleration: greatest yaw acceleration, likewise [rad/s^2].
    :param first_gain: speed of the left wheel (differential) or of the translation (holonomic)
        over what is commanded.
    :param second_gain: the same of the right wheel, or of the rotation.
    :param gain_deviation: standard deviation of both; 0 where they are as stated.
    """

    dead_time: float = 0.0
    min_speed: float = 0.0
    min_yaw_rate: float = 0.0
    pulse: float = PULSE
    max_acceleration: float = math.inf
    max_yaw_acceleration: float = math.inf
    first_gain: float = 1.0
    second_gain: float = 1.0
    gain_deviation: float = 0.0

    @property
    def gains(self) -> tuple[float, float]:
        """Both gains."""
        return self.first_gain, self.second_gain

    @classmethod
    def stated(cls, robot: RoundRobot) -> 'BaseKnowledge':
        """
        Take what the parameters of a robot state.

        :param robot: the ``RoundRobot``, nominal.
        """
        return cls(robot.dead_time, robot.min_speed, robot.min_yaw_rate)

    def to_mapping(self) -> dict[str, float]:
        """Turn it into plain numbers by field, as ``from_mapping`` reads them."""
        return {name: float(value) for name, value in self._asdict().items()}

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> 'BaseKnowledge':
        """
        Make it of plain numbers.

        :param values: by field; what is missing is as of a base of which nothing is known.
        :raises ValueError: naming the field that is unknown or wrong.
        """
        for name, value in values.items():
            if name not in cls._fields:
                raise ValueError(f'{name}: got an unknown field, expected one of '
                                 + ', '.join(cls._fields))
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            limit = MAX_VALUES.get(name, math.inf)
            is_allowed_zero = name in ZERO_VALUES
            if not (is_number and 0.0 <= value <= limit and (value > 0.0 or is_allowed_zero)):
                raise ValueError(f'{name}: got {value!r}, expected a number '
                                 f'{"of at least" if is_allowed_zero else "above"} 0'
                                 + (f', up to {limit:g}' if limit < math.inf else ''))
        return cls(**{name: float(value) for name, value in values.items()})

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


def robot_key(robot: RoundRobot) -> str:
    """
    Name a robot by its nominal parameters, the same in every process.

    What was learned of a base belongs to these: once they are stated otherwise it does not hold.

    :return: ``robot_`` and hexadecimal digits.
    """
    text = json.dumps(dataclasses.asdict(robot), sort_keys=True)
    return 'robot_' + hashlib.sha256(text.encode()).hexdigest()[:KEY_DIGITS]
