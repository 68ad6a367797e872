"""
When a fault of the commands has an effect: the base moves otherwise than it was commanded to.

A base that is stuck at the command that it gets anyway does what it should, until the commands
change. What it should do is what the true drive would have done since the beginning of the fault
with the commands as they were sent.
"""

from collections.abc import Sequence
import math

from benchmarks.faults.injection import Fault, SentCommand
import numpy as np
from push_dynamics.actuation import limit_command, track_command
from push_dynamics.layout import MAX_ACCELERATION, MAX_YAW_ACCELERATION, TIME_CONSTANT
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_sim_node.tape import Tape

# What the base does otherwise, from which on a fault has an effect: velocity [m/s], and distance
# that it adds up to [m]; chosen: a third of the speed of pushes, and half of what may be driven.
MIN_SPEED = 0.05
MIN_DISTANCE = 0.02
# Lever by which a rotation counts as a distance [m]; chosen: a radius of the robots.
LEVER = 0.2


def effect_time(robot: RoundRobot, fault: Fault, tape: Tape, sent: Sequence[SentCommand]) -> float:
    """
    Find when the base first does something else than it was commanded to.

    :param robot: the true ``RoundRobot``.
    :param fault: the ``Fault``, of commands.
    :param tape: ``Tape`` of the run.
    :param sent: each ``SentCommand``.
    :return: time [s]; nan where it does what it should.
    """
    drive = _drive(robot)
    units = np.array([1.0, 1.0, LEVER])
    first = int(np.searchsorted(tape['time'], fault.start))
    times = tape['time'][first:]
    moved = np.stack([tape[f'robot_{name}'][first:] for name in Twist._fields], axis=1)
    if not len(times):
        return math.nan
    expected, command, remaining = moved[0], STOP, iter([*sent, SentCommand(math.inf, STOP)])
    following = next(remaining)
    gap = np.zeros(3)
    for start, end, measured in zip(times, times[1:], moved[1:]):
        while following.time <= start:
            command, following = following.twist, next(remaining)
        tracked = track_command(*expected.tolist(), tuple(limit_command(robot, command)), drive,
                                float(end - start))
        expected = np.array(tracked[:3])
        difference = (measured - expected) * units
        gap += difference * (end - start)
        if (np.abs(difference).max() > MIN_SPEED or np.abs(gap).max() > MIN_DISTANCE):
            return float(end)
        if end >= fault.end:
            break
    return math.nan


def _drive(robot: RoundRobot) -> FloatArray:
    drive = np.zeros(1 + max(TIME_CONSTANT, MAX_ACCELERATION, MAX_YAW_ACCELERATION))
    drive[TIME_CONSTANT] = robot.time_constant
    drive[MAX_ACCELERATION] = robot.max_acceleration
    drive[MAX_YAW_ACCELERATION] = robot.max_yaw_acceleration
    return drive
