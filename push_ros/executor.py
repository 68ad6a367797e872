"""
Run a node until a signal comes, and end it cleanly.

In lockstep, simulator and controller exchange some thousand messages a second. Measured for the
controller's node (median on a busy core): polling its two real-time topics takes 5 us, a turn of
the executor 0.2 ms without and 0.5 ms with the background group. So real-time subscriptions are
polled while messages keep coming:

    spin:  every BACKGROUND_PERIOD (BUSY_BACKGROUND_PERIOD while busy)
             open the background group (services, plans, maps, clock) and turn the executor
           else, if a real-time message was there   handle it; busy for BUSY_TIME
           else, while busy                         poll again after POLL_PAUSE
           else                                     wait in the executor for the next message
                                                    or the next background period
"""

import abc
import gc
import math
import signal
import sys
import time
from types import FrameType
from typing import Any, Callable, Sequence

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from rclpy.utilities import try_shutdown

# Longest wait of background callbacks [s]; chosen: nobody notices it in a service or a plan.
BACKGROUND_PERIOD = 0.02
# The same while real-time messages come [s]: its turns of 0.5 ms each take 2 % of it.
BUSY_BACKGROUND_PERIOD = 0.1
# Turns of the executor at one opening, each of which runs at most one callback; chosen.
BACKGROUND_CALLBACKS = 4
# Time after a real-time message during which the next one is polled for [s]: the period of
# odometry at 50 Hz.
BUSY_TIME = 0.02
# Pauses after a message was handled and between polls [s]: the shorter one takes 0.1 ms with the
# resolution of the system's timers, which is what a message waits at most.
FIRST_PAUSE = 1e-4
POLL_PAUSE = 2e-5
# Exit status where a parameter is refused.
BAD_PARAMETER = 2


class BackgroundGroup(MutuallyExclusiveCallbackGroup):
    """
    Callbacks that can wait a little: services, plans, the clock.

    Every entity that an executor waits for costs time at every message, so that ``spin`` opens
    this group only now and then.
    """

    is_open = True

    def can_execute(self, entity: Any) -> bool:
        """
        Tell whether a callback may be run now.

        :param entity: the subscription, timer or service.
        """
        return self.is_open and super().can_execute(entity)


class PolledNode(Node, abc.ABC):
    """A node with a group of background callbacks, whose real-time topics can be polled."""

    background: BackgroundGroup

    @property
    def wake_time(self) -> float:
        """Time on the wall at which to poll even if nothing has come, of ``time.monotonic``."""
        return math.inf

    @abc.abstractmethod
    def poll(self) -> bool:
        """Handle a message of each real-time topic that has one; tell whether there was any."""

    @abc.abstractmethod
    def close(self) -> None:
        """Shut down: called once, while publishers are still valid."""


def take_message(subscription: Subscription) -> Any:
    """
    Take the next message of a subscription, as an executor would.

    :param subscription: rclpy ``Subscription``.
    :return: the message (serialized where the subscription is raw), or None where there is none.
    """
    handle = subscription.handle
    with handle:
        taken = handle.take_message(subscription.msg_type, subscription.raw)
    return None if taken is None else taken[0]


def run(make_node: Callable[[], PolledNode], arguments: Sequence[str] | None = None) -> int:
    """
    Make a node, run it until SIGINT or SIGTERM, close it.

    :param make_node: takes nothing, returns a ``push_ros.node.PushNode``.
    :param arguments: command line; None for that of the process.
    :return: exit status: 0 after a signal, 2 where the node refuses a parameter.
    """
    stop = _StopSignal()
    rclpy.init(args=None if arguments is None else list(arguments),
               signal_handler_options=SignalHandlerOptions.NO)
    try:
        try:
            node = make_node()
        except ValueError as error:
            print(f'refused to start: {error} (give parameters with --params-file; '
                  'config/push.yaml is an example)', file=sys.stderr)
            return BAD_PARAMETER
        # Nothing of what exists now will be collected: a full collection takes 50 ms.
        gc.collect()
        gc.freeze()
        try:
            spin(node, stop)
        finally:
            node.close()
            node.destroy_node()
    finally:
        stop.release()
        try_shutdown()
    return 0


def spin(node: PolledNode, is_stopped: Callable[[], bool]) -> None:
    """
    Run a node's callbacks: real-time ones at once, the others 10 to 50 times a second.

    :param node: the ``PushNode``.
    :param is_stopped: takes nothing, tells whether to end.
    """
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    background_due = 0.0
    busy_until = 0.0
    while not is_stopped():
        now = time.monotonic()
        if now >= background_due:
            _run_background(node, executor)
            period = BUSY_BACKGROUND_PERIOD if now < busy_until else BACKGROUND_PERIOD
            background_due = time.monotonic() + period
        elif node.poll():
            busy_until = now + BUSY_TIME
            time.sleep(FIRST_PAUSE)
        elif now < busy_until:
            time.sleep(POLL_PAUSE)
        else:
            until = min(background_due, node.wake_time)
            executor.spin_once(timeout_sec=max(0.0, until - now))
    executor.remove_node(node)
    executor.shutdown()


def _run_background(node: PolledNode, executor: SingleThreadedExecutor) -> None:
    node.background.is_open = True
    for _ in range(BACKGROUND_CALLBACKS):
        executor.spin_once(timeout_sec=0.0)
    node.background.is_open = False


class _StopSignal:
    """Remembers that SIGINT or SIGTERM came."""

    def __init__(self) -> None:
        self._has_come = False
        self._former_handlers = {number: signal.signal(number, self._remember)
                                 for number in (signal.SIGINT, signal.SIGTERM)}

    def _remember(self, number: int, frame: FrameType | None) -> None:
        self._has_come = True

    def __call__(self) -> bool:
        return self._has_come

    def release(self) -> None:
        """Put the former handlers back."""
        for number, handler in self._former_handlers.items():
            signal.signal(number, handler)
