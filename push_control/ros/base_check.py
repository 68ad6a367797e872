"""
Check of the base's own parameters, as of reflexes that would take the robot out of every push.

The base's node is asked over its parameter service, whenever a goal comes: its parameters may have
been set, or lost as it started again. Nothing waits for the answer but the goal.
"""

import math
import time
from typing import Any, Callable, NamedTuple

from push_ros.node import PushNode
from push_ros.node_settings import BaseSettings, CHOICE_SEPARATOR
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import GetParameters
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.parameter import parameter_value_to_python
from rclpy.task import Future

# Period at which answers are looked for [s]; chosen: nobody notices it in a goal.
PERIOD = 0.05
# Time after which the base is asked again [s]; chosen: an answer that is not there by then was
# lost, as the base had not met this client yet.
REPEAT_TIME = 0.5


class BaseFault(NamedTuple):
    """
    Why a goal cannot be pursued.

    :param reason: one sentence.
    :param is_interrupted: whether the check was interrupted; else the base is not ready.
    """

    reason: str
    is_interrupted: bool = False


class _Inquiry(NamedTuple):
    """Who waits for a result, and until when, in the time of the ``BaseCheck`` [s]."""

    on_result: Callable[[BaseFault | None], None]
    deadline: float


class BaseCheck:
    """Compares parameters of the base's node with those that pushing needs."""

    def __init__(self, node: PushNode, settings: BaseSettings) -> None:
        """
        Wait for the first inquiry.

        :param settings: ``BaseSettings``; without a node there is nothing to check.
        """
        self._node = node
        self._settings = settings
        self._inquiries: list[_Inquiry] = []
        # Of the present inquiries; one may be lost, and any of them counts.
        self._answers: list[Future] = []
        self._asked_at = 0.0
        # Time that this node has waited [s]: without what it slept, be it suspended or busy, in
        # which no answer could be taken.
        self._time = 0.0
        self._looked_at = 0.0
        if settings.node:
            self._client = node.create_client(GetParameters, f'{settings.node}/get_parameters')
            self._timer = node.create_timer(PERIOD, node.guarded(self._look),
                                            clock=Clock(clock_type=ClockType.STEADY_TIME))
            self._timer.cancel()

    def run(self, on_result: Callable[[BaseFault | None], None]) -> None:
        """
        Check the base.

        :param on_result: called once, at once where there is nothing to check, else within
            ``base.timeout``; takes the ``BaseFault``, or None where the robot can push.
        """
        if not self._settings.node:
            on_result(None)
            return
        self._inquiries.append(_Inquiry(on_result, self._time + self._settings.timeout))
        # An answer that is under way may be older than what somebody has set since.
        self._answers = []
        self._asked_at = 0.0
        self._looked_at = time.monotonic()
        self._timer.reset()

    def interrupt(self, reason: str) -> None:
        """
        End the inquiries that are under way.

        :param reason: why there is no result, one sentence.
        """
        if self._settings.node:
            self._finish(BaseFault(reason, is_interrupted=True))

    def destroy(self) -> None:
        """Ask no more."""
        if self._settings.node:
            self._node.destroy_timer(self._timer)
            self._node.destroy_client(self._client)

    def _look(self) -> None:
        """Ask the base, take its answer, or give up."""
        now = time.monotonic()
        self._time += min(now - self._looked_at, REPEAT_TIME)
        self._looked_at = now
        for answer in self._answers:
            if answer.done():
                self._finish(self._fault(answer.result()))
                return
        self._finish(BaseFault(
            f'{self._settings.node}: got none of its parameters within '
            f'{self._settings.timeout:g} s, expected that this node of the base can be reached '
            '(an empty base.node leaves this check out)'), self._time)
        if (self._inquiries and now >= self._asked_at + REPEAT_TIME
                and self._client.service_is_ready()):
            self._asked_at = now
            self._answers.append(self._client.call_async(GetParameters.Request(
                names=[parameter.name for parameter in self._settings.parameters])))

    def _finish(self, fault: BaseFault | None, latest_deadline: float = math.inf) -> None:
        """Hand a result to those whose deadlines have passed, or to all."""
        inquiries = self._inquiries
        self._inquiries = [inquiry for inquiry in inquiries if inquiry.deadline > latest_deadline]
        if not self._inquiries:
            self._timer.cancel()
            self._answers = []
        for inquiry in inquiries:
            if inquiry.deadline <= latest_deadline:
                inquiry.on_result(fault)

    def _fault(self, response: Any) -> BaseFault | None:
        """Compare the answer of the base with what is expected."""
        parameters, values = self._settings.parameters, list(response.values)
        if len(values) != len(parameters):
            names = ', '.join(parameter.name for parameter in parameters)
            return BaseFault(f'{self._settings.node}: got no values, expected the parameters '
                             + names)
        for parameter, value in zip(parameters, values):
            choices = parameter.expected.split(CHOICE_SEPARATOR)
            if _text(value) not in choices:
                return BaseFault(f'{self._settings.node}: {parameter.name}: got {_text(value)}, '
                                 'expected ' + ' or '.join(choices))
        return None


def _text(value: Any) -> str:
    """Write the value of a parameter as in a parameter file."""
    if value.type == ParameterType.PARAMETER_NOT_SET:
        return 'no such parameter'
    plain = parameter_value_to_python(value)
    return str(plain).lower() if isinstance(plain, bool) else str(plain)
