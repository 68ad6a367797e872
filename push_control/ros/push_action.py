"""
The action ``push_object``: goals from programs, with feedback, cancellation and a result.

It is served where the package ``push_control_msgs`` is installed. As servers of Nav2 do, it
accepts every goal while the node is active and aborts one that cannot be used, with an error code;
another goal, also one from ``goal_pose``, takes the place of the present one.
"""

import functools
import math
from typing import Any, Callable, NamedTuple

from builtin_interfaces.msg import Duration
from push_control.goal import GoalOutcome, GoalProgress, PushGoal, PushState
from push_control.ros.base_check import BaseFault
from push_control.ros.goal_entry import GoalEntry, GoalHandle
from push_control.task.code_text import code_names
from push_model.events import codes, sentence
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.signals import PoseDeviation
from push_ros import qos
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import (
    MessageRefused, seconds, to_pose_message, to_stamp)
from push_ros.deferring_server import DeferringActionServer
from push_ros.node import PushNode, RateLimiter
from push_ros.push_interfaces import ACTION, PushInterfaces, STATUS
from rclpy.action.server import CancelResponse, GoalResponse, ServerGoalHandle

# Feedback and status per second of measured time without a change [Hz]; chosen: smooth for a
# progress bar, few beside a hundred measurements per second.
FEEDBACK_RATE = 5.0
UNKNOWN_POSE = Pose(math.nan, math.nan, math.nan)
# Names of the error codes; a goal whose client has cancelled it has none.
ERRORS = {GoalOutcome.REACHED: 'NONE', GoalOutcome.CANCELLED: 'INTERRUPTED',
          GoalOutcome.REPLACED: 'PREEMPTED', GoalOutcome.TIMED_OUT: 'TIMEOUT',
          GoalOutcome.NO_PLAN: 'NO_VALID_PLAN', GoalOutcome.FAILED: 'FAILED_TO_MAKE_PROGRESS',
          GoalOutcome.INTERRUPTED: 'INTERRUPTED'}

# Fields of a status, by which number of an ``Outlook`` they are.
STATED = {'chance': 'chance',
          'expected_time_median': 'time.median', 'expected_time_p95': 'time.p95',
          'expected_position_error_median': 'position_error.median',
          'expected_position_error_p95': 'position_error.p95',
          'expected_heading_error_median': 'heading_error.median',
          'expected_heading_error_p95': 'heading_error.p95'}


class GoalReceiver(NamedTuple):
    """
    Receiver of a goal pose in the world frame.

    :param accept: takes the ``geometry_msgs/PoseStamped`` in the world frame, and a function to be
        called with nothing once the goal is taken.
    :param refuse: takes the ``MessageRefused`` and the message as it came.
    """

    accept: Callable[[Any, Callable[[], None]], None]
    refuse: Callable[[MessageRefused, Any], None]


class ObjectSelector(NamedTuple):
    """
    Selector of the object that a goal names.

    :param find: takes a name, and returns the nominal ``PushedObject``; raises ValueError.
    :param use: takes both, and makes this the object that is pushed; the robot stands.
    """

    find: Callable[[str], PushedObject]
    use: Callable[[str, PushedObject], None]


class PushActionServer:
    """Serves ``push_object``, and publishes ``push_status``."""

    def __init__(self, node: PushNode, goals: GoalEntry, interfaces: PushInterfaces,
                 receive: Callable[[str, Any, GoalReceiver], None], *,
                 is_active: Callable[[], bool], objects: ObjectSelector,
                 check_base: Callable[[Callable[[BaseFault | None], None]], None]) -> None:
        """
        Wait for goals.

        :param receive: brings a goal pose to the world frame; takes a name for errors, the message
            and the ``GoalReceiver``.
        :param is_active: whether goals are accepted.
        :param check_base: as of ``BaseCheck.run``.
        """
        self._node = node
        self._goals = goals
        self._interfaces = interfaces
        self._receive = receive
        self._is_active = is_active
        self._objects = objects
        self._check_base = check_base
        self._object_name = ''
        self._current: ServerGoalHandle | None = None
        self._last_state: tuple[PushState, str] | None = None
        self._rate = RateLimiter(FEEDBACK_RATE)
        self._status_publisher = node.create_publisher(interfaces.status, STATUS, qos.LATCHED)
        self._server = DeferringActionServer(
            node, interfaces.action, ACTION, goal_callback=self._answer_goal,
            handle_accepted_callback=node.guarded(self._on_goal), cancel_callback=self._on_cancel)

    def set_object(self, name: str) -> None:
        """
        Serve goals for an object from now on.

        :param name: its name, or empty.
        """
        self._object_name = name
        # The next status names it.
        self._last_state = None

    def destroy(self) -> None:
        """Serve no more."""
        self._server.destroy()
        self._node.destroy_publisher(self._status_publisher)

    def update(self, time: float, waiting: str = '') -> None:
        """
        Publish status and feedback, where they have changed or it is time.

        :param time: of the newest measurement, or the present one before the first [s].
        :param waiting: what the node waits for, one clause; empty where it waits for nothing.
        """
        feedback = self._goals.feedback()
        progress = feedback.progress
        reason = '; '.join(filter(None, (sentence(progress.cause), waiting)))
        state = progress.state, reason
        if not self._rate.due(time) and state == self._last_state:
            return
        self._last_state = state
        status = self._status_message(progress, reason, time)
        self._status_publisher.publish(status)
        if self._current is None or not math.isfinite(progress.position_error):
            return
        remaining_time = 0.0 if progress.outlook is None else progress.outlook.time.median
        self._current.publish_feedback(self._interfaces.action.Feedback(
            status=status, elapsed_time=to_stamp(feedback.elapsed_time, Duration),
            estimated_time_remaining=to_stamp(remaining_time, Duration)))

    def _answer_goal(self, _: Any) -> GoalResponse:
        if self._is_active():
            return GoalResponse.ACCEPT
        self._node.get_logger().warning(f'{ACTION}: a goal is rejected, as the node is inactive')
        return GoalResponse.REJECT

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        """Start with a goal, once its pose is in the world frame and the base is ready."""
        handle.execute()
        request = handle.request

        def refuse(code: str, reason: str) -> None:
            self._node.get_logger().error(f'{ACTION}: {reason}')
            self._finish(handle, code, reason, self._unmeasured_result())

        def accept(message: Any, follow: Callable[[], None]) -> None:
            self._check_base(lambda fault: start(message, follow, fault))

        def start(message: Any, follow: Callable[[], None], fault: BaseFault | None) -> None:
            if not handle.is_active:
                return
            if fault is None:
                self._pursue(handle, message, follow, refuse)
            else:
                refuse('INTERRUPTED' if fault.is_interrupted else 'ROBOT_NOT_READY', fault.reason)
        fault = self._goal_fault(request)
        if fault is not None:
            refuse(*fault)
            return
        self._receive(f'{ACTION}.goal_pose', request.goal_pose,
                      GoalReceiver(accept, lambda error, _: refuse('TF_ERROR', str(error))))

    def _goal_fault(self, request: Any) -> tuple[str, str] | None:
        """Find code and reason for which a goal is refused as it comes."""
        if self._goals.refusal:
            return 'STOPPED', self._goals.refusal
        try:
            self._preparation(request.object_name)
        except ValueError as error:
            return 'UNKNOWN_OBJECT', str(error)
        try:
            _check_pose(request.goal_pose)
        except MessageRefused as error:
            return 'INVALID_GOAL', str(error)
        return None

    def _pursue(self, handle: ServerGoalHandle, message: Any, follow: Callable[[], None],
                refuse: Callable[[str, str], None]) -> None:
        request = handle.request
        if self._goals.refusal:
            # It has waited for its transform while the controller was stopped.
            refuse('STOPPED', self._goals.refusal)
            return
        try:
            pose = from_object_pose_message(message, message.header.frame_id, ACTION).pose
            goal = PushGoal(pose, request.position_tolerance or None,
                            request.heading_tolerance or None,
                            seconds(request.time_limit) or math.inf)
            prepare = self._preparation(request.object_name)
        except ValueError as error:
            refuse('INVALID_GOAL', str(error))
            return
        self._goals.start(goal, lambda ended: self._on_end(handle, ended), prepare)
        self._current = handle
        follow()

    def _preparation(self, name: str) -> Callable[[], None] | None:
        """Make what turns to the object of a goal; None where it is the present one."""
        if name in ('', self._object_name):
            return None
        return functools.partial(self._objects.use, name, self._objects.find(name))

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        """Accept, and begin to back off once the state of the goal is that."""
        executor = self._node.executor
        if executor is None:
            return CancelResponse.REJECT
        executor.create_task(self._node.guarded(self._cancel), handle)
        return CancelResponse.ACCEPT

    def _cancel(self, handle: ServerGoalHandle) -> None:
        if handle is self._current:
            self._goals.cancel()
        else:
            # Its pose has not come to the world frame yet, or the base is being checked.
            self._finish(handle, 'NONE', 'cancelled', self._unmeasured_result())

    def _on_end(self, handle: ServerGoalHandle, ended: GoalHandle) -> None:
        if handle is self._current:
            self._current = None
        outcome = ended.outcome or GoalOutcome.INTERRUPTED
        last = ended.last_feedback
        result = self._interfaces.action.Result(
            codes=code_names(codes(ended.cause)), pushes=last.progress.pushes,
            duration=to_stamp(last.elapsed_time, Duration), **_errors(last.progress))
        is_reached = outcome is GoalOutcome.REACHED
        text = '' if is_reached else sentence(ended.cause) or outcome.value
        is_cancelled = outcome is GoalOutcome.CANCELLED and handle.is_cancel_requested
        self._finish(handle, 'NONE' if is_cancelled else ERRORS[outcome], text, result,
                     is_reached=is_reached)

    def _unmeasured_result(self) -> Any:
        """Make the result of a goal that was not pursued: its errors were not measured."""
        return self._interfaces.action.Result(**_errors(GoalProgress()))

    def _finish(self, handle: ServerGoalHandle, code: str, text: str, result: Any, *,
                is_reached: bool = False) -> None:
        """End a goal of a client, unless it has ended: it may be cancelled while it waits."""
        if not handle.is_active:
            return
        result.error_code = getattr(self._interfaces.action.Result, code)
        result.error_msg = text
        if is_reached:
            handle.succeed()
        elif handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        self._server.answer(handle, result)

    def _status_message(self, progress: GoalProgress, reason: str, time: float) -> Any:
        is_pushing = progress.state is PushState.PUSHING
        status = self._interfaces.status(
            object_name=self._object_name,
            state=getattr(self._interfaces.status, progress.state.name),
            text=f'{progress.state.value}, {reason}' if reason else progress.state.value,
            push_number=progress.pushes, pushes_done=progress.pushes - is_pushing,
            codes=code_names(codes(progress.cause)), **_errors(progress), **_stated(progress),
            robot_pose=to_pose_message(progress.robot_pose or UNKNOWN_POSE))
        status.header.stamp = to_stamp(time)
        status.header.frame_id = self._goals.frame
        return status


def _errors(progress: GoalProgress) -> dict[str, float]:
    """Name the errors as status and result have them, and how well they are known."""
    deviation = progress.deviation or PoseDeviation(math.nan, math.nan)
    return {'position_error': progress.position_error, 'heading_error': progress.heading_error,
            'position_deviation': deviation.position, 'heading_deviation': deviation.heading}


def _stated(progress: GoalProgress) -> dict[str, float]:
    """Name what the last plan states of the end as the status has it; NaN where nothing is."""
    outlook = progress.outlook
    if outlook is None:
        return dict.fromkeys(STATED, math.nan)
    values = outlook.values()
    return {field: values[name] for field, name in STATED.items()}


def _check_pose(message: Any) -> None:
    """Refuse a pose that is none in any frame."""
    from_object_pose_message(message, message.header.frame_id, f'{ACTION}.goal_pose')
