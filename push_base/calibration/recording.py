"""What happened while a base was calibrated: commands and measurements, with their times."""

import dataclasses
import enum
from typing import NamedTuple

from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, Twist


class Purpose(enum.Enum):
    """Purpose of a segment of the program; the value is the text in reports."""

    REST = 'rest'
    STEP = 'step'
    LEVELS = 'steps while it moves'
    RAMP = 'ramp'
    LINE = 'line'
    TURN = 'turn'
    RETURN = 'return'
    SETTLE = 'settle'
    APPROACH = 'way to and from the object'
    TOUCH = 'push'
    CONTACT = 'rest in contact'


class Interruption(enum.Enum):
    """Why the program ended early; the value is the text in reports."""

    BY_USER = 'it was interrupted'
    ODOMETRY_LOST = 'odometry ceased'
    NO_MOTION = 'the base did not move'
    WRONG_MOTION = 'the base moved otherwise than commanded'
    RUNAWAY = 'the base moved much faster than commanded'
    NO_STOP = 'the base did not stop'

    @property
    def is_of_motion(self) -> bool:
        """Tell whether the base moved otherwise than commanded."""
        return self not in (Interruption.BY_USER, Interruption.ODOMETRY_LOST)


class SentCommand(NamedTuple):
    """
    A command.

    :param time: when it was sent [s].
    :param twist: the ``Twist``.
    :param segment: number of the segment of the program that it belongs to.
    :param purpose: ``Purpose`` of that segment.
    """

    time: float
    twist: Twist
    segment: int
    purpose: Purpose


class ReceivedOdometry(NamedTuple):
    """
    Odometry, and when it came.

    :param arrival: on the clock of the commands [s].
    :param odometry: the ``Odometry``, with its stamp.
    """

    arrival: float
    odometry: Odometry


class ReceivedPose(NamedTuple):
    """
    A pose of the object, or of the robot in the world, and when it came.

    :param arrival: on the clock of the commands [s].
    :param measured: the pose, with its stamp.
    """

    arrival: float
    measured: ObjectPose


@dataclasses.dataclass
class Recording:
    """
    Everything that was sent and received.

    :param robot: the nominal ``RoundRobot``.
    :param commands: in the order of their times.
    :param odometry: in the order of their arrival.
    :param object_poses: of an object that stands still, likewise.
    :param robot_poses: of the robot, measured in the world, likewise.
    :param interruption: why it ended early; None where it did not.
    :param object: the nominal ``PushedObject``, where it is to be touched.
    """

    robot: RoundRobot
    commands: list[SentCommand] = dataclasses.field(default_factory=list)
    odometry: list[ReceivedOdometry] = dataclasses.field(default_factory=list)
    object_poses: list[ReceivedPose] = dataclasses.field(default_factory=list)
    robot_poses: list[ReceivedPose] = dataclasses.field(default_factory=list)
    interruption: Interruption | None = None
    object: PushedObject | None = None

    def until(self, time: float) -> 'Recording':
        """
        Return the part before a time.

        :param time: of sending and arrival [s].
        """
        return dataclasses.replace(
            self, commands=[item for item in self.commands if item.time < time],
            odometry=[item for item in self.odometry if item.arrival < time],
            object_poses=[item for item in self.object_poses if item.arrival < time],
            robot_poses=[item for item in self.robot_poses if item.arrival < time])
