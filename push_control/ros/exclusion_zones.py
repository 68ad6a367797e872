"""
The pushed object is hidden from Nav2's collision monitor while a goal is pursued.

A monitor that sees the object right in front of the robot would stop every push. Each of its
sources offers two services, ``<monitor>/<source>/add_exclusion_zone`` and
``.../remove_exclusion_zone`` (Nav2 of Lyrical and later). It ignores points within a zone. The
zone hangs on the frame of the object, which the controller publishes. So it moves with the object,
and is void for the monitor as soon as nobody publishes that frame, as after a crash.
"""

import enum
import importlib
import time
from typing import Any, Callable, NamedTuple

from geometry_msgs.msg import Point32
from push_model.parameters import PushedObject
from push_ros.conversions.footprint import grown_outline
from push_ros.diagnostics import OK, WARN
from push_ros.executor import await_answer
from push_ros.node import PushNode
from push_ros.node_settings import CollisionMonitorSettings
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.task import Future

# Name of the zone at every source, and of the part of the diagnostics.
ZONE = 'pushed_object'
PART = 'collision_monitor'
# Period at which zones are compared with what is wanted [s]; chosen: a robot at 0.3 m/s drives
# 3 cm in it, less than monitors look ahead.
PERIOD = 0.1
# Time after which an answer is lost, and after which a refused call is repeated [s]; chosen: a
# hundred times the usual one.
ANSWER_TIME = 2.0
# Longest wait for answers at the end [s]; chosen: forty times the usual one, as on a
# busy machine, and half of what a node has to end.
LAST_ANSWER_TIME = 1.0

Outline = tuple[tuple[float, float], ...]


class Call(enum.Enum):
    """Call of a source."""

    ADD = enum.auto()
    REMOVE = enum.auto()


class SourceZone:
    """
    The zone at one source: what is wanted, and what its answers tell of the present one.

    At first, and after a lost answer, the present zone is unknown: it is removed before another
    one is added. A removal that is refused means that there is no zone.

    ``refusal``: why the source has refused the zone last; empty where it has not.
    ``is_silent``: whether its last answer was lost.
    """

    def __init__(self) -> None:
        """Know nothing of the source, and want no zone."""
        self.refusal = ''
        self.is_silent = False
        self._requested: Outline | None = None
        self._present: Outline | None = None
        self._is_known = False
        self._pending: Call | None = None
        self._sent: Outline | None = None
        # Time from which on the next call may be made, or the pending one is lost [s].
        self._deadline = 0.0

    @property
    def is_settled(self) -> bool:
        """Tell whether the source is known to have the requested zone, or none."""
        return self._is_known and self._pending is None and self._present == self._requested

    @property
    def requested(self) -> Outline | None:
        """Vertices of the requested zone in the frame of the object [m]; None for no zone."""
        return self._requested

    def want(self, outline: Outline | None) -> None:
        """
        Want a zone, or none.

        :param outline: vertices in the frame of the object [m]; None for no zone.
        """
        self._requested = outline

    def next_call(self, now: float) -> Call | None:
        """
        Choose the call to make now, and suppose that it is made.

        :param now: time [s].
        :return: ``Call``, of ``requested`` where a zone is added; None for no call.
        """
        if now < self._deadline or self.is_settled:
            return None
        if self._pending is not None:
            # The answer is lost, and whether the call was heard is unknown.
            self._is_known = False
            self.is_silent = True
        is_absent = self._is_known and self._present is None
        self._pending = Call.ADD if is_absent else Call.REMOVE
        self._sent = self._requested
        self._deadline = now + ANSWER_TIME
        return self._pending

    def on_answer(self, now: float, *, success: bool, message: str = '') -> None:
        """
        Take the answer to the last call.

        :param now: time [s].
        :param success: whether it was carried out.
        :param message: of the source.
        """
        call, self._pending = self._pending, None
        self.is_silent = False
        is_refused = call is Call.ADD and not success
        self._present = self._sent if call is Call.ADD and success else None
        # A zone that is refused may be there already.
        self._is_known = not is_refused
        self._deadline = now + ANSWER_TIME if is_refused else now
        if call is Call.ADD:
            self.refusal = message if is_refused else ''

    def forget(self) -> None:
        """Know nothing of a source any more, as its monitor has ended."""
        self._is_known = False
        self._pending = None
        self._deadline = 0.0


class _Types(NamedTuple):
    """Types of ``nav2_msgs``."""

    add: Any
    remove: Any


class ExclusionZones:
    """Adds a zone at each source while a goal is pursued, and removes it whatever happens."""

    def __init__(self, node: PushNode, settings: CollisionMonitorSettings, object_frame: str,
                 hidden_object: Callable[[], PushedObject | None]) -> None:
        """
        Start, and remove zones that a previous process may have left.

        :param settings: ``CollisionMonitorSettings``; without a node there is nothing to do.
        :param object_frame: frame of the object on tf.
        :param hidden_object: returns the object that is to be ignored now, or None.
        :raises ValueError: where ``nav2_msgs`` is missing or older than the zones.
        """
        self._node = node
        self._settings = settings
        self._object_frame = object_frame
        self._hidden_object = hidden_object
        self._sources: list[_Source] = []
        self._reported = ''
        if not settings.node:
            return
        types = _import_types(settings.node)
        self._sources = [_Source(node, settings.node, source.name, types)
                         for source in settings.sources]
        self._timer = node.create_timer(PERIOD, node.guarded(self._update),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))

    def remove(self) -> None:
        """Ask for the removal of all zones now: the process may end before the next period."""
        for source in self._sources:
            source.ask_for_removal()

    def destroy(self) -> None:
        """Remove the zones, and ask no more: a request without an answer may be lost."""
        if self._sources:
            self._node.destroy_timer(self._timer)
        end = time.monotonic() + LAST_ANSWER_TIME
        for source in self._sources:
            source.await_addition(end)
        self.remove()
        for source in self._sources:
            source.await_removal(end)
            source.destroy()
        self._sources = []

    def _update(self) -> None:
        obj = self._hidden_object()
        outline = None if obj is None else tuple(grown_outline(obj, self._settings.margin))
        for source in self._sources:
            source.update(outline, self._object_frame)
        self._report(is_hidden=obj is not None)

    def _report(self, *, is_hidden: bool) -> None:
        """Report where the monitor may stop the robot in front of the object."""
        missing = [source.fault for source in self._sources if source.fault] if is_hidden else []
        text = '; '.join(missing) or (
            'the object is ignored' if is_hidden else 'the object is watched like an obstacle')
        self._node.reporter.report_part(PART, WARN if missing else OK, text, {},
                                        is_news=bool(missing) and text != self._reported)
        self._reported = text


class _Source:
    """The services of one source."""

    def __init__(self, node: PushNode, monitor: str, name: str, types: _Types) -> None:
        self._node = node
        self._types = types
        self._name = f'{monitor}/{name}'
        self._zone = SourceZone()
        self._add = node.create_client(types.add, f'{self._name}/add_exclusion_zone')
        self._remove = node.create_client(types.remove, f'{self._name}/remove_exclusion_zone')
        self._answer: Future | None = None
        # The last request for a zone.
        self._addition: Future | None = None

    @property
    def fault(self) -> str:
        """Why the object may not be ignored here; empty where it is."""
        if self._zone.is_settled:
            return ''
        if self._zone.refusal:
            return f'{self._name} refuses to ignore the object: {self._zone.refusal}'
        if not self._is_there:
            return f'{self._name} does not offer exclusion zones, and may stop the robot'
        return f'{self._name} does not answer' if self._zone.is_silent else ''

    @property
    def _is_there(self) -> bool:
        return bool(self._add.service_is_ready() and self._remove.service_is_ready())

    def update(self, outline: Outline | None, frame: str) -> None:
        """Take an answer that has come, and make the next call."""
        now = time.monotonic()
        self._zone.want(outline)
        if not self._is_there:
            self._zone.forget()
            self._answer = None
            return
        if self._answer is not None and self._answer.done():
            answer: Any = self._answer.result()
            self._answer = None
            self._zone.on_answer(now, success=answer.success, message=answer.message)
        call = self._zone.next_call(now)
        if call is Call.ADD:
            self._answer = self._addition = self._add.call_async(self._add_request(frame))
        elif call is Call.REMOVE:
            self._answer = self._request_removal()

    def ask_for_removal(self) -> None:
        """Call without a wait for the answer; what was asked before may still be on its way."""
        self._zone.forget()
        self._answer = None
        if self._remove.service_is_ready():
            self._answer = self._request_removal()

    def await_addition(self, end: float) -> None:
        """Wait until a zone is there that was asked for, or a time of ``time.monotonic`` [s]."""
        if self._addition is not None:
            await_answer(self._add, self._addition, end - time.monotonic())

    def await_removal(self, end: float) -> None:
        """Likewise until it is gone."""
        if self._answer is not None:
            await_answer(self._remove, self._answer, end - time.monotonic())

    def _request_removal(self) -> Future:
        return self._remove.call_async(self._types.remove.Request(zone_name=ZONE))

    def destroy(self) -> None:
        """Ask no more."""
        self._node.destroy_client(self._add)
        self._node.destroy_client(self._remove)

    def _add_request(self, frame: str) -> Any:
        request = self._types.add.Request()
        zone = request.zone
        zone.zone_name, zone.type, zone.frame_id = ZONE, 'polygon', frame
        zone.points = [Point32(x=x, y=y, z=0.0) for x, y in self._zone.requested or ()]
        zone.enabled = True
        return request


def _import_types(monitor: str) -> _Types:
    """
    Import the types of the services.

    :raises ValueError: where they are not installed.
    """
    try:
        services = importlib.import_module('nav2_msgs.srv')
        return _Types(services.AddExclusionZone, services.RemoveExclusionZone)
    except (ImportError, AttributeError) as error:
        raise ValueError(f'collision_monitor.node: got {monitor!r}, but nav2_msgs has no '
                         'AddExclusionZone here (it has one from Lyrical on); expected an empty '
                         'text') from error
