"""
Bases whose speeds are a constant part of what is commanded: tired motors, a wheel that is smaller.

The speed of each wheel of a differential base, and translation and rotation of a holonomic one,
is its gain times the commanded one. As that is linear in the twist, a base makes M c of a command
c, with a matrix M of the two gains; and M^-1 c has to be sent for a motion c.
"""

import numpy as np
from push_model.base_knowledge import BaseKnowledge
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import Twist

# Least gain that commands make up for; chosen: motors get weaker by a fifth, and what slows a base
# down by more, as a collision monitor does, is to be obeyed. Where one wheel is as slow as that,
# the other one turns in proportion: the robot keeps to its arc.
MIN_COMPENSATED = 0.75


def gain_matrix(robot: RoundRobot, first: float, second: float) -> FloatArray:
    """
    Make the matrix M that turns a commanded twist into the one that follows.

    :param robot: the ``RoundRobot``, nominal.
    :param first: gain of the left wheel, or of the translation of a holonomic base.
    :param second: gain of the right wheel, or of the rotation of a holonomic base.
    :return: shape (3, 3).
    """
    if robot.drive != 'differential':
        return np.diag((first, first, second))
    half = 0.5 * robot.wheel_track
    mean, difference = 0.5 * (first + second), 0.5 * (second - first)
    return np.array([[mean, 0.0, half * difference], [0.0, 1.0, 0.0],
                     [difference / half, 0.0, mean]])


def delivered(command: Twist, robot: RoundRobot, knowledge: BaseKnowledge) -> Twist:
    """
    Tell what a base makes of a command in the end.

    :param robot: the ``RoundRobot``, nominal.
    :param knowledge: ``BaseKnowledge`` with its gains.
    :return: ``Twist``; the command itself where both gains are 1.
    """
    return _scaled(command, robot, *knowledge.gains)


def compensated(command: Twist, robot: RoundRobot, knowledge: BaseKnowledge) -> Twist:
    """
    Choose what to send so that a base does what is desired.

    :param robot: the ``RoundRobot``, nominal.
    :param knowledge: ``BaseKnowledge`` with its gains; the motion is slower where the least of
        them is below ``MIN_COMPENSATED``.
    :return: ``Twist``, which may exceed the limits of the robot; the command itself where both
        gains are 1.
    """
    speed_ratio = min(1.0, min(knowledge.gains) / MIN_COMPENSATED)
    first, second = (speed_ratio / gain for gain in knowledge.gains)
    return _scaled(command, robot, first, second)


def _scaled(command: Twist, robot: RoundRobot, first: float, second: float) -> Twist:
    if first == second == 1.0:
        return command
    v_x, v_y, omega = (gain_matrix(robot, first, second) @ command).tolist()
    return Twist(v_x, v_y, omega)
