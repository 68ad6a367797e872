"""The pieces of a plan, in time."""

from typing import NamedTuple

import numpy as np


class Piece(NamedTuple):
    """
    A piece of a push.

    :param angles: pushing angle at its begin and its end, linear in the way [rad].
    :param speeds: of the contact, its square linear in the way [m/s].
    :param length: way of the contact [m].
    """

    angles: tuple
    speeds: tuple
    length: float

    @property
    def acceleration(self):
        """Of the contact along the push [m/s^2]."""
        return 0.5 * (self.speeds[1] ** 2 - self.speeds[0] ** 2) / self.length

    @property
    def duration(self):
        """Time that it takes [s]."""
        return 2.0 * self.length / (self.speeds[0] + self.speeds[1])

    def at(self, time):
        """Pushing angle [rad], its rate [rad/s], and speed [m/s] after a time [s]."""
        speed = self.speeds[0] + self.acceleration * time
        bend = (self.angles[1] - self.angles[0]) / self.length
        way = 0.5 * (self.speeds[0] + speed) * time
        return self.angles[0] + bend * way, bend * speed, speed


def pieces_of(plan, pace=1.0):
    """
    List the pieces of a plan.

    :param plan: the ``Plan``.
    :param pace: factor on all its speeds.
    :return: list of ``Piece``.
    """
    lengths = np.diff(plan.segment_ends, prepend=0.0).tolist()
    return [Piece(angles, (pace * speeds[0], pace * speeds[1]), length)
            for angles, speeds, length in zip(plan.pushing_angles, plan.speeds, lengths)]


def joined(pieces):
    """
    Join neighbours that push on at the same angle and speed.

    :param pieces: list of ``Piece``.
    :return: list of ``Piece``, as few as there can be.
    """
    found = []
    for piece in pieces:
        steady = len({*piece.angles}) == len({*piece.speeds}) == 1
        if found and steady and found[-1][:2] == piece[:2]:
            found[-1] = found[-1]._replace(length=found[-1].length + piece.length)
        else:
            found.append(piece)
    return found
