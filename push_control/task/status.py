"""States of a task, and the status that its supervisor reports."""

import dataclasses
import enum
from typing import NamedTuple

from push_control.goal import TaskFailure
from push_control.steered.status import ControllerStatus
from push_model.events import Codes
from push_model.geometry import Pose
from push_model.outlook import Outlook
from push_model.signals import PoseDeviation


class TaskState(enum.Enum):
    """State of a task; the values are those of messages, tables and files."""

    IDLE = 'idle'
    PLAN = 'plan'
    APPROACH = 'approach'
    ALIGN = 'align'
    PUSH = 'push'
    RETREAT = 'retreat'
    LOOK = 'look'
    DONE = 'done'
    FAILED = 'failed'
    PAUSED = 'paused'

    @property
    def is_standing(self) -> bool:
        """Tell whether the robot stands, and goes on only on request of the user."""
        return self in STANDING_STATES

    @property
    def is_final(self) -> bool:
        """Tell whether the task is over, well or not."""
        return self in FINAL_STATES


FINAL_STATES = (TaskState.DONE, TaskState.FAILED)
STANDING_STATES = (TaskState.IDLE, TaskState.PAUSED, *FINAL_STATES)


class StateChange(NamedTuple):
    """
    A change of state.

    :param time: when [s].
    :param state: the new ``TaskState``.
    :param reason: why, one sentence; empty where all goes as it should.
    :param is_requested: whether the user asked for it, so that the reason is no fault.
    :param codes: of the reason, as of ``Report``.
    """

    time: float
    state: TaskState
    reason: str
    is_requested: bool = False
    codes: Codes = ()


@dataclasses.dataclass(frozen=True)
class SupervisorStatus:
    """
    Status of the supervisor, with its reason.

    :param state: the present ``TaskState``.
    :param reason: one sentence, empty while all is well.
    :param since: when this state was entered [s].
    :param pushes: number of pushes begun for this goal.
    :param recoveries: number of failures recovered from for this goal.
    :param robot_pose: ``Pose`` of the robot in the world, corrected for the drift of its odometry;
        None before the first odometry.
    :param history: ``StateChange`` of every state since the goal was set.
    :param push: ``ControllerStatus`` of the present or last push.
    :param is_requested: whether the user asked for this state, so that the reason is no fault.
    :param failure: the ``TaskFailure`` where the state is ``FAILED``, else None.
    :param codes: of the reason, as of ``Report``.
    :param goal_deviation: ``PoseDeviation`` of the object in the frame of its goal, where the
        place of that drifts with odometry; None where it does not.
    :param outlook: ``Outlook`` of the last plan, from now on; None where none was stated for this
        goal, or it has ended.
    """

    state: TaskState = TaskState.IDLE
    reason: str = ''
    since: float = 0.0
    pushes: int = 0
    recoveries: int = 0
    robot_pose: Pose | None = None
    history: tuple[StateChange, ...] = ()
    push: ControllerStatus = ControllerStatus()
    is_requested: bool = False
    failure: TaskFailure | None = None
    codes: Codes = ()
    goal_deviation: PoseDeviation | None = None
    outlook: Outlook | None = None
