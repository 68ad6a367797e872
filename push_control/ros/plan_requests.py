"""Requests for plans, which the planner's node answers."""

from collections import deque
import time as wall
from typing import Any, NamedTuple

from push_control.events import TaskEvent
from push_model.events import Report
from push_model.plan_request import PlanRequest
from push_ros.conversions.plan_request import to_request_message
from push_ros.conversions.primitives import (
    exact_stamp, MessageRefused, NANOSECONDS, nanoseconds,
)
from push_ros.diagnostics import WARN
from push_ros.node import PushNode

# Requests without a plan that are remembered, as their answers may be late; chosen: those of a
# task that is given up for want of a plan.
MAX_REQUESTS = 12


class _SentRequest(NamedTuple):
    """A ``PlanRequest`` and its stamp [ns]."""

    request: PlanRequest
    stamp: int


class PlanRequester:
    """Publishes plan requests, each with a stamp of its own, and recognizes their answers."""

    def __init__(self, node: PushNode, frame: str, *, is_lockstep: bool) -> None:
        """
        Start without a request.

        :param frame: id of the world frame.
        :param is_lockstep: whether answers are awaited in measured time, and not on the wall,
            where planners live.
        """
        self._node = node
        self._publisher = node.publisher('push_request')
        self._topic = node.resolve_topic_name('push_request')
        self._logger = node.get_logger()
        self._frame = frame
        self._is_lockstep = is_lockstep
        # Stamps of the last requests [ns], those included that are forgotten.
        self._stamps: deque[int] = deque(maxlen=MAX_REQUESTS)
        self.reset()

    def reset(self) -> None:
        """Forget all requests."""
        self._request: PlanRequest | None = None
        self._stamp = 0
        self._requested_at = 0.0
        self.forget_unanswered()

    def forget_unanswered(self) -> None:
        """Ignore what answers the requests so far, as where a plan has come."""
        self._unanswered: deque[_SentRequest] = deque(maxlen=MAX_REQUESTS)

    def update(self, request: PlanRequest | None, time: float) -> None:
        """
        Publish a request that is new.

        :param request: the present ``PlanRequest``, or None.
        :param time: of the newest measurement [s].
        """
        if request is not None and request is not self._request:
            if self._unanswered and self._unanswered[-1].request.goal != request.goal:
                self.forget_unanswered()
            self._stamp = max(round(time * NANOSECONDS), self._stamp + 1)
            self._stamps.append(self._stamp)
            self._unanswered.append(_SentRequest(request, self._stamp))
            self._requested_at = self._now(time)
            self._publisher.publish(to_request_message(request, exact_stamp(self._stamp),
                                                       self._frame))
            self._logger.debug(
                f'requests a plan: object at {request.object_pose}, robot at '
                f'{request.robot_pose}, goal {request.goal}')
        self._request = request

    def is_overdue(self, time: float, timeout: float) -> bool:
        """
        Tell whether the present request has been waiting for its plan for too long.

        :param time: of the newest measurement [s].
        :param timeout: longest wait [s].
        """
        return self._request is not None and self._now(time) - self._requested_at > timeout

    def on_time_ahead(self, duration: float) -> None:
        """
        Note that clocks were set ahead: nobody has waited for that time.

        :param duration: by how much [s].
        """
        if self._is_lockstep:
            self._requested_at += duration

    def report_silence(self, timeout: float) -> Report[TaskEvent]:
        """
        Report who has not answered.

        :param timeout: longest wait [s].
        """
        count = self._publisher.get_subscription_count()
        if count == 0:
            return TaskEvent.NOBODY_PLANS.report(timeout=timeout, topic=self._topic)
        if count == 1:
            return TaskEvent.PLANNER_SILENT.report(timeout=timeout, topic=self._topic)
        return TaskEvent.PLANNERS_SILENT.report(timeout=timeout, topic=self._topic, count=count)

    def request_answered_by(self, message: Any) -> PlanRequest | None:
        """
        Find the request that a plan answers, late as it may be.

        :param message: message with a header.
        :return: ``PlanRequest`` to the same goal as the last one, since there was a plan; or None.
        """
        stamp = nanoseconds(message.header.stamp)
        request = next((sent.request for sent in self._unanswered if sent.stamp == stamp), None)
        kind = ('an unrequested' if request is None else 'the awaited' if request is self._request
                else 'a late')
        self._logger.debug(f'receives {kind} plan')
        return request

    def has_requested(self, message: Any) -> bool:
        """
        Tell whether a plan answers a request of this node, be it one that was given up.

        :param message: message with a header.
        """
        return nanoseconds(message.header.stamp) in self._stamps

    def report_unrequested(self, message: Any) -> None:
        """
        Report a plan that answers no request that is open, and who may have sent it.

        :param message: message with a header.
        """
        reason = ('its request has been answered, or given up' if self.has_requested(message)
                  else 'this node has not requested it')
        self._node.reporter.report(WARN, f'push_plan: a plan is not driven, as {reason}; '
                                         f'{self._senders}')

    def refusal(self, error: ValueError) -> MessageRefused:
        """
        Make the error of an answer that cannot be driven, and say who may have sent it.

        :param error: what is wrong with it.
        """
        return MessageRefused(f'push_plan: {str(error).removeprefix("push_plan: ")}; '
                              f'{self._senders}')

    @property
    def _senders(self) -> str:
        """Who publishes plans: rclpy does not tell which of them has sent a message."""
        names = self._node.publishers_of('push_plan')
        return f'push_plan is published by {" and ".join(names) or "nobody who is known by now"}'

    def _now(self, time: float) -> float:
        return time if self._is_lockstep else wall.monotonic()
