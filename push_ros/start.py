"""
Commands that start the nodes: signals first, then the imports, which take seconds.

Until a node is made there is nothing to end in order, so that Ctrl-C ends the process at once.
"""

import importlib
import os
import signal
import sys
from types import FrameType

NODES = {'controller': 'push_control.controller_node', 'planner': 'push_planner.planner_node',
         'sim': 'push_sim_node.sim_node', 'tf_tracker': 'push_tracker.tracker_node',
         'view': 'push_view.view_node'}


def controller() -> int:
    """Run the controller; return its exit status."""
    return start('controller')


def planner() -> int:
    """Run the planner; return its exit status."""
    return start('planner')


def sim() -> int:
    """Run the simulator; return its exit status."""
    return start('sim')


def tf_tracker() -> int:
    """Run the tracker; return its exit status."""
    return start('tf_tracker')


def view() -> int:
    """Run the page; return its exit status."""
    return start('view')


def start(name: str, arguments: list[str] | None = None) -> int:
    """
    Run a node.

    :param name: of ``NODES``.
    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave)
    return importlib.import_module(NODES[name]).main(arguments)


def _leave(number: int, frame: FrameType | None) -> None:
    os._exit(0)


if __name__ == '__main__':
    sys.exit(start(sys.argv[1], sys.argv[1:]))
