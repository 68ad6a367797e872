"""Nodes as processes of their own: started, watched, and ended together."""

import contextlib
import fcntl
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
import threading

DOMAINS = range(1, 102)


@contextlib.contextmanager
def private_domain():
    """
    Take a ROS domain that no other replay on this machine uses, until the block ends.

    :return: context manager that yields the number of the domain.
    :raises RuntimeError: where all are taken.
    """
    folder = Path(tempfile.gettempdir()) / f'push_control_domains_{os.getuid()}'
    folder.mkdir(mode=0o700, exist_ok=True)
    # Begin at another one in each process, so that domains just left can fall silent.
    for i in range(len(DOMAINS)):
        domain = DOMAINS[(os.getpid() + i) % len(DOMAINS)]
        with open(folder / str(domain), 'w', encoding='ascii') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    raise RuntimeError(f'no ROS domain is free: all of {DOMAINS[0]} to {DOMAINS[-1]} are locked '
                       f'in {folder}')


STOP_TIMEOUT = 5.0
LAST_LINES = 12


class NodeDied(RuntimeError):
    """A node ended that should have gone on, or could not be ended."""


class NodeProcesses:
    """
    Starts nodes; at the end of the ``with`` block none is left.

    :param domain: ROS domain.
    :param log_folder: where output and parameter files go.
    """

    def __init__(self, domain, log_folder):
        self.domain, self._logs = domain, Path(log_folder)
        self._processes, self._has_handler = {}, False
        self._environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain),
                             'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                             'PYTHONUNBUFFERED': '1'}
        # Children find the package where this process found it, installed or not.
        root = str(Path(__file__).resolve().parents[2])
        path = [root, *filter(None, [os.environ.get('PYTHONPATH')])]
        self._environment['PYTHONPATH'] = os.pathsep.join(path)

    def __enter__(self):
        in_main = threading.current_thread() is threading.main_thread()
        if in_main and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            # By default it would end this process at once, and leave the nodes behind.
            signal.signal(signal.SIGTERM, _leave)
            self._has_handler = True
        return self

    def __exit__(self, *_):
        for name in self.names:
            self._kill(name)
        if self._has_handler:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)

    def start(self, name, module, parameter_file):
        """
        Start a node.

        :param name: what errors call it.
        :param module: Python module with its main function.
        :param parameter_file: path of its ROS parameters.
        """
        command = [sys.executable, '-m', module, '--ros-args', '--params-file',
                   str(parameter_file)]
        with open(self._log(name), 'wb') as log:
            # A session of its own: one signal reaches whatever it may have started.
            self._processes[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                env=self._environment, start_new_session=True)

    @property
    def names(self):
        """Names of the nodes that were started and not stopped."""
        return list(self._processes)

    def pid(self, name):
        """
        Look up the process id of a node.

        :param name: of the node.
        """
        return self._processes[name].pid

    def check(self):
        """
        See that all nodes are alive.

        :raises NodeDied: naming the one that is not, its exit status and last words.
        """
        for name, process in self._processes.items():
            status = process.poll()
            if status is not None:
                raise NodeDied(f'{name} ended unexpectedly with {_status_text(status)}'
                               + self.log_tail(name))

    def send(self, name, number):
        """
        Send a signal to a node.

        :param name: of the node.
        :param number: of the signal.
        """
        self._processes[name].send_signal(number)

    def stop(self, name):
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

    def stop_all(self):
        """
        Ask all nodes to end, the first started first.

        :raises NodeDied: where one does not end well.
        """
        for name in self.names:
            self.stop(name)

    def log_tail(self, name):
        """
        Quote the end of a node's output.

        :param name: of the node.
        """
        text = self._log(name).read_text(encoding='utf-8', errors='replace')
        lines = text.rstrip().splitlines()[-LAST_LINES:]
        return '; its last words:\n  ' + '\n  '.join(lines) if lines else '; it said nothing'

    def _log(self, name):
        return self._logs / f'{name}.log'

    def _kill(self, name):
        process = self._processes.pop(name)
        for number, patience in ((signal.SIGTERM, 1.0), (signal.SIGKILL, STOP_TIMEOUT)):
            if process.poll() is not None:
                break
            os.killpg(process.pid, number)
            try:
                process.wait(patience)
            except subprocess.TimeoutExpired:
                continue


def _leave(number, _):
    sys.exit(128 + number)


def _status_text(status):
    if status < 0:
        return f'signal {signal.Signals(-status).name}'
    return f'exit status {status}'
