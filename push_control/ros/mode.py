"""What the controller's node does, chosen by its parameter ``task``: the interface of a mode."""

import abc
from typing import Any, ClassVar, NamedTuple

from push_control.goal import GoalProgress, PushGoal
from push_control.observation import Observation
from push_control.safety.status import SafetyReport
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.geometry import Pose
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
    What the controller's node does with measurements, goals, plans, maps and services.

    ``required_topic``: topic that it needs besides measurements before it can start.
    ``stops_on_refused_plan``: whether a plan that is
    refused stops the robot. ``reports_events``: whether it reports after every plan, goal, map and
    service, not only after measurements.
    """

    required_topic: ClassVar[str]
    stops_on_refused_plan: ClassVar[bool]
    reports_events: ClassVar[bool]

    @property
    @abc.abstractmethod
    def is_set(self) -> bool:
        """Whether there is something to do."""

    @property
    @abc.abstractmethod
    def is_commanding(self) -> bool:
        """Whether it drives the robot, or holds it for a moment: then measurements must come."""

    @property
    @abc.abstractmethod
    def awaits_plan(self) -> bool:
        """Whether a plan was requested and has not come yet."""

    @property
    @abc.abstractmethod
    def progress(self) -> GoalProgress:
        """How far the pursuit of the goal has come."""

    @abc.abstractmethod
    def reset(self) -> None:
        """Forget everything, as when time went back."""

    @abc.abstractmethod
    def interrupt(self, reason: str) -> None:
        """
        Say, after ``reset``, why the robot stands; a goal that is still known waits for ``start``.

        :param reason: one sentence.
        """

    @abc.abstractmethod
    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before the step with that odometry.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """

    def renew_request(self) -> None:
        """Ask again for a plan that was requested before a gap of odometry."""

    @abc.abstractmethod
    def set_parameters(self, parameters: ControllerParameters) -> None:
        """
        Set parameters; movements use them from the next one on.

        :param parameters: ``ControllerParameters``, with the object and robot of before.
        """

    @abc.abstractmethod
    def set_object(self, parameters: ControllerParameters) -> None:
        """
        Push another object from now on; the robot stands, and has no goal.

        :param parameters: ``ControllerParameters``, with the robot of before.
        """

    @abc.abstractmethod
    def set_goal(self, goal: PushGoal) -> None:
        """
        Pursue a goal, in place of the present one; before the start, keep it until then.

        :param goal: the ``PushGoal``.
        """

    @abc.abstractmethod
    def cancel(self, reason: str) -> None:
        """
        Abandon the goal; the robot may back off before it stands.

        :param reason: one sentence.
        """

    @abc.abstractmethod
    def halt(self, reason: str) -> None:
        """
        Abandon the goal, and stand at once, as where odometry is lost.

        :param reason: one sentence.
        """

    @abc.abstractmethod
    def on_plan(self, message: Any) -> None:
        """
        Handle a plan.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
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
    def refuse_map(self, reason: str) -> None:
        """
        Take note of a map that cannot be brought to the world frame.

        :param reason: one sentence.
        """

    @abc.abstractmethod
    def move_goal(self, correction: Pose) -> None:
        """
        Follow the frame of the goal, which has drifted.

        :param correction: ``Pose`` that takes the former goal to the new one,
            ``correction @ goal``.
        """

    @abc.abstractmethod
    def move_map(self, correction: Pose) -> None:
        """
        Follow the frame of the map, which has drifted.

        :param correction: ``Pose``, likewise.
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
