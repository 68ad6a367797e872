"""Diagnostics: what a node does, published when it changes and once a second."""

import enum
import math
import numbers
import re
import time
from typing import Any, Callable, Mapping

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from push_model.geometry import Pose
from push_ros.conversions.primitives import seconds
from rclpy.node import Node

OK = DiagnosticStatus.OK
WARN = DiagnosticStatus.WARN
ERROR = DiagnosticStatus.ERROR
# Time after which a status is published again [s], as diagnostic tools expect it.
PERIOD = 1.0
# Period of reports of one fault whose numbers differ each time [s], number of such faults that are
# remembered, and characters of a report; chosen: what somebody can read.
REPEAT_PERIOD = 1.0
MAX_KINDS = 100
MAX_TEXT = 1000
# Lines of a log that may come at once, and per second from then on [1/s]; chosen: several tasks in
# a row, of which each begins and ends with a dozen lines in some twenty seconds.
BURST = 40.0
LINE_RATE = 2.0
NUMBER = re.compile(r'[-+]?\d[\d.e+-]*')
# Keys of values that programs read: whether a node has a map, and the ``PlanFailure`` for which
# there is no plan.
HAS_MAP = 'has_map'
FAILURE = 'failure'
# Units of the values by the last part of their names; all others are counts, words or ratios.
UNITS = {
    **dict.fromkeys(('time', 'since', 'duration', 'stamp_lag'), 's'),
    **dict.fromkeys(('position_error', 'position_deviation', 'remaining_distance',
                     'travelled_distance', 'path_length', 'friction_center', 'final_straight',
                     'displacement_bound', 'longest_blend'), 'm'),
    **dict.fromkeys(('heading_error', 'heading_deviation', 'push_direction',
                     'peak_angle_change'), 'rad'),
    **dict.fromkeys(('pushing_speed', 'highest_speed', 'present_speed'), 'm/s')}


class LogThrottle:
    """
    Lets lines into a log, many at once, but few per second for ever.

    Where there are more, the newest of them is kept until there is room, and the others counted.
    """

    def __init__(self) -> None:
        """Start with all lines of a burst."""
        self._room = BURST
        self._times: tuple[float, ...] = ()
        self._held: tuple[bytes, str] | None = None
        self._omitted = 0

    def admits(self, level: bytes, text: str, times: tuple[float, ...]) -> bool:
        """
        Tell whether a line may be logged now; otherwise keep it, in place of a previous one.

        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: the line.
        :param times: the present on several clocks [s], of which the fastest counts: simulated
            time may stand still, or pass ten times as fast.
        """
        if self._held is None and self._takes_room(times):
            return True
        self._omitted += self._held is not None
        self._held = level, text
        return False

    def release(self, times: tuple[float, ...]) -> tuple[bytes, str] | None:
        """
        Return level and text of the line that is held, once there is room for it.

        :param times: as of ``admits``.
        """
        if self._held is None or not self._takes_room(times):
            return None
        return self.release_last()

    def release_last(self) -> tuple[bytes, str] | None:
        """Return level and text of the line that is held, whether there is room for it or not."""
        if self._held is None:
            return None
        (level, text), self._held = self._held, None
        count, self._omitted = self._omitted, 0
        return level, f'{text} ({count} lines before it are left out)' if count else text

    def _takes_room(self, times: tuple[float, ...]) -> bool:
        passed = max((now - before for now, before in zip(times, self._times)), default=0.0)
        self._times = times
        self._room = min(BURST, self._room + LINE_RATE * max(0.0, passed))
        if self._room < 1.0:
            return False
        self._room -= 1.0
        return True


class Reporter:
    """
    Publishes the status of a node on ``/diagnostics``, and logs its changes.

    Where these never end, as with a hundred goals a second, the log has the newest of each second.
    """

    def __init__(self, node: Node, publisher: Any, now: Callable[[], Time]) -> None:
        """
        Start without a status.

        :param node: the node.
        :param publisher: its publisher of ``DiagnosticArray``.
        :param now: gives the present time of the node.
        """
        # With its namespace: all robots share one topic.
        self._name = node.get_fully_qualified_name().lstrip('/')
        self._logger = node.get_logger()
        self._publisher = publisher
        self._now = now
        self._last: tuple[bytes, str] | None = None
        self._status: DiagnosticStatus | None = None
        # Statuses besides that of the node, by name.
        self._parts: dict[str, DiagnosticStatus] = {}
        # Kinds of faults that were reported lately, and when, in monotonic time [s].
        self._reported: dict[str, float] = {}
        # Errors have a throttle of their own: nothing else keeps them out.
        self._throttles = {is_error: LogThrottle() for is_error in (False, True)}

    def report(self, level: bytes, text: str, values: Mapping[str, Any] | None = None,
               always: bool = False) -> None:
        """
        Report what the node does; published at once where level or text differ from the last.

        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: one sentence.
        :param values: names, as in ``UNITS``, to values, see ``value_text``.
        :param always: whether it is published at once in any case.
        """
        text = shortened(text)
        self._status = _make_status(level, self._name, text, values or {})
        is_news = (level, text) != self._last and not self._floods(level, text)
        if always or is_news:
            self._last = level, text
            self.log(level, text)
            self.publish()

    def report_part(self, part: str, level: bytes, text: str, values: Mapping[str, Any], *,
                    is_news: bool) -> None:
        """
        Report a status besides that of the node, which is repeated with it.

        :param part: its name, behind that of the node.
        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: one sentence.
        :param values: as of ``report``.
        :param is_news: whether it is logged, and published at once.
        """
        text = shortened(text)
        self._parts[part] = _make_status(level, f'{self._name}: {part}', text, values)
        if is_news:
            self.log(level, text)
            self.publish()

    def _floods(self, level: bytes, text: str) -> bool:
        """Tell whether the same fault was reported a moment ago, with other numbers perhaps."""
        if level != ERROR:
            return False
        kind, now = NUMBER.sub('#', text), time.monotonic()
        if now - self._reported.get(kind, -math.inf) < REPEAT_PERIOD:
            return True
        if len(self._reported) >= MAX_KINDS:
            self._reported.clear()
        self._reported[kind] = now
        return False

    def publish(self) -> None:
        """Publish the last status again, with the present time."""
        if self._status is not None:
            message = DiagnosticArray(status=[self._status, *self._parts.values()])
            message.header.stamp = self._now()
            self._publisher.publish(message)

    def repeat(self) -> None:
        """Publish the status again, and log what waits; called once per ``PERIOD``."""
        self.publish()
        for throttle in self._throttles.values():
            line = throttle.release(self._times)
            if line is not None:
                self._write(*line)

    def close(self) -> None:
        """Log what was kept for want of room: nothing follows it."""
        for throttle in self._throttles.values():
            line = throttle.release_last()
            if line is not None:
                self._write(*line)

    def log(self, level: bytes, text: str) -> None:
        """
        Log a sentence that is no status, at once or when there is room for it.

        :param level: ``OK``, ``WARN`` or ``ERROR``.
        :param text: one sentence.
        """
        if self._throttles[level == ERROR].admits(level, text, self._times):
            self._write(level, text)

    @property
    def _times(self) -> tuple[float, float]:
        """The present on a steady clock and on the clock of the node [s]."""
        return time.monotonic(), seconds(self._now())

    def _write(self, level: bytes, text: str) -> None:
        # One call site each: rclpy ties a severity to the line that logs.
        if level == ERROR:
            self._logger.error(text)
        elif level == WARN:
            self._logger.warning(text)
        else:
            self._logger.info(text)


def _make_status(level: bytes, name: str, text: str, values: Mapping[str, Any]
                 ) -> DiagnosticStatus:
    status = DiagnosticStatus(level=level, name=name, message=text)
    status.values = [KeyValue(key=_key(key), value=value_text(value))
                     for key, value in values.items()]
    return status


def shortened(text: str, limit: int = MAX_TEXT) -> str:
    """
    Shorten what somebody has sent, or a sentence that quotes it.

    :param text: of any length.
    :param limit: greatest number of its characters that are kept.
    """
    if len(text) <= limit:
        return text
    half = limit // 2
    return f'{text[:half]} ... ({len(text)} characters) ... {text[-half:]}'


def value_text(value: Any) -> str:
    """
    Write a value for people, in a form that programs can read as well.

    :param value: number, text, truth value, enum, ``Pose``, None, or several of them.
    """
    if value is None:
        return 'none'
    if isinstance(value, enum.Enum):
        return str(value.value)
    if isinstance(value, Pose):
        return f'{value.x:.4f} m, {value.y:.4f} m, {value.theta:.4f} rad'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, numbers.Real):
        return _number_text(float(value))
    if type(value) in (list, tuple):
        # Types of their own have texts of their own.
        return ', '.join(map(value_text, value))
    return str(value)


def status_values(status: DiagnosticStatus) -> dict[str, str]:
    """
    Read the values of a status.

    :param status: as a ``Reporter`` made it.
    :return: texts by name, without units.
    """
    return {item.key.partition(' [')[0]: item.value for item in status.values}


def _key(name: str) -> str:
    unit = UNITS.get(name.rpartition('.')[2])
    return f'{name} [{unit}]' if unit else name


def _number_text(number: float) -> str:
    """Write a number with the decimals that matter, whole ones without any."""
    if not math.isfinite(number):
        return str(number)
    # Times of a clock in microseconds, small quantities with six digits.
    text = f'{number:.6f}' if abs(number) >= 0.1 else f'{number:.6g}'
    return text.rstrip('0').rstrip('.') if '.' in text and 'e' not in text else text
