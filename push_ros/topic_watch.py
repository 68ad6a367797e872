"""What a node waits for: topics on which nothing comes, and why."""

from collections.abc import Collection
import difflib
import time
from typing import Any, Callable, cast, NamedTuple

from push_ros.diagnostics import OK, WARN
from push_ros.node import PushNode
from push_ros.publisher_names import publisher_name
from push_ros.topics import interface_name, TOPICS
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

# Period of looks at what has come [s], and time after which what has not come is reported [s];
# chosen: a person waits no longer, and whoever publishes has met the node before.
PERIOD = 0.25
REPORT_TIME = 1.0
# Topics of the same type that are named in place of one that nobody publishes.
MAX_SUGGESTIONS = 3
# Name of the status besides that of the node.
PART = 'inputs'


class TopicState(NamedTuple):
    """
    Who publishes on a topic.

    :param publishers: number of publishers.
    :param is_obstructed: whether one of them cannot reach the node.
    :param text: who publishes, and what does not fit, one clause.
    """

    publishers: int
    is_obstructed: bool
    text: str


class _Wait(NamedTuple):
    """
    A topic on which something is missing.

    :param since: when that was first so, on a steady clock [s].
    :param is_awaited: whether the node cannot go on without it.
    :param state: the present ``TopicState``.
    """

    since: float
    is_awaited: bool
    state: TopicState

    def sentence(self, now: float) -> str:
        """Say what is missing, and for how long."""
        subject = 'waits for ' if self.is_awaited else ''
        return f'{subject}{self.state.text}, for {now - self.since:.1f} s'


class TopicWatch:
    """
    Reports topics on which nothing comes that is needed, and publishers that do not fit.

    ``text``: what the node waits for, one clause; empty where it waits for nothing.
    """

    def __init__(self, node: PushNode, awaited: Callable[[], Collection[str]]) -> None:
        """
        Start to wait.

        :param awaited: names the topics on which something has to come, and has not.
        """
        self.text = ''
        self._node = node
        self._awaited = awaited
        self._waits: dict[str, _Wait] = {}
        # Number of publishers at the last look at who they are.
        self._counts: dict[str, int] = {}
        self._reported: tuple[str, ...] = ()
        self._timer = node.create_timer(PERIOD, node.guarded(self.check),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))

    def destroy(self) -> None:
        """Wait for nothing any more."""
        self._node.destroy_timer(self._timer)
        self._waits.clear()
        self._report(time.monotonic())

    def check(self) -> None:
        """Look at what has not come; reported at once where it is news."""
        now, awaited = time.monotonic(), self._awaited()
        for topic, subscription in self._node.topic_subscriptions:
            is_awaited = topic in awaited
            state = self._look(topic, subscription, is_awaited)
            if state is None:
                continue
            if is_awaited or state.is_obstructed:
                since = self._waits[topic].since if topic in self._waits else now
                self._waits[topic] = _Wait(since, is_awaited, state)
            else:
                self._waits.pop(topic, None)
        self._report(now)

    def _look(self, topic: str, subscription: Subscription, is_awaited: bool) -> TopicState | None:
        """Look who publishes; None where nothing has changed that is of interest."""
        count = self._node.count_publishers(subscription.topic_name)
        if count == self._counts.get(topic, 0) and not is_awaited and topic not in self._waits:
            return None
        self._counts[topic] = count
        return topic_state(self._node, subscription)

    def _report(self, now: float) -> None:
        waits = {topic: wait for topic, wait in self._waits.items()
                 if now - wait.since >= REPORT_TIME}
        names = [topic for topic, wait in waits.items() if wait.is_awaited]
        self.text = f'waits for {" and ".join(names)}' if names else ''
        clauses = tuple(wait.state.text for wait in waits.values())
        if not clauses and not self._reported:
            return
        is_news, self._reported = clauses != self._reported, clauses
        values: dict[str, Any] = {}
        for topic, wait in waits.items():
            values[f'{topic}.since'] = now - wait.since
            values[f'{topic}.publishers'] = wait.state.publishers
        text = '; '.join(wait.sentence(now) for wait in waits.values())
        self._node.reporter.report_part(PART, WARN if waits else OK, text or 'waits for nothing',
                                        values, is_news=is_news)


def topic_state(node: Node, subscription: Subscription) -> TopicState:
    """
    Find out who publishes on a topic, and whether that can reach a subscription.

    :param node: that is asked what it knows of others.
    :param subscription: of the topic.
    """
    message_type = cast(type[Any], subscription.msg_type)
    name, kind = subscription.topic_name, interface_name(message_type)
    publishers = node.get_publishers_info_by_topic(name)
    if not publishers:
        return TopicState(0, False, f'{name}: 0 publishers{_suggestion(node, name, kind)}')
    names = [publisher_name(info) for info in publishers]
    faults = [f'{who} {fault}' for who, fault in zip(names, (
        _obstacle(info, subscription, kind) for info in publishers)) if fault]
    count = f'{len(publishers)} publisher{"s" if len(publishers) > 1 else ""}'
    text = '; '.join(faults) or f'{" and ".join(names)}, but nothing usable has come'
    return TopicState(len(publishers), bool(faults), f'{name}: {count}: {text}')


def _obstacle(info: TopicEndpointInfo, subscription: Subscription, kind: str) -> str:
    """Say why a publisher cannot reach a subscription; empty where it can."""
    if info.topic_type != kind:
        return f'publishes {info.topic_type}, expected {kind}'
    compatibility, reason = qos_check_compatible(info.qos_profile, subscription.qos_profile)
    # What rclpy returns is no member of its own enum, but equal to one.
    if compatibility != QoSCompatibility.ERROR:
        return ''
    return f'offers a quality of service that does not fit: {reason.strip(" ;")}'


def _suggestion(node: Node, name: str, kind: str) -> str:
    """Name topics that may be meant: of that type, and none that has a meaning of its own."""
    known = {node.resolve_topic_name(topic) for topic in TOPICS}
    others = [other for other, types in node.get_topic_names_and_types()
              if kind in types and other not in known and node.count_publishers(other) > 0]
    similar = difflib.get_close_matches(name, others, MAX_SUGGESTIONS, cutoff=0.0)
    return f'; {" and ".join(similar)} would have the type {kind}' if similar else ''
