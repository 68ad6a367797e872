"""Commands of the package: Ctrl-C while they import, and output that nobody reads."""

import signal
import subprocess
import sys

from push_ros.start import BROKEN_PIPE, INTERRUPTED, NODES, TOOLS
import pytest

# Sends a signal to itself as soon as the module of a command is imported.
INTERRUPTED_IMPORT = """
import os, sys
from push_ros import start
class Interrupt:
    def find_spec(self, name, *_):
        if name == {module!r}:
            os.kill(os.getpid(), {number})
sys.meta_path.insert(0, Interrupt())
sys.exit(start.{name}())
"""


@pytest.mark.parametrize('name, module, number, status', [
    *((name, module, number, 0) for name, (module, _) in NODES.items()
      for number in (signal.SIGINT, signal.SIGTERM)),
    *((name, module, signal.SIGINT, INTERRUPTED) for name, module in TOOLS.items())])
def test_an_interrupt_during_the_imports_ends_a_command_quietly(name, module, number, status):
    """With nothing on either stream."""
    code = INTERRUPTED_IMPORT.format(module=module, number=int(number), name=name)
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (status, '', '')


@pytest.mark.slow
def test_output_that_nobody_reads_ends_a_tool_quietly():
    """As behind ``| head``: whoever reads has gone before anything is written."""
    code = 'import sys; from push_ros import start; sys.exit(start.replay())'
    with subprocess.Popen([sys.executable, '-c', code, '--list'], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        errors = process.stderr.read()
    assert (process.returncode, errors) == (BROKEN_PIPE, '')
