"""What the controller's node does, chosen by its parameter ``task``: the interface of a mode."""

import abc
from typing import Any, ClassVar, NamedTuple

from push_control.observation import Observation
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_navigation.settings import DriveSettings
from push_ros.node import ServiceAnswer


class ControllerParameters(NamedTuple):
    """
    Parameters of the controller, by section.

    :param object: the nominal ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param control: ``ControlSettings``.
    :param drive: ``DriveSettings``; for tasks.
    :param supervision: ``SupervisionSettings``; for tasks.
    """

    object: PushedObject
    robot: RoundRobot
    control: ControlSettings
    drive: DriveSettings
    supervision: SupervisionSettings


class Mode(abc.ABC):
    """
    What the controller's node does with measurements, plans, goals, maps and services.

    ``required_topic``: topic that it needs besides measurements before it can start.
    ``awaited``: what comes on it, in words. ``stops_on_refused_plan``: whether a plan that is
    refused stops the robot. ``reports_events``: whether it reports after every plan, goal, map and
    service, not only after measurements.
    """

    required_topic: ClassVar[str]
    awaited: ClassVar[str]
    stops_on_refused_plan: ClassVar[bool]
    reports_events: ClassVar[bool]

    @property
    @abc.abstractmethod
    def is_set(self) -> bool:
        """Whether there is something to do."""

    @property
    @abc.abstractmethod
    def is_active(self) -> bool:
        """Whether it does it, so that measurements must come."""

    @property
    @abc.abstractmethod
    def awaits_plan(self) -> bool:
        """Whether a plan was requested and has not come yet."""

    @abc.abstractmethod
    def reset(self) -> None:
        """Forget everything, as time went back."""

    @abc.abstractmethod
    def on_plan(self, message: Any) -> None:
        """
        Handle a plan.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used.
        """

    @abc.abstractmethod
    def on_goal(self, message: Any) -> None:
        """
        Handle a goal.

        :param message: ``geometry_msgs/PoseStamped``.
        :raises MessageRefused: where it cannot be used.
        """

    @abc.abstractmethod
    def on_map(self, message: Any) -> None:
        """
        Handle a map.

        :param message: ``nav_msgs/OccupancyGrid``.
        :raises MessageRefused: where it cannot be used.
        """

    @abc.abstractmethod
    def start(self) -> None:
        """Start, or start over."""

    @abc.abstractmethod
    def stop(self) -> None:
        """Stop, until ``start``."""

    @abc.abstractmethod
    def pause(self) -> ServiceAnswer:
        """Stand until ``resume``."""

    @abc.abstractmethod
    def resume(self) -> ServiceAnswer:
        """Go on after a pause."""

    @abc.abstractmethod
    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """

    @abc.abstractmethod
    def report(self, stamp: Any, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param stamp: ``builtin_interfaces/Time`` of the measurement.
        :param time: of the newest measurement [s].
        """

    @abc.abstractmethod
    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
