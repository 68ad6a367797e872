"""
What a base that follows late will do with the commands that are under way.

With dead time tau and lag T, a command c acts from tau after it was sent. From the measured
velocity v on, each command that acts for a time h in the dead time ahead moves the base by

    c h + (v - c) T (1 - exp(-h / T)),    v <- c + (v - c) exp(-h / T)

turned by half of the rotation within it, and all before it.
"""

from collections import deque
import math
from typing import NamedTuple

from push_model.geometry import Pose
from push_model.parameters import MAX_DEAD_TIME, RoundRobot
from push_model.signals import STOP, Twist

# Time for which commands are kept [s].
MEMORY = 2.0 * MAX_DEAD_TIME


class PredictedMotion(NamedTuple):
    """
    Motion within the dead time, which no command can change any more.

    :param displacement: ``Pose`` of the robot after it, in its present axes.
    :param velocity: ``Twist`` after it, own axes.
    """

    displacement: Pose
    velocity: Twist


class BaseModel:
    """
    Remembers the commands that are under way.

    ``dead_time``: from a command until the base begins to follow it [s].
    """

    def __init__(self, robot: RoundRobot) -> None:
        """
        Start with a robot that nobody has commanded.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._lag = robot.time_constant
        self._commands: deque[tuple[float, Twist]] = deque()
        self.dead_time = robot.dead_time

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command, as it is meant: pulses that give its mean do not count.

        :param time: when [s].
        """
        commands = self._commands
        if commands and time < commands[-1][0]:
            # Time fell back: nothing is known of what is under way.
            commands.clear()
        commands.append((time, command))
        while len(commands) > 1 and commands[1][0] < time - MEMORY:
            commands.popleft()

    def has_pending_motion(self, time: float) -> bool:
        """
        Tell whether a command is under way that is not to stand.

        :param time: now [s].
        """
        return self.dead_time > 0.0 and any(
            command != STOP for _, command in self._pending(time))

    def predict(self, velocity: Twist, time: float) -> PredictedMotion:
        """
        Predict the motion within the dead time.

        :param velocity: measured ``Twist``, own axes.
        :param time: now [s].
        """
        x = y = theta = 0.0
        if self.dead_time == 0.0:
            return PredictedMotion(Pose(x, y, theta), velocity)
        for duration, command in self._pending(time):
            decay = -math.expm1(-duration / self._lag) if self._lag > 0.0 else 1.0
            d_x, d_y, rotation = (c * duration + (v - c) * self._lag * decay
                                  for c, v in zip(command, velocity))
            d_x, d_y = Pose(0.0, 0.0, theta + 0.5 * rotation).rotate((d_x, d_y))
            x, y, theta = x + d_x, y + d_y, theta + rotation
            velocity = Twist(*(v + decay * (c - v) for c, v in zip(command, velocity)))
        return PredictedMotion(Pose(x, y, theta), velocity)

    def _pending(self, time: float) -> list[tuple[float, Twist]]:
        """List durations and commands that act within the dead time ahead, in order."""
        start, commands = time - self.dead_time, self._commands
        if not commands:
            return [(self.dead_time, STOP)]
        pending = []
        if commands[0][0] > start:
            pending.append((min(time, commands[0][0]) - start, STOP))
        for k, (sent, command) in enumerate(commands):
            end = commands[k + 1][0] if k + 1 < len(commands) else time
            duration = min(end, time) - max(sent, start)
            if duration > 0.0:
                pending.append((duration, command))
        return pending
