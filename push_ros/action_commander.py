"""What commanders of actions have in common: one goal at a time, without threads."""

import abc
import enum
import math
import time
from types import TracebackType
from typing import Any, Callable, Generic, TypeVar

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from push_model.geometry import Pose
from push_ros.conversions.primitives import to_pose_message
from push_ros.push_interfaces import import_push_interfaces, PushInterfaces
import rclpy
from rclpy.action.client import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

# Longest time that ``is_done`` handles what comes [s]; chosen: half the time between two
# feedbacks, and programs that do something else besides react at once.
SPIN_TIME = 0.1

Feedback = TypeVar('Feedback')
Result = TypeVar('Result')
AnyCommander = TypeVar('AnyCommander', bound='ActionCommander[Any, Any]')


class PushOutcome(enum.Enum):
    """Outcome of the pursuit of a goal."""

    SUCCEEDED = 'succeeded'
    CANCELLED = 'cancelled'
    # Given up, refused or preempted: the error code says which.
    ABORTED = 'aborted'
    # The node was inactive.
    REJECTED = 'rejected'
    # The server ended, and gave no result.
    LOST = 'lost'


OUTCOMES = {GoalStatus.STATUS_SUCCEEDED: PushOutcome.SUCCEEDED,
            GoalStatus.STATUS_CANCELED: PushOutcome.CANCELLED,
            GoalStatus.STATUS_ABORTED: PushOutcome.ABORTED}


class ActionCommander(abc.ABC, Generic[Feedback, Result]):
    """Sends goals of an action, one at a time."""

    # What a server is called in sentences.
    server_name = 'server'
    # Why a server rejects a goal.
    rejection = 'the server is inactive'

    def __init__(self, namespace: str = '', *, frame: str = 'odom',
                 context: Context | None = None) -> None:
        """
        Make a client; rclpy must be initialized.

        :param namespace: of the server.
        :param frame: frame of goals that are given as ``Pose``.
        :param context: of rclpy; None for the usual one.
        :raises ImportError: where ``push_control_msgs`` is not installed.
        """
        interfaces = import_push_interfaces()
        if interfaces is None:
            raise ImportError('push_control_msgs: not installed; build it with colcon and source '
                              'the workspace')
        self._interfaces = interfaces
        self._frame = frame
        action, name = self._action_of(interfaces)
        # Topic by whose publishers servers of the action are told from each other.
        self._status_topic = f'{name}/_action/status'
        self._node = rclpy.create_node('push_commander', namespace=namespace, context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self._node)
        self._client = ActionClient(self._node, action, name)
        # The goal: its number among those sent here, the handle once it was accepted.
        self._goal_count = 0
        self._handle: Any = None
        self._feedback: Feedback | None = None
        self._result: Result | None = None
        # Servers that there were when it was sent, or accepted.
        self._servers: set[bytes] = set()

    @abc.abstractmethod
    def _action_of(self, interfaces: PushInterfaces) -> tuple[Any, str]:
        """Return type and name of the action."""

    @abc.abstractmethod
    def _read_feedback(self, message: Any) -> Feedback:
        """Read a feedback of the action."""

    @abc.abstractmethod
    def _read_result(self, outcome: PushOutcome, message: Any) -> Result:
        """Read a result of the action."""

    @abc.abstractmethod
    def _missing_result(self, outcome: PushOutcome, reason: str) -> Result:
        """Make the result of a goal of which none has come."""

    def __enter__(self: AnyCommander) -> AnyCommander:
        """Return itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """Close; a goal that is pursued stays."""
        self.close()

    def close(self) -> None:
        """End the client; a goal that is pursued stays."""
        self._executor.shutdown()
        self._client.destroy()
        self._node.destroy_node()

    def wait_until_ready(self, timeout: float = math.inf) -> bool:
        """
        Wait for the server.

        :param timeout: longest wait [s].
        :return: whether it is there.
        """
        return self._spin_until(self._client.server_is_ready, timeout)

    def _send(self, goal: Any) -> bool:
        """Send a goal, in place of the present one; return whether it is accepted."""
        self._goal_count += 1
        self._handle = self._feedback = self._result = None
        goal_index = self._goal_count
        self._servers = self._present_servers()
        sent = self._client.send_goal_async(
            goal,
            feedback_callback=lambda message: self._on_feedback(goal_index, message.feedback))
        if not self._spin_until(sent.done, math.inf):
            self._result = self._missing_result(PushOutcome.LOST,
                                                f'the {self.server_name} is gone')
            return False
        self._handle = sent.result()
        if not self._handle.accepted:
            self._result = self._missing_result(PushOutcome.REJECTED, self.rejection)
            return False
        self._servers = self._present_servers()
        self._handle.get_result_async().add_done_callback(
            lambda future: self._on_result(goal_index, future.result()))
        return True

    def is_done(self, timeout: float = SPIN_TIME) -> bool:
        """
        Handle what has come, and return whether the pursuit of the goal has ended.

        :param timeout: how long to wait for that [s]; 0 handles one message, where there is one.
        """
        if self._handle is None:
            return True
        if not self._spin_until(lambda: self._result is not None, timeout):
            if self._is_server_lost:
                self._result = self._missing_result(
                    PushOutcome.LOST, f'the {self.server_name} is gone')
        return self._result is not None

    def feedback(self) -> Feedback | None:
        """Return the last feedback on the goal; None before the first."""
        return self._feedback

    def cancel(self) -> None:
        """Cancel the goal: ``is_done`` returns True once the robot has backed off and stands."""
        if self._handle is not None and self._result is None:
            self._handle.cancel_goal_async()

    def result(self) -> Result | None:
        """Return the result; None before the end."""
        return self._result

    def _stamped(self, pose: Pose | PoseStamped) -> PoseStamped:
        if isinstance(pose, PoseStamped):
            return pose
        message = PoseStamped(pose=to_pose_message(pose))
        message.header.frame_id = self._frame
        return message

    def _present_servers(self) -> set[bytes]:
        """List who serves the action; one that was started again is another one."""
        return {bytes(publisher.endpoint_gid)
                for publisher in self._node.get_publishers_info_by_topic(self._status_topic)}

    @property
    def _is_server_lost(self) -> bool:
        """Tell whether the server that has the goal is gone, maybe replaced by another."""
        is_replaced = bool(self._servers) and self._servers.isdisjoint(self._present_servers())
        return is_replaced or not self._client.server_is_ready()

    def _spin_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Handle what comes until a condition holds; False after the time, or without a server."""
        end = time.monotonic() + timeout
        was_lost = self._is_server_lost
        while not condition():
            self._executor.spin_once(timeout_sec=min(SPIN_TIME, timeout))
            is_lost = not was_lost and self._is_server_lost
            if is_lost or time.monotonic() >= end:
                return condition()
        return True

    def _on_feedback(self, goal_index: int, message: Any) -> None:
        if goal_index == self._goal_count:
            self._feedback = self._read_feedback(message)

    def _on_result(self, goal_index: int, response: Any) -> None:
        if goal_index == self._goal_count:
            self._result = self._read_result(OUTCOMES.get(response.status, PushOutcome.LOST),
                                             response.result)
