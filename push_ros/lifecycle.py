"""Managed nodes: configure, activate, deactivate and clean up, by the lifecycle of ROS 2."""

import abc
from collections.abc import Callable, Generator, Mapping, Sequence
import contextlib
import traceback
from typing import Any

from lifecycle_msgs.msg import State
from lifecycle_msgs.srv import ChangeState
from push_ros.diagnostics import ERROR, OK
from push_ros.executor import BackgroundGroup, RCLError, without_location
from push_ros.node import AnyAnswer, PushNode, ServiceAnswer
from push_ros.parameters import Section
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn
from rclpy.service import Service

INACTIVE = ServiceAnswer(False, 'is inactive: activate the node first')


class ManagedNode(LifecycleNodeMixin, PushNode):
    """
    A ``PushNode`` that is silent but for diagnostics until it is active.

    With ``autostart`` it configures and activates itself at its start; else somebody calls its
    service ``change_state``, as ``ros2 lifecycle set`` and lifecycle managers do.
    """

    def __init__(self, name: str, sections: Sequence[Section],
                 settable: Mapping[str, str] | None = None) -> None:
        """
        Read the parameters.

        :param name: of the node.
        :param sections: (prefix with its dot, dataclass) sequence.
        :param settable: when those may be set that may, by name, as of ``ParameterSet``.
        :raises ValueError: naming the parameter that is unknown, missing or wrong.
        """
        PushNode.__init__(self, name, sections, settable)
        LifecycleNodeMixin.__init__(self)
        self.is_active = False
        self._fault: ValueError | None = None
        for service in self.services:
            if service.srv_type is ChangeState:
                self._refuse_impossible_transitions(service)

    @property
    @abc.abstractmethod
    def is_autostarted(self) -> bool:
        """Tell whether the node configures and activates itself."""

    @abc.abstractmethod
    def configure(self) -> None:
        """
        Make everything that needs time or memory.

        :raises ValueError: naming the parameter with which that is impossible.
        """

    @abc.abstractmethod
    def activate(self) -> None:
        """Subscribe, and begin."""

    @abc.abstractmethod
    def deactivate(self) -> None:
        """End what is under way; subscriptions end by themselves."""

    @abc.abstractmethod
    def clean_up(self) -> None:
        """Forget what ``configure`` made."""

    def start(self) -> None:
        """
        Configure and activate the node, where it is started so.

        :raises ValueError: naming the parameter with which that is impossible.
        """
        if not self.is_autostarted:
            self.reporter.report(OK, 'is unconfigured')
            return
        configured = self.trigger_configure()
        if self._fault is not None:
            self.refuse_to_start(str(self._fault))
        success = TransitionCallbackReturn.SUCCESS
        if configured is not success or self.trigger_activate() is not success:
            self.refuse_to_start('the node could not be configured and activated: see the error '
                                 'before')

    def close(self) -> None:
        """End what is under way: called once, while publishers are still valid."""
        if self.is_active:
            self._leave_active_state()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """
        Configure the node.

        :param state: the former one.
        :return: failure where a parameter does not allow it; the node stays unconfigured then.
        """
        self._fault = None
        # Said before, as nothing is answered meanwhile.
        self.reporter.report(OK, 'is being configured; the first time with an object this takes a '
                             'minute or two')
        with self._logged_errors():
            try:
                self.configure()
            except ValueError as error:
                self._fault = error
                self.reporter.report(ERROR, f'cannot be configured: {error}')
                return TransitionCallbackReturn.FAILURE
        self.reporter.report(OK, 'is configured, and inactive')
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """
        Activate the node.

        :param state: the former one.
        """
        self.is_active = True
        with self._logged_errors():
            self.activate()
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """
        Deactivate the node.

        :param state: the former one.
        """
        self._leave_active_state()
        self.reporter.report(OK, 'is inactive')
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """
        Forget what configuring made.

        :param state: the former one.
        """
        self.clean_up()
        self.reporter.report(OK, 'is unconfigured')
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """
        End what is under way, for good.

        :param state: the former one.
        """
        if state.state_id == State.PRIMARY_STATE_ACTIVE:
            self._leave_active_state()
        self.reporter.report(OK, 'is shut down')
        return TransitionCallbackReturn.SUCCESS

    def serve_active_trigger(self, service: str, action: Callable[[], AnyAnswer],
                             group: BackgroundGroup | None = None) -> Service:
        """
        Offer a Trigger service of the list, which is refused while the node is inactive.

        :param service: its name.
        :param action: takes nothing, returns (success, sentence), or waits for it.
        :param group: of callbacks; None for the usual one.
        """
        return self.serve_trigger(service, lambda: action() if self.is_active else INACTIVE,
                                  group)

    def _leave_active_state(self) -> None:
        with self._logged_errors():
            self.deactivate()
        self.unsubscribe_all()
        self.is_active = False

    @contextlib.contextmanager
    def _logged_errors(self) -> Generator[None, None, None]:
        """
        Log what goes wrong in a transition, as rclpy drops every error there.

        Of what the system or rcl refuses, the text says all that a user can use.
        """
        is_logged = True
        try:
            yield
            is_logged = False
        except (OSError, RCLError, KeyboardInterrupt) as error:
            is_logged = False
            if not isinstance(error, KeyboardInterrupt):
                self.get_logger().error(without_location(error))
            raise
        finally:
            if is_logged:
                self.get_logger().error(traceback.format_exc())

    def _refuse_impossible_transitions(self, service: Service) -> None:
        """Answer a transition that the present state does not have, where rclpy raises."""
        change_state: Callable[[Any, Any], Any] = service.callback

        def answer(request: Any, response: Any) -> Any:
            try:
                return change_state(request, response)
            except RuntimeError as error:
                self.get_logger().warning(f'change_state: {error}')
                response.success = False
                return response
        service.callback = answer
