"""
Commands of the package: signals first, then the imports, which take seconds.

Until a node is made, or the main function of a tool has begun, there is nothing to end in order,
so that Ctrl-C ends the process at once, and quietly.
"""

import gc
import importlib
from importlib import util
import os
import signal
import sys
from types import FrameType, ModuleType

# Module of each node and its class, or what makes it; and module of each other command, which has
# a function main.
NODES = {'controller': ('push_control.controller_node', 'ControllerNode'),
         'planner': ('push_planner.planner_node', 'PlannerNode'),
         'mocap_odometry': ('push_tracker.mocap_node', 'MocapNode'),
         'mujoco_sim': ('push_mujoco.mujoco_node', 'make_node'),
         'sim': ('push_sim_node.sim_node', 'SimNode'),
         'tag_detector': ('push_tags.tag_detector_node', 'TagDetectorNode'),
         'tf_tracker': ('push_tracker.tracker_node', 'TrackerNode'),
         'tidy': ('push_tidy.tidy_node', 'TidyNode')}
# A node with options of its own, which its function main reads.
VIEW = 'push_view.view_node'
PUSH = 'push_ros.command_line'
TOOLS = {'calibrate': 'push_scenario.calibration.cli',
         'identify': 'push_scenario.recordings.cli', 'play': 'push_view.cli',
         'replay': 'push_scenario.cli'}
# Exit statuses of a shell for a tool that Ctrl-C ends, and for one whose reader has gone.
INTERRUPTED = 130
BROKEN_PIPE = 141
MISUSE = 2


def controller() -> int:
    """Run the controller; return its exit status."""
    return start('controller')


def planner() -> int:
    """Run the planner; return its exit status."""
    return start('planner')


def sim() -> int:
    """Run the simulator; return its exit status."""
    return start('sim')


def mujoco_sim() -> int:
    """Run the simulator in MuJoCo; return its exit status."""
    return start('mujoco_sim')


def mocap_odometry() -> int:
    """Run the odometry of motion capture; return its exit status."""
    return start('mocap_odometry')


def tf_tracker() -> int:
    """Run the tracker; return its exit status."""
    return start('tf_tracker')


def tag_detector() -> int:
    """Run the detector of tags; return its exit status."""
    return start('tag_detector')


def tidy() -> int:
    """Run the node for several objects; return its exit status."""
    return start('tidy')


def view(words: list[str] | None = None) -> int:
    """
    Run the page.

    :param words: command line; None for that of the process.
    :return: exit status.
    """
    _leave_on_signals()
    try:
        module = import_node_module(VIEW)
    except ModuleNotFoundError:
        if util.find_spec('rclpy') is not None:
            raise
        print('push view: no module rclpy: source a ROS installation', file=sys.stderr)
        return MISUSE
    return module.main(sys.argv[1:] if words is None else words)


def push() -> int:
    """Run a subcommand of ``push``; return its exit status."""
    words = sys.argv[1:]
    return view(words[1:]) if words[:1] == ['view'] else start_tool(PUSH)


def calibrate() -> int:
    """Calibrate a base; return the exit status."""
    return start_tool(TOOLS['calibrate'])


def identify() -> int:
    """Identify friction from recorded pushes; return the exit status."""
    return start_tool(TOOLS['identify'])


def play() -> int:
    """Serve the page of a simulation; return the exit status."""
    return start_tool(TOOLS['play'])


def replay() -> int:
    """Replay a scenario; return the exit status."""
    return start_tool(TOOLS['replay'])


def start(name: str, arguments: list[str] | None = None) -> int:
    """
    Run a node.

    :param name: of ``NODES``.
    :param arguments: command line behind the name of the program; None for that of the process.
    :return: exit status.
    """
    _leave_on_signals()
    module, node = NODES[name]
    make_node = getattr(import_node_module(module), node)
    return importlib.import_module('push_ros.executor').run(make_node, arguments)


def import_node_module(name: str) -> ModuleType:
    """
    Import the module of a node.

    :param name: of the module.
    """
    # Read when numpy is imported. The matrices are small: threads of the linear algebra would only
    # wait for each other, busily.
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
    # Nothing of what imports make is garbage: looking for it takes a tenth of their time.
    gc.disable()
    try:
        return importlib.import_module(name)
    finally:
        gc.enable()


def start_tool(module: str) -> int:
    """
    Run a command that is no node; one whose output nobody reads any more ends quietly.

    :param module: with a function ``main`` of the words behind the command's name.
    :return: exit status.
    """
    signal.signal(signal.SIGINT, _leave_tool)
    main = importlib.import_module(module).main
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        status = main(sys.argv[1:])
        sys.stdout.flush()
    except KeyboardInterrupt:
        # Before the tool has begun with what it would end in order, as while it imports that.
        return INTERRUPTED
    except BrokenPipeError:
        # What is left in the buffer goes nowhere; else its last flush would fail again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    finally:
        signal.signal(signal.SIGINT, _leave_tool)
    return status


def _leave_on_signals() -> None:
    for signum in (signal.SIGINT, signal.SIGTERM):
        signal.signal(signum, _leave)


def _leave(signum: int, frame: FrameType | None) -> None:
    os._exit(0)


def _leave_tool(signum: int, frame: FrameType | None) -> None:
    os._exit(INTERRUPTED)


if __name__ == '__main__':
    sys.exit(start(sys.argv[1], sys.argv[2:]))
