"""What the supervisor of a task tells and asks."""

import dataclasses
from typing import NamedTuple

from push_control.push.controller import ControllerStatus
from push_model.geometry import Pose

STATES = ('idle', 'plan', 'approach', 'align', 'push', 'retreat', 'done', 'failed', 'paused')


class StateChange(NamedTuple):
    """
    A change of state.

    :param time: when [s].
    :param state: the new one, one of ``STATES``.
    :param reason: why, empty where all goes as it should.
    """

    time: float
    state: str
    reason: str


@dataclasses.dataclass(frozen=True)
class SupervisorStatus:
    """
    What the supervisor does, and why.

    :param state: one of ``STATES``.
    :param reason: one sentence, empty while all is well.
    :param since: when this state began [s].
    :param pushes: number of pushes begun for this goal.
    :param recoveries: number of times that something went wrong.
    :param robot_pose: ``Pose`` of the robot in the world, drift of odometry taken off; None before
        the first odometry.
    :param history: ``StateChange`` of every state since the goal was set.
    :param push: ``ControllerStatus`` of the present or last push.
    """

    state: str = 'idle'
    reason: str = ''
    since: float = 0.0
    pushes: int = 0
    recoveries: int = 0
    robot_pose: Pose | None = None
    history: tuple = ()
    push: ControllerStatus = ControllerStatus()
