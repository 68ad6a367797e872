"""
Cases of commands: parameter files of any content, spoilt caches, files that may not grow, signals.

Each command runs in processes of its own. What it leaves running is found by a mark in the
environment that all its processes inherit.
"""

from collections.abc import Callable, Mapping, Sequence
import functools
import os
from pathlib import Path
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
from typing import NamedTuple
import uuid

from benchmarks.faults.observation import Observation, traceback_in
import numpy as np
from push_dynamics.compiled import cache_directory
from push_ros.topics import CONTROLLER
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain, private_environment
from push_scenario.dds.replay import MODULES
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.start import place_robot

SCENARIO = 'task_tap'
PUSH = 'straight_push'
# Longest time of a command, and what its processes may take to end after it [s]; chosen: far above
# what they take on a busy machine.
TIMEOUT, ENDING_TIME = 300.0, 20.0
# How often a command is looked at [s].
PERIOD = 0.05
# Exit statuses: of a refusal, and of what Ctrl-C and SIGTERM have ended.
REFUSED, INTERRUPTED, TERMINATED = 2, 130, 143
# What each mark begins with, and the variable of the environment that has it.
MARK = 'PUSH_CONTROL_SURROUNDINGS'
# Part of the files of the cache that are spoilt, and bytes of each; limit of the size of files
# [bytes]; chosen: a recording begins, and does not end.
SPOILT_PART, SPOILT_BYTES = 0.3, 16
FILE_LIMIT = 20_000
# What is told of the last line that was printed: without these, and so many characters.
FOLDERS, LOG_HEAD = re.compile(r'/\S+/'), re.compile(r'^(\[.*?\] ?)+: ')
MAX_LENGTH = 150


class Finished(NamedTuple):
    """
    A command that has ended.

    :param status: exit status; negative: minus the signal that has ended it.
    :param output: all that it has printed.
    :param survivors: number of processes that it has left.
    """

    status: int
    output: str
    survivors: int

    def observation(self, expected: int) -> Observation:
        """
        Compare its end with what is expected.

        :param expected: exit status.
        """
        faults = traceback_in(self.output)
        if self.status != expected:
            faults.append(f'ends with {self.status}, expected {expected}')
        if self.survivors:
            faults.append(f'leaves {self.survivors} processes')
        lines = [line for line in self.output.splitlines() if line.strip()]
        return Observation(_shortened(lines[-1] if lines else 'prints nothing'), tuple(faults))


def _shortened(text: str) -> str:
    """Leave out what differs each time, folders and the head of a line of a log, and the end."""
    line = FOLDERS.sub('', LOG_HEAD.sub('', text)).replace('|', '/')
    return textwrap.shorten(line, MAX_LENGTH, placeholder=' ...')


def run_command(arguments: Sequence[str], *, is_ready: Callable[[], bool] | None = None,
                signum: int = 0, environment: Mapping[str, str] | None = None,
                file_limit: int = 0) -> Finished:
    """
    Run a command of Python to its end.

    :param arguments: behind the interpreter.
    :param is_ready: whether ``signum`` is to be sent now; None for never.
    :param signum: that is sent once.
    :param environment: variables beside those of this process.
    :param file_limit: of the size of files [bytes]; 0 for none.
    """
    mark = f'{MARK}={uuid.uuid4().hex}'
    limit = functools.partial(resource.setrlimit, resource.RLIMIT_FSIZE,
                              (file_limit, file_limit)) if file_limit else None
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            [sys.executable, *arguments], stdout=output, stderr=subprocess.STDOUT,
            env={**os.environ, **(environment or {}), **dict([mark.split('=')])},
            preexec_fn=limit, start_new_session=True)
        _send_when_ready(process, is_ready, signum)
        try:
            status = process.wait(TIMEOUT)
        except subprocess.TimeoutExpired:
            process.kill()
            status = process.wait()
        survivors = _await_end(mark.encode())
        output.seek(0)
        return Finished(status, output.read().decode(errors='replace'), survivors)


def _send_when_ready(process: 'subprocess.Popen[bytes]', is_ready: Callable[[], bool] | None,
                     signum: int) -> None:
    while is_ready is not None and process.poll() is None:
        if is_ready():
            process.send_signal(signum)
            return
        time.sleep(PERIOD)


def _await_end(mark: bytes) -> int:
    """Wait until no process has a mark; return how many still have it after a while."""
    end = time.monotonic() + ENDING_TIME
    while (count := sum(mark in _environment(folder) for folder in Path('/proc').glob('[0-9]*'))
           ) and time.monotonic() < end:
        time.sleep(PERIOD)
    return count


def _environment(folder: Path) -> bytes:
    try:
        return (folder / 'environ').read_bytes()
    except OSError:
        return b''


def _start_with(change: Callable[[Path], None], expected: int = REFUSED) -> Observation:
    """Start the controller with a parameter file to which something is done."""
    scenario = place_robot(load_scenario(SCENARIO))
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder:
        path = write_parameter_files(Path(folder), scenario, scenario.control, Path(),
                                     real_time=True, stamped=True)[CONTROLLER]
        change(path)
        return run_command(['-m', MODULES[CONTROLLER], '--ros-args', '--params-file', str(path)],
                           environment=private_environment(domain)).observation(expected)


def _replaced(old: str, new: str) -> Callable[[Path], None]:
    """Make what changes the value of one parameter."""
    def change(path: Path) -> None:
        lines = path.read_text(encoding='utf-8').splitlines()
        path.write_text('\n'.join(
            line.partition(':')[0].replace(old, new.partition(':')[0]) + ':'
            + new.partition(':')[2] if line.strip().startswith(f'{old}:') else line
            for line in lines), encoding='utf-8')
    return change


def _as_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _as_bytes(path: Path) -> None:
    path.write_bytes(np.random.default_rng(1).bytes(10_000))


def _spoilt_cache() -> Observation:
    """Run a push with a cache of which some files are spoilt."""
    rng = np.random.default_rng(1)
    source = cache_directory()
    if source is None:
        return Observation('not run: there is no cache')
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, 'push_control', source.path.name)
        shutil.copytree(source.path, copy)
        files = sorted(path for path in copy.iterdir() if path.suffix == '.code')
        spoilt = [path for path in files if rng.uniform() < SPOILT_PART]
        for path in spoilt:
            content = bytearray(path.read_bytes())
            for position in rng.integers(len(content), size=SPOILT_BYTES):
                content[position] ^= 0xff
            path.write_bytes(content[:rng.integers(1, len(content) + 1)])
        finished = _push(Path(folder, 'out'), XDG_CACHE_HOME=folder)
        seen = f'{len(spoilt)} of {len(files)} files spoilt: runs as before'
        return Observation(seen, finished.observation(0).faults)


def _cache_is_a_file() -> Observation:
    """List scenarios and start a node where the folder of the cache cannot be made."""
    with tempfile.TemporaryDirectory() as folder:
        blocked = Path(folder, 'push_control')
        blocked.write_text('not a folder', encoding='utf-8')
        finished = _push(Path(folder, 'out'), XDG_CACHE_HOME=folder)
        return finished.observation(0)


def _push(out: Path, **environment: str) -> Finished:
    return run_command([*_replay(PUSH, out), '--in-process'], environment=environment)


def _replay(name: str, out: Path) -> list[str]:
    return ['-m', 'push_scenario.cli', name, '--out', str(out), '--no-pictures']


def _replay_with_signal(signum: int, expected: int) -> Observation:
    """Replay over DDS, and send a signal once a recording has begun."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        return run_command(
            _replay(SCENARIO, out), signum=signum,
            is_ready=lambda: any(path.stat().st_size for path in out.rglob('*.mcap'))
        ).observation(expected)


def _replay_with_file_limit() -> Observation:
    with tempfile.TemporaryDirectory() as folder:
        return run_command(_replay(SCENARIO, Path(folder)), file_limit=FILE_LIMIT,
                           ).observation(REFUSED)


COMMAND_CASES: dict[str, Callable[[], Observation]] = {
    'parameters: not a number': functools.partial(
        _start_with, _replaced('object.mass', 'object.mass: .nan')),
    'parameters: a wrong name': functools.partial(
        _start_with, _replaced('object.mass', 'object.masses: 3.0')),
    'parameters: a list for a number': functools.partial(
        _start_with, _replaced('object.mass', 'object.mass: [1.0, 2.0]')),
    'parameters: a text for a number': functools.partial(
        _start_with, _replaced('object.mass', 'object.mass: heavy')),
    'parameters: a folder': functools.partial(_start_with, _as_folder),
    'parameters: random bytes': functools.partial(_start_with, _as_bytes),
    'cache: some files are spoilt': _spoilt_cache,
    'cache: its folder is a file': _cache_is_a_file,
    'replay: Ctrl-C': functools.partial(_replay_with_signal, signal.SIGINT, INTERRUPTED),
    'replay: SIGTERM': functools.partial(_replay_with_signal, signal.SIGTERM, TERMINATED),
    'replay: SIGKILL': functools.partial(
        _replay_with_signal, signal.SIGKILL, -int(signal.SIGKILL)),
    'replay: a limit of the size of files': _replay_with_file_limit,
}
