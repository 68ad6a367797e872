"""What the nodes share: parameters, topics by name, diagnostics, two groups of callbacks."""

import sys
import time
import traceback
from types import TracebackType
from typing import Any, Awaitable, Callable, Mapping, NamedTuple, NoReturn, Sequence

from builtin_interfaces.msg import Time
from push_ros import qos
from push_ros.conversions.serialized import message_reader
from push_ros.diagnostics import ERROR, PERIOD, Reporter
from push_ros.executor import (
    BackgroundGroup, PolledNode, StartRefused, take_message, without_location,
)
from push_ros.parameter_files import missed_section, parameter_files
from push_ros.parameters import ParameterHooks, ParameterSet, Section
from push_ros.publisher_names import publisher_name
from push_ros.topics import SERVICES, topic_of_object, TOPICS
from rcl_interfaces.msg import Log, SetParametersResult
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.task import Future
from std_msgs.msg import Header

# Longest waits until somebody reads the log of a node that ends at once, and until all of it has
# got there [s]; chosen: discovery takes some tenths of a second, more on a busy machine.
ROSOUT_WAIT = 3.0
ROSOUT_DELIVERY = 5.0
# As rcl keeps the log: for those who come late.
ROSOUT = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Characters of a traceback that are logged, and how often one is [s]; chosen: all of most, and few
# enough for a fault that comes with every message.
MAX_TRACEBACK = 4000
# What a service answers whose callback raises.
INTERNAL_ERROR = 'internal error: see the log'
TRACEBACK_PERIOD = 1.0
# Without a callback for offers that do not fit: none fails to fit best effort, and an executor
# takes twice as long for a topic that has one.
NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)


class ServiceAnswer(NamedTuple):
    """Answer to a Trigger service: whether it was done, and one sentence."""

    success: bool
    message: str


# What an action of a Trigger service returns, at once or when it has waited for something.
AnyAnswer = ServiceAnswer | Awaitable[ServiceAnswer]


class NewestMessage:
    """
    The newest message of a topic, taken when it is asked for: until then it costs little.

    ``subscription``: of depth 1, which no executor waits for.
    """

    def __init__(self, subscription: Subscription) -> None:
        """Start without a message."""
        self.subscription = subscription
        self._message: Any = None

    @property
    def message(self) -> Any:
        """The newest message, or None before the first."""
        message = take_message(self.subscription)
        if message is not None:
            self._message = message
        return self._message


class _ErrorGuard:
    """Hands every error to a function, but not what ends a process."""

    def __init__(self, on_error: Callable[[Exception], None]) -> None:
        self._on_error = on_error

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 _: TracebackType | None) -> bool:
        if not isinstance(error, Exception):
            return False
        self._on_error(error)
        return True


class PushNode(PolledNode):
    """
    A node with parameters from dataclasses, whose topics and services are those of the list.

    Callbacks belong to the group ``background`` unless they are made with ``real_time=True``.

    ``parameters``: the ``ParameterSet``. ``topic_subscriptions``: what ``subscribe`` and
    ``subscribe_newest`` have made, with the name of each topic in the list.
    """

    def __init__(self, name: str, sections: Sequence[Section],
                 settable: Mapping[str, str] | None = None) -> None:
        """
        Read the parameters.

        :param name: of the node.
        :param sections: (prefix with its dot, dataclass) sequence.
        :param settable: when those may be set that may, by name, as of ``ParameterSet``.
        :raises ValueError: naming the parameter that is unknown, missing or wrong; it is logged,
            too.
        """
        self._publishers_by_topic: dict[str, Publisher] = {}
        self.topic_subscriptions: list[tuple[str, Subscription]] = []
        self.real_time_subscriptions: list[Subscription] = []
        self.background = BackgroundGroup()
        self.real_time = MutuallyExclusiveCallbackGroup()
        super().__init__(name, automatically_declare_parameters_from_overrides=True)
        self._warn_of_missed_sections(name)
        try:
            self.parameters = ParameterSet(self, sections, settable, ParameterHooks(
                self.further_parameters, self.parameter_refusal, self.on_settings_changed))
        except ValueError as error:
            self.refuse_to_start(f'{error} (give parameters with --params-file; config/push.yaml '
                                 'is an example)')
        self.reporter = Reporter(self, self.publisher('diagnostics'), self.now)
        # On the wall clock, so that late subscribers receive it, even while time is held.
        self.create_timer(PERIOD, self.guarded(self.reporter.repeat),
                          clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _warn_of_missed_sections(self, usual_name: str) -> None:
        """Tell a user who has renamed the node that its section in a file was not."""
        for path in parameter_files(sys.argv):
            section = missed_section(path, usual_name, self.get_name())
            if section:
                self.get_logger().warning(
                    f'{path}: its section {section!r} is ignored, as this node is called '
                    f'{self.get_name()!r}; expected a section with that name')

    @property
    def settings(self) -> list[Any]:
        """Instances of the dataclasses of the parameters, in the order of the sections."""
        return self.parameters.settings

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """
        Set parameters, all or none, as its services do.

        :param parameter_list: rclpy ``Parameter`` objects.
        :return: ``SetParametersResult``, with a reason that says what to do instead.
        """
        fault = self.parameters.read_only_fault(parameter.name for parameter in parameter_list)
        if fault:
            return SetParametersResult(successful=False, reason=fault)
        return super().set_parameters_atomically(parameter_list)

    def now(self) -> Time:
        """Return the present time of the node."""
        return self.get_clock().now().to_msg()

    def running_time(self) -> float:
        """Return a time that nobody sets: steady, or simulated where that is used [s]."""
        clock: Any = self.get_clock()
        is_simulated = clock.ros_time_is_active
        return clock.now().nanoseconds * 1e-9 if is_simulated else time.monotonic()

    def further_parameters(self, values: Mapping[str, Any]) -> Mapping[str, Any]:
        """
        Find the parameters that have to be set together with others.

        :param values: those that are being set, by name.
        :return: further values by name.
        """
        return {}

    def parameter_refusal(self, values: Mapping[str, Any]) -> str:
        """
        Find out why parameters cannot be set at present.

        :param values: those that are being set, by name.
        :return: one sentence; empty where they can.
        """
        return ''

    def on_settings_changed(self) -> None:
        """Use ``settings``, of which some have other values."""

    def refuse_to_start(self, reason: str) -> NoReturn:
        """
        Log why the node cannot start, and wait a moment for those who listen to rosout.

        :param reason: one sentence.
        :raises StartRefused: always, with the reason.
        """
        self.get_logger().fatal(f'refused to start: {reason}')
        # The publisher of the log itself is not accessible. One that is made after it meets
        # subscribers after it, and they acknowledge what it sends after what the log has sent.
        publisher = self.create_publisher(Log, '/rosout', ROSOUT)
        end = time.monotonic() + ROSOUT_WAIT
        while time.monotonic() < end and publisher.get_subscription_count() == 0:
            time.sleep(0.05)
        publisher.publish(Log(stamp=self.get_clock().now().to_msg(), level=Log.DEBUG,
                              name=self.get_name(), msg='ends'))
        publisher.wait_for_all_acked(Duration(seconds=ROSOUT_DELIVERY))
        raise StartRefused(reason)

    @property
    def default_callback_group(self) -> BackgroundGroup:
        """Group of everything that rclpy makes by itself, and of what may wait."""
        return self.background

    def publisher(self, topic: str, stamped: bool = True, *, with_covariance: bool = False,
                  object_name: str = '') -> Publisher:
        """
        Make the publisher of a topic of the list; there is one for each.

        :param topic: its name.
        :param stamped: whether commands have a stamp.
        :param with_covariance: whether poses have a covariance.
        :param object_name: of the object, where there are several with such a topic.
        """
        entry = TOPICS[topic]
        name = f'/{topic}' if entry.is_global else topic_of_object(topic, object_name)
        if name not in self._publishers_by_topic:
            self._publishers_by_topic[name] = self.create_publisher(
                entry.message_type(stamped, with_covariance=with_covariance), name,
                entry.publish_qos)
        return self._publishers_by_topic[name]

    def subscribe(self, topic: str, callback: Callable[[Any], None], *, real_time: bool = False,
                  stamped: bool = True, with_covariance: bool = False,
                  frame: str | None = None, object_name: str = '',
                  read: Callable[[bytes], Any] | None = None) -> Subscription:
        """
        Subscribe to a topic of the list.

        :param topic: its name.
        :param callback: takes the message; where that is real-time, values with its attributes.
        :param real_time: whether the callback is run at once.
        :param stamped: whether commands have a stamp.
        :param with_covariance: whether poses have a covariance.
        :param frame: id of the frame beside which the callback takes whole messages all the same.
        :param object_name: of the object, where there are several with such a topic.
        :param read: makes the message of its bytes; None for what the list says.
        """
        entry = TOPICS[topic]
        kind = entry.message_type(stamped, with_covariance=with_covariance)
        if read is None and entry.largest_size is not None:
            read = self._limited_reader(topic, kind, entry.largest_size)
        elif read is None and real_time:
            read = message_reader(kind, frame)
        if read is not None:
            callback = self._reading(topic, callback, read)
        group = self.real_time if real_time else self.background
        is_best_effort = entry.subscribe_qos.reliability is ReliabilityPolicy.BEST_EFFORT
        subscription = self.create_subscription(
            kind, topic_of_object(topic, object_name), self.guarded(callback),
            entry.subscribe_qos, callback_group=group,
            event_callbacks=NO_EVENTS if is_best_effort else None, raw=read is not None)
        self.topic_subscriptions.append((topic, subscription))
        if real_time:
            self.real_time_subscriptions.append(subscription)
        return subscription

    def _limited_reader(self, topic: str, kind: type[Any],
                        largest_size: int) -> Callable[[bytes], Any]:
        """Make a function that reads no more than the header of a message that is too large."""
        def read(data: bytes) -> Any:
            if len(data) <= largest_size:
                return deserialize_message(data, kind)
            self.reporter.report(ERROR, f'{topic}: got a message of {len(data)} bytes, expected '
                                        f'at most {largest_size}')
            # Every one of these messages begins with its header.
            return kind(header=deserialize_message(data, Header))
        return read

    def _reading(self, topic: str, callback: Callable[[Any], None],
                 read: Callable[[bytes], Any]) -> Callable[[bytes], None]:
        """Make the callback of a raw subscription of one that takes messages."""
        def receive(data: bytes) -> None:
            try:
                message = read(data)
            except RuntimeError as error:
                self.on_unreadable(topic, f'{topic}: got a message that cannot be read: '
                                          + without_location(error))
                return
            callback(message)
        return receive

    def subscribe_newest(self, topic: str, *, with_covariance: bool = False) -> NewestMessage:
        """
        Subscribe to a topic of the list of which only the newest message matters, now and then.

        :param topic: its name.
        :param with_covariance: whether poses have a covariance.
        """
        group = BackgroundGroup()
        group.is_open = False
        subscription = self.create_subscription(
            TOPICS[topic].message_type(with_covariance=with_covariance), topic, _ignore,
            qos.NEWEST, callback_group=group)
        self.topic_subscriptions.append((topic, subscription))
        return NewestMessage(subscription)

    def publishers_of(self, topic: str) -> list[str]:
        """
        Name the nodes that publish on a topic, as far as they are known by now.

        :param topic: its name.
        :return: full names in alphabetical order; one for each publisher.
        """
        return sorted(publisher_name(info) for info in self.get_publishers_info_by_topic(topic))

    def unsubscribe_newest(self, newest: NewestMessage) -> None:
        """End a subscription that ``subscribe_newest`` made."""
        self.topic_subscriptions = [
            (topic, subscription) for topic, subscription in self.topic_subscriptions
            if subscription is not newest.subscription]
        self.destroy_subscription(newest.subscription)

    def unsubscribe_all(self) -> None:
        """End all subscriptions that ``subscribe`` made."""
        self.real_time_subscriptions = []
        for _, subscription in self.topic_subscriptions:
            self.destroy_subscription(subscription)
        self.topic_subscriptions = []

    def poll(self) -> bool:
        """Handle a message of each real-time topic that has one; tell whether there was any."""
        has_message = False
        for subscription in self.real_time_subscriptions:
            message = take_message(subscription)
            if message is not None:
                has_message = True
                subscription.callback(message)
        return has_message

    def on_unreadable(self, topic: str, reason: str) -> None:
        """
        Report a message that cannot be read.

        :param topic: its topic in the list.
        :param reason: one sentence.
        """
        self.reporter.report(ERROR, reason)

    def on_unexpected_error(self, error: Exception) -> None:
        """
        Log an error that a callback did not expect, and go on.

        :param error: that it has raised.
        """
        text = ''.join(traceback.format_exception(error))
        self.get_logger().error(f'internal error: {text[-MAX_TRACEBACK:]}',
                                throttle_duration_sec=TRACEBACK_PERIOD)

    def guarded(self, callback: Callable[..., None]) -> Callable[..., None]:
        """
        Keep the node alive whatever a callback raises.

        :param callback: of a subscription or a timer.
        :return: the same, whose errors go to ``on_unexpected_error``.
        """
        def call(*arguments: Any) -> None:
            with _ErrorGuard(self.on_unexpected_error):
                callback(*arguments)
        return call

    def serve_trigger(self, service: str, action: Callable[[], AnyAnswer],
                      group: BackgroundGroup | None = None) -> Service:
        """
        Offer a Trigger service of the list.

        :param service: its name.
        :param action: takes nothing, returns (success, sentence), or waits for it.
        :param group: of callbacks; None for the usual one, of which none is run while the action
            waits.
        """
        async def answer(_: Any, response: Any) -> Any:
            response.message = INTERNAL_ERROR
            with _ErrorGuard(self.on_unexpected_error):
                outcome = action()
                response.success, response.message = (
                    outcome if isinstance(outcome, ServiceAnswer) else await outcome)
            return response
        return self.create_service(SERVICES[service].type, service, answer, callback_group=group)

    async def wait_until(self, condition: Callable[[], bool], period: float,
                         timeout: float) -> None:
        """
        Wait until a condition holds, while callbacks of other groups run.

        :param condition: takes nothing, returns whether it holds.
        :param period: at which to look [s].
        :param timeout: longest wait [s]; both on the wall.
        """
        is_over, end = Future(), time.monotonic() + timeout

        def look() -> None:
            if condition() or time.monotonic() >= end:
                is_over.set_result(None)

        timer = self.create_timer(period, self.guarded(look),
                                  clock=Clock(clock_type=ClockType.STEADY_TIME))
        look()
        await is_over
        self.destroy_timer(timer)

    def start(self) -> None:
        """Start: called once, before the first callback."""

    def close(self) -> None:
        """Shut down: called once, while publishers are still valid."""

    def destroy_node(self) -> None:
        """End, with a log that has everything."""
        self.reporter.close()
        super().destroy_node()


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


def _ignore(_: Any) -> None:
    """Do nothing with a message that is taken elsewhere."""
