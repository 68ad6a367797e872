"""
Events that show where a robot is, and verdicts on them.

The first half is what ``LostRobotMonitor`` observes, the second half how it answers.
"""

import dataclasses
from typing import NamedTuple

from push_control.perception.contact_consistency import Touch
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.object_at_rest import TapMotion
from push_model.geometry import Pose
from push_model.signals import ObjectPose


@dataclasses.dataclass(frozen=True)
class TaskStarted:
    """Another task starts: what contacts have shown may have been mended."""


@dataclasses.dataclass(frozen=True)
class RobotLocalized:
    """The robot is where it is estimated to be, as at the start."""


@dataclasses.dataclass(frozen=True)
class RobotMoved:
    """
    The robot has moved.

    :param step: by odometry, as ``Pose`` in its axes before.
    :param object_pose: ``Pose`` of the object as it was seen last, or None.
    """

    step: Pose
    object_pose: Pose | None


@dataclasses.dataclass(frozen=True)
class OdometryFault:
    """
    Odometry is wrong.

    :param has_jumped: whether its pose has jumped, so that the step is not added up.
    """

    has_jumped: bool


@dataclasses.dataclass(frozen=True)
class ObjectPoseRejected:
    """A new object pose is an outlier."""


@dataclasses.dataclass(frozen=True)
class ObjectPoseAccepted:
    """The filter has accepted an object pose."""

    measured: ObjectPose


@dataclasses.dataclass(frozen=True)
class PushSucceeded:
    """
    A push has moved the object.

    :param contact: what it has shown.
    :param time: now [s].
    """

    contact: Touch
    time: float


@dataclasses.dataclass(frozen=True)
class ObjectTapped:
    """A push has moved the object by little, which shows in its average only."""


@dataclasses.dataclass(frozen=True)
class TapCompared:
    """The average of the object at rest shows how a tap has moved it."""

    motion: TapMotion


@dataclasses.dataclass(frozen=True)
class PushWithoutEffect:
    """
    A push has not moved the object, which is at ``object_pose``.

    :param deviation: standard deviation of the robot's position when it should have touched it;
        infinite where the object poses tell no more than that it has not moved along [m].
    """

    object_pose: Pose
    deviation: float


@dataclasses.dataclass(frozen=True)
class UnexpectedContact:
    """The robot has run into the object at ``object_pose``, where it should not be."""

    object_pose: Pose


@dataclasses.dataclass(frozen=True)
class LostRobotTouched:
    """A robot that was lost moves the object, to ``object_pose``."""

    object_pose: Pose


@dataclasses.dataclass(frozen=True)
class ObjectMoved:
    """
    The object has moved while it was not pushed.

    :param before: ``Pose`` that it had at rest.
    :param after: ``Pose`` that it has at rest.
    :param object_pose: ``Pose`` as it was seen last.
    :param time: now [s].
    """

    before: Pose
    after: Pose
    object_pose: Pose
    time: float


LostRobotEvent = (
    TaskStarted | RobotLocalized | RobotMoved | OdometryFault | ObjectPoseRejected
    | ObjectPoseAccepted | PushSucceeded | ObjectTapped | TapCompared | PushWithoutEffect
    | UnexpectedContact | LostRobotTouched | ObjectMoved)


class PlaceRobot(NamedTuple):
    """
    Replace the estimate of the robot.

    :param pose: its ``Pose``, about.
    :param stds: standard deviations of x, y [m] and heading [rad].
    """

    pose: Pose
    stds: tuple[float, float, float]


class RestoreRobot(NamedTuple):
    """
    Return to an earlier estimate of the robot.

    :param memory: ``RobotMemory``.
    :param stds: standard deviations that are added to position [m] and heading [rad].
    """

    memory: RobotMemory
    stds: tuple[float, float]


class InflateRobot(NamedTuple):
    """
    Make the estimate of the robot less certain.

    :param stds: standard deviations that are added to position [m] and heading [rad].
    """

    stds: tuple[float, float]


# None where the estimate stands.
Verdict = PlaceRobot | RestoreRobot | InflateRobot | None
