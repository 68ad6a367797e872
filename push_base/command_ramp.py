"""
Commands that change no faster than a base follows which accelerates less than stated.

Whoever plans a path keeps to the accelerations of its base, but some stop at once or turn round:

    |v_k - v_(k-1)| <= a dt,    |omega_k - omega_(k-1)| <= alpha dt

with the learned accelerations a and alpha. The base does so anyhow, as its velocity smoother has
it; the checks that compare its motion with the commands then see what it does.
"""

import math

from push_model.base_knowledge import BaseKnowledge
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist

# Time after which the last command tells nothing of the present velocity [s]; chosen: ten periods.
MAX_GAP = 0.5


class CommandRamp:
    """Follows commands within the learned accelerations of a base."""

    def __init__(self, robot: RoundRobot) -> None:
        """
        Start with a robot that stands.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._robot = robot
        self._sent = STOP
        self._sent_at = -math.inf

    def reset(self) -> None:
        """Start from a standstill: the robot was stopped, or others have driven it."""
        self._sent = STOP

    def limit(self, command: Twist, knowledge: BaseKnowledge, time: float) -> Twist:
        """
        Come as near to a command as the base can.

        :param command: desired ``Twist``, in the axes of the robot.
        :param knowledge: ``BaseKnowledge``; of a base that accelerates as stated all commands pass
            as they are.
        :param time: [s].
        """
        limited = knowledge.limited(self._robot)
        dt = time - self._sent_at
        if limited is not self._robot and 0.0 <= dt <= MAX_GAP:
            command = self._between(command, limited.max_acceleration * dt,
                                    limited.max_yaw_acceleration * dt)
        self._sent, self._sent_at = command, time
        return command

    def _between(self, command: Twist, step: float, yaw_step: float) -> Twist:
        """Go from the last command towards another one by these steps at most."""
        v_x, v_y, omega = (value - last for value, last in zip(command, self._sent))
        change = math.hypot(v_x, v_y)
        ratio = min(1.0, step / change) if change > 0.0 else 1.0
        return Twist(self._sent.v_x + ratio * v_x, self._sent.v_y + ratio * v_y,
                     self._sent.omega + min(yaw_step, max(-yaw_step, omega)))
