"""Commands of the package: what they import, Ctrl-C meanwhile, and output that nobody reads."""

import gc
import os
import signal
import subprocess
import sys

from push_ros.start import (
    BROKEN_PIPE, import_node_module, INTERRUPTED, MISUSE, NODES, PUSH, TOOLS,
)
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
sys.argv = ["push", *{words!r}]
sys.exit(start.{name}())
"""


@pytest.mark.parametrize('name, module, number, status', [
    *((name, module, number, 0) for name, (module, _) in NODES.items()
      for number in (signal.SIGINT, signal.SIGTERM)),
    ('push', PUSH, signal.SIGINT, INTERRUPTED),
    *((name, module, signal.SIGINT, INTERRUPTED) for name, module in TOOLS.items())])
def test_an_interrupt_during_the_imports_ends_a_command_quietly(name, module, number, status):
    """With nothing on either stream."""
    code = INTERRUPTED_IMPORT.format(module=module, number=int(number), name=name, words=[])
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (status, '', '')


def test_an_interrupt_of_a_tool_that_has_just_begun_ends_it_quietly() -> None:
    """While it imports what it needs for its arguments."""
    code = INTERRUPTED_IMPORT.format(module='push_view.belief', number=int(signal.SIGINT),
                                     name='push', words=['replay', 'curved_push'])
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (INTERRUPTED, '', '')


def test_the_page_of_a_robot_needs_ros_and_says_so():
    """In a line, without a traceback."""
    code = ('import sys; sys.modules.update(rclpy=None, builtin_interfaces=None); '
            'from push_ros import start; sys.exit(start.view([]))')
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (MISUSE, '')
    assert done.stderr == 'push view: no module rclpy: source a ROS installation\n'


@pytest.mark.slow
def test_output_that_nobody_reads_ends_a_tool_quietly():
    """As behind ``| head``: whoever reads has gone before anything is written."""
    code = 'import sys; from push_ros import start; sys.exit(start.push())'
    with subprocess.Popen([sys.executable, '-c', code, 'replay', '--list'], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        errors = process.stderr.read()
    assert (process.returncode, errors) == (BROKEN_PIPE, '')


@pytest.mark.parametrize('given, expected', [(None, '1'), ('3', '3')])
def test_a_node_is_imported_with_one_thread_and_without_collections(
        given, expected, tmp_path, monkeypatch):
    """Whoever sets the number of threads keeps it; garbage is collected again afterwards."""
    (tmp_path / f'some_node_{expected}.py').write_text(
        'import gc, os\nfound = gc.isenabled(), os.environ["OPENBLAS_NUM_THREADS"]\n')
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv('OPENBLAS_NUM_THREADS', given or '')
    if given is None:
        del os.environ['OPENBLAS_NUM_THREADS']
    assert import_node_module(f'some_node_{expected}').found == (False, expected)
    assert gc.isenabled()


@pytest.mark.parametrize('node, left_out', [
    ('push_control.controller_node', ('push_control.task.supervisor', 'push_planner')),
    ('push_planner.planner_node', ('push_primitives', 'push_planner.task_planner',
                                   'push_planner.steered', 'push_planner.straight'))])
def test_a_node_does_not_import_what_its_first_message_does_not_need(node, left_out):
    """The modes of the controller, and all that plans, take as long as all the rest."""
    code = (f'import sys, {node}; '
            'print([name for name in sys.modules if name in ("casadi", "numba", "scipy") '
            f'or name.startswith({left_out})])')
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout == '[]\n'
