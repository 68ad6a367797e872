"""Behaviours: what the robot does in one state of a task, and what all of them know."""

import abc
from typing import NamedTuple

from push_control.push.status import ControllerStatus
from push_control.settings import ControlSettings
from push_control.task.perception import TaskPerception
from push_control.task.settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings


class BehaviorContext(NamedTuple):
    """
    What a behaviour acts upon.

    :param obj: the ``PushedObject`` as identified so far.
    :param robot: the ``RoundRobot``.
    :param control: ``ControlSettings``.
    :param drive: ``DriveSettings``.
    :param supervision: ``SupervisionSettings``.
    :param occupancy_map: the ``OccupancyMap``, or None on open floor.
    """

    obj: PushedObject
    robot: RoundRobot
    control: ControlSettings
    drive: DriveSettings
    supervision: SupervisionSettings
    occupancy_map: OccupancyMap | None = None


class Behavior(abc.ABC):
    """
    What the robot does in one state of a task.

    ``finished``: whether it has ended well. ``failure_reason``: why it has ended otherwise, one
    sentence; empty while it has not.
    """

    def __init__(self) -> None:
        """Begin."""
        self.finished = False
        self.failure_reason = ''

    @abc.abstractmethod
    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """
        Compute the command.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is a ``failure_reason``.
        """

    @abc.abstractmethod
    def pause(self) -> None:
        """Note that the robot stands for now; the next step goes on from wherever it is."""

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """
        Tell whether a new map has an obstacle in the way where the former one has none.

        :param occupancy_map: the new ``OccupancyMap``, or None for open floor.
        :param pose: ``Pose`` of the robot.
        """
        return False

    @property
    def push_reason(self) -> str:
        """What is out of the ordinary in a push, one sentence; empty while all is well."""
        return self.failure_reason

    @property
    def push_status(self) -> ControllerStatus | None:
        """``ControllerStatus`` of a push; None for all other behaviours."""
        return None
