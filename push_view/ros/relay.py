"""Relay of commands from the page, which come in its thread, to the controller."""

import queue
from typing import Any

from push_model.signals import ObjectPose
from push_ros.conversions.measurements import to_object_pose_message
from push_ros.conversions.primitives import seconds
from push_ros.node import PushNode
from push_view.server.commands import Call, CALLS, CommandRefused, parse_command, SetGoal
from push_view.server.message_log import MessageLog
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.task import Future
from std_srvs.srv import Trigger

# Period at which commands are looked for [s]; chosen: a user notices no wait.
PERIOD = 0.05


class CommandRelay:
    """
    Publishes goals and calls services of the controller, or refuses everything.

    :param node: the ``PushNode``.
    :param log: where it is shown what the controller answers.
    :param frame: id of the world frame.
    :param is_enabled: whether commands are relayed.
    """

    def __init__(self, node: PushNode, log: MessageLog, frame: str, is_enabled: bool) -> None:
        self._node = node
        self._log = log
        self._frame = frame
        self._is_enabled = is_enabled
        self._commands: queue.SimpleQueue[SetGoal | Call] = queue.SimpleQueue()
        if is_enabled:
            self._goals = node.publisher('goal_pose')
            self._clients = {name: node.create_client(Trigger, f'controller/{name}')
                             for name in CALLS}
            node.create_timer(PERIOD, node.guarded(self._relay),
                              clock=Clock(clock_type=ClockType.STEADY_TIME))

    async def handle(self, text: str) -> None:
        """
        Take a command, in the thread of the page.

        :param text: of the command.
        :raises CommandRefused: with the reason.
        """
        command = parse_command(text)
        if not self._is_enabled:
            raise CommandRefused('this page is read only; start push view with --control '
                                 'to command the robot')
        if not isinstance(command, (SetGoal, Call)):
            raise CommandRefused('that is possible in a simulation only')
        if isinstance(command, Call) and not self._clients[command.name].service_is_ready():
            raise CommandRefused(f'no node offers the service controller/{command.name}')
        # The page's own node listens too.
        if isinstance(command, SetGoal) and self._goals.get_subscription_count() < 2:
            raise CommandRefused('no controller listens to goal_pose')
        self._commands.put(command)

    def _relay(self) -> None:
        while not self._commands.empty():
            command = self._commands.get()
            if isinstance(command, SetGoal):
                goal = ObjectPose(seconds(self._node.now()), command.pose)
                self._goals.publish(to_object_pose_message(goal, self._frame))
            else:
                call = self._clients[command.name].call_async(Trigger.Request())
                call.add_done_callback(self._show_answer)

    def _show_answer(self, call: Future) -> None:
        answer: Any = call.result()
        if answer is not None:
            self._log.replace({'type': 'notice', 'text': answer.message})
