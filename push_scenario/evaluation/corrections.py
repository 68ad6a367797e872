"""
Correcting pushes: how long it takes to mend a miss.

A push is a correcting one if it is not the first of its task and begins with the object within
60 mm and 8 degrees of the goal, by the true pose, or comes after such a push. Its time runs from
the end of the push before to its own end: retreat, look, plan, approach and the push itself. A
task that needs none has no such time.
"""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.task.status import StateChange, TaskState
from push_model.geometry import distance, Pose, wrap_angle
from push_sim_node.tape import Tape

# Distance [m] and angle [rad] from the goal within which a push is a correction; set for tasks.
MISS_DISTANCE = 0.06
MISS_ANGLE = math.radians(8.0)


class PushInterval(NamedTuple):
    """Time from the beginning to the end of a push [s]."""

    start: float
    end: float


class Corrections(NamedTuple):
    """
    Correcting pushes of a task.

    :param pushes: their number.
    :param seconds: from the end of the push before the first of them to the end of the last [s].
    """

    pushes: int
    seconds: float


def push_intervals(history: Sequence[StateChange], duration: float) -> list[PushInterval]:
    """
    List when pushes began and ended.

    :param history: ``StateChange`` of every state.
    :param duration: when the task ended [s].
    """
    ends = [change.time for change in history[1:]] + [duration]
    return [PushInterval(change.time, end) for change, end in zip(history, ends)
            if change.state is TaskState.PUSH]


def correcting_pushes(history: Sequence[StateChange], duration: float, tape: Tape,
                      goal: Pose) -> Corrections:
    """
    Find the correcting pushes of a task.

    :param history: ``StateChange`` of every state.
    :param duration: when the task ended [s].
    :param tape: ``Tape`` with the true poses.
    :param goal: goal ``Pose`` of the object.
    """
    pushes = push_intervals(history, duration)
    times, poses = tape['time'], tape.poses('object')
    for index, push in enumerate(pushes[1:], 1):
        pose = Pose(*poses[min(int(np.searchsorted(times, push.start)), len(poses) - 1)].tolist())
        if (distance(pose, goal) <= MISS_DISTANCE
                and abs(wrap_angle(pose.theta - goal.theta)) <= MISS_ANGLE):
            return Corrections(len(pushes) - index, pushes[-1].end - pushes[index - 1].end)
    return Corrections(0, 0.0)
