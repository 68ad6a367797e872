"""
Run a node until a signal comes, and end it cleanly.

rclpy's executor builds its wait set anew at every turn, which takes 0.2 ms for the two real-time
topics of the controller, and 0.5 ms with all its services, plans and timers. In lockstep there are
some thousand messages a second, on a robot a hundred. So a node with real-time topics waits for
these alone, with a wait set that is kept, and lets its background group join at intervals. A node
without such topics waits for everything:

    spin:  no real-time topics    wait for anything, or to look whether a signal has come
           background due         open the background group, and turn the executor until it is idle
           a real-time message    handle it
           else                   wait for the next one, or until the background is due

rclpy 7.1.6 has an experimental events executor, which needs no wait set; not every Jazzy has it.
It was tried with the entities of the controller: idle it took 10 % of a core where this takes 1 %,
it answered none of 86 messages, and it did not end on SIGINT.
"""

import abc
import contextlib
import gc
import inspect
import math
import re
import signal
import sys
import time
from types import FrameType
from typing import Any, Callable, Sequence

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import ShutdownException, SingleThreadedExecutor, TimeoutException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from rclpy.task import Future
from rclpy.utilities import remove_ros_args, timeout_sec_to_nsec, try_shutdown

# Longest wait of background callbacks [s]; chosen: nobody notices it in a service or a plan.
BACKGROUND_PERIOD = 0.05
# Turns of the executor at one opening, each of which runs at most one callback; chosen.
BACKGROUND_CALLBACKS = 8
# Longest wait of a node without real-time topics [s]: signals do not end it; chosen.
SIGNAL_PERIOD = 0.1
# Time that a callback may still take after a signal before it is interrupted [s]; chosen: launch
# sends the next signal after 5 s, and kills after 15 s.
ENDING_TIME = 2.0
# Time after a signal from which on another one interrupts at once [s]; chosen: launch and a
# terminal send one each for the same Ctrl-C.
INTERRUPT_DELAY = 0.5
# Time after which an interrupt that could not be passed on is repeated [s]; chosen.
REPEAT_TIME = 0.01
# Signals that ask a node to end. They do so also where its parent ignores them, as a shell without
# job control ignores SIGINT for what it starts in the background.
ASKING_SIGNALS = (signal.SIGINT, signal.SIGTERM)
# Signals that end a node: all that would end its process, and can be noticed. Others than those
# that ask are ignored where the parent ignores them, as nohup does.
ENDING_SIGNALS = (*ASKING_SIGNALS, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2)
# Words that ask for help, and what is said before the contract of a node, in its docstring.
HELP = frozenset(('-h', '--help'))
USAGE = ('usage: --ros-args [--params-file FILE] [-p PARAMETER:=VALUE] [-r TOPIC:=OTHER]; '
         'all parameters and topics: docs/reference')
# Exit status where a parameter is refused.
BAD_PARAMETER = 2
# Exit status where a node cannot write at its end what it was to leave.
UNWRITTEN = 1
# What rclpy raises where rcl cannot do something, as types of a topic that do not fit.
RCLError: type[Exception] = rclpy_implementation.RCLError
# What rcl adds to its errors, which helps nobody who uses it.
SOURCE_LOCATION = re.compile(r', at [^,\s]+:\d+')


class StartRefused(ValueError):
    """A node that cannot start, and has logged why."""


class _Interrupt(KeyboardInterrupt):
    """
    Exception that ends a callback after a signal.

    A plain ``KeyboardInterrupt`` that passes through ``exec``, as libraries use it, is remembered
    by Python although it is caught: a module that was started with -m would end by SIGINT. Python
    compares the type for that, so that one of our own is not remembered.
    """


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
    """
    A node with a group of background callbacks, whose real-time topics are taken by ``poll``.

    ``real_time_subscriptions``: those of these topics.
    """

    background: BackgroundGroup
    real_time_subscriptions: list[Subscription]

    @property
    def wake_time(self) -> float:
        """Time on the wall at which to poll even if nothing has come, of ``time.monotonic``."""
        return math.inf

    @abc.abstractmethod
    def start(self) -> None:
        """Start: called once, before the first callback."""

    @abc.abstractmethod
    def poll(self) -> bool:
        """Handle a message of each real-time topic that has one; tell whether there was any."""

    @abc.abstractmethod
    def close(self) -> None:
        """
        Shut down: called once, while publishers are still valid.

        :raises OSError: naming the file that could not be written.
        """


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


class MessageWaiter:
    """
    Waits for messages of a few subscriptions, and for nothing else.

    An executor gathers everything that a node has each time before it waits, which takes longer
    than to answer some of its messages.
    """

    def __init__(self, context: Context) -> None:
        """
        Start without a wait set.

        :param context: of the subscriptions.
        """
        self._context = context
        self._size = 0

    def wait(self, subscriptions: Sequence[Subscription], timeout: float) -> None:
        """
        Wait until a message can be taken.

        :param subscriptions: rclpy ``Subscription`` objects.
        :param timeout: longest wait [s].
        """
        if len(subscriptions) != self._size:
            self._size = len(subscriptions)
            self._wait_set = rclpy_implementation.WaitSet(self._size, 0, 0, 0, 0, 0,
                                                          self._context.handle)
        self._wait_set.clear_entities()
        for subscription in subscriptions:
            self._wait_set.add_subscription(subscription.handle)
        self._wait_set.wait(timeout_sec_to_nsec(max(0.0, timeout)))


def await_answer(client: Client, request: Future, timeout: float) -> None:
    """
    Wait until a service has answered, where no executor runs any more, or may not run now.

    :param client: rclpy ``Client``.
    :param request: what its ``call_async`` has returned; it is done as soon as the answer is here.
    :param timeout: longest wait [s].
    """
    end = time.monotonic() + timeout
    wait_set = rclpy_implementation.WaitSet(0, 0, 0, 1, 0, 0, client.context.handle)
    service: Any = client.srv_type
    while not request.done() and (remaining := end - time.monotonic()) > 0.0:
        wait_set.clear_entities()
        wait_set.add_client(client.handle)
        wait_set.wait(timeout_sec_to_nsec(remaining))
        with client.handle:
            header, answer = client.handle.take_response(service.Response)
        if header is None:
            continue
        try:
            answered = client.get_pending_request(header.request_id.sequence_number)
        except KeyError:
            # Of a request that was given up.
            continue
        answered.set_result(answer)


def run(make_node: Callable[[], PolledNode], arguments: Sequence[str] | None = None) -> int:
    """
    Make a node, run it until one of ``ENDING_SIGNALS`` comes, close it.

    :param make_node: takes nothing, returns a ``push_ros.node.PushNode``.
    :param arguments: command line behind the name of the program; None for that of the process.
    :return: exit status: 0 after a signal or help, 1 where a file could not be written at the
        end, 2 where the node refuses to start, as for a parameter, or a parameter file or the
        command line cannot be read.
    """
    command_line = sys.argv[1:] if arguments is None else list(arguments)
    stop = _StopSignal()
    try:
        try:
            rclpy.init(args=command_line, signal_handler_options=SignalHandlerOptions.NO)
            foreign = remove_ros_args(command_line)
        except rclpy_implementation.UnknownROSArgsError as error:
            return _refuse(f'got the unknown ROS arguments {error}')
        except RuntimeError as error:
            # A command line or a parameter file that cannot be read.
            return _refuse(without_location(error))
        if not HELP.isdisjoint(foreign):
            print(f'{USAGE}\n\n{inspect.getdoc(make_node)}')
            return 0
        if foreign:
            return _refuse(f'got the arguments {" ".join(foreign)}, expected none but those of '
                           'ROS, as --ros-args --params-file FILE')
        return _run(make_node, stop)
    except KeyboardInterrupt:
        return 0
    finally:
        stop.is_starting = False
        stop.disarm()
        try_shutdown()
        stop.release()


def _run(make_node: Callable[[], PolledNode], stop: '_StopSignal') -> int:
    try:
        node = make_node()
        node.start()
    except StartRefused:
        return BAD_PARAMETER
    except (ValueError, RCLError) as error:
        # Of rclpy, as it makes the node: a domain that is none, a parameter without a type.
        return _refuse(without_location(error))
    # Nothing of what exists now will be collected: a full collection takes 50 ms.
    gc.collect()
    gc.freeze()
    stop.is_starting = False
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    has_finished = False
    status = 0
    try:
        spin(node, executor, stop)
        has_finished = True
    finally:
        stop.disarm()
        try:
            node.close()
        except OSError as error:
            node.get_logger().fatal(f'could not write what it leaves: {error}')
            status = UNWRITTEN
        if has_finished:
            # One of these may take long as well.
            with contextlib.suppress(KeyboardInterrupt):
                stop.arm()
                _run_last_callbacks(node, executor)
            stop.disarm()
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()
    return status


def _refuse(reason: str) -> int:
    """Say why there is no node, which could log it; return the exit status."""
    print(f'refused to start: {reason}', file=sys.stderr)
    return BAD_PARAMETER


def without_location(error: Exception) -> str:
    """
    Write an error without its location in the source of rcl.

    :param error: of rclpy, or any other.
    """
    return SOURCE_LOCATION.sub('', str(error))


def spin(node: PolledNode, executor: SingleThreadedExecutor,
         is_stopped: Callable[[], bool]) -> None:
    """
    Run a node's callbacks: real-time ones at once, the others 20 times a second.

    :param node: the ``PushNode``.
    :param executor: that the node was added to.
    :param is_stopped: takes nothing, tells whether to end.
    """
    background_due = 0.0
    waiter = MessageWaiter(node.context)
    while not is_stopped():
        now = time.monotonic()
        subscriptions = node.real_time_subscriptions
        if not subscriptions:
            node.background.is_open = True
            executor.spin_once(timeout_sec=SIGNAL_PERIOD)
        elif now >= background_due:
            _run_background(node, executor)
            background_due = time.monotonic() + BACKGROUND_PERIOD
        elif not node.poll():
            waiter.wait(subscriptions, min(background_due, node.wake_time) - now)


def _run_background(node: PolledNode, executor: SingleThreadedExecutor) -> None:
    node.background.is_open = True
    with contextlib.suppress(TimeoutException, ShutdownException):
        for _ in range(BACKGROUND_CALLBACKS):
            task, entity, _ = executor.wait_for_ready_callbacks(0.0)
            task()
            task.result()
            # What an action has left to be done later belongs to no group.
            if entity is not None and entity.callback_group is not node.background:
                break
    node.background.is_open = False


def _run_last_callbacks(node: PolledNode, executor: SingleThreadedExecutor) -> None:
    """Send what the end of a node has left to be sent, as results of goals."""
    node.background.is_open = True
    for _ in range(BACKGROUND_CALLBACKS):
        executor.spin_once(timeout_sec=0.0)


class _StopSignal:
    """
    Remembers that one of ``ENDING_SIGNALS`` came.

    A flag that ``spin`` reads would do, if every callback returned soon. Four things make more of
    it, each with a test in test/ros/test_executor.py. Making a node may take minutes: there the
    signal interrupts at once. A callback may plan for long: an alarm interrupts it after
    ``ENDING_TIME``, and a second Ctrl-C at once, but not the second signal that launch and a
    terminal send for one Ctrl-C. An interrupt within a callback of a C library, as the compiler
    has them, is reported and dropped by Python: the hook hides that report and sets the alarm
    again. At its end a node stops the robot, which nothing may interrupt: ``disarm`` comes before.
    """

    def __init__(self) -> None:
        self.is_starting = True
        self._has_come = False
        self._came_at = 0.0
        self._is_armed = False
        self._previous_handlers = {signum: signal.signal(signum, self._remember)
                                   for signum in ENDING_SIGNALS
                                   if signum in ASKING_SIGNALS
                                   or signal.getsignal(signum) is not signal.SIG_IGN}
        self._previous_handlers[signal.SIGALRM] = signal.signal(signal.SIGALRM, self._interrupt)
        self._previous_hook, sys.unraisablehook = sys.unraisablehook, self._repeat

    def _remember(self, signum: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if not self._has_come:
            self._came_at = now
            self.arm()
        elif now - self._came_at > INTERRUPT_DELAY:
            self._interrupt(signum, frame)
        self._has_come = True
        if self.is_starting:
            self.is_starting = False
            raise _Interrupt

    def _interrupt(self, signum: int, frame: FrameType | None) -> None:
        if self._is_armed:
            raise _Interrupt

    def _repeat(self, dropped: Any) -> None:
        if not issubclass(dropped.exc_type, KeyboardInterrupt):
            self._previous_hook(dropped)
        elif self._is_armed:
            signal.setitimer(signal.ITIMER_REAL, REPEAT_TIME)

    def arm(self) -> None:
        """Interrupt what is still under way after a while."""
        self._is_armed = True
        signal.setitimer(signal.ITIMER_REAL, ENDING_TIME)

    def disarm(self) -> None:
        """Interrupt nothing any more: what is left to do is the end."""
        self._is_armed = False
        signal.setitimer(signal.ITIMER_REAL, 0.0)

    def __call__(self) -> bool:
        return self._has_come

    def release(self) -> None:
        """Put the previous handlers back."""
        for signum, handler in self._previous_handlers.items():
            signal.signal(signum, handler)
        sys.unraisablehook = self._previous_hook
