"""Nodes as processes of their own, in the private network."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
from types import FrameType
from typing import NoReturn

from push_scenario.dds.private_network import joining_script, private_environment

# How long a node may take to end after a signal, on a slow machine that is busy [s]: nothing
# interrupts a compiler in the middle of a function.
STOP_TIMEOUT = 90.0
# How long a node that is no longer needed may take to end by itself before it is killed [s].
TERMINATION_TIMEOUT = 1.0
# File among the nodes' output that lets a shell see them.
SCRIPT_NAME = 'private_network.sh'
# Lines of a node's output that an error quotes: a traceback with its cause.
TAIL_LENGTH = 12


class NodeDied(RuntimeError):
    """A node ended that should have gone on, or could not be ended."""


class NodeProcesses:
    """
    Starts nodes in the private network; at the end of the ``with`` block none is left.

    :param domain: ROS domain, as ``private_domain`` yields it.
    :param log_folder: where output and parameter files go; it exists.
    """

    def __init__(self, domain: int, log_folder: str | Path) -> None:
        self.domain = domain
        self._logs = Path(log_folder)
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._has_handler = False
        # Children find the package where this process found it, installed or not.
        root = str(Path(__file__).resolve().parents[2])
        path = [root, *filter(None, [os.environ.get('PYTHONPATH')])]
        # For matrices as small as those of the nodes, threads only wait for each other, busily.
        self._environment = {'OPENBLAS_NUM_THREADS': '1', **private_environment(domain),
                             'PYTHONUNBUFFERED': '1', 'PYTHONPATH': os.pathsep.join(path)}
        (self._logs / SCRIPT_NAME).write_text(joining_script(domain), encoding='utf-8')

    def __enter__(self) -> 'NodeProcesses':
        """Make SIGTERM end this process in order, so that the nodes are ended too."""
        is_main = threading.current_thread() is threading.main_thread()
        if is_main and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, _exit)
            self._has_handler = True
        return self

    def __exit__(self, *_: object) -> None:
        """Kill what is left of the nodes."""
        for name in self.names:
            self._kill(name)
        if self._has_handler:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)

    def start(self, name: str, module: str, parameter_file: Path) -> None:
        """
        Start a node.

        :param name: of the node, for errors.
        :param module: Python module with its main function.
        :param parameter_file: path of its ROS parameters.
        """
        command = [sys.executable, '-m', 'push_scenario.dds.child_process', str(os.getpid()),
                   module, '--ros-args', '--params-file', str(parameter_file)]
        with open(self._log(name), 'wb') as log:
            # A session of its own: Ctrl-C in the terminal does not reach the node, and one signal
            # reaches whatever it may have started.
            self._processes[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                env=self._environment, start_new_session=True)

    @property
    def names(self) -> list[str]:
        """Names of the nodes that were started and not stopped."""
        return list(self._processes)

    def pid(self, name: str) -> int:
        """
        Look up the process id of a node.

        :param name: of the node.
        """
        return self._processes[name].pid

    def check(self) -> None:
        """
        Check that all nodes are alive.

        :raises NodeDied: naming the one that is not, its exit status and the end of its output.
        """
        for name, process in self._processes.items():
            status = process.poll()
            if status is not None:
                raise NodeDied(f'{name} ended unexpectedly with {_status_text(status)}'
                               + self.log_tail(name))

    def send(self, name: str, signum: int) -> None:
        """
        Send a signal to a node.

        :param name: of the node.
        :param signum: of the signal.
        """
        self._processes[name].send_signal(signum)

    def stop(self, name: str) -> None:
        """
        Ask a node to end, and wait until it has.

        :param name: of the node.
        :raises NodeDied: where it does not end, or not with exit status 0.
        """
        process = self._processes[name]
        process.send_signal(signal.SIGINT)
        try:
            status = process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            raise NodeDied(f'{name} did not end within {STOP_TIMEOUT:g} s'
                           + self.log_tail(name)) from None
        if status:
            raise NodeDied(f'{name} ended with {_status_text(status)}' + self.log_tail(name))
        del self._processes[name]

    def stop_all(self) -> None:
        """
        Ask all nodes to end, in the order in which they were started.

        :raises NodeDied: where one does not end well.
        """
        for name in self.names:
            self.stop(name)

    def log_tail(self, name: str) -> str:
        """
        Quote the end of a node's output.

        :param name: of the node.
        """
        text = self._log(name).read_text(encoding='utf-8', errors='replace')
        lines = text.rstrip().splitlines()[-TAIL_LENGTH:]
        return '; its last lines:\n  ' + '\n  '.join(lines) if lines else '; it printed nothing'

    def _log(self, name: str) -> Path:
        return self._logs / f'{name}.log'

    def _kill(self, name: str) -> None:
        process = self._processes.pop(name)
        for signum, timeout in ((signal.SIGTERM, TERMINATION_TIMEOUT),
                                (signal.SIGKILL, STOP_TIMEOUT)):
            if process.poll() is not None:
                break
            os.killpg(process.pid, signum)
            try:
                process.wait(timeout)
            except subprocess.TimeoutExpired:
                continue


def _exit(signum: int, _: FrameType | None) -> NoReturn:
    sys.exit(128 + signum)


def _status_text(status: int) -> str:
    if status < 0:
        return f'signal {signal.Signals(-status).name}'
    return f'exit status {status}'
