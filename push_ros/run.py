"""Run a node until a signal comes, and end it cleanly."""

import signal
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

PATIENCE = 0.02
PATIENT_CALLBACKS = 4
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
            print(f'refused to start: {error}', file=sys.stderr)
            return BAD_PARAMETER
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
    Run a node's callbacks: urgent ones at once, patient ones about 50 times a second.

    :param node: the ``PushNode``.
    :param stopped: takes nothing, tells whether to end.
    """
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    patient, due = node.patient, 0.0
    while not stopped():
        now = time.monotonic()
        if now >= due:
            patient.opened = True
            for _ in range(PATIENT_CALLBACKS):
                executor.spin_once(timeout_sec=0.0)
            patient.opened = False
            due = time.monotonic() + PATIENCE
        executor.spin_once(timeout_sec=max(0.0, due - time.monotonic()))
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
