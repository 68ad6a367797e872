"""What the nodes share: parameters, topics by name, diagnostics, and two kinds of callbacks."""

from push_ros.diagnostics import Reporter
from push_ros.executor import take_message
from push_ros.parameters import declare_parameters
from push_ros.topics import SERVICES, TOPICS
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class BackgroundGroup(MutuallyExclusiveCallbackGroup):
    """
    Callbacks that can wait a little: services, plans, the clock.

    Every entity that an executor waits for costs time at every message, so ``run.spin`` opens
    this group only now and then, and an exchange in lockstep takes half as long.
    """

    opened = True

    def can_execute(self, entity):
        """
        Tell whether a callback may be run now.

        :param entity: the subscription, timer or service.
        """
        return self.opened and super().can_execute(entity)


class PushNode(Node):
    """
    A node with parameters from dataclasses, whose topics and services are those of the list.

    Callbacks belong to ``background`` unless they are made with ``real_time=True``.

    :param name: of the node.
    :param sections: (prefix with its dot, dataclass) sequence; the instances are ``settings``.
    :raises ValueError: naming the parameter that is unknown, missing or wrong.
    """

    def __init__(self, name, sections):
        self._polled = []
        self.background = BackgroundGroup()
        self.real_time = MutuallyExclusiveCallbackGroup()
        super().__init__(name, automatically_declare_parameters_from_overrides=True)
        self.settings = declare_parameters(self, sections)
        self.reporter = Reporter(self, self.publisher('diagnostics'))

    @property
    def default_callback_group(self):
        """Group of everything that rclpy makes for itself, and of what may wait."""
        return self.background

    def publisher(self, topic, stamped=True):
        """
        Make the publisher of a topic of the list.

        :param topic: its name.
        :param stamped: whether commands have a stamp.
        """
        entry = TOPICS[topic]
        return self.create_publisher(entry.message_type(stamped), topic, entry.publish_qos)

    def subscribe(self, topic, callback, real_time=False, stamped=True, qos=None):
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
            self._polled.append((subscription, callback))
        return subscription

    def poll(self):
        """Handle an urgent message of each topic that has one; tell whether there was any."""
        found = False
        for subscription, callback in self._polled:
            message = take_message(subscription)
            if message is not None:
                found = True
                callback(message)
        return found

    def serve_trigger(self, service, action):
        """
        Offer a Trigger service of the list.

        :param service: its name.
        :param action: takes nothing, returns (success, sentence).
        """
        def answer(_, response):
            response.success, response.message = action()
            return response
        return self.create_service(SERVICES[service][0], service, answer)

    def trigger_client(self, service):
        """
        Make what calls a Trigger service of another node, and does not wait for its answer.

        :param service: its name.
        :return: function of nothing.
        """
        client = self.create_client(SERVICES[service][0], service)
        return lambda: client.call_async(SERVICES[service][0].Request())

    def close(self):
        """Say good-bye: called once, while publishers still work."""


class RateLimiter:
    """
    Lets something happen at most so often in simulated or measured time.

    :param frequency: [Hz].
    """

    def __init__(self, frequency):
        self._period = 1.0 / frequency
        self._next = None

    def due(self, time):
        """
        Tell whether it is time again, and if so count it as done.

        :param time: now [s]; where it runs backwards, it is time.
        """
        if self._next is not None and self._next - self._period <= time < self._next:
            return False
        self._next = time + self._period
        return True
