"""Diagnostics: what a node does, published when it changes and once a second."""

from typing import Any, Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

OK = DiagnosticStatus.OK
WARN = DiagnosticStatus.WARN
ERROR = DiagnosticStatus.ERROR
# Time after which a status is published again [s], as diagnostic tools expect it.
PERIOD = 1.0
# Keys of values that programs read: whether a node has a map, and the ``PlanFailure`` for which
# there is no plan.
HAS_MAP = 'has_map'
FAILURE = 'failure'


class Reporter:
    """
    Publishes the status of a node on ``diagnostics``.

    :param node: the node.
    :param publisher: its publisher of ``DiagnosticArray``.
    """

    def __init__(self, node: Node, publisher: Any) -> None:
        self._name = node.get_name()
        self._logger = node.get_logger()
        self._publisher = publisher
        self._last: tuple[bytes, str] | None = None
        self._message: DiagnosticArray | None = None
        # On the wall clock, so that late subscribers receive it, even while time is held.
        node.create_timer(PERIOD, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def report(self, level: bytes, text: str, stamp: Any,
               values: Mapping[str, Any] | None = None, always: bool = False) -> None:
        """
        Report what the node does; published at once where level or text differ from the last.

        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: one sentence.
        :param stamp: ``builtin_interfaces/Time`` to which it applies.
        :param values: names to anything that has a text.
        :param always: whether it is published at once in any case.
        """
        status = DiagnosticStatus(level=level, name=self._name, message=text)
        status.values = [KeyValue(key=key, value=str(value))
                         for key, value in (values or {}).items()]
        self._message = DiagnosticArray(status=[status])
        self._message.header.stamp = stamp
        if always or (level, text) != self._last:
            self._last = level, text
            self._log(level, text)
            self.publish()

    def publish(self) -> None:
        """Publish the last status again."""
        if self._message is not None:
            self._publisher.publish(self._message)

    def _log(self, level: bytes, text: str) -> None:
        # One call site each: rclpy ties a severity to the line that logs.
        if level == ERROR:
            self._logger.error(text)
        elif level == WARN:
            self._logger.warning(text)
        else:
            self._logger.info(text)
