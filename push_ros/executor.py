"""Run a node until a signal comes, and end it cleanly."""

import gc
import signal
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions


def take_message(subscription):
    """
    Take the next message of a subscription, as an executor would.

    :param subscription: rclpy ``Subscription``.
    :return: the message (serialized where the subscription is raw), or None where there is none.
    """
    handle = subscription.handle
    with handle:
        taken = handle.take_message(subscription.msg_type, subscription.raw)
    return None if taken is None else taken[0]


PATIENCE, BUSY_PATIENCE = 0.02, 0.1
PATIENT_CALLBACKS = 4
BUSY = 0.02
FIRST_PAUSE, POLL_PAUSE = 1e-4, 2e-5
BAD_PARAMETER = 2


def run(make_node, arguments=None):
    """
    Make a node, run it until SIGINT or SIGTERM, close it.

    :param make_node: takes nothing, returns a ``PushNode``.
    :param arguments: command line; None for that of the process.
    :return: exit status: 0 after a signal, 2 where the node refuses a parameter.
    """
    stop = _Stop()
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    try:
        try:
            node = make_node()
        except ValueError as error:
            print(f'refused to start: {error} (give parameters with --params-file; '
                  'config/push.yaml is an example)', file=sys.stderr)
            return BAD_PARAMETER
        # What is there now stays: a full collection in the middle of a push takes 50 ms.
        gc.collect()
        gc.freeze()
        try:
            spin(node, stop)
        finally:
            node.close()
            node.destroy_node()
    finally:
        stop.release()
        rclpy.try_shutdown()
    return 0


def spin(node, stopped):
    """
    Run a node's callbacks: urgent ones at once, patient ones 10 to 50 times a second.

    While urgent messages come thick and fast they are polled for; then the executor waits.

    :param node: the ``PushNode``.
    :param stopped: takes nothing, tells whether to end.
    """
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    patient_due = busy_until = 0.0
    while not stopped():
        now = time.monotonic()
        if now >= patient_due:
            node.background.opened = True
            for _ in range(PATIENT_CALLBACKS):
                executor.spin_once(timeout_sec=0.0)
            node.background.opened = False
            busy = now < busy_until
            patient_due = time.monotonic() + (BUSY_PATIENCE if busy else PATIENCE)
        elif node.poll():
            busy_until = now + BUSY
            time.sleep(FIRST_PAUSE)
        elif now < busy_until:
            time.sleep(POLL_PAUSE)
        else:
            executor.spin_once(timeout_sec=max(0.0, min(PATIENCE, patient_due - now)))
    executor.remove_node(node)
    executor.shutdown()


class _Stop:
    """Remembers that SIGINT or SIGTERM came."""

    def __init__(self):
        self._came = False
        self._before = {number: signal.signal(number, self._remember)
                        for number in (signal.SIGINT, signal.SIGTERM)}

    def _remember(self, *_):
        self._came = True

    def __call__(self):
        return self._came

    def release(self):
        """Put the former handlers back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
