"""Client of ``push_object``: one goal of one object after the other."""

from typing import Any, Callable, NamedTuple

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration, Time
from push_model.geometry import Pose
from push_model.plan_request import GoalTolerances
from push_ros.conversions.primitives import to_pose_message, to_stamp
from push_ros.node import PushNode
from push_ros.push_interfaces import ACTION, PushInterfaces
from rclpy.action.client import ActionClient
from rclpy.task import Future

# Errors of a move after which none of the others would do better: somebody wants the robot to
# stand, or another goal.
ENDING_ERRORS = 'PREEMPTED', 'INTERRUPTED', 'ROBOT_NOT_READY', 'STOPPED'


class MoveGoal(NamedTuple):
    """
    Goal of one move.

    :param name: of the object.
    :param pose: goal ``Pose`` in the world.
    :param tolerances: ``GoalTolerances``.
    :param stamp: of the goal.
    :param frame: id of the world frame.
    """

    name: str
    pose: Pose
    tolerances: GoalTolerances
    stamp: Time
    frame: str


class MoveEnd(NamedTuple):
    """
    End of a move.

    :param failure: why it failed, one sentence; empty where the object is at its goal.
    :param ends_all: whether nothing more is to be moved.
    """

    failure: str = ''
    ends_all: bool = False


class SingleMoves:
    """Sends one goal at a time; of a goal that was dropped nothing is heard any more."""

    def __init__(self, node: PushNode, interfaces: PushInterfaces) -> None:
        self._interfaces = interfaces
        self._client = ActionClient(node, interfaces.action, ACTION)
        self._count = 0
        self._handle: Any = None
        self._on_end: Callable[[MoveEnd], None] | None = None
        self._is_cancelled = False

    @property
    def is_ready(self) -> bool:
        """Tell whether the controller is there."""
        return self._client.server_is_ready()

    def start(self, goal: MoveGoal, on_feedback: Callable[[Any], None],
              on_end: Callable[[MoveEnd], None]) -> None:
        """
        Send a goal.

        :param on_feedback: takes each feedback of ``PushObject``.
        :param on_end: takes the ``MoveEnd``.
        """
        request = self._interfaces.action.Goal(
            object_name=goal.name, position_tolerance=goal.tolerances.position,
            heading_tolerance=goal.tolerances.heading, time_limit=to_stamp(0.0, Duration))
        request.goal_pose.header.stamp, request.goal_pose.header.frame_id = goal.stamp, goal.frame
        request.goal_pose.pose = to_pose_message(goal.pose)
        self._count += 1
        count = self._count
        self._handle = None
        self._on_end = on_end
        self._is_cancelled = False
        sent = self._client.send_goal_async(request, feedback_callback=lambda message: (
            on_feedback(message.feedback) if count == self._count else None))
        sent.add_done_callback(lambda future: self._on_answer(count, future))

    def cancel(self) -> None:
        """Cancel the goal: it ends once the robot has backed off."""
        self._is_cancelled = True
        if self._handle is not None:
            self._handle.cancel_goal_async()

    def drop(self) -> None:
        """Forget the goal: the controller is gone."""
        self._count += 1
        self._handle = self._on_end = None

    def _on_answer(self, count: int, future: Future) -> None:
        if count != self._count:
            return
        handle = future.result()
        if handle is None or not handle.accepted:
            self._end(MoveEnd('the controller is inactive', ends_all=True))
            return
        self._handle = handle
        handle.get_result_async().add_done_callback(
            lambda ended: self._on_result(count, ended.result()))
        if self._is_cancelled:
            handle.cancel_goal_async()

    def _on_result(self, count: int, response: Any) -> None:
        if count != self._count:
            return
        if response.status == GoalStatus.STATUS_SUCCEEDED:
            self._end(MoveEnd())
            return
        result = response.result
        ending = [getattr(result, name) for name in ENDING_ERRORS]
        is_cancelled = response.status == GoalStatus.STATUS_CANCELED
        self._end(MoveEnd(result.error_msg or 'cancelled',
                          ends_all=is_cancelled or result.error_code in ending))

    def _end(self, end: MoveEnd) -> None:
        on_end, self._on_end, self._handle = self._on_end, None, None
        if on_end is not None:
            on_end(end)
