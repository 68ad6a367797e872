"""A goal for the object, how far its pursuit has come, and how it ended."""

import dataclasses
import enum
import math
from typing import NamedTuple

from push_model.events import AnyReport
from push_model.geometry import Pose
from push_model.outlook import Outlook
from push_model.plan_request import (
    check_heading_tolerance, MAX_HEADING_TOLERANCE, MAX_TOLERANCE, MIN_TOLERANCE)
from push_model.signals import PoseDeviation


class PushState(enum.Enum):
    """State of the pursuit of a goal; the names are those of the constants of ``PushStatus``."""

    IDLE = 'idle'
    PLANNING = 'planning'
    APPROACHING = 'approaching'
    ALIGNING = 'aligning'
    PUSHING = 'pushing'
    RETREATING = 'retreating'
    REACHED = 'reached'
    FAILED = 'failed'
    PAUSED = 'paused'
    LOOKING = 'looking'


class GoalOutcome(enum.Enum):
    """Outcome of the pursuit of a goal."""

    REACHED = 'reached'
    # By whoever gave the goal, or by the service that stops the robot.
    CANCELLED = 'cancelled'
    # By another goal.
    REPLACED = 'replaced'
    TIMED_OUT = 'timed out'
    # There is no plan: in a task, twice from the same place.
    NO_PLAN = 'no plan'
    # A single push was lost, or a task made no progress.
    FAILED = 'failed'
    # The controller was deactivated, or time went back.
    INTERRUPTED = 'interrupted'


class TaskFailure(enum.Enum):
    """Why a task was given up."""

    # Planning failed twice from the same place.
    NO_PLAN = 'no plan'
    NO_PROGRESS = 'no progress'
    # A single push has failed.
    PUSH_FAILED = 'push failed'
    NOT_AT_REST = 'not at rest'
    # Poses or odometry do not come, or cannot be used.
    NO_MEASUREMENTS = 'no measurements'
    # The safety layer has stopped the robot too often.
    ROBOT_STOPPED = 'robot stopped'
    # The wheels spin or stall at the object, which hardly moves.
    TOO_HEAVY = 'too heavy'
    # The robot has looked for the object all around.
    OBJECT_NOT_SEEN = 'object not seen'


@dataclasses.dataclass(frozen=True)
class PushGoal:
    """
    Goal for the object.

    :param pose: goal ``Pose`` of the object in the world.
    :param position_tolerance: distance from the goal at which it is reached [m]; None for that of
        the parameters.
    :param heading_tolerance: heading error at which it is reached [rad]; None likewise; 2 pi for
        any heading.
    :param time_limit: time after which it is abandoned [s]; infinite for none.
    :raises ValueError: naming the field, what came and what was expected.
    """

    pose: Pose
    position_tolerance: float | None = None
    heading_tolerance: float | None = None
    time_limit: float = math.inf

    def __post_init__(self) -> None:
        """Validate the fields."""
        if not self.pose.is_finite():
            raise ValueError(f'goal: got {self.pose}, expected three finite numbers')
        for name, most in (('position_tolerance', MAX_TOLERANCE),
                           ('heading_tolerance', MAX_HEADING_TOLERANCE)):
            value = getattr(self, name)
            if value is not None and not MIN_TOLERANCE <= value <= most:
                raise ValueError(f'goal: {name}: got {value:g}, expected a number from '
                                 f'{MIN_TOLERANCE:g} to {most:g}')
        if self.heading_tolerance is not None:
            check_heading_tolerance('goal', self.heading_tolerance)
        if not self.time_limit > 0.0:
            raise ValueError(f'goal: time_limit: got {self.time_limit:g}, expected a number '
                             'above 0 [s]')


class TaskGoal(NamedTuple):
    """
    Goal of a task that is under way.

    :param pose: goal ``Pose`` of the object in the world.
    :param since: time up to which object poses tell nothing of where the object is [s]: somebody
        may have moved it before the goal came. Minus infinity where they do.
    """

    pose: Pose
    since: float = -math.inf


class GoalProgress(NamedTuple):
    """
    Progress of the pursuit of a goal.

    :param state: what the robot does, a ``PushState``.
    :param cause: ``Report`` of why, or of what is wrong; None while all is well.
    :param outcome: the ``GoalOutcome``, once the robot has ended by itself; else None.
    :param pushes: number of pushes begun.
    :param position_error: distance of the object from its goal as last measured or estimated [m];
        nan before.
    :param heading_error: heading of the object minus that of its goal [rad]; nan before.
    :param deviation: ``PoseDeviation`` of the object in the frame of its goal, where that drifts
        with odometry; None where it does not.
    :param outlook: ``Outlook`` from now on; None where none is known.
    :param robot_pose: estimated ``Pose`` of the robot in the world; None before it is known.
    """

    state: PushState = PushState.IDLE
    cause: AnyReport | None = None
    outcome: GoalOutcome | None = None
    pushes: int = 0
    position_error: float = math.nan
    heading_error: float = math.nan
    deviation: PoseDeviation | None = None
    outlook: Outlook | None = None
    robot_pose: Pose | None = None
