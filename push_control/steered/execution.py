"""Interface of one push under way, with or without feedback."""

import abc

from push_control.steered.status import ControllerStatus, Phase
from push_model.events import EventReport, sentence
from push_model.observation import Observation
from push_model.signals import Odometry, Twist
from push_model.trajectory import PushTrajectory


class PushExecution(abc.ABC):
    """Moves the robot along the path of one target, from first contact to the end."""

    @property
    @abc.abstractmethod
    def finished(self) -> bool:
        """Tell whether the push has come to its end."""

    @property
    def failure(self) -> EventReport | None:
        """Why the push has failed, or None."""
        return None

    @property
    def notice(self) -> EventReport | None:
        """Notice of an event while the push goes on, or None."""
        return None

    @property
    def replan_requested(self) -> bool:
        """Tell whether it has failed where another plan may bring the object to its goal."""
        return False

    def pose_fault(self, time: float) -> EventReport | None:
        """
        Tell why object poses have not been believed for a while.

        :param time: now [s].
        :return: ``EventReport``, or None where it is known where the object is, or need not be.
        """
        return None

    @abc.abstractmethod
    def continue_with(self, target: PushTrajectory, observation: Observation) -> bool:
        """
        Change over to another target without a stop, where that starts at the present push.

        :param observation: the newest ``Observation``.
        :return: whether it does; nothing has changed otherwise.
        :raises ValueError: where the robot does not touch the object at the target's start.
        """

    @abc.abstractmethod
    def observe(self, observation: Observation) -> None:
        """
        Process the measurements that are new.

        :param observation: ``Observation``, usable.
        """

    @abc.abstractmethod
    def pause(self, odometry: Odometry | None) -> None:
        """
        Stand still; the next ``advance`` sets out from rest.

        :param odometry: ``Odometry`` to process meanwhile, or None.
        """

    @abc.abstractmethod
    def advance(self, time: float, dt: float) -> Twist:
        """
        Compute the command.

        :param time: now [s].
        :param dt: time since the last call [s].
        :return: ``Twist`` in the robot's axes; STOP once ``finished`` or ``failure`` is set.
        """

    def status(self, phase: Phase, event: EventReport | None) -> ControllerStatus:
        """
        Describe the push.

        :param phase: the controller's ``Phase``.
        :param event: ``EventReport`` of what is out of the ordinary, or None.
        """
        return plain_status(phase, event)


def plain_status(phase: Phase, event: EventReport | None) -> ControllerStatus:
    """
    Make the status of a controller that knows nothing of the object.

    :param phase: its ``Phase``.
    :param event: ``EventReport`` of what is out of the ordinary, or None.
    """
    return ControllerStatus(phase, sentence(event), None if event is None else event.code)
