"""What the nodes share: parameters, topics by name, diagnostics, and two kinds of callbacks."""

from push_ros.diagnostics import Reporter
from push_ros.executor import take
from push_ros.parameters import declare
from push_ros.topics import SERVICES, TOPICS
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class PatientGroup(MutuallyExclusiveCallbackGroup):
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

    Callbacks belong to ``patient`` unless they are made with ``urgent=True``.

    :param name: of the node.
    :param sections: (prefix with its dot, dataclass) sequence; the instances are ``settings``.
    :raises ValueError: naming the parameter that is unknown, missing or wrong.
    """

    def __init__(self, name, sections):
        self._polled = []
        self.patient = PatientGroup()
        self.urgent = MutuallyExclusiveCallbackGroup()
        super().__init__(name, automatically_declare_parameters_from_overrides=True)
        self.settings = declare(self, sections)
        self.reporter = Reporter(self, self.publisher('diagnostics'))

    @property
    def default_callback_group(self):
        """Group of everything that rclpy makes for itself, and of what may wait."""
        return self.patient

    def publisher(self, topic, stamped=True):
        """
        Make the publisher of a topic of the list.

        :param topic: its name.
        :param stamped: whether commands have a stamp.
        """
        entry = TOPICS[topic]
        return self.create_publisher(entry.message_type(stamped), topic, entry.publish_qos)

    def subscribe(self, topic, callback, urgent=False, stamped=True, qos=None):
        """
        Subscribe to a topic of the list.

        :param topic: its name.
        :param callback: takes the message.
        :param urgent: whether the callback is run at once.
        :param stamped: whether commands have a stamp.
        :param qos: another quality of service than that of the list.
        """
        entry = TOPICS[topic]
        group = self.urgent if urgent else self.patient
        subscription = self.create_subscription(
            entry.message_type(stamped), topic, callback, qos or entry.subscribe_qos,
            callback_group=group)
        if urgent:
            self._polled.append((subscription, callback))
        return subscription

    def poll(self):
        """Handle an urgent message of each topic that has one; tell whether there was any."""
        found = False
        for subscription, callback in self._polled:
            message = take(subscription)
            if message is not None:
                found = True
                callback(message)
        return found

    def serve(self, service, action):
        """
        Offer a Trigger service of the list.

        :param service: its name.
        :param action: takes nothing, returns (success, sentence).
        """
        def answer(_, response):
            response.success, response.message = action()
            return response
        return self.create_service(SERVICES[service][0], service, answer)

    def ask(self, service):
        """
        Make what calls a Trigger service of another node, and does not wait for its answer.

        :param service: its name.
        :return: function of nothing.
        """
        client = self.create_client(SERVICES[service][0], service)
        return lambda: client.call_async(SERVICES[service][0].Request())

    def close(self):
        """Say good-bye: called once, while publishers still work."""


class Rate:
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
