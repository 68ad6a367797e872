"""Requests for plans, which the planner's node answers."""

from typing import Any

from push_model.plan_request import PlanRequest
from push_ros.conversions.plan_request import to_request_message
from push_ros.conversions.primitives import exact_stamp, NANOSECONDS, nanoseconds
from push_ros.node import PushNode


class PlanRequester:
    """Publishes plan requests, each with a stamp of its own, and recognizes their answers."""

    def __init__(self, node: PushNode, frame: str) -> None:
        """
        Start without a request.

        :param node: the ``PushNode``.
        :param frame: id of the world frame.
        """
        self._publisher = node.publisher('push_request')
        self._logger = node.get_logger()
        self._frame = frame
        self.reset()

    def reset(self) -> None:
        """Forget the request."""
        self._request: PlanRequest | None = None
        self._stamp = 0

    def update(self, request: PlanRequest | None, time: float) -> None:
        """
        Publish a request that is new.

        :param request: the present ``PlanRequest``, or None.
        :param time: of the newest measurement [s].
        """
        if request is not None and request is not self._request:
            self._stamp = max(round(time * NANOSECONDS), self._stamp + 1)
            self._publisher.publish(to_request_message(request, exact_stamp(self._stamp),
                                                       self._frame))
            self._logger.debug(
                f'requests a plan: object at {request.object_pose}, robot at '
                f'{request.robot_pose}, goal {request.goal}')
        self._request = request

    def is_answered_by(self, message: Any) -> bool:
        """
        Tell whether a plan answers the last request.

        :param message: message with a header.
        """
        is_answer = nanoseconds(message.header.stamp) == self._stamp
        self._logger.debug(f'receives the {"awaited" if is_answer else "an unrequested"} plan')
        return is_answer
