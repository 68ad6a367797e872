"""
How closely a base is known to follow its commands.

What is tolerated of any base is more than most bases need. One that has kept a closer tolerance
for some seconds, along every axis that moves, is held to it from then on. Where it leaves that
tolerance, as under another load or with noise, it is known less well, and must keep it twice as
long before it is held to it again. A base that has been stopped for it alone may be a good one
under another load, or on a busy computer: that happens once, and then what any base may do counts.
"""

import math
from typing import Sequence

from push_model.signals import Twist

# Lever by which a rotation counts as a distance [m]; chosen: a radius of the robots.
LEVER = 0.2
# How long each axis has to have moved within the close tolerance [s], and what counts as moving
# [m/s]; chosen: two seconds show acceleration and speed, above the noise of odometry.
LEARNING_TIME = 2.0
MOVING_SPEED = 0.012
# Error of the velocity of a base at which its command has jumped [m/s], and how long that shows
# [s]; chosen: above what a command that changes at the limit of the acceleration leaves behind a
# lag of 0.1 s, and longer than a base with another acceleration takes for a jump of 0.6 m/s.
JUMP = 0.15
SETTLING_TIME = 0.4


class CloseFollowing:
    """Notes along which axes, and for how long, a base has followed closely."""

    def __init__(self) -> None:
        """Begin with a base of which nothing is known."""
        self._durations = [0.0, 0.0, 0.0]
        self._learning_time = LEARNING_TIME
        self._is_in_doubt = False
        self._settled_at = -math.inf

    def is_settled(self, error: Sequence[float], time: float) -> bool:
        """
        Tell whether the base has come to follow its commands, or they have jumped just now.

        :param error: what the velocity of a nominal base differs by from its command, three
            numbers [m/s, m/s, rad/s].
        :param time: now [s].
        """
        if max(abs(error[0]), abs(error[1]), LEVER * abs(error[2])) > JUMP:
            self._settled_at = time + SETTLING_TIME
        return time >= self._settled_at

    def add(self, velocity: Twist, dt: float, *, is_close: bool) -> None:
        """
        Note how a base follows.

        :param velocity: ``Twist`` of the model that is nearest.
        :param dt: for how long [s].
        :param is_close: whether it is within the close tolerance.
        """
        if not is_close:
            self._is_in_doubt = True
            return
        if self._is_in_doubt:
            self._is_in_doubt = False
            self._durations = [0.0, 0.0, 0.0]
            self._learning_time *= 2.0
        for axis, moves in enumerate(_moving_axes(velocity)):
            if moves:
                self._durations[axis] += dt

    def give_up(self) -> None:
        """Never hold the base to more than the stated tolerance again."""
        self._learning_time = math.inf

    @property
    def has_given_up(self) -> bool:
        """Whether only the stated tolerance counts."""
        return math.isinf(self._learning_time)

    def is_known(self, velocity: Twist) -> bool:
        """
        Tell whether a base that moves so is known to follow closely; one that stands is not.

        :param velocity: ``Twist`` of the model that is nearest.
        """
        durations = [duration for duration, moves in zip(self._durations, _moving_axes(velocity))
                     if moves]
        return bool(durations) and min(durations) >= self._learning_time


def _moving_axes(velocity: Twist) -> tuple[bool, bool, bool]:
    v_x, v_y, omega = velocity
    return abs(v_x) > MOVING_SPEED, abs(v_y) > MOVING_SPEED, LEVER * abs(omega) > MOVING_SPEED
