"""Other publishers of commands: teleoperation, navigation, or another controller."""

from collections import deque
import math
import time
from typing import Any

from push_model.signals import Twist
from push_ros.conversions.primitives import nanoseconds
from push_ros.executor import BackgroundGroup, take_message
from push_ros.node import PushNode
from push_ros.topics import TOPICS
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

TOPIC = 'cmd_vel'
# Period at which other publishers are counted, and looked for where there are others [s]; chosen:
# counting takes a thirtieth of the time of looking, and nobody has met the base much sooner.
PERIOD = 0.2
LOOKING_PERIOD = 1.0
# Number of own commands that are known again when they come back; chosen: some seconds of them.
OWN_COMMANDS = 200
# Whatever they offer; as many as come between two of the node's own odometry messages.
LATEST_COMMANDS = QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT)
# Time for which a command of somebody else counts [s]; chosen: longer than the period of any.
MEMORY = 0.5


class OtherCommanders:
    """
    Listens to ``cmd_vel`` where it has other publishers; where it has none, that costs nothing.

    A publisher may stay visible for a while after its process was killed, or be silent as long as
    nobody touches a joystick: only what it commands counts. Who comes later gives way: while
    another one commands the base, if only to stand, this node does not begin to.
    """

    def __init__(self, node: PushNode, *, stamped: bool) -> None:
        """
        Look for other publishers.

        :param stamped: whether commands have a stamp.
        """
        self._node = node
        self._stamped = stamped
        self._names: list[str] = []
        # How many publishers there were at the last look, and when that was [s].
        self._count = 0
        self._looked_at = -math.inf
        self._subscription: Subscription | None = None
        # Keys of own commands, and when they were sent [s].
        self._own: deque[tuple[tuple[Any, ...], float]] = deque(maxlen=OWN_COMMANDS)
        # When one of them has commanded anything, and a motion, last [s].
        self._commanded_at = self._driven_at = -MEMORY
        self._timer = node.create_timer(PERIOD, node.guarded(self._look_now_and_then),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME),
                                        callback_group=node.background)

    def destroy(self) -> None:
        """Look no more."""
        self._node.destroy_timer(self._timer)
        self._listen(False)

    def add_own(self, command: Twist, stamp: int) -> None:
        """
        Note a command of this node.

        :param command: ``Twist`` as published.
        :param stamp: of it [ns].
        """
        if self._subscription is not None:
            self._own.append(((stamp if self._stamped else 0, *command), time.monotonic()))

    @property
    def names(self) -> str:
        """Names of the nodes that publish on the topic, too; empty where there are none."""
        return ', '.join(self._names)

    @property
    def is_driving(self) -> bool:
        """Tell whether one of them has commanded a motion a moment ago."""
        return time.monotonic() - self._driven_at < MEMORY

    @property
    def is_commanding(self) -> bool:
        """Tell whether one of them has commanded the base a moment ago, if only to stand."""
        return time.monotonic() - self._commanded_at < MEMORY

    def take(self) -> None:
        """Take the commands that have come; called at each measurement, as they count from now."""
        own = {key for key, _ in self._own}
        while (self._subscription is not None
               and (message := take_message(self._subscription)) is not None):
            if self._key(message) in own:
                continue
            self._commanded_at = time.monotonic()
            twist = message.twist if self._stamped else message
            if any((twist.linear.x, twist.linear.y, twist.angular.z)):
                self._driven_at = self._commanded_at
        # Without a stamp a command of somebody else is like one of long ago.
        while self._own and time.monotonic() - self._own[0][1] > MEMORY:
            self._own.popleft()

    def _look_now_and_then(self) -> None:
        """Look for other publishers where their number has changed, or may have to be named."""
        count, now = self._node.count_publishers(TOPIC), time.monotonic()
        if count != self._count or self._names and now - self._looked_at >= LOOKING_PERIOD:
            self._count, self._looked_at = count, now
            self._look()

    def _look(self) -> None:
        names = self._node.publishers_of(TOPIC)
        own = self._node.get_fully_qualified_name()
        if own in names:
            # Once: a second controller may have the same name.
            names.remove(own)
        if names and names != self._names:
            self._node.get_logger().warning(
                f'{TOPIC}: is also published by {", ".join(names)}; the robot is stopped '
                'where that drives the base while an object is pushed, and no push begins while '
                'that commands it')
        self._names = names
        self._listen(bool(names))

    def _listen(self, is_needed: bool) -> None:
        if is_needed and self._subscription is None:
            # Taken where it is asked for: no executor waits for it.
            group = BackgroundGroup()
            group.is_open = False
            self._subscription = self._node.create_subscription(
                TOPICS[TOPIC].message_type(self._stamped), TOPIC, _ignore, LATEST_COMMANDS,
                callback_group=group)
        elif not is_needed and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
            self._own.clear()

    def _key(self, message: Any) -> tuple[Any, ...]:
        twist, stamp = message, 0
        if self._stamped:
            twist, stamp = message.twist, nanoseconds(message.header.stamp)
        return stamp, twist.linear.x, twist.linear.y, twist.angular.z


def _ignore(_: Any) -> None:
    """Leave a message to ``take_message``."""
