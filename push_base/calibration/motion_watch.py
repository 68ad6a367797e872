"""
Watch over the motion of a base about which little is known yet.

Along each axis the velocity of a base is between the least and the greatest command, and 0, of
the time within which it answers, or on its way there from velocities of commands before:

    u <- max(0, commands of the last second, u - b dt),    v <= r u + s

and the same to the other side. The margins are generous: bases that are late, slow, or stop for a
while are measured. A base that is beyond them for a while is stopped, whatever the reason.
"""

from collections import deque
from typing import NamedTuple

from push_base.calibration.recording import Interruption
from push_model.parameters import RoundRobot
from push_model.signals import Twist

# Time within which a base answers [s]; chosen: above the dead time of any that can push.
ANSWER_TIME = 1.0
# Part of the stated acceleration with which it brakes at least; chosen: smoothers have a third.
BRAKING_RATIO = 0.25
# Ratio r of speeds, and s of wheels or axes [m/s]; chosen: wheels of another size, and those of
# which one rests at a speed at which the other one turns.
SPEED_RATIO = 1.4
MARGIN = 0.1
# Time beyond the bounds that is no accident [s], and the longest step of which it is a sum.
FAULT_TIME = 0.2
MAX_STEP = 0.1


class _Sent(NamedTuple):
    """A command, and when it was sent [s]."""

    time: float
    twist: Twist


class MotionWatch:
    """Compares the velocities of a base with the commands of the last second."""

    def __init__(self, robot: RoundRobot) -> None:
        """
        Start at rest.

        :param robot: the nominal ``RoundRobot``.
        """
        self._rates = (BRAKING_RATIO * robot.max_acceleration,) * 2 + (
            BRAKING_RATIO * robot.max_yaw_acceleration,)
        self._margins = MARGIN, MARGIN, 2.0 * MARGIN / robot.wheel_track
        self._sent: deque[_Sent] = deque()
        self._lows, self._highs = [0.0] * 3, [0.0] * 3
        self._time: float | None = None
        self._fault_time = 0.0

    def add_command(self, time: float, twist: Twist) -> None:
        """
        Note a command.

        :param time: when it was sent [s].
        :param twist: the ``Twist``.
        """
        self._sent.append(_Sent(time, twist))

    def check(self, time: float, velocity: Twist) -> Interruption | None:
        """
        Compare a velocity with the commands.

        :param time: now, on the clock of the commands [s].
        :param velocity: measured ``Twist``.
        :return: what is wrong; None where nothing is.
        """
        step = 0.0 if self._time is None else min(MAX_STEP, max(0.0, time - self._time))
        self._time = time
        # The command before the last second stands at its start.
        while len(self._sent) > 1 and self._sent[1].time <= time - ANSWER_TIME:
            self._sent.popleft()
        fault: Interruption | None = None
        for axis in range(3):
            fault = self._compare(axis, velocity[axis], step) or fault
        self._fault_time = 0.0 if fault is None else self._fault_time + step
        return fault if self._fault_time > FAULT_TIME else None

    def _compare(self, axis: int, velocity: float, step: float) -> Interruption | None:
        commands = [sent.twist[axis] for sent in self._sent]
        change = self._rates[axis] * step
        low = self._lows[axis] = min(0.0, *commands, self._lows[axis] + change)
        high = self._highs[axis] = max(0.0, *commands, self._highs[axis] - change)
        margin = self._margins[axis]
        if SPEED_RATIO * low - margin <= velocity <= SPEED_RATIO * high + margin:
            return None
        if not any(any(sent.twist) for sent in self._sent):
            return Interruption.NO_STOP
        is_along = any(command * velocity > 0.0 for command in commands)
        return Interruption.RUNAWAY if is_along else Interruption.WRONG_MOTION
