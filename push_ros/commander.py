"""
A commander for programs: push an object somewhere, watch, cancel, and learn how it ended.

    rclpy.init()
    with PushCommander() as commander:
        commander.wait_until_ready()
        commander.push_to(Pose(1.0, 0.5, 0.0))
        while not commander.is_done():
            print(commander.feedback())
        print(commander.result())

Nothing here needs threads: ``is_done`` handles what has come. All states and error codes are those
of the action ``push_object`` of ``push_control_msgs``.
"""

import enum
import math
import time
from types import TracebackType
from typing import Any, Callable, NamedTuple

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from push_model.geometry import Pose
from push_ros.conversions.primitives import seconds, to_pose_message, to_stamp
from push_ros.push_interfaces import ACTION, import_push_interfaces
import rclpy
from rclpy.action.client import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

# Topic by whose publishers servers of the action are told from each other.
STATUS_TOPIC = f'{ACTION}/_action/status'
# Longest time that ``is_done`` handles what comes [s]; chosen: half the time between two
# feedbacks, and programs that do something else besides react at once.
SPIN_TIME = 0.1


class PushOutcome(enum.Enum):
    """Outcome of the pursuit of a goal."""

    SUCCEEDED = 'succeeded'
    CANCELLED = 'cancelled'
    # Given up, refused or preempted: the error code says which.
    ABORTED = 'aborted'
    # The node was inactive.
    REJECTED = 'rejected'
    # The controller ended, and gave no result.
    LOST = 'lost'


class PushFeedback(NamedTuple):
    """
    Progress of the pursuit of a goal.

    :param state: one of the constants of ``PushStatus``.
    :param text: state and reason, for people.
    :param push_number: of the present or last push, from 1 on; 0 before the first.
    :param pushes_done: number of pushes that have ended.
    :param position_error: distance of the object from its goal [m].
    :param heading_error: object heading minus that of the goal [rad].
    :param position_deviation: standard deviation of the position in the frame of the goal [m],
        where that drifts with odometry; nan where it does not.
    :param heading_deviation: of the heading [rad], likewise.
    :param codes: cause codes of the reason, such as ``TaskEvent.AVERAGING``.
    :param elapsed_time: since the goal was taken [s].
    :param estimated_time_remaining: if it goes on like this [s]; 0 while nothing is known.
    """

    state: int
    text: str
    push_number: int
    pushes_done: int
    position_error: float
    heading_error: float
    position_deviation: float
    heading_deviation: float
    codes: tuple[str, ...]
    elapsed_time: float
    estimated_time_remaining: float


class PushResult(NamedTuple):
    """
    Result of the pursuit of a goal.

    :param outcome: ``PushOutcome``.
    :param error_code: one of the constants of ``PushObject.Result``; 0 where all went well.
    :param error_msg: one sentence on that, or empty.
    :param position_error: last known distance of the object from its goal [m]; nan if unknown.
    :param heading_error: last known object heading minus that of the goal [rad]; nan if unknown.
    :param position_deviation: standard deviation of the position in the frame of the goal [m],
        where that drifts with odometry; nan where it does not.
    :param heading_deviation: of the heading [rad], likewise.
    :param pushes: number of pushes begun.
    :param duration: [s].
    :param codes: cause codes, such as ``TaskEvent.NO_PLAN``; of a goal that was reached
        ``TaskEvent.DONE_BY_ODOMETRY`` where the deviations say how well that is known.
    """

    outcome: PushOutcome
    error_code: int = 0
    error_msg: str = ''
    position_error: float = math.nan
    heading_error: float = math.nan
    position_deviation: float = math.nan
    heading_deviation: float = math.nan
    pushes: int = 0
    duration: float = 0.0
    codes: tuple[str, ...] = ()


OUTCOMES = {GoalStatus.STATUS_SUCCEEDED: PushOutcome.SUCCEEDED,
            GoalStatus.STATUS_CANCELED: PushOutcome.CANCELLED,
            GoalStatus.STATUS_ABORTED: PushOutcome.ABORTED}


class PushCommander:
    """Sends goals to the controller, one at a time."""

    def __init__(self, namespace: str = '', *, frame: str = 'odom',
                 context: Context | None = None) -> None:
        """
        Make a client; rclpy must be initialized.

        :param namespace: of the controller.
        :param frame: frame of goals that are given as ``Pose``.
        :param context: of rclpy; None for the usual one.
        :raises ImportError: where ``push_control_msgs`` is not installed.
        """
        interfaces = import_push_interfaces()
        if interfaces is None:
            raise ImportError('push_control_msgs: not installed; build it with colcon and source '
                              'the workspace')
        self._action = interfaces.action
        self._frame = frame
        self._node = rclpy.create_node('push_commander', namespace=namespace, context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self._node)
        self._client = ActionClient(self._node, self._action, ACTION)
        # The goal: its number among those sent here, the handle once it was accepted.
        self._goal_count = 0
        self._handle: Any = None
        self._feedback: PushFeedback | None = None
        self._result: PushResult | None = None
        # Servers that there were when it was sent, or accepted.
        self._servers: set[bytes] = set()

    def __enter__(self) -> 'PushCommander':
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
        Wait for the controller.

        :param timeout: longest wait [s].
        :return: whether it is there.
        """
        return self._spin_until(self._client.server_is_ready, timeout)

    def push_to(self, pose: Pose | PoseStamped, *, object_name: str = '',
                position_tolerance: float = 0.0, heading_tolerance: float = 0.0,
                time_limit: float = 0.0) -> bool:
        """
        Send a goal, in place of the present one, and wait until it is accepted.

        :param pose: goal pose of the object.
        :param object_name: name of the object; empty for the present one.
        :param position_tolerance: [m]; 0 for that of the parameters.
        :param heading_tolerance: [rad]; 0 for that of the parameters.
        :param time_limit: [s]; 0 for none.
        :return: whether it is accepted; a goal that cannot be used is accepted and aborted.
        """
        goal = self._action.Goal(
            goal_pose=pose if isinstance(pose, PoseStamped) else self._stamped(pose),
            object_name=object_name, position_tolerance=position_tolerance,
            heading_tolerance=heading_tolerance, time_limit=to_stamp(time_limit, Duration))
        self._goal_count += 1
        self._handle = self._feedback = self._result = None
        goal_index = self._goal_count
        self._servers = self._present_servers()
        sent = self._client.send_goal_async(
            goal,
            feedback_callback=lambda message: self._on_feedback(goal_index, message.feedback))
        if not self._spin_until(sent.done, math.inf):
            self._result = PushResult(PushOutcome.LOST, error_msg='the controller is gone')
            return False
        self._handle = sent.result()
        if not self._handle.accepted:
            self._result = PushResult(PushOutcome.REJECTED, error_msg='the controller is inactive')
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
                self._result = PushResult(PushOutcome.LOST, error_msg='the controller is gone')
        return self._result is not None

    def feedback(self) -> PushFeedback | None:
        """Return the last ``PushFeedback`` on the goal; None before the first."""
        return self._feedback

    def cancel(self) -> None:
        """Cancel the goal: ``is_done`` returns True once the robot has backed off and stands."""
        if self._handle is not None and self._result is None:
            self._handle.cancel_goal_async()

    def result(self) -> PushResult | None:
        """Return the ``PushResult``; None before the end."""
        return self._result

    def _stamped(self, pose: Pose) -> PoseStamped:
        message = PoseStamped(pose=to_pose_message(pose))
        message.header.frame_id = self._frame
        return message

    def _present_servers(self) -> set[bytes]:
        """List who serves the action; one that was started again is another one."""
        return {bytes(publisher.endpoint_gid)
                for publisher in self._node.get_publishers_info_by_topic(STATUS_TOPIC)}

    @property
    def _is_server_lost(self) -> bool:
        """Tell whether the controller that has the goal is gone, maybe replaced by another."""
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
            status = message.status
            self._feedback = PushFeedback(
                status.state, status.text, status.push_number, status.pushes_done,
                status.position_error, status.heading_error, status.position_deviation,
                status.heading_deviation, tuple(status.codes), seconds(message.elapsed_time),
                seconds(message.estimated_time_remaining))

    def _on_result(self, goal_index: int, response: Any) -> None:
        if goal_index == self._goal_count:
            result = response.result
            self._result = PushResult(
                OUTCOMES.get(response.status, PushOutcome.LOST), result.error_code,
                result.error_msg, result.position_error, result.heading_error,
                result.position_deviation, result.heading_deviation, result.pushes,
                seconds(result.duration), tuple(result.codes))
