"""What the nodes share: parameters, topics by name, diagnostics, two groups of callbacks."""

from typing import Any, Callable, NamedTuple, Sequence

from push_ros.diagnostics import Reporter
from push_ros.executor import BackgroundGroup, PolledNode, take_message
from push_ros.parameters import declare_parameters, Section
from push_ros.topics import SERVICES, TOPICS
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.subscription import Subscription


class ServiceAnswer(NamedTuple):
    """Answer to a Trigger service: whether it was done, and one sentence."""

    success: bool
    message: str


class PolledSubscription(NamedTuple):
    """A real-time subscription and its callback."""

    subscription: Subscription
    callback: Callable[[Any], None]


class PushNode(PolledNode):
    """
    A node with parameters from dataclasses, whose topics and services are those of the list.

    Callbacks belong to the group ``background`` unless they are made with ``real_time=True``.

    :param name: of the node.
    :param sections: (prefix with its dot, dataclass) sequence; the instances are ``settings``.
    :raises ValueError: naming the parameter that is unknown, missing or wrong.
    """

    def __init__(self, name: str, sections: Sequence[Section]) -> None:
        self._polled: list[PolledSubscription] = []
        self.background = BackgroundGroup()
        self.real_time = MutuallyExclusiveCallbackGroup()
        super().__init__(name, automatically_declare_parameters_from_overrides=True)
        self.settings = declare_parameters(self, sections)
        self.reporter = Reporter(self, self.publisher('diagnostics'))

    @property
    def default_callback_group(self) -> BackgroundGroup:
        """Group of everything that rclpy makes by itself, and of what may wait."""
        return self.background

    def publisher(self, topic: str, stamped: bool = True) -> Publisher:
        """
        Make the publisher of a topic of the list.

        :param topic: its name.
        :param stamped: whether commands have a stamp.
        """
        entry = TOPICS[topic]
        return self.create_publisher(entry.message_type(stamped), topic, entry.publish_qos)

    def subscribe(self, topic: str, callback: Callable[[Any], None], *, real_time: bool = False,
                  stamped: bool = True, qos: QoSProfile | None = None) -> Subscription:
        """
        Subscribe to a topic of the list.

        :param topic: its name.
        :param callback: takes the message.
        :param real_time: whether the callback is run at once.
        :param stamped: whether commands have a stamp.
        :param qos: another quality of service than that of the list.
        """
        entry = TOPICS[topic]
        group = self.real_time if real_time else self.background
        subscription = self.create_subscription(
            entry.message_type(stamped), topic, callback, qos or entry.subscribe_qos,
            callback_group=group)
        if real_time:
            self._polled.append(PolledSubscription(subscription, callback))
        return subscription

    def poll(self) -> bool:
        """Handle a message of each real-time topic that has one; tell whether there was any."""
        found = False
        for polled in self._polled:
            message = take_message(polled.subscription)
            if message is not None:
                found = True
                polled.callback(message)
        return found

    def serve_trigger(self, service: str, action: Callable[[], ServiceAnswer]) -> Service:
        """
        Offer a Trigger service of the list.

        :param service: its name.
        :param action: takes nothing, returns (success, sentence).
        """
        def answer(_: Any, response: Any) -> Any:
            response.success, response.message = action()
            return response
        return self.create_service(SERVICES[service].type, service, answer)

    def trigger_client(self, service: str) -> Callable[[], None]:
        """
        Make a function that calls a Trigger service of another node without waiting for it.

        :param service: its name.
        :return: function of nothing.
        """
        kind = SERVICES[service].type
        client: Client = self.create_client(kind, service)

        def call() -> None:
            client.call_async(kind.Request())
        return call

    def close(self) -> None:
        """Shut down: called once, while publishers are still valid."""


class RateLimiter:
    """
    Limits how often something happens, in simulated or measured time.

    :param frequency: at most so often [Hz].
    """

    def __init__(self, frequency: float) -> None:
        self._period = 1.0 / frequency
        self._next: float | None = None

    def due(self, time: float) -> bool:
        """
        Tell whether it is time, and if so count it as done.

        :param time: now [s]; where it runs backwards, it is time.
        """
        if self._next is not None and self._next - self._period <= time < self._next:
            return False
        self._next = time + self._period
        return True
