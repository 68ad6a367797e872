"""Servers of actions whose goals are pursued by somebody else, with the measurements."""

from typing import Any, Callable

from push_ros import qos
from rclpy.action.server import (
    ActionServer, CancelResponse, GoalResponse, ServerGoalHandle)
from rclpy.node import Node


class DeferringActionServer(ActionServer):
    """
    An action server that leaves the pursuit of its goals to others.

    rclpy would run a callback until the end of the goal: in a thread of its own, or resumed at
    every turn of the executor, which never waits then.
    """

    def __init__(self, node: Node, action: Any, name: str, *,
                 goal_callback: Callable[[Any], GoalResponse],
                 handle_accepted_callback: Callable[[ServerGoalHandle], None],
                 cancel_callback: Callable[[ServerGoalHandle], CancelResponse]) -> None:
        """
        Serve an action; the callbacks are those of rclpy.

        :param action: its type.
        """
        super().__init__(node, action, name, _no_result, goal_callback=goal_callback,
                         handle_accepted_callback=handle_accepted_callback,
                         cancel_callback=cancel_callback,
                         goal_service_qos_profile=qos.REQUEST,
                         result_service_qos_profile=qos.REQUEST,
                         cancel_service_qos_profile=qos.REQUEST)

    def answer(self, handle: ServerGoalHandle, result: Any) -> None:
        """
        Send the result of a goal that was set to an end.

        :param result: message of the action.
        """
        if self._node.executor is not None:
            # Else the node is being shut down, and nobody can be answered any more.
            self.notify_execute(handle, lambda _: result)

    def notify_execute(self, goal_handle: ServerGoalHandle,
                       execute_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """
        Run a callback that is given, which makes the result; do nothing at the beginning.

        :param execute_callback: takes it and returns the result; None at the beginning.
        """
        if execute_callback is not None:
            super().notify_execute(goal_handle, execute_callback)


def _no_result(_: Any) -> None:
    """Do nothing: every goal is ended with a callback of its own."""
