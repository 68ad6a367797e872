"""Diagnostics: what a node does, said when it changes and once a second."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
PERIOD = 1.0
# Key of the value that tells that a node has a map.
HAS_MAP = 'has_map'


class Reporter:
    """
    Publishes the status of a node on ``diagnostics``.

    :param node: the node.
    :param publisher: its publisher of ``DiagnosticArray``.
    """

    def __init__(self, node, publisher):
        self._name, self._publisher, self._logger = node.get_name(), publisher, node.get_logger()
        self._last = None
        # On the wall clock, so that whoever listens late hears of it, even while time is held.
        node.create_timer(PERIOD, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._message = None

    def report(self, level, text, stamp, values=None, always=False):
        """
        Say what the node does; published at once where level or text differ from the last.

        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: one sentence.
        :param stamp: ``builtin_interfaces/Time`` to which it applies.
        :param values: dict of names to anything that has a text.
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

    def publish(self):
        """Publish the last status again."""
        if self._message is not None:
            self._publisher.publish(self._message)

    def _log(self, level, text):
        # One call site each: rclpy ties a severity to the line that logs.
        if level == ERROR:
            self._logger.error(text)
        elif level == WARN:
            self._logger.warning(text)
        else:
            self._logger.info(text)
