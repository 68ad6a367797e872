"""
Motion against commands, of a base as stated and of one whose speeds were learned.

A base is at fault where neither explains its motion: not what is stated, nor a constant part of
what is commanded (``push_base.speed_gain``). Both are held to the same tolerances. Without such a
part there is one check only.

What is learned of a base excuses no sudden change: where it has followed closely, and does not any
more, another gain may be learned only after the robot was stopped for that.
"""

import math

from push_base.speed_gain import delivered
from push_model.base_knowledge import BaseKnowledge
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, Twist
from push_safety.motion_check import MotionCheck
from push_safety.status import SafetyReport
from push_safety.tolerances import RELAPSE_TIME


class LearnedMotionCheck:
    """``MotionCheck`` as stated, and another one by the gains that are known."""

    def __init__(self, robot: RoundRobot) -> None:
        """Start with a robot at rest, as stated, whose speeds are those that are commanded."""
        self._robot = robot
        self._stated = MotionCheck(robot)
        self._learned: MotionCheck | None = None
        self._knowledge = BaseKnowledge.stated(robot)
        # Time of the newest odometry, and when the robot last went on after a stop [s].
        self._time = self._forgiven_at = -math.inf

    @property
    def has_changed(self) -> bool:
        """Tell whether the base has changed suddenly, and the robot was not stopped for it."""
        return (all(check.has_changed for check in self._checks)
                and self._time - self._forgiven_at > RELAPSE_TIME)

    def learn(self, knowledge: BaseKnowledge) -> bool:
        """
        Take note of the gains of a base.

        :param knowledge: ``BaseKnowledge``; nothing but its gains counts.
        :return: whether they are new.
        """
        if knowledge.gains == self._knowledge.gains:
            return False
        self._knowledge = knowledge
        # It restarts at the next odometry, and follows the commands from then on.
        self._learned = None if knowledge.gains == (1.0, 1.0) else MotionCheck(self._robot)
        return True

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when [s], of the clock of odometry.
        """
        self._stated.add_command(command, time)
        if self._learned is not None:
            self._learned.add_command(delivered(command, self._robot, self._knowledge), time)

    def check(self, odometry: Odometry) -> SafetyReport | None:
        """
        Compare a measured velocity with the commands before it.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: ``SafetyReport``, or None where the robot follows.
        """
        self._time = odometry.time
        fault = self._stated.check(odometry)
        if self._learned is None:
            return fault
        learned_fault = self._learned.check(odometry)
        if fault is None or learned_fault is None:
            # The other one counts as soon as the base changes.
            self._stated.limit_sums()
            self._learned.limit_sums()
            return None
        return learned_fault

    def reset(self) -> None:
        """Restart at whatever velocity the robot has: somebody else has commanded it."""
        for check in self._checks:
            check.reset()

    def interrupt(self) -> None:
        """Restart at the next odometry; commands sent in between are unknown."""
        for check in self._checks:
            check.interrupt()

    def forgive(self) -> None:
        """Restart with a robot that is at rest as commanded."""
        self._forgiven_at = self._time
        for check in self._checks:
            check.forgive()

    @property
    def _checks(self) -> list[MotionCheck]:
        return [self._stated] + ([] if self._learned is None else [self._learned])
